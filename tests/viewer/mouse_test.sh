#!/usr/bin/env bash
# The mouse in the real window: drops files through the window system, sets breakpoints in the
# gutter, drags the timeline, finds lines by clicks on the path and on cut surfaces, makes a section.
# Arguments: the program feeler, the folder of assets, a folder for pictures (kept), the folder of
# drop_files and await_frames.
set -euo pipefail
feeler=$1 assets=$2 pictures=$3 tools=$4
# shellcheck source=tests/viewer/screen.sh
source "$(dirname "${BASH_SOURCE[0]}")/screen.sh"

# Three grooves along X in a plate: lines 7, 11 and 15 cut them.
cat >"$work/grooves.nc" <<'NC'
G21 G90 G17 G54
T1 M6
M3 S3000
G43 H1 Z20.
G0 X-10. Y20.
G1 Z-5. F800.
X110.
G0 Z20.
X-10. Y50.
G1 Z-5.
X110.
G0 Z20.
X-10. Y80.
G1 Z-5.
X110.
G0 Z20.
M30
NC
cat >"$work/grooves.toml" <<'TOML'
mesh_size = 1.0
[stock]
box = [[0, 0, -20], [100, 100, 0]]
frame = "G54"
[offsets]
G54 = { X = -350, Y = -200, Z = -420 }
[[tool]]
number = 1
shape = "flat"
diameter = 14
flute_length = 22
shank = [[14, 14, 23]]
holder = [[32, 40, 30]]
TOML

drop() { "$tools/drop_files" "$window" 700 400 "$@" || die "a drop of $* is accepted"; }

# shellcheck disable=SC2119
open_window
picture 01-welcome
drop "$work/grooves.nc" "$work/grooves.toml"
expect 'a program and its set-up are opened by a drop' 'grooves.nc, line 1 \(block 0 of 16'
still 02-dropped

# The list: rows of 20 pixels from y = 114 on; the gutter is left of x = 34.
row_y() { printf '%s' $((104 + 20 * $1)); }
click 22 "$(row_y 9)"
[[ $(title) =~ 'block 0 of' ]] || die 'a click in the gutter does not go to another block'
picture 03-gutter
press F5
expect 'F5 stops at the line whose gutter was clicked' 'line 9 \(block 8 of'
click 22 "$(row_y 9)"
press Home
expect 'Home' 'block 0 of'
press F5
expect 'a second click removes the breakpoint' 'block 16 of 16'

# The timeline: the bars of 17 blocks are between x = 12 and x = 1428.
bar_x() { printf '%s' $((12 + (1416 * (2 * $1 + 1)) / 34)); }
xdotool mousemove "$(bar_x 14)" 800 mousedown 1
expect 'a press on the timeline goes to its block' 'block 14 of'
for block in 12 9 6 3; do
    xdotool mousemove "$(bar_x $block)" 830
    expect 'the timeline follows a drag to the left' "block $block of"
done
for block in 5 11; do
    xdotool mousemove "$(bar_x $block)" 830
    expect 'and to the right' "block $block of"
done
xdotool mouseup 1
frames
xdotool mousemove "$(bar_x 2)" 830
frames
[[ $(title) =~ 'block 11 of' ]] || die 'the timeline does not move when the button is up'

# The view: from the top, without perspective, tool and machine.
press End
expect 'End' 'block 16 of'
xdotool mousemove 720 600
press 1
press p
press shift+h
press shift+m
press a
still 04-top

click 425 213
expect 'a click on the path goes to its line' 'line 15 '
click 425 582
expect 'and on another stretch of it' 'line 7 '
press End
press shift+p
still 05-whole
click 800 425
expect 'a click on the floor of a groove goes to the line that cut it' 'line 11 '
picture 05-cut-by
press End
still 05-whole
click 800 605
expect 'and in another groove' 'line 7 '
press End
expect 'End' 'block 16 of'
still 05-whole
click 800 310
picture 06-raw
[[ $(title) =~ 'block 16 of' ]] || die 'a click on raw stock goes nowhere'

# The section: a hatched face in the colour of the stock where it is cut open.
face='#999EA6'
press 0
press a
xdotool mousemove 720 30
shows 07-whole 'there is no face without a section' has_no_color 07-whole "$face"
press x
shows 08-section 'a section shows a face' has_color 08-section "$face" 10000
click 1000 500
[[ $(title) =~ 'block 16 of' ]] || die 'a click misses what the section has removed'
xdotool mousemove 720 30
# Its bar at the lower edge of the view: keys, slider, axis, side, a picked face.
sleep 6 # clock: the message of the click is shown for 5 s
still 08-section
press period
shows 08-moved '. moves the section' differ 08-section 08-moved 300
press comma
shows 08-back ', moves it back' same 08-section 08-back
click 860 716
shows 08-slid 'the slider moves it far' differ 08-section 08-slid 5000
click 1042 716
shows 08-flipped 'a button cuts away the other side' differ 08-slid 08-flipped 5000
click 497 716
shows 08-level 'another cuts across Z' differ 08-flipped 08-level 5000
shows 08-level 'and shows a face' has_color 08-level "$face" 10000
click 540 716
still 08-picking
click 770 560
shows 08-picked 'a click on a face cuts parallel to it' differ 08-picking 08-picked 300
[[ $(title) =~ 'block 16 of' ]] || die 'picking a face goes to no line'
click 1109 716
shows 08-closed 'a button ends the section' has_no_color 08-closed "$face"
press x
shows 08-again 'X begins another' has_color 08-again "$face" 10000
xdotool mousemove 720 30
press Escape
shows 09-whole 'Escape ends the section' has_no_color 09-whole "$face"

# The camera: a drag turns, the wheel zooms in, and neither changes the current block.
xdotool mousemove 900 600
frames
xdotool mousedown 2
for x in 850 800 750; do
    frames
    xdotool mousemove "$x" 560
done
frames
xdotool mouseup 2
frames
xdotool mousemove 720 30
shows 10-turned 'a drag turns the view' differ 09-whole 10-turned 20000
xdotool mousemove 760 500
frames
xdotool click 4 click 4
frames
xdotool mousemove 720 30
shows 11-nearer 'the wheel zooms in' differ 10-turned 11-nearer 20000
[[ $(title) =~ 'block 16 of' ]] || die 'the camera does not change the current block'

# Another program by a drop, and drops that open nothing.
cp "$assets/programs/clamped_plate_low.nc" "$work/plate.nc"
sed 's/^X110\.$/&\n(TWICE)/' "$work/grooves.nc" >"$work/a program with blanks.nc"
drop "$work/plate.nc"
expect 'another program is opened by a drop, at its beginning' 'plate.nc, line 2 \(block 0 of'
picture 12-another
drop "$work/a%20program%20with%20blanks.nc"
expect 'a file name with blanks is opened' 'a program with blanks.nc, line 1 \(block 0 of'
printf 'solid\nendsolid\n' >"$work/part.stl"
drop "$work/part.stl"
picture 13-mesh
expect 'a mesh becomes a fixture of the set-up; this one is empty' 'with blanks.nc, line .*, last good state'
press ctrl+z
expect 'Ctrl+Z takes it out again' '^a program with blanks.nc, line 1 \(block 0 of 16[^*]*\) - feeler'

press ctrl+q
ended 'by Ctrl+Q'
printf 'passed\n'
