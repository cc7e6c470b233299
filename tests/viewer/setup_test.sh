#!/usr/bin/env bash
# Builds a job in the window with keys and mouse: a vise is put under the stock and closed on it,
# undone, saved, lost in a crash and restored.
# setup_test.sh FEELER ASSETS PICTURES TOOLS
set -euo pipefail

feeler=$1 assets=$2 pictures=$3 tools=$4
# shellcheck source=tests/viewer/screen.sh
. "$(dirname "$0")/screen.sh"

cp "$assets"/meshes/vise6-*.stl "$work"
cat >"$work/job.nc" <<'EOF'
%
O1001
G90 G54 G21
T2 M6
S8000 M3
G43 H2 Z15
G0 X0 Y0
Z2
G1 Z-10 F300
X20 F1200
G0 Z15
M30
%
EOF
cat >"$work/job.toml" <<'EOF'
# The bracket in the vise.
[stock]
box = [[-45, -30, -25], [45, 30, 0]]

[[fixture]]
name = "vise"
mesh = "vise6-body.stl"
at = [0, 60, -60]

[[fixture]]
name = "fixed jaw"
mesh = "vise6-fixed-jaw.stl"
frame = "vise"

[[fixture]]
name = "jaw"
mesh = "vise6-moving-jaw.stl"
at = [0, -150, 0] # open
frame = "vise"
EOF
cp "$work/job.toml" "$work/before.toml"
sed 's/at = \[0, 60, -60\]/at = [0, 30, -25]/; s/at = \[0, -150, 0\]/at = [0, -60, 0]/' \
    "$work/before.toml" >"$work/closed.toml"

is_closed() { cmp -s "$work/job.toml" "$work/closed.toml"; }
is_as_before() { cmp -s "$work/job.toml" "$work/before.toml"; }
has_unsaved() { compgen -G "$work/config/feeler/unsaved/*.toml" >/dev/null; }
vise_row() { click 60 245; }
jaw_row() { click 60 286; }

# close_vise: slides the vise to the stock, upwards and to the back, and the jaw to the front.
close_vise() {
    vise_row
    click 200 660 # -Y
    expect 'an edit marks the program' '^\* job.nc'
    click 300 660 # +Z
    jaw_row
    click 235 660 # +Y
}

open_window "$work/job.nc" --setup "$work/job.toml"
expect 'opens' '^job.nc, line 2'
press e
still 01-setup

# The arrow along X moves the vise by whole millimetres along X only.
vise_row
frames
xdotool mousemove 826 469
frames
xdotool mousedown 1
for _ in 1 2 3 4 5; do
    xdotool mousemove_relative 9 5
    frames
done
xdotool mouseup 1
expect 'a drag of an arrow is an edit' '^\* job.nc'
press ctrl+s
is_moved() { grep -Eq '^at = \[[1-9][0-9]*, 60, -60\]$' "$work/job.toml"; }
wait_for is_moved || die 'the arrow along X moves along X, in whole millimetres'
press ctrl+z ctrl+s
wait_for is_as_before || die 'the drag is one edit'

# Insert opens the list of what can be added, and F2 the name of the fixture.
vise_row
press Insert Return
expect 'a block is added by keys' '^\* job.nc'
press F2
xdotool type clamp
press Return ctrl+s
has_clamp() { grep -q '^name = "clamp"$' "$work/job.toml"; }
wait_for has_clamp || die 'the new fixture is renamed by keys'
press ctrl+z ctrl+z ctrl+s
wait_for is_as_before || die 'both are undone'

vise_row # the panel has the keys
click 38 65 # the tab of the program
press Right
expect 'after a click on its tab the program has the keys' 'block 1 of'
press Home e
expect 'Home' 'block 0 of'

# What is typed is read as a whole, and is saved although its field was not left.
click 60 182 # G54
click 160 443 # its X
xdotool type -- '-300,5'
press Tab
xdotool type -- '-3 1/2'
press ctrl+s
has_zero() { grep -q '^G54 = { X = -300.5, Y = -3.5, Z = -500 }$' "$work/job.toml"; }
wait_for has_zero || die 'a field is taken over before the set-up is saved'
press ctrl+z
press ctrl+z ctrl+s
wait_for is_as_before || die 'undo is about the set-up while nothing is typed'
click 160 443
xdotool type -- '1,234'
press Tab
shows 02-refused 'what can be meant in two ways is refused' has_color 02-refused '#FF5A36' 40
is_as_before || die 'and changes nothing'
xdotool type 5
press Tab
expect 'the next field goes on' '^\* job.nc'
press ctrl+z
expect 'and can be undone' '^job.nc'

close_vise
press ctrl+s
wait_for is_closed || die 'the vise is closed, exactly, and comments stay'
expect 'it is saved' '^job.nc'
picture 02-closed

press ctrl+z ctrl+z ctrl+z
expect 'edits are undone after saving' '^\* job.nc'
press ctrl+s
wait_for is_as_before || die 'all edits are undone'
press ctrl+y ctrl+y ctrl+y
wait_for has_unsaved || die 'unsaved edits are kept'
press ctrl+q
still 03-leaving
! has_ended || die 'closing asks before edits are dropped'
press Escape
expect 'Esc keeps the window open' '^\* job.nc'

# Another program takes a tab of its own: nothing is asked, and no edit is lost.
cp "$work/job.nc" "$work/other.nc"
"$tools/drop_files" "$window" 700 400 "$work/other.nc"
expect 'a program is opened beside edits' '^other.nc'
press ctrl+q
expect 'closing shows the program with edits' '^\* job.nc'
still 03-leaving-both
press Escape ctrl+w Escape
expect 'Ctrl+W asks as well' '^\* job.nc'
press ctrl+Tab ctrl+w
expect 'a program without edits is closed' '^\* job.nc'

kill -9 "$view"
wait_for has_ended || die 'the window is killed'
wait "$view" 2>/dev/null || true
view='' window=''
is_as_before || die 'a crash changes no file'
open_window "$work/job.nc" --setup "$work/job.toml"
still 04-found
click 60 162 # Restore them
expect 'unsaved edits are restored' '^\* job.nc'
press ctrl+s
wait_for is_closed || die 'the restored edits are saved'
! has_unsaved || die 'saved edits are not kept as unsaved'

# What is being typed belongs to its program when the tab changes.
"$tools/drop_files" "$window" 700 400 "$work/other.nc"
expect 'the other program is opened again' '^other.nc'
press ctrl+Tab
expect 'Ctrl+Tab shows the first' '^job.nc'
click 60 245 # the stock: everything is lower while there are tabs
click 152 539 # its X
xdotool type 7
press ctrl+Tab
expect 'Ctrl+Tab works while something is typed' '^other.nc'
press ctrl+w
expect 'what was typed is an edit' '^\* job.nc'
press ctrl+s
is_typed() { grep -q '^at = \[7, 0, 0\]$' "$work/job.toml"; }
wait_for is_typed || die 'and it is saved'
press ctrl+z ctrl+s
wait_for is_closed || die 'and undone'

# A program that is not shown is checked again, too, when its set-up changes.
"$tools/drop_files" "$window" 700 400 "$work/other.nc"
expect 'a program without a set-up' '^other.nc'
still 06-hidden
has_no_color 06-hidden '#FF5A36' || die 'both are without problems'
sed -i 's/at = \[0, -60, 0\]/at = [0, -20, 0]/' "$work/job.toml"
shows 07-hidden 'the tab of the other says that there is a problem' has_color 07-hidden '#FF5A36' 20
cp "$work/closed.toml" "$work/job.toml"
shows 08-hidden 'and that it is gone' has_no_color 08-hidden '#FF5A36'
press ctrl+w
expect 'the first is left' '^job.nc'

printf '[[[\n' >"$work/job.toml"
expect 'a damaged set-up keeps the last good state' 'last good state'
picture 05-damaged
cp "$work/closed.toml" "$work/job.toml"
wait_for title_matches '^job.nc, line [0-9]+ \(block [0-9]+ of [0-9]+[^)]*\) - feeler$' \
    || die 'and is read again when it is mended'
press ctrl+q
ended 'by Ctrl+Q'
printf 'passed\n'
