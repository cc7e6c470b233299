#!/usr/bin/env bash
# How fast large pages open, scroll, sort and filter in headless Chromium. Arguments: the program feeler,
# the one that writes a large page, the folder of assets, a folder to work in. Skipped where there is no
# Chromium, node or npm's packages.
set -euo pipefail
feeler=$1 large_page=$2 assets=$3 work=$4
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
# shellcheck source=tests/support/npm_test.sh
source "$here/../support/npm_test.sh"
need chromium node npm
install_packages "$here/../html" "$here"
"$here/../html/long_program.sh" >long.nc
make_report any long.nc --setup "$assets/setups/clamped_plate.toml" --format html -o long.html
"$large_page" large.html empty.html

exec node browser_speed_test.mjs "$work"
