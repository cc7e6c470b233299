#!/usr/bin/env bash
# feeler.exe under wine. Arguments: the folder with the unpacked archive for Windows, the program feeler, the
# source folder. Skipped unless FEELER_WINDOWS is set, because the archive takes some minutes to build.
set -euo pipefail
archive=$1 feeler=$2 source_folder=$3
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
[[ -n ${FEELER_WINDOWS:-} ]] || {
    echo 'skipped: without FEELER_WINDOWS, feeler.exe is not built'
    exit 77
}
exec python3 "$here/windows_test.py" "$archive"/feeler-*/feeler.exe "$feeler" "$source_folder"
