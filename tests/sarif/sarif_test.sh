#!/usr/bin/env bash
# Real SARIF files against the published schema. Arguments: the program feeler, the program that
# writes batches a shell cannot make, the folder of assets, a work folder. Skipped without node or
# the npm packages.
set -euo pipefail
feeler=$1 odd_batches=$2 assets=$3 work=$4
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd -P)
# shellcheck source=tests/support/npm_test.sh
source "$here/../support/npm_test.sh"
need node npm
install_packages "$here"
rm -f ./*.sarif

make_report 1 "$assets/programs/clamped_plate_low.nc" --setup "$assets/setups/clamped_plate.toml" \
    --format sarif -o findings.sarif
make_report 0 "$assets/programs/clamped_plate.nc" --setup "$assets/setups/clamped_plate.toml" \
    --format sarif -o clear.sarif
printf '%%\nO7\nG21 G90 G54\nG999 X1.\nM30\n%%\n' >broken.nc
make_report 2 broken.nc --format sarif -o broken.sarif
make_report 2 nowhere.nc --format sarif -o nowhere.sarif

# A batch with names that are not valid URIs: blanks, UTF-8, invalid bytes, special characters.
rm -rf shop
mkdir -p "shop/Gehäuse 50%"
cp "$assets/programs/clamped_plate_low.nc" "shop/Gehäuse 50%/it's [\"a\"] #1?.nc"
cp "$assets/programs/clamped_plate_low.nc" $'shop/\xe4\xff:<b>.nc'
cp broken.nc 'shop/C:\broken^`{|}.nc'
printf 'notes\n' >'shop/more notes.md'
make_report 2 shop --setup "$assets/setups/clamped_plate.toml" --no-cache --format sarif -o shop.sarif
"$odd_batches" .

exec node sarif_test.mjs ./*.sarif
