#!/usr/bin/env bash
# Drives the real window with keys and clicks on a separate virtual screen, and reads the current
# block from its title. Arguments: the program feeler, the folder of assets, a folder for pictures
# (kept), the folder of await_frames.
set -euo pipefail
feeler=$1 assets=$2 pictures=$3 tools=$4
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
expect 'N goes to the first problem' 'line 44 \(block 38 of 45, collision\)'
still 03-violation
press f
shows 04-closest-pair 'F shows the closest pair' differ 03-violation 04-closest-pair
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
frames
xdotool type 30
press Return
expect 'G goes to a line' 'line 30 '
press ctrl+f
frames
xdotool type 'violation'
still 06-filter
press ctrl+a BackSpace
press Escape
picture 06-filter-cleared
press g
frames
xdotool type 30
kill -STOP "$view" # so that Enter, Ctrl+F and what is typed then arrive at once
xdotool key --window 0 --clearmodifiers Return
xdotool key --window 0 --clearmodifiers ctrl+f
xdotool type 'violation'
kill -CONT "$view"
# The panel of the program: the rest of the window is not about the filter.
shows 06-filter-fast 'what is typed right after Ctrl+F goes into the filter' \
    same_in_area 06-filter 06-filter-fast 372x740+0+48
press ctrl+a BackSpace
press Escape

xdotool mousemove 1198 810 click 1
expect 'a click on the timeline goes to its block' 'block 38 of 45, collision'
xdotool mousemove 640 810 mousedown 1 mousemove 500 810 mousemove 400 810 mouseup 1
expect 'dragging scrubs back' 'block 1[23] of 45'
frames # process the release before the mouse moves on
press Home
expect 'Home' 'block 0 of'
xdotool mousemove 640 810 mousedown 1 mousemove 500 810
expect 'dragging scrubs' 'block 1[56] of 45'
kill -STOP "$view" # so that the end of the drag and the release arrive at once
xdotool mousemove 400 810 mouseup 1
kill -CONT "$view"
expect 'a drag counts up to its end' 'block 1[23] of 45'
frames
press Home
expect 'Home shows the beginning of the list' 'block 0 of'
click 200 340
expect 'a click in the list goes to its line' 'line 16 '

[[ $(of_color 06-filter-cleared '#FFFFFF') -lt 5000 ]] || die 'it starts with the dark theme'
press t
shows 07-light 'T changes the theme: panels are white' has_color 07-light '#FFFFFF' 100000
press question
picture 08-keys
press Escape
press w
picture 09-what-if
press Escape
press u
picture 09-tolerances
press Escape
# Whether the last but one row of pixels is drawn in a window of 900x600.
is_filled() { [[ $(convert "$pictures/$1.png" -crop 900x1+0+598 -format '%[fx:mean>0.5]' info:) == 1 ]]; }
xdotool windowsize "$window" 900 600
shows 10-small 'a smaller window is filled to its edge' is_filled 10-small
xdotool windowsize "$window" 1440 900
shows 10-large 'a larger window is drawn' differ 10-small 10-large 100000
click 1198 810
expect 'clicks hit the right block after a change of size' 'block 38 of 45, collision'
press 1
picture 11-top
press F12
wait_for test -s "$work/pictures/feeler-0001.png" || die 'F12 saves a picture'

press Home
expect 'Home' 'block 0 of'
press bracketright bracketright bracketright bracketright
press space
expect 'Space plays' 'block ([4-9]|[1-4][0-9]) of'
press space
press Home

still 14-before
press v
shows 14-findings 'V shows the findings' differ 14-before 14-findings
press ctrl+Down
expect 'Ctrl+Down goes to the first finding' 'block 3[0-9] of 45'
press v
press Home
expect 'Home' 'block 0 of'
press e
shows 15-setup 'E opens the set-up' differ 14-before 15-setup 100000
xdotool windowsize "$window" 640 420
shows 16-setup-small 'a very small window is drawn' differ 15-setup 16-setup-small 100000
press Escape
shows 17-small 'Escape closes it' differ 16-setup-small 17-small
xdotool windowsize "$window" 1440 900

sed -i '6a (ANOTHER LINE)\nG4 P0.1' "$work/plate.nc"
expect 'a saved file is reloaded' 'of 4[67]\)'
printf 'GARBAGE[[[' >"$work/plate.nc"
expect 'a program that cannot be run leaves the last good state' 'of 4[67]\), last good state - feeler'
shows 12-garbage 'with a banner' has_color 12-garbage '#B3261E' 5000
head -c 3000 /dev/urandom >"$work/plate.nc"
sleep 1.5 # clock: the window reads it again
expect 'a file that cannot be read likewise' 'of 4[67]\), last good state - feeler'
picture 13-error
cp "$assets/programs/clamped_plate.nc" "$work/plate.nc"
expect 'and it is read again when it is corrected' 'plate.nc, line [0-9]+ \([^,]*\) - feeler'

press ctrl+q
ended 'by Ctrl+Q'
grep -q 'theme = "light"' "$work/config/feeler/view.toml" || die 'the theme is saved'
printf 'passed\n'
