#!/usr/bin/env bash
# Drives the real window with keys and clicks on a screen of its own, as a person would, and reads
# from its title where it stands. Arguments: the program feeler, the folder of assets, a folder for
# pictures (kept).
set -euo pipefail
feeler=$1 assets=$2 pictures=$3
# shellcheck source=tests/viewer/screen.sh
source "$(dirname "${BASH_SOURCE[0]}")/screen.sh"
cp "$assets/programs/clamped_plate_low.nc" "$work/plate.nc"

open_window "$work/plate.nc" --setup "$assets/setups/clamped_plate.toml"
xdotool mousemove 720 450

expect 'opens at the first block' 'plate.nc, line 2 \(block 0 of 45\)'
picture 01-open
press Right
expect 'Right steps' 'block 1 of'
press shift+Right
expect 'Shift+Right steps ten' 'block 11 of'
picture 02-step
press Left
expect 'Left steps back' 'block 10 of'
press ctrl+Right
expect 'Ctrl+Right goes to the next tool' 'line 38 '
press End
expect 'End goes to the end' 'block 45 of 45'
press Home
expect 'Home goes to the beginning' 'block 0 of'

press n
expect 'N goes to the first violation' 'line 44 \(block 38 of 45, violation\)'
picture 03-violation
press f
picture 04-closest-pair
same_picture 03-violation 04-closest-pair && die 'F looks at the closest pair'
press F3
expect 'F3 goes to the next' 'line 45 '
press shift+n
expect 'Shift+N goes back' 'line 44 '

press Home
press Down Down Down Down
expect 'Down steps' 'block 4 of'
press F9
press Home
expect 'Home' 'block 0 of'
press F5
expect 'F5 stops at the breakpoint' 'line 8 \(block 4 of'
picture 05-breakpoint
press F9

press g
sleep 0.5
xdotool type 30
press Return
expect 'G goes to a line' 'line 30 '
press ctrl+f
sleep 0.5
xdotool type 'violation'
picture 06-filter
press BackSpace BackSpace BackSpace BackSpace BackSpace BackSpace BackSpace BackSpace BackSpace
press Escape
picture 06-filter-cleared

xdotool mousemove 1198 810 click 1
expect 'a click on the timeline goes to its block' 'block 38 of 45, violation'
xdotool mousemove 640 810 mousedown 1 mousemove 500 810 mousemove 400 810 mouseup 1
expect 'dragging scrubs back' 'block 1[23] of 45'
sleep 0.5 # the button is up before the mouse goes on
xdotool mousemove 200 340 click 1
expect 'a click into the list goes to its line' 'line 16 '

[[ $(of_color 06-filter-cleared '#FFFFFF') -lt 5000 ]] || die 'it begins dark'
press t
picture 07-light
[[ $(of_color 07-light '#FFFFFF') -gt 100000 ]] || die 'T changes the theme: panels are white'
press question
picture 08-keys
press Escape
press w
picture 09-what-if
press Escape
xdotool windowsize "$window" 900 600
sleep 0.7
picture 10-small
[[ $(convert "$pictures/10-small.png" -crop 900x1+0+598 -format '%[fx:mean>0.5]' info:) == 1 ]] \
    || die 'a smaller window is filled to its edge'
xdotool windowsize "$window" 1440 900
sleep 0.7
click 1198 810
expect 'after a change of size clicks meet what is there' 'block 38 of 45, violation'
press 1
picture 11-top
press F12
for _ in $(seq 50); do
    [[ -s $work/pictures/feeler-0001.png ]] && break
    sleep 0.1
done
[[ -s $work/pictures/feeler-0001.png ]] || die 'F12 saves a picture'

press Home
expect 'Home' 'block 0 of'
press bracketright bracketright bracketright bracketright
press space
expect 'Space plays' 'block ([4-9]|1[0-9]) of'
press space
press Home

picture 14-before
press v
picture 14-findings
same_picture 14-before 14-findings && die 'V shows the findings'
press ctrl+Down
expect 'Ctrl+Down goes to the first of them' 'block 3[0-9] of 45'
press v
press Home
expect 'Home' 'block 0 of'
press e
picture 15-setup
[[ $(compare -metric AE "$pictures/14-before.png" "$pictures/15-setup.png" null: 2>&1 || true) -gt 100000 ]] \
    || die 'E opens the set-up'
xdotool windowsize "$window" 640 420
sleep 0.7
picture 16-setup-small
press Escape
picture 17-small
same_picture 16-setup-small 17-small && die 'Escape closes it'
xdotool windowsize "$window" 1440 900
sleep 0.7

sed -i '6a (ANOTHER LINE)\nG4 P0.1' "$work/plate.nc"
expect 'a saved file is read again' 'of 4[67]\)'
printf 'GARBAGE[[[' >"$work/plate.nc"
expect 'a program that cannot be run is explained' 'could not be opened'
picture 12-garbage
head -c 3000 /dev/urandom >"$work/plate.nc"
expect 'what cannot be read is explained' 'could not be opened'
picture 13-error
cp "$assets/programs/clamped_plate.nc" "$work/plate.nc"
expect 'and opens again when it is mended' 'plate.nc, line'

press ctrl+q
ended 'by Ctrl+Q'
grep -q 'theme = "light"' "$work/config/feeler/view.toml" || die 'the theme is remembered'
printf 'passed\n'
