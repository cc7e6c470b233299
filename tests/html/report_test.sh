#!/usr/bin/env bash
# HTML reports in headless Chromium. Arguments: the program feeler, the folder of assets, a work
# folder (reports and pictures are kept there). Skipped without Chromium, node or the npm packages.
set -euo pipefail
feeler=$1 assets=$2 work=$3
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
# shellcheck source=tests/support/npm_test.sh
source "$here/../support/npm_test.sh"
need chromium node npm
install_packages "$here"

make_report any "$assets/programs/clamped_plate_low.nc" --setup "$assets/setups/clamped_plate.toml" \
    --format html -o findings.html
make_report any "$assets/programs/PARALLEL.NC" --setup "$assets/setups/parallel.toml" \
    --format html -o clear.html

# Text that a browser must treat as plain, and bytes of another code page.
sed 's|^O1011.*|O1011 (</script><script>document.title="broken"</script><img src=x onerror=alert(1)> \xe4)|' \
    "$assets/programs/clamped_plate_low.nc" >evil.nc
make_report any evil.nc --setup "$assets/setups/clamped_plate.toml" --format html -o evil.html

# Thousands of blocks in the material, where contact is allowed, and one that passes a clamp at 1.5
# mm with a minimum clearance of 2 mm.
awk 'BEGIN {
    print "O1000\nG21 G90 G17 G54\nT1 M6\nS6000 M3\nG0 G43 H1 Z60.\nX20. Y30.\nZ3.";
    for (i = 0; i < 3000; ++i) {
        printf "G0 X%.3f Y%.3f\nG1 Z-1. F900.\nG0 Z3.\n", 10 + i % 60 * 0.9, 10 + int(i / 60) * 1.2;
        if (i == 1500) print "G0 X20. Y97.5\nG1 X90. F9000.\nG0 Y50.";
    }
    print "G0 Z60.\nM30" }' >one_of_many.nc
cat >one_of_many.toml <<END
mesh_size = 2
[program]
dialect = "fanuc"
start = { X = -350, Y = -200, Z = 0 }
[stock]
box = [[0, 0, -30], [100, 100, 0]]
[offsets]
G54 = { X = -350, Y = -200, Z = -420 }
[[length_offset]]
number = 1
length = 95.0
[[tool]]
number = 1
shape = "flat"
diameter = 10
flute_length = 20
shank = [[10, 10, 25]]
holder = [[40, 40, 50]]
[[fixture]]
name = "clamp"
box = [[40, 104, 0], [60, 130, 42]]
END
make_report 1 one_of_many.nc --setup one_of_many.toml --format html -o one_of_many.html

"$here/long_program.sh" >long.nc
make_report any long.nc --setup "$assets/setups/clamped_plate.toml" --format html -o long.html

exec node report_test.mjs "$work"
