#!/usr/bin/env bash
# Prints a program of 100,000 blocks that cut nothing.
awk 'BEGIN {
    print "%\nG21 G90 G54\nT1 M6\nG43 H1 Z100.\nS3000 M3\nG0 X0. Y0. Z60.";
    for (i = 0; i < 100000; ++i) printf "G1 X%.3f Y%.3f F900.\n", i % 150, (i * 7) % 143 + i * 0.0001;
    print "M30\n%" }'
