#!/usr/bin/env python3
"""Checks that a program needs no newer C library than Debian 12 has, so that its archive runs there.

    glibc.py PROGRAM
"""
import re
import subprocess
import sys

NEWEST = (2, 36)

symbols = subprocess.run(["objdump", "-T", sys.argv[1]], capture_output=True, text=True, check=True).stdout
needed = {tuple(map(int, version.split("."))) for version in re.findall(r"GLIBC_([0-9.]+)", symbols)}
print("the program needs glibc", ".".join(map(str, max(needed))))
sys.exit(1 if max(needed) > NEWEST else 0)
