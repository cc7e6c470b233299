#!/usr/bin/env bash
# Opening files in the real window: the file browser with the keyboard alone, recent programs,
# samples, Save as, and paths that are wrong. Then the dialog of the system, through a portal that
# answers as a file tells it to. Arguments: the program feeler, the folder of assets, a folder for
# pictures (kept), the folder of drop_files and await_frames.
set -euo pipefail
feeler=$1 assets=$2 pictures=$3 tools=$4
# shellcheck source=tests/viewer/screen.sh
source "$(dirname "${BASH_SOURCE[0]}")/screen.sh"
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

export HOME=$work/home
mkdir -p "$work/jobs/later" "$HOME/Documents"
cp "$assets/programs/clamped_plate_low.nc" "$work/jobs/plate.nc"
cp "$assets/programs/clamped_plate.nc" "$work/jobs/later/plate 2.nc"
jobs=$work/jobs

# enter TEXT: types into the field of the browser and presses Enter.
enter() {
    frames
    xdotool type "$1"
    press Return
}

open_window
picture 01-empty
press ctrl+o
picture 02-browser
enter "$jobs/"
still 02-listed
press Down
picture 03-folder
press Return
expect 'Down and Enter open the second row' 'plate.nc, line 2 \(block 0 of 45'
wait_for grep -q "$jobs/plate.nc" "$work/config/feeler/recent.toml" || die 'it is a recent program'

# In the folder of the program now: a part of a name, Backspace, a folder.
press ctrl+o
still 04-opened
xdotool type 'plat'
picture 04-filtered
press BackSpace BackSpace BackSpace BackSpace
press BackSpace
picture 05-above
press Escape
press ctrl+o
still 05-again
enter 'later'
still 05-later
enter '2.nc'
expect 'a part of a name opens it' 'plate 2.nc, line 2 \(block 0 of 45'
press ctrl+shift+o
expect 'Ctrl+Shift+O goes back to the program before' 'plate.nc, line 2 \(block 0 of 45'

# Paths that are wrong end nothing.
press ctrl+o
enter "$jobs/none.nc"
shows 06-wrong 'a wrong path is explained' says_wrong 06-wrong
press Escape
[[ $(title) =~ 'plate.nc, line 2' ]] || die 'the program stays open'
"$tools/drop_files" "$window" 700 400 "$jobs/none.nc" || true
picture 07-dropped
[[ $(title) =~ 'plate.nc, line 2' ]] || die 'a drop of nothing changes nothing'
"$tools/drop_files" "$window" 700 400 "$jobs/later"
still 07-folder
enter '2'
expect 'a folder that is dropped is shown' 'plate 2.nc, line 2 \(block 0 of 45'
press ctrl+q
ended 'by Ctrl+Q'

# Several programs at once: each keeps its block; a click or Ctrl+Tab shows another one.
open_window "$jobs/plate.nc" "$jobs/later/plate 2.nc"
expect 'the first of several programs is shown' '^plate.nc, line 2 \(block 0 of 45'
press Right Right Right
expect 'Right' '^plate.nc, .*block 3 of'
press ctrl+Tab
expect 'Ctrl+Tab shows the next one' '^plate 2.nc, line 2 \(block 0 of'
press ctrl+Next
expect 'and the first one again, at its block' '^plate.nc, .*block 3 of'
"$tools/drop_files" "$window" 700 400 "$jobs/plate.nc"
picture 07-tabs
expect 'an open program is not opened again' '^plate.nc, .*block 3 of'
click 300 15
expect 'a click on its tab shows a program' '^plate 2.nc'
press ctrl+w
expect 'Ctrl+W closes it' '^plate.nc, .*block 3 of'
press ctrl+w
expect 'the last one leaves the empty screen' '^feeler$'
rm "$jobs/later/plate 2.nc"
press ctrl+q
ended 'by Ctrl+Q'

# The empty screen: recent programs, one of them missing; samples.
open_window
frames
sleep 3 # clock: the list of what is missing comes within two seconds
picture 08-recent
xdotool windowsize "$window" 640 420
picture 09-recent-small
xdotool windowsize "$window" 1440 900
press t
picture 10-recent-light
press t
press ctrl+shift+o
expect 'the last program that is not missing is opened' 'plate.nc, line 2 \(block 0 of 45'
press ctrl+q
ended 'by Ctrl+Q'

# A sample: a click opens it, Save as proposes the documents, and nothing is written beside it.
before=$(find "$assets" -type f -printf '%p %s %T@\n' | sort | sha256sum)
open_window
frames
click 760 440
expect 'a click opens a sample' '(clamped_plate_low.nc|TEST_G90.NC), line'
press e
frames
press ctrl+s
shows 11-save 'the samples cannot be overwritten' says_wrong 11-save
press Return
is_saved() { [[ -n $(find "$HOME/Documents" -name '*.toml' -size +0) ]]; }
wait_for is_saved || die 'it is saved in the documents'
grep -q "$assets" "$HOME/Documents/"*.toml || die 'it names its files by whole paths'
expect 'and goes on' ', line [0-9]+ \([^,]*(, [a-z]*)?\) - feeler'
[[ $before == "$(find "$assets" -type f -printf '%p %s %T@\n' | sort | sha256sum)" ]] \
    || die 'nothing is written among the samples'
press ctrl+q
ended 'by Ctrl+Q'

# The dialog of the system.
if ! command -v dbus-daemon >/dev/null || ! /usr/bin/python3 -c 'import dbus, gi' 2>/dev/null; then
    printf 'passed; the dialog of the system is not tested without dbus-daemon, python3-dbus and python3-gi\n'
    exit 0
fi
unset FEELER_FILE_DIALOG
bus=$(dbus-daemon --session --fork --print-address=1 --print-pid=1)
DBUS_SESSION_BUS_ADDRESS=$(head -1 <<<"$bus")
export DBUS_SESSION_BUS_ADDRESS
bus_id=$(tail -1 <<<"$bus")
printf '%s\n' "$jobs/plate.nc" cancel "$jobs/own.toml" wait >"$work/answers"
: >"$work/questions"
"$here/portal.py" "$work/answers" "$work/questions" >"$work/portal" 2>&1 &
portal=$!
cleanup_portal() {
    kill "$portal" "$bus_id" 2>/dev/null || true
    cleanup
}
trap cleanup_portal EXIT
wait_for grep -q ready "$work/portal" || die 'the portal of the test starts'
open_window
frames
press ctrl+o
expect 'the dialog of the system opens a program' 'plate.nc, line 2 \(block 0 of 45'
grep -q "^OpenFile|x11:$(printf '%x' "$window")|" "$work/questions" || die 'it belongs to the window'
press ctrl+o
asked() { (($(wc -l <"$work/questions") >= $1)); }
wait_for asked 2 || die 'it is asked again'
sleep 1 # clock: the answer comes after 0.2 s
[[ $(title) =~ 'plate.nc, line 2' ]] || die 'cancelling changes nothing'
press ctrl+shift+s
wait_for test -e "$jobs/own.toml" || die 'Save as asks the system'
grep -q "^SaveFile|.*|$jobs|plate.toml" "$work/questions" || die 'with a proposal'
press ctrl+o
wait_for asked 4 || die 'it is asked for the fourth time'
press Right
expect 'the window goes on while the dialog is open' 'block 1 of 45'
press ctrl+q
ended 'while the dialog is open'

kill "$portal"
open_window
frames
press ctrl+o
frames
picture 12-absent
enter "$jobs/plate.nc"
expect 'without a portal there is the browser' 'plate.nc, line 2 \(block 0 of 45'
press ctrl+q
ended 'by Ctrl+Q'
printf 'passed\n'
