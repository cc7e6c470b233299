#!/usr/bin/env bash
# How fast the window is, on a screen of its own of 1280x800: frames a second while the view turns,
# from a key to the picture of the next block, from the start to the path of a long program.
# Arguments: the program feeler, the folder of assets.
set -euo pipefail
(($# == 2)) || {
    printf 'usage: %s FEELER ASSETS\n' "$0" >&2
    exit 2
}
feeler=$1 assets=$2 screen_size=1280x800
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd -P)
pictures=$(mktemp -d)
# shellcheck disable=SC2034 # screen.sh reads it
tools=$(dirname "$feeler")/../tests/viewer
# shellcheck source=tests/viewer/screen.sh
source "$root/tests/viewer/screen.sh"
log=$work/frames
mkdir -p "$XDG_CONFIG_HOME/feeler"
printf 'width = 1280\nheight = 800\nx = 0\ny = 0\n' >"$XDG_CONFIG_HOME/feeler/view.toml"
plate=("$assets/programs/clamped_plate_low.nc" --setup "$assets/setups/clamped_plate.toml")

close() {
    press ctrl+q
    ended "$1"
}

# turn WHAT: frames a second while the middle button turns the view round the part, tool and machine.
turn() {
    xdotool mousemove 640 360 mousedown 2
    : >"$work/moves"
    for i in $(seq 400); do
        printf 'mousemove %s %s sleep 0.01\n' $((500 + 280 * (i % 40) / 40)) $((330 + 60 * (i % 25) / 25))
    done >"$work/moves"
    local begin end still
    begin=$(date +%s.%N)
    xdotool - <"$work/moves"
    end=$(date +%s.%N)
    xdotool mouseup 2
    sleep 1
    still=$(date +%s.%N)
    for i in $(seq 60); do printf 'mousemove %s 24 sleep 0.01\n' $((100 + 5 * i)); done | xdotool -
    close 'after turning'
    awk -v begin="$begin" -v end="$end" -v what="$1" '
        $1 == "frame" && $3 > begin && $3 < end { ++frames; spent += $3 - $2 }
        END { printf "%s, turning: %.1f frames/s (%d frames in %.1f s, %.1f ms each)\n", what,
              frames / (end - begin), frames, end - begin, 1000 * spent / frames }' "$log"
    awk -v still="$still" -v what="$1" '$1 == "frame" && $2 > still { ++frames; spent += $3 - $2 }
        END { printf "%s, panels alone: %.1f ms a frame\n", what, 1000 * spent / frames }' "$log"
}

open_window "${plate[@]}" --frame-log "$log"
expect 'opens' 'block 0 of 45'
press n
expect 'N' 'violation|collision'
sleep 2
turn 'clamped plate'

# A fixture of a million triangles, selected in the set-up, with its gizmo.
python3 - "$work/ball.stl" <<'END'
import math, struct, sys
rows, columns = 500, 1000
def point(row, column):
    if row in (0, rows): return (0.0, 0.0, 40.0 if row == 0 else -40.0)
    a, b = math.pi * row / rows, 2 * math.pi * (column % columns) / columns
    return (40 * math.sin(a) * math.cos(b), 40 * math.sin(a) * math.sin(b), 40 * math.cos(a))
faces = []
for row in range(rows):
    for column in range(columns):
        a, b = point(row, column), point(row, column + 1)
        c, d = point(row + 1, column), point(row + 1, column + 1)
        if row < rows - 1: faces.append((a, c, d))
        if row > 0: faces.append((a, d, b))
with open(sys.argv[1], 'wb') as file:
    file.write(b'ball'.ljust(80) + struct.pack('<I', len(faces)))
    for face in faces:
        file.write(struct.pack('<12fH', 0, 0, 0, *face[0], *face[1], *face[2], 0))
END
cp "$assets/programs/clamped_plate.nc" "$work/ball.nc"
printf '[[fixture]]\nname = "ball"\nmesh = "ball.stl"\nat = [-60, 0, -40]\n' >"$work/ball.toml"
open_window "$work/ball.nc" --setup "$work/ball.toml" --frame-log "$log"
expect 'opens' 'block 0 of'
press e
sleep 10
click 80 250 # the ball
sleep 1
turn 'million triangles'

# From a key to the picture of the next block, stock included, along the pocket at h = 0.4.
open_window "${plate[@]}" --mesh-size 0.4 --frame-log "$log"
expect 'opens' 'block 0 of 45'
sleep 3
for _ in $(seq 35); do
    press Right
    sleep 0.3
done
close 'after stepping'
awk '
    $1 == "key" && $3 == 262 { pressed[++last] = $2 }
    $1 == "frame" && $4 == $5 { for (; done < $4; ) print 1000 * ($3 - pressed[++done]) }
    ' "$log" | sort -n >"$work/steps"
awk '{ times[NR] = $1 }
    END { printf "one step at h = 0.4: median %.0f ms, slowest %.0f ms of %d steps\n",
          times[int((NR + 1) / 2)], times[NR], NR }' "$work/steps"

# From the start of the program to the first frame with the path.
{
    printf 'G21 G90 G17 G54\nT1 M6\nM3 S9000\nG43 H1 Z20.\nG0 X0. Y0.\nG1 Z-1. F3000.\n'
    awk 'BEGIN {
        for (i = 0; i < 66992; ++i) {
            row = int(i / 200); x = i % 200; if (row % 2) x = 199 - x
            printf "X%.3f Y%.3f Z%.3f\n", x / 2, row * 0.3, -1 - ((i * 7919) % 100) / 200
        } }'
    printf 'G0 Z20.\nM30\n'
} >"$work/long.nc"
for how in 'with a set-up' 'without one'; do
    words=("$work/long.nc" --frame-log "$log")
    [[ $how == 'without one' ]] || words+=(--setup "$assets/setups/clamped_plate.toml")
    begin=$(date +%s.%N)
    open_window "${words[@]}"
    expect 'the path shows' 'of [0-9]{5}\)'
    sleep 2
    close 'after opening'
    awk -v begin="$begin" -v how="$how" '
        $1 == "frame" && !first { first = $3 }
        $1 == "frame" && $6 > 0 && !path { path = $3 }
        $1 == "frame" && $6 > 0 && $3 - $2 > slowest { slowest = $3 - $2 }
        END { printf "67,000 lines %s: first frame %.2f s, path %.2f s, slowest frame %.0f ms\n",
              how, first - begin, path - begin, 1000 * slowest }' "$log"
done
rm -rf "$pictures"
