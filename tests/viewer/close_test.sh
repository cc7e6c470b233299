#!/usr/bin/env bash
# Closes the real window at many moments of a long check: it must end at once, with status 0 and
# without output. Run with the address sanitizer, this also shows that nothing is used after it is
# freed and that feeler leaks nothing. Arguments: the program feeler, the folder of assets, a folder
# for pictures (kept), the folder of drop_files and await_frames. FEELER_CLOSE_BLOCKS: length of the
# program.
set -euo pipefail
feeler=$1 assets=$2 pictures=$3 tools=$4
# shellcheck source=tests/viewer/screen.sh
source "$(dirname "${BASH_SOURCE[0]}")/screen.sh"

# A raster over a plate, about 60,000 blocks.
raster() {
    printf 'G21 G90 G17 G54\nT1 M6\nM3 S9000\nG43 H1 Z20.\nG0 X0. Y0.\nG1 Z-1. F3000.\n'
    awk -v blocks="$1" 'BEGIN {
        for (i = 0; i < blocks; ++i) {
            row = int(i / 200); x = i % 200; if (row % 2) x = 199 - x
            printf "X%.2f Y%.2f Z%.3f\n", x / 2, row * 0.3, -1 - ((i * 7919) % 100) / 200
        } }'
    printf 'G0 Z20.\nM30\n'
}
raster "${FEELER_CLOSE_BLOCKS:-60000}" >"$work/raster.nc"
raster 300 >"$work/short.nc"
cat >"$work/raster.toml" <<'TOML'
mesh_size = 0.5
[stock]
box = [[0, 0, -20], [100, 100, 0]]
frame = "G54"
[offsets]
G54 = { X = -350, Y = -200, Z = -420 }
[[tool]]
number = 1
shape = "ball"
diameter = 6
flute_length = 22
shank = [[6, 6, 23]]
holder = [[32, 40, 30]]
TOML

open_raster() { open_window "$work/raster.nc" --setup "$work/raster.toml"; }
close() {
    press ctrl+q
    ended "$1"
}
running() { kill -0 "$view" 2>/dev/null || die "the window stays open: $1"; }

for seconds in 0 0.1 0.3 1 3; do
    open_raster
    sleep "$seconds" # clock: it may be closed at any moment
    close "$seconds s after it was opened"
done

open_raster
expect 'the path of all blocks is shown' 'of [0-9]{4,}\)'
picture 01-checking
press bracketright bracketright bracketright bracketright bracketright space
expect 'it plays while it is checked' 'block [1-9][0-9]+ of'
picture 02-playing
close 'while it plays and is checked'

open_window "$work/raster.nc" --setup "$work/raster.toml" --coprocessor
expect 'the coprocessor runs during the check' 'coprocessor: running'
sleep 2 # clock: any moment
press d d d
close 'while the coprocessor runs'

open_raster
expect 'is open' 'block 0 of'
press End
close 'while it goes to the last block'

open_raster
expect 'is open' 'block 0 of'
press n
close 'while it searches for the next problem'

open_raster
expect 'is open' 'block 0 of'
for _ in 1 2 3 4; do
    press ctrl+r
    sleep 0.2 # clock: any moment
done
running 'after several reloads'
close 'while it is reloaded'

open_raster
expect 'is open' 'block 0 of'
printf '(ONE MORE)\n' >>"$work/raster.nc"
sleep 1.5 # clock: any moment
running 'the file has changed'
press Right Right
close 'after the file has changed'

open_raster
expect 'is open' 'block 0 of'
"$tools/drop_files" "$window" 700 400 "$work/short.nc" "$work/raster.toml"
expect 'another program replaces the one being checked' 'short.nc, line .* of 30[0-9]\)'
"$tools/drop_files" "$window" 700 400 "$work/raster.nc" "$work/raster.toml"
close 'after two drops'

printf 'passed\n'
