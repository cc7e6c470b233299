#!/usr/bin/env bash
# Takes the shop's own data into a set-up: a tool library, of which a tool is exchanged, the ini file
# of LinuxCNC, the offsets of the control; puts a block to the stock by clicking two faces.
# shop_test.sh FEELER ASSETS PICTURES TOOLS
set -euo pipefail

feeler=$1 assets=$2 pictures=$3 tools=$4
here=$(cd "$(dirname "$0")" && pwd -P)
# shellcheck source=tests/viewer/screen.sh
. "$here/screen.sh"

cp "$here/bracket.nc" "$work"
cat >"$work/shop.json" <<'END'
{"version": 36, "data": [
 {"type": "flat end mill", "description": "12 mm rougher", "unit": "millimeters",
  "geometry": {"DC": 12, "LCF": 26, "LB": 40, "OAL": 83, "SFDM": 12},
  "post-process": {"number": 8}},
 {"type": "ball end mill", "description": "8 mm ball", "unit": "millimeters",
  "geometry": {"DC": 8, "LCF": 16, "LB": 30, "OAL": 63, "SFDM": 8},
  "post-process": {"number": 9}}]}
END
printf '[TRAJ]\nLINEAR_UNITS = mm\n[AXIS_X]\nMIN_LIMIT = -500\nMAX_LIMIT = 0\n' >"$work/mill.ini"
printf '5221 -350\n5222 -200.5\n5223 -420\n' >"$work/mill.var"
cat >"$work/wanted.toml" <<'END'
tool_library = "shop.json"

[[tool]]
number = 1
name = "8 mm ball"
shape = "ball"
diameter = 8
flute_length = 16
shank_diameter = 8
stick_out = 30                # from the tip to the holder

[[fixture]]
name = "block-1"
box = [[0, 0, 0], [50, 25, 25]]
at = [84, -3.4, -32]
frame = "G54"
rotate_deg = [0, 0, -90]

[offsets]
G54 = { X = -350, Y = -200.5, Z = -420 }

[program]
ini = "mill.ini"
END

settle() { "$tools/await_frames" "$window" 30 || die 'the window keeps drawing'; }
clicks=0
pick() {
    click "$1" "$2"
    clicks=$((clicks + 1))
    settle
}
drop() {
    "$tools/drop_files" "$window" 700 400 "$@"
    settle
}

open_window "$work/bracket.nc"
expect 'opens' '^bracket.nc, line 2'
press e
drop "$work/shop.json"
expect 'a tool library is taken' '^\* bracket.nc'
still 00-library
pick 73 265  # T1
pick 207 567 # Exchange for
press Down Return
settle
((clicks <= 2)) || die 'two clicks open the list of tools'
still 01-exchanged
press Insert Return
still 02-block
clicks=0
pick 163 588 # Face to face
pick 508 303 # the front of the block
still 03-first-face
pick 969 529 # the right side of the stock
((clicks <= 3)) || die 'three clicks put a face to another'
still 04-face-to-face
drop "$work/mill.var"
shows 05-compared 'the offsets are compared' differ 05-compared 04-face-to-face 20000
settle
press Return # Take the work offsets
settle
drop "$work/mill.ini"
still 06-ini
press ctrl+s
settle
press Return
is_saved() { cmp -s "$work/bracket.toml" "$work/wanted.toml"; }
if ! wait_for is_saved; then
    diff "$work/wanted.toml" "$work/bracket.toml" || true
    die 'all of it is in the set-up'
fi
for _ in $(seq 12); do press ctrl+z; done
is_empty() { [[ -z $(tail -n +5 "$work"/config/feeler/unsaved/*.toml) ]]; }
wait_for is_empty || die 'all of it is undone'
for _ in $(seq 12); do press ctrl+y; done
press ctrl+q
ended 'by Ctrl+Q, with nothing to save'
printf 'passed\n'
