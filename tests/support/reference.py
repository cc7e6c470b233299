#!/usr/bin/python3
"""Runs programs through LinuxCNC's interpreter and prints the motions of each, in mm.

usage: reference.py FILE [INDEX...]

FILE holds the programs, separated by lines that say ---. Those with an INDEX may never end, and count as
refused after a short time. All others have as much time as any machine needs.
"""
import ctypes
import os
import shutil
import signal
import subprocess
import sys
import tempfile

MM = 25.4
PATIENCE, SHORT_PATIENCE = 300.0, 0.5  # seconds of the processor
STRAIGHT = {"straight_traverse", "straight_feed", "rigid_tap"}


def prepare_home(home):
    """Uses a private home folder, where the tool table is, so that runs do not interfere."""
    os.environ["HOME"] = home
    ctypes.CDLL(None).setenv(b"HOME", home.encode(), 1)
    empty = os.path.join(home, "empty.ngc")
    with open(empty, "w") as file:
        file.write("M2\n")
    subprocess.run(["rs274", "-v", os.path.join(home, "p.var"), "-g", empty],
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
    ctypes.CDLL("libtooldata.so.0", mode=ctypes.RTLD_GLOBAL)._Z14tool_mmap_userv()


class Canon:
    """Receives the calls of the interpreter and prints the motions."""

    def __init__(self, home):
        self.parameter_file = os.path.join(home, "p.var")

    def get_axis_mask(self): return 0b111111111
    def get_external_length_units(self): return 1.0
    def get_external_angular_units(self): return 1.0
    def get_block_delete(self): return 0
    def check_abort(self): return False
    def get_tool(self, pocket): return (-1,) + (0.0,) * 12 + (0,)
    def next_line(self, state): pass

    def arc_feed(self, end1, end2, centre1, centre2, turns, normal, *rest):
        print("arc_feed", *(repr(v * MM) for v in (end1, end2, centre1, centre2)), turns,
              repr(normal * MM))

    def __getattr__(self, name):
        if name.startswith("_"): raise AttributeError(name)
        if name not in STRAIGHT: return lambda *values: None
        return lambda *values: print(name, *(repr(v * MM) for v in values[:3]))


def run(gcode, home, text):
    path = os.path.join(home, "program.ngc")
    with open(path, "w") as file:
        file.write(text)
    result, _ = gcode.parse(path, Canon(home), "G21")
    print("refused " + gcode.strerror(result) if result > gcode.MIN_ERROR else "ended")


def main():
    home = tempfile.mkdtemp(prefix="feeler-reference")
    try:
        prepare_home(home)
        import gcode
        with open(sys.argv[1]) as file:
            programs = file.read().split("---\n")
        endless = {int(index) for index in sys.argv[2:]}
        for index, text in enumerate(programs):
            print("program", flush=True)
            child = os.fork()  # the state left by a program must not affect the next
            if child == 0:
                limit = SHORT_PATIENCE if index in endless else PATIENCE
                signal.setitimer(signal.ITIMER_VIRTUAL, limit)  # clock: ends only what never ends
                sys.stdout = os.fdopen(os.dup(1), "w")  # some of them print as well
                os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
                os.dup2(1, 2)
                run(gcode, home, text)
                sys.stdout.flush()
                os._exit(0)
            if os.waitpid(child, 0)[1]: print("\nrefused did not end")
    finally:
        shutil.rmtree(home, True)


main()
