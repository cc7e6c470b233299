#!/usr/bin/env python3
"""feeler_tp compiles with the headers of the LinuxCNC that is installed, and not with those of a version whose
planner has other functions or more flags than it knows.

    planner_versions.py SOURCE HEADERS
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

CHANGES = [
    # as in the versions that limit jerk
    ("tp.h", r"double acc, unsigned char enables", "double acc, double ini_maxjerk, unsigned char enables"),
    ("tp.h", r"double scale,\s*struct state_tag_t tag\)", "double scale, double jerk, struct state_tag_t tag)"),
    ("tp.h", r"int tpSetVlimit\(TP_STRUCT \* tp, double limit\)", "int tpSetVlimit(TP_STRUCT * tp, float limit)"),
    ("emcmotcfg.h", r"EMCMOT_MAX_JOINTS 16", "EMCMOT_MAX_JOINTS 18"),
    ("state_tag.h", r"GM_FLAG_MAX_FLAGS", "GM_FLAG_MAX_FLAGS = 33"),
]


def compiles(source, headers):
    command = ["gcc", "-std=gnu11", "-fsyntax-only", "-DRTAPI", "-DREALTIME", "-D_GNU_SOURCE"]
    command += [f"-I{headers}", source]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def main(source, headers):
    module = f"{source}/assets/linuxcnc/feeler_tp/feeler_tp.c"
    as_installed = compiles(module, headers)
    if as_installed.returncode != 0:
        print(as_installed.stderr)
        return 1
    for name, pattern, replacement in CHANGES:
        text = pathlib.Path(headers, name).read_text(encoding="utf-8")
        changed, count = re.subn(pattern, replacement, text)
        if count == 0:
            print(f"{name} has nothing like '{pattern}'")
            return 1
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(headers, folder, dirs_exist_ok=True)
            pathlib.Path(folder, name).write_text(changed, encoding="utf-8")
            built = compiles(module, folder)
        if built.returncode == 0 or "version of LinuxCNC" not in built.stderr:
            print(f"{replacement}: {'compiles' if built.returncode == 0 else built.stderr}")
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
