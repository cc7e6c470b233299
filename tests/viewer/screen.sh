# shellcheck shell=bash
# A separate virtual screen with the real window on it, for tests that drive it with keys and mouse.
# To be sourced after `feeler`, `assets`, `pictures` and `tools` are set: the program, the folder of
# assets, a folder for pictures (kept), the folder of await_frames and drop_files. FEELER_PATIENCE:
# seconds after which a test gives up waiting.
#
# Nothing here sleeps for a fixed time: `frames` waits until the window has processed and drawn all
# input, `expect` and `shows` until the expected state is reached.

: "${feeler:?}" "${assets:?}" "${pictures:?}" "${tools:?}"
for command in Xvfb xdotool import; do
    if ! command -v "$command" >/dev/null; then
        printf 'skipped: %s is not installed\n' "$command"
        exit 77
    fi
done

mkdir -p "$pictures"
rm -f "$pictures"/*.png
work=$(mktemp -d)
mkdir "$work/pictures"
# Tests use the file browser and not the dialog of the system that runs them.
export FEELER_FILE_DIALOG=own
export XDG_CONFIG_HOME=$work/config XDG_PICTURES_DIR=$work/pictures LC_ALL=C.UTF-8

exec 3<>"$work/display" 2>/dev/null || true
# -r: on a busy machine a key that is released late would count as several presses.
Xvfb -displayfd 3 -screen 0 "${screen_size:-1440x900}x24" -noreset -r 3>"$work/display" 2>/dev/null &
screen=$!
view='' window=''
patience=${FEELER_PATIENCE:-120}
cleanup() {
    [[ -z $view ]] || kill "$view" 2>/dev/null || true
    kill "$screen" 2>/dev/null || true
    rm -rf "$work"
}
trap cleanup EXIT
# wait_for COMMAND...: waits until the command succeeds. False if it does not in time.
wait_for() {
    local end=$((SECONDS + patience)) # clock: gives up after 2 min
    until "$@"; do
        ((SECONDS < end)) || return 1 # clock: as above
        sleep 0.1 # clock: polls
    done
}
if ! wait_for test -s "$work/display"; then
    printf 'failed: Xvfb starts\n'
    exit 1
fi
DISPLAY=:$(tr -d '\n' <"$work/display")
export DISPLAY

die() {
    import -window root "$pictures/failed.png" || true
    printf 'failed: %s\nthe title is: %s\n' "$1" "$(title)"
    [[ ! -s $work/errors ]] || sed 's/^/stderr: /' "$work/errors"
    exit 1
}
title() { xdotool getwindowname "$window" 2>/dev/null || true; }

has_ended() { ! kill -0 "$view" 2>/dev/null; }
has_window() {
    window=$(xdotool search --onlyvisible --name feeler 2>/dev/null | head -1 || true)
    [[ -n $window ]]
}
has_window_or_ended() { has_window || has_ended; }
# open_window ARGUMENTS...: starts feeler view. FEELER_PRELOAD: a library to preload.
open_window() {
    LD_PRELOAD=${FEELER_PRELOAD:-} "$feeler" view "$@" 2>"$work/errors" &
    view=$!
    wait_for has_window_or_ended || true
    [[ -n $window ]] || die 'the window opens'
}

# ended WHEN: the window, after the request to close, ends in time, with status 0 and without output.
ended() {
    wait_for has_ended || die "closing ends: $1"
    local status=0
    wait "$view" || status=$?
    view=''
    [[ $status == 0 ]] || die "closing ends with status $status: $1"
    [[ ! -s $work/errors ]] || die "nothing is written to standard error: $1"
}

# expect WHAT PATTERN: waits until the title matches the pattern.
expect() {
    wait_for title_matches "$2" || die "$1"
}
title_matches() { [[ $(title) =~ $1 ]]; }
# Waits until the window has processed all input so far and has drawn the result.
frames() { "$tools/await_frames" "$window" 4 || die 'the window keeps drawing'; }
picture() {
    frames
    import -window root "$pictures/$1.png"
}
# shows NAME WHAT CONDITION...: takes pictures of this name until one meets the condition.
shows() {
    local name=$1 what=$2
    shift 2
    wait_for picture_meets "$name" "$@" || die "$what$(difference "$@")"
}
# difference CONDITION NAME NAME...: where and in how many pixels the two pictures of a condition
# differ, for the message.
difference() {
    [[ $1 == same* || $1 == differ ]] || return 0
    printf ' (%s and %s differ in %s pixels, in the area %s)' "$2" "$3" "$(differing "$2" "$3")" \
        "$(convert "$pictures/$2.png" "$pictures/$3.png" -compose difference -composite \
            -threshold 0 -trim -format '%wx%h%O' info:)"
}
# still NAME: takes a picture once nothing has changed for two seconds, so that background work is
# complete. On a slow machine the five pictures take longer, by as much as that work.
still() {
    picture "$1"
    wait_for is_still "$1" || die "the window stops changing: $1"
}
is_still() {
    for _ in 1 2 3 4; do
        sleep 0.5 # clock: the pictures take more of the processor than the work in the background
        picture "$1-later"
        if differ "$1" "$1-later"; then
            mv "$pictures/$1-later.png" "$pictures/$1.png"
            return 1
        fi
    done
    rm "$pictures/$1-later.png"
}
picture_meets() {
    picture "$1"
    "${@:2}"
}
# The number of pixels in which two pictures differ; the number of pixels of a colour in one.
differing() { printf '%.0f' "$(compare -metric AE "$pictures/$1.png" "$pictures/$2.png" null: 2>&1 || true)"; }
of_color() {
    convert "$pictures/$1.png" -fill black +opaque "$2" -fill white -opaque "$2" \
        -format '%[fx:round(mean*w*h)]' info:
}
# Conditions: two pictures differ in more than N pixels; a picture has more than N pixels of a
# colour, or none.
# Pictures of the same state: only what blinks may differ.
same() { (($(differing "$1" "$2") < 200)); }
# The same in an area, as WxH+X+Y: the caret of a field is smaller than any letter that is missing.
same_in_area() {
    local name
    for name in "$1" "$2"; do
        convert "$pictures/$name.png" -crop "$3" +repage "$pictures/$name-area.png"
    done
    (($(differing "$1-area" "$2-area") < 60))
}
differ() { (($(differing "$1" "$2") > ${3:-0})); }
has_color() { (($(of_color "$1" "$2") > $3)); }
has_no_color() { [[ $(of_color "$1" "$2") == 0 ]]; }
# Condition: the file browser, in a window of 1440x900, says in its lower left corner what is wrong.
# Small letters have hardly a pixel of the pure colour.
says_wrong() {
    local pixels
    pixels=$(convert "$pictures/$1.png" -crop 600x60+260+640 -fuzz 30% -fill black +opaque '#FF5A36' \
        -fill white -opaque '#FF5A36' -format '%[fx:round(mean*w*h)]' info:)
    ((pixels > 100))
}
# press KEY...: GLFW takes a key that is pressed again within 20 ms for one that is held down, so each
# waits until the one before it has been processed.
press() {
    xdotool key --window 0 --clearmodifiers "$1"
    local key
    for key in "${@:2}"; do
        frames
        xdotool key --window 0 --clearmodifiers "$key"
    done
}
# click X Y: clicks, and waits until the release has been processed.
click() {
    xdotool mousemove "$1" "$2"
    frames
    xdotool mousedown 1
    frames
    xdotool mouseup 1
    frames
}
