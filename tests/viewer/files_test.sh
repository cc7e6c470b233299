#!/usr/bin/env bash
# Files that change while the real window shows them, and files that cannot be read: a program, a
# set-up and a mesh. Each error is explained, and each file is opened again once it is corrected.
# Arguments: the program feeler, the folder of assets, a folder for pictures (kept), the folder of
# await_frames.
set -euo pipefail
feeler=$1 assets=$2 pictures=$3 tools=$4
# shellcheck source=tests/viewer/screen.sh
source "$(dirname "${BASH_SOURCE[0]}")/screen.sh"

cp -r "$assets/programs" "$assets/setups" "$assets/machines" "$assets/meshes" "$work"
program=$work/programs/clamped_plate_low.nc setup=$work/setups/clamped_plate.toml
mesh=$(find "$work/meshes" -name "$(grep -o '[a-z_]*\.stl' "$setup" | head -1)")
for file in "$program" "$setup" "$mesh"; do cp "$file" "$file.good"; done

# broken FILE WHAT PICTURE: the file was just damaged. The last good state stays, at the same block,
# with a banner; restores the file.
broken() {
    expect "$2 leaves the last good state" "clamped_plate_low.nc, line $good_line.*, last good state - feeler"
    shows "$3" "$2 is explained by a banner" has_color "$3" '#FF5A36' 5000
    cp "$1.good" "$1"
    expect "$2 is read again when it is corrected" "line $good_line "'\([^,]*(, collision)?\) - feeler'
}

open_window "$program" --setup "$setup"
expect 'opens' 'line 2 \(block 0 of 45'
press n
expect 'N' 'line 44 \(block 38'
press g
frames
xdotool type 30
press Return
expect 'G goes to a line' 'line 30 \(block 25'
press F9
press Home
expect 'Home' 'block 0 of'
press n
expect 'N again' 'line 44 \(block 38'
press 2
xdotool mousemove 720 30
shows 01-before 'colliding bodies are marked in the view' has_color 01-before '#FF5A36' 2800
still 01-before

# The last line but one changes: current line, camera and breakpoint stay.
sed -i 's/^M30$/G4 P0.2\nM30/' "$program"
expect 'a saved program is reloaded at the same line' 'line 44 \(block 38 of 46, collision\)'
convert "$pictures/01-before.png" -crop 760x600+380+110 "$work/before.png"
# True once the check has reached the block and the message is gone.
is_as_before() {
    convert "$pictures/02-after.png" -crop 760x600+380+110 "$work/after.png"
    (($(compare -metric AE "$work/before.png" "$work/after.png" null: 2>&1 || true) <= 2000))
}
shows 02-after 'the camera stays' is_as_before
press Home
expect 'Home' 'block 0 of'
press F5
expect 'the breakpoint stays' 'line 30 \(block 25'

# The original again, one line shorter.
cp "$program.good" "$program"
expect 'the original is reloaded' 'block [0-9]+ of 45'

printf 'G21 G90\nG0 X1.\nG1 [[[\n' >"$program"
expect 'the title says that the program stops early' 'of 1\), stopped at line 3'
shows 03-stopped 'a large warning shows where the program stops' has_color 03-stopped '#FF5A36' 5000
cp "$program.good" "$program"
expect 'it is read again when it is corrected' 'of 45\) - feeler'
press n
expect 'N goes to the first problem' 'line 44 \(block 38 of 45, collision\)'
good_line=44
printf 'GARBAGE[[[' >"$program"
broken "$program" 'a corrupted program' 03-program
head -c 4000 /dev/urandom >"$program"
broken "$program" 'a program of random bytes' 04-random
sed -i 's/^mesh_size.*/mesh_size = "much"/' "$setup"
broken "$setup" 'a wrong value in the set-up' 05-setup
printf '[[[\n' >"$setup"
broken "$setup" 'a set-up that is not TOML' 06-toml
head -c 700 "$mesh.good" >"$mesh"
broken "$mesh" 'a truncated mesh' 07-mesh
head -c 4000 /dev/urandom >"$mesh"
broken "$mesh" 'a mesh of random bytes' 08-random-mesh
rm "$program"
sleep 1 # clock: the window may notice or not
cp "$program.good" "$program"
expect 'a program that was deleted for a while is opened again' 'clamped_plate_low.nc, line'
rm "$program"
expect 'the title says that the file is missing' 'missing or empty'
shows 09-gone 'and a large warning is shown' has_color 09-gone '#FF5A36' 5000
cp "$program.good" "$program"
expect 'the warning goes when the file is back' 'clamped_plate_low.nc, line [0-9]+ \(block [^)]*\) - feeler'

# A path that is wrong ends nothing: what is open stays, and a message names the path.
press ctrl+o
frames
xdotool type "$work/programs/clamped_plat.nc"
press Return
shows 10-mistyped 'a mistyped path is explained in the dialog' says_wrong 10-mistyped
press Escape
[[ $(title) =~ 'clamped_plate_low.nc, line 44' ]] || die 'a mistyped path leaves the program open'

# Another program that cannot be read: Escape goes back to the one before it, at the same line.
head -c 4000 /dev/urandom >"$work/random.nc"
"$tools/drop_files" "$window" 700 400 "$work/random.nc"
expect 'another program that cannot be read is explained' 'could not be opened'
shows 11-unreadable 'with a way back' has_color 11-unreadable '#FF5A36' 20
press Escape
expect 'Escape goes back' 'clamped_plate_low.nc, line 44 \(block 38 of 45, collision\) - feeler'

press ctrl+q
ended 'by Ctrl+Q'

# A stock that moves out of sight when its set-up is read again: the view moves to it.
printf 'G21 G90 G54\nT1 M6\nM3 S3000\nG0 X0 Y0 Z9.\nG1 Z-2. F300.\nG0 Z20.\nM30\n' >"$work/far.nc"
printf '[stock]\nbox = [[-10, -10, -10], [60, 10, 0]]\n' >"$work/far.toml"
top='#D6DEE9'
open_window "$work/far.nc" --setup "$work/far.toml"
shows 10-near 'the stock is in the view' has_color 10-near "$top" 10000
printf '[stock]\nbox = [[990, -10, -10], [1060, 10, 0]]\n' >"$work/far.toml"
shows 11-far 'the set-up is read again' differ 10-near 11-far 300
still 11-far
has_color 11-far "$top" 10000 || die 'the view moves to the stock'
press ctrl+q
ended 'after moving the stock'
printf 'passed\n'
