#!/usr/bin/env bash
# Pictures without a window: every form of `feeler shot`, no display needed. Arguments: the program
# feeler, the folder of assets, a folder for the pictures (kept).
set -euo pipefail
feeler=$1 assets=$2 pictures=$3
unset DISPLAY WAYLAND_DISPLAY
if ! command -v identify >/dev/null; then
    printf 'skipped: identify (imagemagick) is not installed\n'
    exit 77
fi
mkdir -p "$pictures"
rm -f "$pictures"/*
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export XDG_CONFIG_HOME=$work

die() {
    printf 'failed: %s\n' "$1"
    exit 1
}
shot() {
    local name=$1
    shift
    "$feeler" shot "$assets/programs/clamped_plate_low.nc" \
        --setup "$assets/setups/clamped_plate.toml" -o "$pictures/$name" "$@"
}
size_of() { identify -format '%wx%h' "$pictures/$1"; }
# Fails if a picture has few colours, as an empty one does.
is_rich() { (($(identify -format '%k' "$pictures/$1") > 400)) || die "$1 is almost empty"; }
differ() { ! cmp -s "$pictures/$1" "$pictures/$2" || die "$1 and $2 are the same"; }

shot worst.png --worst
[[ $(size_of worst.png) == 1440x900 ]] || die 'the default size'
is_rich worst.png
shot again.png --worst
cmp "$pictures/worst.png" "$pictures/again.png" || die 'the same picture every time'

shot light.png --worst --theme light --size 1000x700
[[ $(size_of light.png) == 1000x700 ]] || die 'the requested size'
is_rich light.png
shot finding.png --finding 2 --view witness --no-ui --size 800x600
is_rich finding.png
shot block.png --block 20 --view top --no-ui --size 800x600
differ finding.png block.png
shot front.png --block 20 --view front --no-ui --size 800x600
differ front.png block.png
shot sheet.png --sheet
is_rich sheet.png

shot device.png --worst --coprocessor --size 1280x800
is_rich device.png
shot no-device.png --worst --size 1280x800
differ device.png no-device.png
printf '[device]\nelements = 1\nclock_mhz = 1\n' >"$work/device.toml"
shot slow.png --worst --device "$work/device.toml" --size 1280x800
differ device.png slow.png

shot steps.png --from 18 --to 18 --no-ui --size 320x200
[[ -s $pictures/steps-0001.png && -s $pictures/steps-0002.png ]] || die 'numbered pictures'
if command -v ffmpeg >/dev/null; then
    printf mine >"$pictures/film-0001.png"
    shot film.mp4 --from 18 --to 18 --no-ui --size 320x200
    [[ -s $pictures/film.mp4 ]] || die 'a video'
    [[ $(cat "$pictures/film-0001.png") == mine ]] || die "pictures of others are not overwritten"
    cp "$pictures/film.mp4" "$pictures/film.xyz"
    status=0
    shot film.xyz --from 18 --to 18 --no-ui --size 320x200 2>"$work/errors" || status=$?
    [[ $status == 2 && -s $work/errors ]] || die 'refuses an unknown video format'
    cmp "$pictures/film.mp4" "$pictures/film.xyz" || die 'an existing file is not changed'
    [[ -z $(find "$pictures" -name '.unfinished*') ]] || die 'no temporary files remain'
fi

refused() {
    local status=0
    shot none.png "$@" 2>"$work/errors" || status=$?
    [[ $status == 2 && -s $work/errors && ! -e $pictures/none.png ]] || die "refuses $*"
}
refused --block -1
refused --block 46
refused --finding 99
refused --size 10x10
refused --size wide
printf 'elements = 1\n' >"$work/device.toml"
refused --device "$work/device.toml"
refused --device "$work/none.toml"
refused --from 9 --to 3

status=0
"$feeler" view "$assets/programs/TEST_G90.NC" 2>"$work/errors" || status=$?
[[ $status == 2 ]] || die 'without a display the window ends with 2'
[[ $(wc -l <"$work/errors") == 1 ]] || die 'and prints one line'
grep -q 'feeler shot' "$work/errors" || die 'and proposes feeler shot'
printf 'passed\n'
