#!/usr/bin/env bash
# Sets up a whole job in the window, from a bare program: stock, a vise that is closed on it, two
# clamps, three holders, a stick-out. Counts the clicks; what is typed is that of a user. Then the
# zero is put on a corner, all is undone, redone, saved and opened again.
# job_test.sh FEELER ASSETS PICTURES TOOLS
set -euo pipefail

feeler=$1 assets=$2 pictures=$3 tools=$4
here=$(cd "$(dirname "$0")" && pwd -P)
# shellcheck source=tests/viewer/screen.sh
. "$here/screen.sh"

cp "$assets"/meshes/vise6-*.stl "$here/bracket.nc" "$work"
# The same job, as a person writes it down.
cat >"$work/wanted.toml" <<'END'
[stock]
box = [[-60, -40, -40], [60, 40, 1]]

[[fixture]]
name = "vise"
mesh = "vise6-body.stl"
at = [0, 40, -40]

[[fixture]]
name = "fixed jaw"
mesh = "vise6-fixed-jaw.stl"
frame = "vise"

[[fixture]]
name = "jaw"
mesh = "vise6-moving-jaw.stl"
at = [0, -80, 0]
frame = "vise"

[[fixture]]
name = "clamp left"
box = [[0, 0, 0], [55, 30, 20]]
at = [-100, -15, 1]

[[fixture]]
name = "clamp right"
box = [[0, 0, 0], [55, 30, 20]]
at = [45, -15, 1]

[[tool]]
number = 1
holder = "BT40-EM20"

[[tool]]
number = 2
stick_out = 24
holder = "BT40-EM10"

[[tool]]
number = 3
holder = "BT40-EM12"
END

# Waits until all keys have had their effect: each may need several frames.
settle() { "$tools/await_frames" "$window" 30 || die 'the window keeps drawing'; }

clicks=0
pick() {
    click "$1" "$2"
    clicks=$((clicks + 1))
}
# fill VALUE...: types into the field that has the keyboard and the ones after it.
fill() {
    local value
    for value in "$@"; do
        xdotool type -- "$value"
        press Tab
    done
    settle
}
# named NAME: renames the fixture that was added.
named() {
    press F2
    xdotool type -- "$1"
    press Tab
    settle
}
# add_mesh PART: a mesh whose name contains this.
add_mesh() {
    press Insert Down Return
    settle
    xdotool type -- "$1"
    settle
    press Return
    settle
}
# holder N: the one after this many of the end-mill holders for BT40, in the open list.
holder() {
    press Down Down Right Down Right
    for _ in $(seq "$1"); do press Down; done
    press Return
    settle
}
scroll() {
    xdotool mousemove 150 300 click "$1" click "$1" click "$1" click "$1" click "$1" click "$1"
    frames
}
# report SETUP: what a check from the command line finds.
report() {
    "$feeler" check "$work/bracket.nc" --setup "$1" --format json >"$work/report.json" || true
    python3 - "$work/report.json" <<'END'
import json, sys
report = json.load(open(sys.argv[1]))
print(report["verdict"], report["coverage"])
for finding in report["findings"]:
    print(finding.get("line"), finding["rule"], finding.get("pair"))
for block in report["blocks"]:
    print(block["line"], block.get("clearance"), block.get("pair"))
END
}

begin=$SECONDS # clock: is printed
open_window "$work/bracket.nc"
expect 'opens' '^bracket.nc, line 2'
press e
still 01-bare
pick 150 447 # the size of the stock
fill 120 80 41 -60 -40 -40
expect 'the stock is stated' '^\* bracket.nc'
add_mesh body
named vise
press Tab
settle
fill 0 40 -40
add_mesh fixed
named 'fixed jaw'
press Tab
settle
fill 0 40 -40
pick 187 601 # In
pick 187 625 # the vise
add_mesh moving
named jaw
press Tab
settle
fill 0 -90 -40
pick 187 601
pick 187 625
pick 234 674 # +Y: the jaw closes on the stock
press Insert Return
settle
named 'clamp left'
fill 55 30 20 -100 -15 1
press ctrl+d
settle
named 'clamp right'
press Tab Tab Tab
settle
fill 45 -15 1
still 02-clamped
scroll 5
pick 100 304 # T1
pick 220 577 # its holder
holder 7 # BT40-EM20
pick 100 325
pick 158 553 # its stick-out
fill 24
pick 220 577
holder 2 # BT40-EM10
pick 100 346
pick 220 601
holder 3 # BT40-EM12
still 03-done
printf 'set up with %s clicks in %s s\n' "$clicks" "$((SECONDS - begin))" # clock: is printed
((clicks <= 30)) || die 'a job is set up with at most 30 clicks'
press ctrl+s
settle
press Return
is_saved() { [[ -s $work/bracket.toml ]] && title_matches '^bracket.nc'; }
wait_for is_saved || die 'the set-up is saved next to the program'
report "$work/bracket.toml" >"$work/own.txt"
report "$work/wanted.toml" >"$work/wanted.txt"
diff "$work/wanted.txt" "$work/own.txt" || die 'the check finds what that of the written set-up finds'
grep -q '^collision' "$work/own.txt" || die 'which is a collision'
cp "$work/bracket.toml" "$work/saved.toml"

# The zero is put on the rear left corner of the stock by a click: the bodies move relative to it.
scroll 4
clicks=0
pick 60 181 # G54
pick 164 482 # By clicking
pick 732 254 # the corner
still 04-corner
((clicks <= 3)) || die 'three clicks put the zero on a corner'
press ctrl+s
has_corner() { grep -q '^box = \[\[0, -80, -41\], \[120, 0, 0\]\]$' "$work/bracket.toml"; }
wait_for has_corner || die 'the zero is on the corner'

# All of it is undone, done again, saved, and opened again.
for _ in $(seq 60); do press ctrl+z; done
expect 'all is undone' '^\* bracket.nc'
# What is kept of unsaved edits begins with four lines of comments.
is_empty() { [[ -z $(tail -n +5 "$work"/config/feeler/unsaved/*.toml) ]]; }
wait_for is_empty || die 'nothing is left of the set-up'
still 05-undone
for _ in $(seq 60); do press ctrl+y; done
press ctrl+z ctrl+s
is_as_saved() { cmp -s "$work/bracket.toml" "$work/saved.toml"; }
wait_for is_as_saved || die 'all but the last edit is done again, and saved'
press ctrl+q
ended 'by Ctrl+Q'
open_window "$work/bracket.nc"
expect 'opens again' '^bracket.nc, line'
press e
still 06-reopened
# A vise from the presets is put around the stock and closed on it at once.
press Insert Down Down Right Down Down Return
settle
press ctrl+s
has_vise() {
    grep -q '^preset = "vise-6"$' "$work/bracket.toml" && grep -q '^opening = 80$' "$work/bracket.toml"
}
wait_for has_vise || die 'a preset is added'
still 07-preset
press n
expect 'the check finds the collision' 'collision'
press ctrl+q
ended 'after opening it again'
printf 'passed\n'
