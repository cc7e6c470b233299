#!/usr/bin/env bash
# The page of a batch in headless Chromium. Arguments: the program feeler, the program that writes a
# large page, the folder of assets, a work folder (pages and pictures are kept there). Skipped
# without Chromium, node or the npm packages.
set -euo pipefail
feeler=$1 large_page=$2 assets=$3 work=$4
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
# shellcheck source=tests/support/npm_test.sh
source "$here/../support/npm_test.sh"
need chromium node npm
install_packages "$here"

# A library with programs of every kind, and names that a browser must treat as plain text.
rm -rf shop
ln -sfn "$assets" assets # so that the path of a set-up contains none of the searched words
mkdir -p "shop/vise/Gehäuse <i>" shop/broken shop/air
cp "$assets/programs/clamped_plate_low.nc" shop/vise/
cp "$assets/programs/clamped_plate_low.nc" "shop/vise/Gehäuse <i>/it's \"50%\" & \$HOME.nc"
cp "$assets/programs/clamped_plate.nc" "shop/vise/part 9.nc"
cp "$assets/programs/clamped_plate.nc" "shop/vise/part 10.nc"
printf '%%\nO7\nG21 G90 G54\nG999 X1.\nM30\n%%\n' >"shop/broken/<script>alert(1).nc"
cp "$assets/programs/PARALLEL.NC" shop/air/
printf 'notes\nof the shop\n' >'shop/<notes>.md'
cat >shop/feeler.toml <<END
[[program]]
files = "."
[[program]]
files = "vise/**/*.nc"
setup = "../assets/setups/clamped_plate.toml"
END
make_report 2 shop --no-cache --format html -o shop.html # one of them cannot be run to its end
make_report 0 "shop/vise/part 9.nc" "shop/vise/part 10.nc" --no-cache --format html -o good.html \
    --setup assets/setups/clamped_plate.toml

# Holes drilled through the clamps by a subprogram in a separate file, and a program that ends in
# one.
rm -rf sub
mkdir -p sub
sed '/^G98/,$d' "$assets/programs/clamped_plate_low.nc" >sub/main.nc
printf 'M98 P2000\nM30\n%%\n' >>sub/main.nc
{ echo O2000; sed -n '/^G98/,/^G80/p' "$assets/programs/clamped_plate_low.nc"; echo M99; } >sub/O2000.nc
printf '%%\nO7\nG21 G90 G54\nM98 P3000\nM30\n%%\n' >sub/broken.nc
printf 'O3000\nG999 X1.\nM99\n' >sub/O3000.nc
make_report 2 sub/main.nc sub/broken.nc --no-cache --format html -o sub.html \
    --setup assets/setups/clamped_plate.toml
"$large_page" large.html empty.html

exec node batch_test.mjs "$work"
