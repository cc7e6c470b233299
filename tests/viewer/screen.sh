# shellcheck shell=bash
# A screen of its own with the real window on it, for the tests that drive it as a person would. To
# be sourced, after `feeler`, `assets` and `pictures` are set: the program, the folder of assets, a
# folder for pictures (kept). FEELER_PATIENCE: seconds that are waited for anything.

: "${feeler:?}" "${assets:?}" "${pictures:?}"
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
patience=$((10 * ${FEELER_PATIENCE:-30})) # tenths of a second that are waited for anything
cleanup() {
    [[ -z $view ]] || kill "$view" 2>/dev/null || true
    kill "$screen" 2>/dev/null || true
    rm -rf "$work"
}
trap cleanup EXIT
for _ in $(seq 100); do
    [[ -s $work/display ]] && break
    sleep 0.1
done
DISPLAY=:$(tr -d '\n' <"$work/display")
export DISPLAY

die() {
    import -window root "$pictures/failed.png" || true
    printf 'failed: %s\nthe title is: %s\n' "$1" "$(title)"
    [[ ! -s $work/errors ]] || sed 's/^/stderr: /' "$work/errors"
    exit 1
}
title() { xdotool getwindowname "$window" 2>/dev/null || true; }

# open_window WORDS...: feeler view with these words. FEELER_PRELOAD: a library loaded before it.
open_window() {
    LD_PRELOAD=${FEELER_PRELOAD:-} "$feeler" view "$@" 2>"$work/errors" &
    view=$!
    for _ in $(seq "$patience"); do
        window=$(xdotool search --onlyvisible --name feeler 2>/dev/null | head -1 || true)
        [[ -n $window ]] && return
        kill -0 "$view" 2>/dev/null || break
        sleep 0.1
    done
    die 'the window opens'
}

# ended: the window has been told to close, and does so in time, with status 0 and no word said.
ended() {
    for _ in $(seq "$patience"); do
        kill -0 "$view" 2>/dev/null || break
        sleep 0.1
    done
    ! kill -0 "$view" 2>/dev/null || die "closing ends: $1"
    local status=0
    wait "$view" || status=$?
    view=''
    [[ $status == 0 ]] || die "closing ends with status $status: $1"
    [[ ! -s $work/errors ]] || die "nothing is said on standard error: $1"
}

# expect WHAT PATTERN: the title comes to match in time.
expect() {
    for _ in $(seq "$patience"); do
        [[ $(title) =~ $2 ]] && return
        sleep 0.1
    done
    die "$1"
}
picture() {
    sleep 0.7
    import -window root "$pictures/$1.png"
}
# How many pixels of two pictures differ, and how many of one have a colour.
differing() { compare -metric AE "$pictures/$1.png" "$pictures/$2.png" null: 2>&1 || true; }
of_color() {
    convert "$pictures/$1.png" -fill black +opaque "$2" -fill white -opaque "$2" \
        -format '%[fx:round(mean*w*h)]' info:
}
same_picture() { [[ $(differing "$1" "$2") == 0 ]]; }
press() { xdotool key --window 0 --clearmodifiers "$@"; }
# click X Y; the button is up before the mouse goes on.
click() {
    xdotool mousemove "$1" "$2"
    sleep 0.2
    xdotool click 1
    sleep 0.3
}
