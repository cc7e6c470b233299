# shellcheck shell=bash
# A screen of its own with the real window on it, for the tests that drive it as a person would. To
# be sourced, after `feeler`, `assets`, `pictures` and `tools` are set: the program, the folder of
# assets, a folder for pictures (kept), the folder of await_frames and drop_files. FEELER_PATIENCE:
# seconds after which a test gives up waiting for anything.
#
# Nothing here sleeps for a fixed time until something must have happened: `frames` waits until the
# window has drawn what it was told, `expect` and `shows` until what is expected is there.

: "${feeler:?}" "${assets:?}" "${pictures:?}" "${tools:?}"
for command in Xvfb xdotool import; do
    if ! command -v "$command" >/dev/null; then
        printf 'skipped: there is no %s\n' "$command"
        exit 77
    fi
done

mkdir -p "$pictures"
rm -f "$pictures"/*.png
work=$(mktemp -d)
mkdir "$work/pictures"
export XDG_CONFIG_HOME=$work/config XDG_PICTURES_DIR=$work/pictures LC_ALL=C.UTF-8

exec 3<>"$work/display" 2>/dev/null || true
Xvfb -displayfd 3 -screen 0 "${screen_size:-1440x900}x24" -noreset 3>"$work/display" 2>/dev/null &
screen=$!
view='' window=''
patience=${FEELER_PATIENCE:-120}
cleanup() {
    [[ -z $view ]] || kill "$view" 2>/dev/null || true
    kill "$screen" 2>/dev/null || true
    rm -rf "$work"
}
trap cleanup EXIT
# wait_for COMMAND...: until it succeeds. False if it does not in time.
wait_for() {
    local end=$((SECONDS + patience))
    until "$@"; do
        ((SECONDS < end)) || return 1
        sleep 0.1
    done
}
if ! wait_for test -s "$work/display"; then
    printf 'failed: the screen starts\n'
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
# open_window WORDS...: feeler view with these words. FEELER_PRELOAD: a library loaded before it.
open_window() {
    LD_PRELOAD=${FEELER_PRELOAD:-} "$feeler" view "$@" 2>"$work/errors" &
    view=$!
    wait_for has_window_or_ended || true
    [[ -n $window ]] || die 'the window opens'
}

# ended: the window has been told to close, and does so in time, with status 0 and no word said.
ended() {
    wait_for has_ended || die "closing ends: $1"
    local status=0
    wait "$view" || status=$?
    view=''
    [[ $status == 0 ]] || die "closing ends with status $status: $1"
    [[ ! -s $work/errors ]] || die "nothing is said on standard error: $1"
}

# expect WHAT PATTERN: the title comes to match in time.
expect() {
    wait_for title_matches "$2" || die "$1"
}
title_matches() { [[ $(title) =~ $1 ]]; }
# Waits until the window has taken in everything that was done so far, and has drawn it.
frames() { "$tools/await_frames" "$window" 4 || die 'the window goes on'; }
picture() {
    frames
    import -window root "$pictures/$1.png"
}
# shows NAME WHAT CONDITION...: a picture of that name comes to meet a condition in time.
shows() {
    local name=$1 what=$2
    shift 2
    wait_for picture_meets "$name" "$@" || die "$what"
}
# still NAME: a picture of that name, once nothing has changed for two seconds: work in the background
# has come to its end.
still() {
    picture "$1"
    wait_for is_still "$1" || die "the window comes to rest: $1"
}
is_still() {
    for _ in 1 2 3 4; do
        sleep 0.5
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
# How many pixels of two pictures differ, and how many of one have a colour.
differing() { printf '%.0f' "$(compare -metric AE "$pictures/$1.png" "$pictures/$2.png" null: 2>&1 || true)"; }
of_color() {
    convert "$pictures/$1.png" -fill black +opaque "$2" -fill white -opaque "$2" \
        -format '%[fx:round(mean*w*h)]' info:
}
# Conditions: more than so many pixels of two pictures differ; more than so many of one have a colour,
# or none has.
differ() { (($(differing "$1" "$2") > ${3:-0})); }
has_color() { (($(of_color "$1" "$2") > $3)); }
has_no_color() { [[ $(of_color "$1" "$2") == 0 ]]; }
press() { xdotool key --window 0 --clearmodifiers "$@"; }
# click X Y; the button is up before the mouse goes on.
click() {
    xdotool mousemove "$1" "$2"
    frames
    xdotool mousedown 1
    frames
    xdotool mouseup 1
    frames
}
