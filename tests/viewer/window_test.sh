#!/usr/bin/env bash
# Drives the real window with keys and clicks on a screen of its own, as a person would, and reads
# from its title where it stands. Arguments: the program feeler, the folder of assets, a folder for
# pictures (kept).
set -euo pipefail
feeler=$1 assets=$2 pictures=$3
for command in Xvfb xdotool import; do
    if ! command -v "$command" >/dev/null; then
        printf 'skipped: there is no %s\n' "$command"
        exit 77
    fi
done

mkdir -p "$pictures"
rm -f "$pictures"/*.png
work=$(mktemp -d)
mkdir "$work/pictures"
cp "$assets/programs/clamped_plate_low.nc" "$work/plate.nc"
export XDG_CONFIG_HOME=$work/config XDG_PICTURES_DIR=$work/pictures LC_ALL=C.UTF-8

exec 3<>"$work/display" 2>/dev/null || true
Xvfb -displayfd 3 -screen 0 1440x900x24 -noreset 3>"$work/display" 2>/dev/null &
screen=$!
view=
cleanup() {
    [[ -z $view ]] || kill "$view" 2>/dev/null || true
    kill "$screen" 2>/dev/null || true
    rm -rf "$work"
}
trap cleanup EXIT
for _ in $(seq 100); do
    [[ -s $work/display ]] && break
    sleep 0.1
done
DISPLAY=:$(tr -d '\n' <"$work/display")
export DISPLAY

die() {
    import -window root "$pictures/failed.png" || true
    printf 'failed: %s\nthe title is: %s\n' "$1" "$(title)"
    exit 1
}
title() { xdotool getwindowname "$window" 2>/dev/null || true; }
# expect WHAT PATTERN: the title comes to match within 20 s.
expect() {
    for _ in $(seq 200); do
        [[ $(title) =~ $2 ]] && return
        sleep 0.1
    done
    die "$1"
}
picture() {
    sleep 0.7
    import -window root "$pictures/$1.png"
}
same_picture() { [[ $(compare -metric AE "$pictures/$1.png" "$pictures/$2.png" null: 2>&1 || true) == 0 ]]; }
press() { xdotool key --window 0 --clearmodifiers "$@"; }

"$feeler" view "$work/plate.nc" --setup "$assets/setups/clamped_plate.toml" 2>"$work/errors" &
view=$!
window=$(xdotool search --sync --onlyvisible --name feeler | head -1)
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

press t
picture 07-light
same_picture 06-filter 07-light && die 'T changes the theme'
press question
picture 08-keys
press Escape
press w
picture 09-what-if
press Escape
xdotool windowsize "$window" 900 600
sleep 0.7
picture 10-small
xdotool windowsize "$window" 1440 900
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
status=0
wait "$view" || status=$?
view=
[[ $status == 0 ]] || die "closing ends with status $status"
[[ ! -s $work/errors ]] || die "nothing is said on standard error: $(cat "$work/errors")"
grep -q 'theme = "light"' "$work/config/feeler/view.toml" || die 'the theme is remembered'
printf 'passed\n'
