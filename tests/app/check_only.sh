#!/bin/bash
# check_only.sh PROGRAM SOURCES: verifies that a program that only checks finds a collision, and that
# it links neither the libraries of the window nor the database.
set -u
program=$1 sources=$2
libraries=$(ldd "$program") || { echo "ldd failed"; exit 1; }
if grep -iE 'glfw|imgui|libEGL|libGL|epoxy|sqlite|libedit' <<<"$libraries"; then
  echo "the program above links a library that a check must not need"
  exit 1
fi
report=$("$program" "$sources/assets/programs/clamped_plate_low.nc" \
  "$sources/assets/setups/clamped_plate.toml")
status=$?
[ $status -eq 1 ] || { echo "status $status instead of 1"; exit 1; }
grep -q '"verdict": "collision"' <<<"$report" || { echo "no collision in the report"; exit 1; }
