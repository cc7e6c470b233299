#!/usr/bin/env bash
# Set-up sheets, printed by headless Chromium. Arguments: the program feeler, the folder of assets, a
# work folder (sheets, PDF files and pictures are kept there). Skipped without Chromium, node or the
# npm packages.
set -euo pipefail
feeler=$1 assets=$2 work=$3
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
# shellcheck source=tests/support/npm_test.sh
source "$here/../support/npm_test.sh"
need chromium node npm
install_packages "$here"

# make_sheet PROGRAM ARGUMENT...: without and with findings.
make_sheet() {
    local status=0
    "$feeler" sheet "$@" || status=$?
    [[ $status -lt 2 ]]
}

make_sheet "$assets/programs/clamped_plate.nc" --setup "$assets/setups/clamped_plate.toml" -o clear.html
make_sheet "$assets/programs/clamped_plate_low.nc" --setup "$assets/setups/clamped_plate.toml" -o findings.html
make_sheet "$assets/programs/PARALLEL.NC" --setup "$assets/setups/parallel.toml" -o inch.html
make_sheet "$assets/programs/clamped_plate.nc" -o inferred.html
make_sheet "$assets/programs/clamped_plate.nc" --setup "$assets/setups/clamped_plate.toml" --tolerances \
    -o tolerances.html

# Sixty tools: more than one page.
awk 'BEGIN {
    print "O1000\nG21 G90 G17 G54";
    for (i = 1; i <= 60; ++i)
        printf "T%d M6 (T%d D=%d CR=0 - ZMIN=-1 - FLAT END MILL)\nS6000 M3\nG0 G43 H%d Z60.\nX20. Y%d.\nG1 Z1. F900.\nG0 Z60.\n", i, i, 2 + i % 9, i, i;
    print "M30" }' >many.nc
make_sheet many.nc -o many.html

exec node sheet_test.mjs "$work"
