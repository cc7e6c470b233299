#!/usr/bin/env bash
# The coprocessor panel in the real window: the program is run with the device on request, and again
# when a file changes; the panel follows the cursor, explains an invalid device file, and can be
# hidden. Arguments: the program feeler, the folder of assets, a folder for pictures (kept), the
# folder of await_frames.
set -euo pipefail
feeler=$1 assets=$2 pictures=$3 tools=$4
screen_size=1280x800
# shellcheck source=tests/viewer/screen.sh
source "$(dirname "${BASH_SOURCE[0]}")/screen.sh"
cp "$assets/programs/clamped_plate_low.nc" "$work/plate.nc"
printf '[device]\nelements = 2\n' >"$work/device.toml"

# drag FROM TO: drags a vertical edge from one X to another.
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
expect 'it starts without the panel' '^plate.nc, line 2 \(block 0 of 45\) - feeler$'
press End
expect 'End' 'block 45 of 45'
still 01-without
press d
expect 'D runs the program with the device' 'block 45 of 45\), coprocessor: no motion - '
press l
expect 'L wraps around to the first refused block' 'block 38 of 45, collision\), coprocessor: refused'
press shift+l
expect 'Shift+L goes back' 'block 42 of 45, collision\), coprocessor: refused'
press ctrl+Left
expect 'the answer follows the cursor' 'block [0-9]+ of 45\), coprocessor: (permitted|no motion)'
press End
expect 'End' 'block 45 of 45'
# Average of the pixels in the colour of violations, in the row of slack at this window size. The row
# is below the bars of clearance.
row() { convert "$pictures/$1.png" -crop 1280x10+0+742 -fill black +opaque '#FF5A36' -format '%[fx:mean]' info:; }
has_slack() { [[ $(row "$1") != 0 ]]; }
shows 02-panel 'the timeline shows refused blocks' has_slack 02-panel
still 02-panel
! has_slack 01-without || die 'without the coprocessor the timeline shows no refused blocks'
click 1140 392
expect 'a click goes to the block before which the machine is stopped' 'block 38 of 45, collision'
drag 982 950 # edge of the panel
drag 369 340 # edge of the list
press End
expect 'End' 'block 45 of 45'
press d
expect 'D hides the panel' 'block 45 of 45\) - feeler'
shows 03-hidden 'slack stays on the timeline' has_slack 03-hidden
press ctrl+q
ended 'after the device has answered'
grep -Eq 'device_width = 33[12]' "$work/config/feeler/view.toml" || die 'the width of the panel is saved'
grep -Eq 'list_width = 34[34]' "$work/config/feeler/view.toml" || die 'the width of the list is saved'

open_window "$work/plate.nc" --setup "$assets/setups/clamped_plate.toml" --device "$work/device.toml"
expect '--device runs the device from the start' 'coprocessor: no motion - '
printf '[device]\nelements = none\n' >"$work/device.toml"
expect 'an invalid device file is explained' 'coprocessor: failed - '
picture 04-wrong
printf '[device]\nelements = 4\n' >"$work/device.toml"
expect 'and reloaded when it is corrected' 'coprocessor: no motion - '
press ctrl+r
expect 'a reloaded program is run again' 'coprocessor: (running|no motion) - '
press ctrl+q
ended 'while the device is running'
printf 'passed\n'
