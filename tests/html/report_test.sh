#!/usr/bin/env bash
# HTML reports in headless Chromium. Arguments: the program feeler, the folder of assets, a folder to
# work in (reports and pictures are kept there). Without Chromium, node or npm's packages it is
# skipped.
set -euo pipefail
feeler=$1 assets=$2 work=$3
# shellcheck source=tests/support/npm_test.sh
source "$(dirname "${BASH_SOURCE[0]}")/../support/npm_test.sh"
need chromium node npm
install_packages

make_report any "$assets/programs/clamped_plate_low.nc" --setup "$assets/setups/clamped_plate.toml" \
    --format html -o findings.html
make_report any "$assets/programs/PARALLEL.NC" --setup "$assets/setups/parallel.toml" \
    --format html -o clear.html

# Text that a browser must not take for more, and bytes of another code page.
sed 's|^O1011.*|O1011 (</script><script>document.title="broken"</script><img src=x onerror=alert(1)> \xe4)|' \
    "$assets/programs/clamped_plate_low.nc" >evil.nc
make_report any evil.nc --setup "$assets/setups/clamped_plate.toml" --format html -o evil.html

# A hundred thousand blocks, in the air.
awk 'BEGIN {
    print "%\nG21 G90 G54\nT1 M6\nG43 H1 Z100.\nS3000 M3\nG0 X0. Y0. Z60.";
    for (i = 0; i < 100000; ++i) printf "G1 X%.3f Y%.3f F900.\n", i % 150, (i * 7) % 143 + i * 0.0001;
    print "M30\n%" }' >long.nc
make_report any long.nc --setup "$assets/setups/clamped_plate.toml" --format html -o long.html

exec node report_test.mjs "$work"
