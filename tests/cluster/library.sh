#!/usr/bin/env bash
# Creates a library of forty programs of a second or less each. Arguments: the folder to create it
# in, the folder of the repository.
set -euo pipefail
library=$1 root=$2
mkdir -p "$library"
for i in $(seq 1 38); do
    # Feed moves back and forth over the plate, in every third program among the clamps.
    awk -v i="$i" 'BEGIN {
        print "%\nG21 G90 G54\nT1 M6\nG43 H1 Z100.\nS3000 M3\nG0 X0. Y0. Z" (i % 3 ? 60 : 26) ".";
        for (k = 0; k < 1000 + 200 * i; ++k) printf "G1 X%.3f Y%.3f F900.\n", (k * 3) % 150, (k * 7) % 143 + k * 0.0001;
        print "G0 Z100.\nM30\n%" }' >"$library/part $i.nc"
done
printf '%%\nG21 G90 G54\nG999\nM30\n' >"$library/wrong.nc"
printf '%%\nG21 G90 G54\nT1 M6\nG0 X0 Y0\nM30\n' >"$library/"$'Geh\xe4use.nc'
printf 'solid a\nendsolid a\n' >"$library/part.stl"
printf '[[program]]\nfiles = "*.nc"\nsetup = "%s/assets/setups/clamped_plate.toml"\n' "$root" >"$library/feeler.toml"
