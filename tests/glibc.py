#!/usr/bin/env python3
"""Checks that a program and the libraries in its archive need the versions of glibc and libstdc++ that the manual
states: exactly this glibc, and at most this libstdc++.

    glibc.py PROGRAM ROOT
"""
import pathlib
import re
import subprocess
import sys

# The newest symbol of libstdc++ by version of GCC.
LIBSTDCXX = {11: (3, 4, 29), 12: (3, 4, 30), 13: (3, 4, 32), 14: (3, 4, 33)}


def newest(name, symbols):
    return max(tuple(map(int, version.split("."))) for version in re.findall(rf"\b{name}_([0-9.]*[0-9])", symbols))


def text_of(version):
    return ".".join(map(str, version))


program, root = sys.argv[1], pathlib.Path(sys.argv[2])
libraries = subprocess.run([root / "cmake" / "package.sh", "--libraries", program], capture_output=True, text=True,
                           check=True).stdout.split()
symbols = "".join(subprocess.run(["objdump", "-T", file], capture_output=True, text=True, check=True).stdout
                  for file in [program, *libraries])
glibc, libstdcxx = newest("GLIBC", symbols), newest("GLIBCXX", symbols)
print(f"program and libraries need glibc {text_of(glibc)} and GLIBCXX_{text_of(libstdcxx)}")

manual = (root / "docs" / "manual" / "getting-started.md").read_text(encoding="utf-8")
stated = tuple(map(int, re.search(r"\bglibc (\d+)\.(\d+) or newer", manual).groups()))
compiler = int(re.search(r"\bGCC (\d+) or newer", manual)[1])
print(f"the manual states glibc {text_of(stated)} and GCC {compiler}")
sys.exit(0 if glibc == stated and libstdcxx <= LIBSTDCXX[compiler] else 1)
