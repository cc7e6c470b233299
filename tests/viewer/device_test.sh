#!/usr/bin/env bash
# The coprocessor's panel in the real window: it is run on request, follows the cursor, is run again
# when a file changes, explains a device file that is wrong, and goes when it is told. Arguments: the
# program feeler, the folder of assets, a folder for pictures (kept), the folder of await_frames.
set -euo pipefail
feeler=$1 assets=$2 pictures=$3 tools=$4
screen_size=1280x800
# shellcheck source=tests/viewer/screen.sh
source "$(dirname "${BASH_SOURCE[0]}")/screen.sh"
cp "$assets/programs/clamped_plate_low.nc" "$work/plate.nc"
printf '[device]\nelements = 2\n' >"$work/device.toml"

# drag FROM TO: an upright edge, from one X to another.
drag() {
    xdotool mousemove "$1" 300
    frames
    xdotool mousedown 1
    frames
    xdotool mousemove "$2" 300
    frames
    xdotool mouseup 1
    frames
}

open_window "$work/plate.nc" --setup "$assets/setups/clamped_plate.toml"
xdotool windowsize "$window" 1280 800
expect 'it begins without the panel' '^plate.nc, line 2 \(block 0 of 45\) - feeler$'
press End
expect 'End' 'block 45 of 45'
still 01-without
press d
expect 'D runs the program beside the device' 'block 45 of 45\), coprocessor: nothing to ask - '
press l
expect 'L goes round to the first refused block' 'block 38 of 45, violation\), coprocessor: refused'
press shift+l
expect 'Shift+L goes back' 'block 42 of 45, violation\), coprocessor: refused'
press ctrl+Left
expect 'the answer follows the cursor' 'block [0-9]+ of 45\), coprocessor: (permitted|nothing)'
press End
expect 'End' 'block 45 of 45'
# The row of slack at this size, above what clearance shows of a violation.
row() { convert "$pictures/$1.png" -crop 1280x10+0+742 -fill black +opaque '#FF5A36' -format '%[fx:mean]' info:; }
has_slack() { [[ $(row "$1") != 0 ]]; }
shows 02-panel 'refusals stand on the timeline' has_slack 02-panel
still 02-panel
! has_slack 01-without || die 'without the coprocessor no refusals stand on the timeline'
click 1140 392
expect 'a click goes to the block before which the machine stands' 'block 38 of 45, violation'
drag 982 950 # the panel's edge
drag 369 340 # that of the list
press End
expect 'End' 'block 45 of 45'
press d
expect 'D hides the panel' 'block 45 of 45\) - feeler'
shows 03-hidden 'slack stays on the timeline' has_slack 03-hidden
press ctrl+q
ended 'with a device that has answered'
grep -Eq 'device_width = 33[12]' "$work/config/feeler/view.toml" || die 'the panel was made wider'
grep -Eq 'list_width = 34[34]' "$work/config/feeler/view.toml" || die 'the list was made narrower'

open_window "$work/plate.nc" --setup "$assets/setups/clamped_plate.toml" --device "$work/device.toml"
expect 'a device that was asked for is run from the beginning' 'coprocessor: nothing to ask - '
printf '[device]\nelements = none\n' >"$work/device.toml"
expect 'a device file that is wrong is explained' 'coprocessor: failed - '
picture 04-wrong
printf '[device]\nelements = 4\n' >"$work/device.toml"
expect 'and read again when it is mended' 'coprocessor: nothing to ask - '
press ctrl+r
expect 'a program that is read again is run again' 'coprocessor: (running|nothing to ask) - '
press ctrl+q
ended 'while the device works'
printf 'passed\n'
