#!/usr/bin/env python3
"""Runs feeler_tp and feeler guard in a headless LinuxCNC.

    linuxcnc_test.py FEELER SOURCE [SCENARIO ...]

Each scenario starts LinuxCNC (Debian's linuxcnc-uspace) with a simulated machine, whose positions a
sampler records in every servo cycle. As root, LinuxCNC runs as the user nobody. Ends with 77 if
LinuxCNC is not installed, or if the module cannot be put where LinuxCNC looks for it.
"""
import filecmp
import json
import math
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time  # clock: LinuxCNC runs in real time; limits only end tests that hang

MODULES = "/usr/lib/linuxcnc/modules"
PATIENCE = float(os.environ.get("FEELER_PATIENCE", "1"))
FEELER, SOURCE = "", ""

SETUP = """mesh_size = 0.5
[program]
dialect = "linuxcnc"
[offsets]
G54 = { X = 0, Y = 0, Z = -200 }
[stock]
box = [[-50, -30, -20], [50, 30, 0]]
[[fixture]]
name = "clamp"
box = [[120, -40, -20], [140, 40, 30]]
[[tool]]
number = 1
shape = "flat"
diameter = 10
flute_length = 30
stick_out = 100
"""

INI = """[EMC]
VERSION = 1.1
MACHINE = feeler-guard-test
[DISPLAY]
DISPLAY = {display}
[RS274NGC]
PARAMETER_FILE = sim.var
[EMCMOT]
EMCMOT = motmod
COMM_TIMEOUT = 4.0
BASE_PERIOD = 0
SERVO_PERIOD = 1000000
[TASK]
TASK = milltask
CYCLE_TIME = 0.001
[HAL]
HALUI = halui
HALFILE = LIB:core_sim.hal
HALFILE = LIB:sim_spindle_encoder.hal
HALFILE = test.hal
[TRAJ]
TPMOD = {planner}
NO_FORCE_HOMING = 1
COORDINATES = X Y Z
LINEAR_UNITS = mm
ANGULAR_UNITS = degree
DEFAULT_LINEAR_VELOCITY = 50
MAX_LINEAR_VELOCITY = 200
MAX_LINEAR_ACCELERATION = 1000
[EMCIO]
EMCIO = io
CYCLE_TIME = 0.100
TOOL_TABLE = tool.tbl
[KINS]
KINEMATICS = trivkins
JOINTS = 3
"""
AXIS = """[AXIS_{letter}]
MIN_LIMIT = -{limit}
MAX_LIMIT = {limit}
MAX_VELOCITY = {speed}
MAX_ACCELERATION = {acceleration}
[JOINT_{joint}]
TYPE = {type}
HOME = 0
HOME_SEQUENCE = 0
MAX_VELOCITY = {speed}
MAX_ACCELERATION = {acceleration}
MIN_LIMIT = -{limit}
MAX_LIMIT = {limit}
FERROR = 5
MIN_FERROR = 1
"""
LINEAR = {"type": "LINEAR", "limit": 500, "speed": 200, "acceleration": 1000}
ANGULAR = {"type": "ANGULAR", "limit": 36000, "speed": 500, "acceleration": 5000}
HAL = """loadrt sampler depth=120000 cfg=fff
net Xpos => sampler.0.pin.0
net Ypos => sampler.0.pin.1
net Zpos => sampler.0.pin.2
addf sampler.0 servo-thread
"""
# A table that tilts about X and turns about Z below the workpiece: (ini, HAL) for scenarios on five axes.
FIVE_AXES_INI = {
    "COORDINATES = X Y Z": "COORDINATES = XYZAC",
    "KINEMATICS = trivkins\nJOINTS = 3": "KINEMATICS = xyzac-trt-kins sparm=identityfirst\nJOINTS = 5",
}
FIVE_AXES_HAL = """loadrt sampler depth=120000 cfg=fffff
net Xpos => sampler.0.pin.0
net Ypos => sampler.0.pin.1
net Zpos => sampler.0.pin.2
net Apos joint.3.motor-pos-cmd => joint.3.motor-pos-fb sampler.0.pin.3
net Cpos joint.4.motor-pos-cmd => joint.4.motor-pos-fb sampler.0.pin.4
addf sampler.0 servo-thread
net :kinstype-select motion.analog-out-03 => motion.switchkins-type
net :tool-offset motion.tooloffset.z => xyzac-trt-kins.tool-offset
setp xyzac-trt-kins.x-rot-point 10
setp xyzac-trt-kins.y-rot-point -5
setp xyzac-trt-kins.z-rot-point -250
setp xyzac-trt-kins.y-offset 20
setp xyzac-trt-kins.z-offset 15
"""
HAL_GUARDED = "net tool-number iocontrol.0.tool-number => feeler-tp.tool-number\n"

FOLLOW_TIP, MOVE_AXES = "M68 E3 Q1\nM66 E0 L0\n", "M68 E3 Q0\nM66 E0 L0\n"

# The tip of tool 1 at Z0 of G54 has the gauge line at machine Z-100.
HEAD = "G21 G90 G17 G54\nT1 M6\nG43 H1\nM3 S1000\n"


def pause(seconds):
    time.sleep(seconds)  # clock: polls, and lets the machine move on


def within(seconds):
    """Yields until the time is over; a busy computer needs more of it."""
    end = time.time() + PATIENCE * seconds  # clock: gives up
    while time.time() < end:  # clock: as above
        yield


def fail(message):
    raise AssertionError(message)


def expect(condition, message):
    if not condition:
        fail(message)


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


# --- in LinuxCNC: the program that it starts as its display -----------------------------------


class Machine:
    """LinuxCNC from inside, for scenarios."""

    def __init__(self, folder):
        import linuxcnc

        self.api = linuxcnc
        self.folder = folder
        self.command, self.status, self.errors = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()
        self.guard = None
        self.messages = []
        with open(folder + "/sim.ini", encoding="utf-8") as ini:
            self.is_guarded = "TPMOD = feeler_tp" in ini.read()

    def start(self):
        for _ in range(100):
            try:
                self.status.poll()
                break
            except self.api.error:
                pause(0.1)
        self.command.state(self.api.STATE_ESTOP_RESET)
        self.command.wait_complete()
        self.command.state(self.api.STATE_ON)
        self.command.wait_complete()
        self.command.home(-1)
        self.wait(lambda s: all(s.homed[: s.joints]), "it is homed")
        self.sampler = subprocess.Popen(
            ["halsampler", "-c", "0"], stdout=open(self.folder + "/samples.txt", "w"), stderr=subprocess.DEVNULL
        )

    def wait(self, condition, what, seconds=60):
        for _ in within(seconds):
            self.poll()
            if condition(self.status):
                return
            pause(0.01)
        fail(f"waited in vain until {what}; messages: {self.messages}")

    def poll(self):
        self.status.poll()
        message = self.errors.poll()
        while message:
            self.messages.append(message[1])
            message = self.errors.poll()

    def start_guard(self, setup="mill.toml", options=(), file_size=None):
        def limit():
            if file_size is not None:
                resource.setrlimit(resource.RLIMIT_FSIZE, (file_size, file_size))

        self.guard = subprocess.Popen(
            [FEELER, "guard", "--setup", f"{self.folder}/{setup}", "--ini", f"{self.folder}/sim.ini", *options],
            stderr=open(self.folder + "/guard.err", "a", encoding="utf-8"),
            preexec_fn=limit,
            restore_signals=False,  # beyond the limit of a file's size, writing fails as on a full disk
        )
        self.wait(lambda s: pin("feeler-tp.guard-alive") == "TRUE", "the guard lives")

    def stop_guard(self):
        self.guard.send_signal(signal.SIGINT)
        return self.guard.wait()

    def run(self, program):
        self.command.mode(self.api.MODE_AUTO)
        self.command.wait_complete()
        self.command.program_open(f"{self.folder}/{program}")
        self.command.wait_complete()
        self.command.auto(self.api.AUTO_RUN, 0)

    def run_to_end(self, program, seconds=120):
        self.run(program)
        pause(0.2)
        self.wait(lambda s: s.interp_state == self.api.INTERP_IDLE and s.inpos, f"{program} ends", seconds)

    def mdi(self, code):
        self.command.mode(self.api.MODE_MDI)
        self.command.wait_complete()
        self.command.mdi(code)

    def abort(self):
        self.command.abort()
        self.command.wait_complete()
        pause(0.1)

    def clear(self):
        set_pin("feeler-tp.clear", "1")
        self.wait(lambda s: pin("feeler-tp.latched") == "FALSE", "the violation is cleared")
        set_pin("feeler-tp.clear", "0")

    def wait_at_rest(self, seconds=60):
        """Until nothing has moved for half a second. If only LinuxCNC waits for a busy machine, its velocity is not 0."""
        last, equal = None, 0
        for _ in within(seconds):
            self.poll()
            now = self.status.position[:6]
            equal = equal + 1 if now == last and self.status.current_vel == 0.0 else 0
            last = now
            if equal == 25:
                return now
            pause(0.02)
        return fail("it does not come to rest")

    def told(self, text):
        return any(text in message for message in self.messages)

    def wait_told(self, text, seconds=60):
        self.wait(lambda s: self.told(text), f"a message contains '{text}'", seconds)

    def end_samples(self):
        pause(0.2)
        self.sampler.send_signal(signal.SIGINT)
        self.sampler.wait()


def pin(name):
    return subprocess.run(["halcmd", "getp", name], capture_output=True, text=True, check=False).stdout.strip()


def set_pin(name, value):
    subprocess.run(["halcmd", "setp", name, value], check=True)


def is_at(position, **axes):
    return all(abs(position["XYZ".index(axis)] - value) < 1e-4 for axis, value in axes.items())


# --- scenarios: NAME_files writes the files, NAME_drive runs in LinuxCNC, NAME_check looks at the samples

SCENARIOS = {}


def scenario(function):
    SCENARIOS[function.__name__] = function
    return function


def steps(first, last, by, letter="X"):
    count = round((last - first) / by)
    return "".join(f"{letter}{first + by * (i + 1):.4f}\n" for i in range(count))


@scenario
def stops_before_the_violation(m):
    """Blocks of 5 mm and 0.1 mm, rapids, arcs, blends: each ends where the last clear block does."""
    # The clamp begins at X120: with a radius of 5 and a minimum of 2 mm, X113 is the last place.
    programs = {
        "long.ngc": (HEAD + "G61\nG0 X60 Y0 Z10\nG1 F6000\n" + steps(60, 140, 5) + "M2\n", 110.0),
        "fine.ngc": (HEAD + "G61\nG0 X100 Y0 Z10\nG1 F2000\n" + steps(100, 130, 0.1) + "M2\n", 113.0),
        "blended.ngc": (
            HEAD + "G64 P0.01 Q0\nG0 X90 Y0 Z10\nG1 F3000\n"
            + "".join(f"X{90 + i / 2} Y{i % 2 / 2}\n" for i in range(1, 80)) + "M2\n", 112.5),
        # LinuxCNC joins these lines to one, which is refused as a whole.
        "joined.ngc": (HEAD + "G64 P0.01\nG0 X90 Y0 Z10\nG1 F3000\n" + steps(90, 130, 0.5) + "M2\n", 90.0),
        "rapid.ngc": (HEAD + "G0 X60 Y0 Z10\n" + steps(60, 140, 4) + "M2\n", 112.0),
        "arc.ngc": (HEAD + "G0 X90 Y-20 Z10\nG1 F3000 X100\nG3 X100 Y20 J20\nG1 X60\nM2\n", 100.0),
        "masked.ngc": (HEAD + "M49\nM53 P0\nG61\nG0 X60 Y0 Z10\nG1 F6000\n" + steps(60, 140, 5) + "M2\n", 110.0),
    }
    for name, (text, _) in programs.items():
        write(f"{m.folder}/{name}", text)
    m.start_guard()
    for name, (_, last) in programs.items():
        m.run(name)
        m.wait(lambda s: pin("feeler-tp.holding") == "TRUE" and pin("feeler-tp.latched") == "TRUE", f"{name} is held")
        position = m.wait_at_rest()
        expect(abs(position[0] - last) < 1e-4, f"{name} stops at X{position[0]}, not X{last}")
        m.wait_told("clamp")
        m.messages.clear()
        m.abort()
        m.clear()
        m.mdi("G0 Z60")
        m.wait(lambda s: is_at(s.position, Z=-40.0), "it goes up")
        m.wait_at_rest()
    expect(m.stop_guard() == 1, "the guard ends with status 1 after refusals")


@scenario
def does_nothing_without_a_guard(m):
    write(m.folder + "/a.ngc", HEAD + "G0 X10\nM2\n")
    m.run("a.ngc")
    m.wait(lambda s: pin("feeler-tp.holding") == "TRUE", "it holds")
    pause(1)
    expect(is_at(m.wait_at_rest(), X=0.0, Y=0.0, Z=0.0), "it has moved without a guard")
    m.wait_told("feeler guard does not run")
    m.start_guard()
    m.wait(lambda s: is_at(s.position, X=10.0), "it goes on with a guard")
    m.stop_guard()


@scenario
def waits_while_an_external_offset_is_in_use(m):
    for axis in "xz":
        set_pin(f"axis.{axis}.eoffset-enable", "1")
        set_pin(f"axis.{axis}.eoffset-scale", "1")
    for state in (m.api.STATE_OFF, m.api.STATE_ON):  # the offsets are enabled when it is switched on
        m.command.state(state)
        m.command.wait_complete()
    m.start_guard()
    m.mdi("G0 X100 Z60")
    m.wait(lambda s: is_at(s.position, X=100.0), "it moves without an offset")
    m.wait_at_rest()
    for i, counts in enumerate((-20, 7, -3)):
        set_pin("axis.z.eoffset-counts", str(counts))
        pause(1)
        m.messages.clear()
        m.mdi(f"G0 X{99 - i}")
        m.wait_told("external offset")
        expect(is_at(m.wait_at_rest(), X=100.0 - i), "it moves with an offset")
        # What LinuxCNC leaves of the offset depends on the way back.
        set_pin("axis.z.eoffset-counts", "0")
        m.wait(lambda s: is_at(s.position, X=99.0 - i), "it goes on without an offset")
    m.stop_guard()


@scenario
def survives_a_guard_that_is_killed(m):
    """Killed at ten moments: it stops at the end of a block, and goes on with the next guard."""
    blocks = steps(60, 110, 5) + "".join(f"X{x}\n" for x in range(105, 55, -5))
    write(m.folder + "/a.ngc", HEAD + "G61\nG0 X60 Y0 Z10\nG1 F3000\n" + blocks * 12 + "M2\n")
    m.start_guard()
    m.run("a.ngc")
    for i in range(10):
        pause(0.35 + 0.09 * i)
        m.guard.kill()
        m.guard.wait()
        position = m.wait_at_rest()
        expect(abs(position[0] / 5 - round(position[0] / 5)) < 1e-5, f"it stops within a block, at {position}")
        if m.status.interp_state == m.api.INTERP_IDLE:
            break
        m.start_guard()
    m.abort()
    m.guard.kill()
    m.guard.wait()
    m.start_guard()
    m.mdi("G0 Z20")
    m.wait_at_rest()
    m.messages.clear()
    m.mdi("G1 X-60 F1000")  # takes longer than the message needs
    m.wait(lambda s: not s.inpos and pin("feeler-tp.holding") == "FALSE", "it moves")
    m.guard.kill()
    m.guard.wait()
    m.wait_told("feeler guard has ended")
    expect(not m.status.inpos, "it is told only when it has stopped")
    m.wait_at_rest()


@scenario
def follows_the_operator(m):
    """Pause, abort, MDI, and what was cut before an abort."""
    write(m.folder + "/a.ngc", HEAD + "G61\nG0 X-70 Y0 Z10\nZ-5\nG1 F1000 X20\nG0 Z20\nX113\nM2\n")
    m.start_guard()
    m.run("a.ngc")
    m.wait(lambda s: s.position[2] < -104.9 and s.position[0] > -40, "it cuts")
    m.command.auto(m.api.AUTO_PAUSE)
    paused = m.wait_at_rest()
    expect(-45 < paused[0] < 20, "it pauses on its way")
    m.command.auto(m.api.AUTO_RESUME)
    m.wait(lambda s: s.position[0] > paused[0] + 10, "it resumes")
    m.abort()
    stopped = m.wait_at_rest()
    expect(paused[0] < stopped[0] < 20, "it is aborted on its way")
    m.mdi("G0 X-70")  # back through its own cut
    m.wait(lambda s: is_at(s.position, X=-70.0), "it goes back through its cut")
    m.wait_at_rest()
    m.mdi(f"G0 X{stopped[0] + 6:.3f}")  # beyond the cut
    m.wait_told("stock")
    expect(is_at(m.wait_at_rest(), X=-70.0), "it moves into stock that was not cut")
    m.abort()
    m.stop_guard()


@scenario
def compares_the_set_up(m):
    """Nothing moves with a work offset or a tool length other than those of the set-up."""
    write(m.folder + "/shifted.toml", SETUP.replace("X = 0, Y = 0", "X = 0.05, Y = 0"))
    write(m.folder + "/longer.toml", SETUP.replace("stick_out = 100", "stick_out = 101"))
    write(m.folder + "/a.ngc", HEAD + "G0 X10\nM2\n")
    for setup, text in (("shifted.toml", "G54 X"), ("longer.toml", "length of tool 1")):
        m.start_guard(setup)
        m.run("a.ngc")
        m.wait_told(text)
        expect(is_at(m.wait_at_rest(), X=0.0), f"it moves with {setup}")
        m.abort()
        m.stop_guard()
    m.start_guard()
    m.run_to_end("a.ngc")
    expect(is_at(m.status.position, X=10.0), "it moves with the right set-up")
    m.messages.clear()
    m.mdi("G10 L20 P1 X10.5")  # touched off anew
    m.wait_at_rest()
    m.mdi("G0 X20")
    m.wait_told("G54 X")
    expect(is_at(m.wait_at_rest(), X=10.0), "it moves after touching off elsewhere")
    m.abort()
    m.mdi("G10 L20 P1 X10")
    m.wait_at_rest()

    def holds(text, x):
        """At X, a motion is held as long as something is not as it should be; then it is aborted."""
        m.messages.clear()
        m.mdi("G0 X20")
        m.wait_told(text)
        expect(is_at(m.wait_at_rest(), X=x), f"it moves although {text}")
        m.abort()

    write(m.folder + "/mill.toml", SETUP + "# edited\n")
    holds("set-up file has changed", 10.0)
    write(m.folder + "/mill.toml", SETUP)
    subprocess.run(["halcmd", "unlinkp", "feeler-tp.tool-number"], check=True)
    set_pin("feeler-tp.tool-number", "2")
    holds("LinuxCNC has tool 1", 10.0)
    set_pin("feeler-tp.tool-number", "1")
    m.mdi("G0 X12")
    expect(is_at(m.wait_at_rest(), X=12.0), "it moves when all is as it should be")
    m.command.mode(m.api.MODE_MANUAL)
    m.command.wait_complete()
    m.command.teleop_enable(0)
    m.command.wait_complete()
    m.command.unhome(-1)
    m.wait(lambda s: not any(s.homed[: s.joints]), "it is not homed")
    holds("not homed", 12.0)
    m.stop_guard()


@scenario
def works_with_a_full_disk_and_slowly(m):
    write(m.folder + "/a.ngc", HEAD + "G64 P0.05 Q0\nG0 X-60 Y0 Z10\nZ-1\nG1 F3000\n"
          + "".join(f"X{-60 + 2 * i} Y{i % 2}\n" for i in range(1, 61)) + "M2\n")
    m.start_guard(options=["--log", m.folder + "/short.ngc"], file_size=250)
    m.run_to_end("a.ngc")
    m.wait_told("log")
    expect(is_at(m.status.position, X=60.0), "it runs with a full disk")
    for code in ("G0 Z10", "G0 X-60"):
        m.mdi(code)
        m.wait_at_rest()
    expect(m.stop_guard() == 0, "the guard has refused nothing")

    m.start_guard(options=["--log", m.folder + "/log.ngc"])
    m.run("a.ngc")
    for _ in within(60):
        m.guard.send_signal(signal.SIGSTOP)
        pause(0.02)
        m.guard.send_signal(signal.SIGCONT)
        pause(0.0005)
        m.poll()
        if is_at(m.status.position, X=60.0):
            break
    m.guard.send_signal(signal.SIGCONT)
    expect(is_at(m.status.position, X=60.0), "it runs with a slow guard")
    m.wait_at_rest()
    expect(m.stop_guard() == 0, "the guard has refused nothing")
    checked = subprocess.run(
        [FEELER, "check", m.folder + "/log.ngc", "--setup", m.folder + "/mill.toml", "--format", "json",
         "-o", m.folder + "/log.json"], check=False)
    expect(checked.returncode == 0, "the log is a program that is clear")
    with open(m.folder + "/log.json", encoding="utf-8") as file:
        blocks = json.load(file)["blocks"]
    expect(len(blocks) > 50, "the log has all motions")


@scenario
def taps_probes_and_threads(m):
    """Motions that cannot be stopped on their way are permitted as a whole."""
    write(
        m.folder + "/a.ngc",
        HEAD + "G0 X90 Y0 Z10\nG38.3 Z5 F100\nG38.5 Z10\nG0 Z10\nS60 M3\nG33.1 Z8 K1\nG33 Z6 K0.5\nG0 Z12\nM2\n",
    )
    m.start_guard()
    m.run_to_end("a.ngc")
    expect(is_at(m.status.position, X=90.0, Z=-88.0), f"it ends at {m.status.position[:3]}")
    for code in ("M5", "G0 Z60", "G0 X0", "G0 Z0.5"):
        m.mdi(code)
        m.wait_at_rest()
    set_pin("motion.probe-input", "1")  # it is bent and stays in contact
    m.mdi("G38.5 Z3 F200")
    expect(is_at(m.wait_at_rest(), Z=-97.0), "a probe may go out of the stock")
    m.mdi("G38.5 Z-5 F200")
    m.wait_told("Feeler stops")
    expect(m.told("stock") and is_at(m.wait_at_rest(), Z=-97.0), "it goes deeper into the stock")
    m.stop_guard()


def random_program(random):
    """Motions around the clamp, of which many come too near to it."""
    lines = [random.choice(["G61.1", "G61", "G64", "G64 P0.05", "G64 P0.5 Q0"]), f"F{random.choice([1000, 4000, 12000])}"]
    lines.append(f"G0 X{random.uniform(90, 170):.3f} Y{random.uniform(-70, 70):.3f} Z60")
    for _ in range(random.randint(4, 14)):
        place = [random.uniform(85, 175), random.uniform(-75, 75), random.choice([random.uniform(-10, 33), random.uniform(33, 60)])]
        words = [f"{axis}{value:.3f}" for axis, value in zip("XYZ", place) if random.random() < 0.6]
        if not words:
            words = [f"X{place[0]:.3f}"]
        if random.random() < 0.2:  # part of a helix
            lines.append(f"{random.choice(['G2', 'G3'])} X#5420 Y#5421 I{random.uniform(-15, 15):.3f} J{random.uniform(-15, 15):.3f} Z{place[2]:.3f}")
        else:
            lines.append(f"{random.choice(['G0', 'G1', 'G1'])} {' '.join(words)}")
    return HEAD + "\n".join(lines) + "\nM2\n"


def run_random_programs(m, make_program, retreat, leave, rounds):
    """Runs random programs, of which some are held; then `retreat` is made by MDI, at times, and `leave` ends the round."""
    import random as source

    rounds = int(os.environ.get("FEELER_GUARD_ROUNDS", rounds))
    random = source.Random(int(os.environ.get("FEELER_GUARD_SEED", "1")))
    m.start_guard()
    m.mdi("M61 Q1")
    m.wait_at_rest()
    held = 0
    for i in range(rounds):
        write(f"{m.folder}/{i}.ngc", make_program(random))
        m.messages.clear()
        m.run(f"{i}.ngc")
        pause(0.3)
        m.wait(lambda s: pin("feeler-tp.holding") == "TRUE" or s.interp_state == m.api.INTERP_IDLE and s.inpos, f"{i}.ngc ends")
        if random.random() < 0.3:
            m.abort()
        if pin("feeler-tp.latched") == "TRUE":
            held += 1
            m.wait_at_rest()
            m.abort()
            if random.random() < 0.5:
                m.mdi(retreat(random))  # while it is latched
                m.wait_at_rest()
                m.abort()
            m.clear()
        expect(not m.told("kinematics"), f"its kinematics are not known: {m.messages}")
        m.abort()
        leave()
    m.stop_guard()
    expect(rounds / 5 < held < rounds, f"{held} of {rounds} programs were held")


@scenario
def keeps_its_distance_in_random_motion(m):
    """In no servo cycle is the tool nearer to the clamp than the set-up allows, however corners are rounded."""

    def leave():
        m.mdi("G0 Z60")
        m.wait_at_rest()
        m.abort()

    run_random_programs(
        m, random_program, lambda random: f"G0 X{random.uniform(85, 175):.3f} Y{random.uniform(-75, 75):.3f}", leave, 15)


def tilted_back(joints, length):
    """Where the end of a tool of this length is, in world coordinates of the work on the table at A0 C0. From the
    formulas of LinuxCNC's trtfuncs.c."""
    x, y, z, a, c = joints
    a, c = math.radians(a), math.radians(c)
    x0, y0, z0, dy, dz = 10.0, -5.0, -250.0, 20.0, 15.0 + length
    q, r, t = y - dy - y0, z - dz - z0, x - x0
    s = q * math.cos(a) + r * math.sin(a) + dy
    return (
        math.cos(c) * t + math.sin(c) * s + x0,
        -math.sin(c) * t + math.cos(c) * s + y0,
        -q * math.sin(a) + r * math.cos(a) + dz + z0 - length,
    )


def distance_to_clamp(tip, a, c):
    """The distance of the tool, a cylinder of radius 5 and length 100, from the clamp of FIVE_AXES, by points on the
    tool: up to 0.02 mm too large. All as seen from the work."""

    def direction(dx, dy, up):  # of the machine
        ends = [tilted_back((k * dx, k * dy, k * up, a, c), 0.0) for k in (0, 1)]
        return [q - p for p, q in zip(*ends)]

    across, along, axis = direction(1, 0, 0), direction(0, 1, 0), direction(0, 0, 1)

    def gap(height, angle, radius=5.0):
        u, v = radius * math.cos(angle), radius * math.sin(angle)
        place = [t + height * w + u * p + v * q for t, w, p, q in zip(tip, axis, across, along)]
        return math.hypot(*(max(low - value, value - high, 0.0)
                            for value, low, high in zip(place, (120, -40, -220), (140, 40, -170))))

    angles = [k * math.pi / 90 for k in range(180)]
    rim = min(gap(0.0, angle, radius) for angle in angles for radius in (5.0, 2.5, 0.0))
    if rim > 60.0:
        return rim
    # The distance is convex in the height along each line of the side.
    def side(angle):
        low, high = 0.0, 100.0
        for _ in range(40):
            third = (high - low) / 3
            if gap(low + third, angle) < gap(high - third, angle):
                high -= third
            else:
                low += third
        return gap(0.5 * (low + high), angle)

    return min(rim, min(side(angle) for angle in angles[::6]))


def nearest_on_five_axes(samples):
    """The least distance of the tool from the clamp, and how far it was tilted at most."""
    least, most_tilt = math.inf, 0.0
    for joints in samples[::3]:
        most_tilt = max(most_tilt, abs(joints[3]))
        tip = tilted_back(joints, 100.0)
        middle = tilted_back(joints, 50.0)
        # The tool is within 51 of its middle, the clamp within 48 of its own.
        if math.dist(middle, (130, 0, -195)) - 99 > min(least, 10.0):
            continue
        least = min(least, distance_to_clamp(tip, *joints[3:]))
    return least, most_tilt


def nearest_to_clamp(samples):
    """The least distance of the tool, a cylinder from its tip to the gauge line, from the clamp."""
    least = math.inf
    for x, y, z in samples:
        beside = math.hypot(max(120 - x, x - 140, 0.0), max(abs(y) - 40, 0.0)) - 5.0
        least = min(least, math.hypot(max(beside, 0.0), max(z + 100 - 30, 0.0)))
    return least


def runs_on_five_axes(m, program, expected_x=None):
    """Runs a program that is held at X of the tip, or not at all."""
    m.messages.clear()
    m.run(program)
    pause(0.3)
    m.wait(lambda s: pin("feeler-tp.latched") == "TRUE" and pin("feeler-tp.holding") == "TRUE"
           or s.interp_state == m.api.INTERP_IDLE and s.inpos, f"{program} ends")
    held = pin("feeler-tp.latched") == "TRUE"
    position = m.wait_at_rest()
    if expected_x is None:
        expect(not held, f"{program} is held: {m.messages}")
    else:
        expect(held and abs(position[0] - expected_x) < 1e-4,
               f"{program} stops at {position}, not at X{expected_x}: {m.messages}")
    m.abort()
    if held:
        m.clear()


def level(m):
    """By hand, which nothing watches: up, and the table level."""
    for code in MOVE_AXES.split("\n")[:2]:
        m.mdi(code)
        m.wait_at_rest()
    m.command.mode(m.api.MODE_MANUAL)
    m.command.wait_complete()
    m.command.teleop_enable(1)
    m.command.wait_complete()
    for axis in (2, 3, 5, 0, 1):
        for _ in range(3):
            m.poll()
            way = -m.status.position[axis]
            if abs(way) > 1e-6:
                m.command.jog(m.api.JOG_INCREMENT, 0, axis, 80 if way > 0 else -80, abs(way))
                m.wait_at_rest()
    expect(all(abs(value) < 1e-5 for value in m.status.joint_actual_position[:5]), "it is level")


@scenario
def five_axes_stop_before_the_violation(m):
    """The tip is followed as LinuxCNC's kinematics do it: it stops where the last clear block ends."""
    m.start_guard(options=["--log", m.folder + "/log.ngc"])
    for a, c in ((0, 30), (20, 0), (-25, 90), (25, 90), (30, -60)):
        name = f"a{a}c{c}.ngc"
        places = [60 + 0.5 * i for i in range(1, 140)]
        lines = "".join(f"X{x:.3f}\n" for x in places)
        write(f"{m.folder}/{name}", HEAD + "G61\n" + MOVE_AXES + FOLLOW_TIP + f"G0 X60 Y0 Z10\nA{a} C{c}\n"
              + "G1 F6000\n" + lines + "M2\n")
        near = next(x for x in places if distance_to_clamp((x, 0, -190), a, c) < 2 - 1e-6)
        runs_on_five_axes(m, name, near - 0.5)
        level(m)
    # Where nothing is near, a program with full turns, arcs and both kinematics runs to its end.
    write(m.folder + "/clear.ngc", HEAD + "G64 P0.05\n" + MOVE_AXES + "G0 X0 Y0 Z60\n" + FOLLOW_TIP
          + "G0 A30 C90\nG1 X20 Y10 F3000\nA-20 C-45\nG3 X-20 Y10 I-20 J0 C135\nG1 Z70 A10 C400\nG0 A0 C360\n"
          + MOVE_AXES + "G0 Z90\nA25 C0\n" + FOLLOW_TIP + "G1 X5 F2000\nG0 A0\nM2\n")
    runs_on_five_axes(m, "clear.ngc")
    level(m)
    expect(m.stop_guard() == 1, "the guard has refused something")
    checked = subprocess.run(
        [FEELER, "check", m.folder + "/log.ngc", "--setup", m.folder + "/mill.toml", "--ini", m.folder + "/sim.ini",
         "--format", "json", "-o", m.folder + "/log.json"], check=False)
    expect(checked.returncode in (0, 1), "the log is a program that can be checked")
    with open(m.folder + "/log.json", encoding="utf-8") as file:
        blocks = json.load(file)["blocks"]
    with open(m.folder + "/log.ngc", encoding="utf-8") as file:
        lines = file.read().split("\n")
    by_hand = {number + 1 for number, line in enumerate(lines, 1) if line.startswith("(moved in another way")}
    wrong = [lines[block["line"] - 1] for block in blocks if block["verdict"] != "clear" and block["line"] not in by_hand]
    expect(len(blocks) > 300 and not wrong, f"what was made is clear: {wrong}")


@scenario
def five_axes_compare_the_kinematics(m):
    """Nothing turns while the pins of the kinematics are not those of the set-up, or when they change on the way."""
    write(m.folder + "/a.ngc", HEAD + MOVE_AXES + "G0 X0 Y0 Z60\n" + FOLLOW_TIP + "G0 A30 C90\nG0 A0 C0\nM2\n")
    m.start_guard()
    runs_on_five_axes(m, "a.ngc")
    level(m)
    set_pin("xyzac-trt-kins.y-offset", "20.5")
    m.run("a.ngc")
    m.wait_told("kinematics")
    expect(abs(m.wait_at_rest()[3]) < 1e-9, "it turns with another pivot")
    m.abort()
    m.clear()
    set_pin("xyzac-trt-kins.y-offset", "20")
    level(m)
    # M67 switches the kinematics while the next motion is made, with the table turned and level.
    for turned, name in (("A30 C90", "b.ngc"), ("A0 C0", "c.ngc")):
        write(f"{m.folder}/{name}", HEAD + MOVE_AXES + f"G0 X0 Y0 Z60\nG1 {turned} F6000\nM67 E3 Q1\nG1 X80 A0\nX85\nM2\n")
        m.messages.clear()
        m.run(name)
        pause(0.3)
        m.wait(lambda s: s.interp_state == m.api.INTERP_IDLE or pin("feeler-tp.latched") == "TRUE", "it ends")
        joints = m.wait_at_rest() and m.status.joint_actual_position[:5]
        expect(joints[0] < 40, f"it goes on in other kinematics: {joints}")
        m.wait_told("has ended the program")
        expect(pin("feeler-tp.latched") == "FALSE", "nothing was refused")
        level(m)
        m.mdi("G0 X-5")  # the next motion is made
        m.wait(lambda s: is_at(s.position, X=-5.0), "it moves again")
        level(m)
    m.stop_guard()


def random_five_axis_program(random):
    lines = [random.choice(["G61.1", "G61", "G64 P0.05", "G64 P0.5 Q0"]), f"F{random.choice([1000, 4000, 12000])}"]
    lines.append(f"G0 X{random.uniform(60, 110):.3f} Y{random.uniform(-60, 60):.3f} Z{random.uniform(60, 90):.3f}")
    lines.append(FOLLOW_TIP.strip())
    for _ in range(random.randint(4, 12)):
        place = [random.uniform(80, 175), random.uniform(-60, 60), random.uniform(5, 70)]
        words = [f"{axis}{value:.3f}" for axis, value in zip("XYZ", place) if random.random() < 0.6]
        if random.random() < 0.6:
            words.append(f"A{random.uniform(-45, 45):.3f}")
        if random.random() < 0.6:
            words.append(f"C{random.uniform(-200, 200):.3f}")
        if random.random() < 0.15:
            lines.append(f"{random.choice(['G2', 'G3'])} X#5420 Y#5421 I{random.uniform(-15, 15):.3f} "
                         f"J{random.uniform(-15, 15):.3f} Z{place[2]:.3f} C{random.uniform(-90, 90):.3f}")
        elif words:
            lines.append(f"{random.choice(['G0', 'G1', 'G1'])} {' '.join(words)}")
        if random.random() < 0.1:
            lines.append(random.choice([FOLLOW_TIP, MOVE_AXES]).strip())
    return HEAD + MOVE_AXES + "\n".join(lines) + "\nM2\n"


@scenario
def five_axes_keep_their_distance(m):
    """Random motion in both kinematics: in no servo cycle is the tool nearer to the clamp than the set-up allows."""

    def leave():
        set_pin("sampler.0.enable", "0")  # what is moved by hand does not count
        level(m)
        set_pin("sampler.0.enable", "1")

    run_random_programs(
        m, random_five_axis_program,
        lambda random: f"G0 X{random.uniform(85, 175):.3f} A{random.uniform(-45, 45):.3f}", leave, 6)


# --- from outside -----------------------------------------------------------------------------


def same_path(m):
    """Real work, from the first motion to the last; also run with the stock planner."""
    programs = {
        "raster.ngc": "G64 P0.01 Q0\nG0 X-60 Y-25 Z5\nG1 Z-2 F6000\n"
        + "".join(f"Y{y}\nX{60 if y % 16 == 8 else -60}\n" for y in range(-24, 25, 8)) + "G0 Z20\n",
        "arcs.ngc": "G64 P0.02\nG0 X0 Y0 Z5\nG1 Z-1 F3000\n"
        + "".join(f"G3 X{-r if i % 2 == 0 else r} Y0 I{-r if i % 2 == 0 else r} J0\nG1 X{-(r + 2) if i % 2 == 0 else r + 2}\n"
                  for i, r in enumerate(range(4, 12, 2))) + "G0 Z20\n",
        "holes.ngc": "".join(f"G81 X{x} Y{y} Z-5 R2 F800\n" for x in range(-40, 41, 20) for y in (-20, 20))
        + "G80\nG0 Z20\n",
        "fine.ngc": "G64\nG0 X-40 Y0 Z5\nG1 Z-1 F2000\n"
        + "".join(f"X{-40 + i / 10:.3f} Y{10 * math.sin(i / 40):.4f} Z{-1 - math.sin(i / 70) / 2:.4f}\n"
                  for i in range(800)) + "G0 Z20\n",
        "stops.ngc": "G61.1\nG0 X-40 Y0 Z5\nG1 F3000\n"
        + "".join(f"X{-40 + i} Y{i % 5}\n" for i in range(40)) + "G0 Z20\n",
    }
    for name, text in programs.items():
        write(f"{m.folder}/{name}", HEAD + text + "M2\n")
    if m.is_guarded:
        m.start_guard()
    for name in programs:
        m.run_to_end(name)
        m.wait_at_rest()
    if m.is_guarded:
        expect(m.stop_guard() == 0, "the guard has refused nothing")


def five_axes_same_path(m):
    """A program on five axes: as before without the guard; and one with a mistake is held at its first motion."""
    if m.is_guarded:
        m.start_guard()
    m.run_to_end("dome.ngc", 240)
    m.wait_at_rest()
    expect(not m.messages, f"something was refused: {m.messages}")
    if not m.is_guarded:
        return
    set_pin("sampler.0.enable", "0")
    m.run("dome_m428.ngc")
    m.wait_told("Feeler stops before line 10")
    m.wait_at_rest()
    m.abort()
    m.stop_guard()


def make_dome_files(folder):
    """A dome of assets/, which feeds faster than it was written, and the sample machine of LinuxCNC that it is for."""
    with open(SOURCE + "/assets/setups/dome.toml", encoding="utf-8") as file:
        setup = file.read()
    write(folder + "/mill.toml", setup.replace("../machines/xyzac.toml", "xyzac.toml"))
    shutil.copy(SOURCE + "/assets/machines/xyzac.toml", folder)
    for name in ("dome.ngc", "dome_m428.ngc"):
        with open(f"{SOURCE}/assets/programs/{name}", encoding="utf-8") as file:
            code = file.read().replace("\nG54\n", "\nG54 G61\n")
        write(f"{folder}/{name}", re.sub(r"F(\d+)", lambda match: "F" + str(10 * int(match[1])), code))
    for name, code in (("428remap", FOLLOW_TIP), ("429remap", MOVE_AXES)):
        write(f"{folder}/{name}.ngc", f"o<{name}> sub\n{code}o<{name}> endsub\nM2\n")
    write(folder + "/tool.tbl", "T1 P1 Z70 D6\n")
    write_parameters(folder, [0.0] * 9)
    with open(folder + "/sim.ini", encoding="utf-8") as file:
        ini = file.read().replace("[JOINT_2]\nTYPE = LINEAR\nHOME = 0\n",
                                  "[JOINT_2]\nTYPE = LINEAR\nHOME_OFFSET = 120\nHOME = 120\n")
    write(folder + "/sim.ini", ini.replace("[RS274NGC]\n", "[RS274NGC]\nSUBROUTINE_PATH = .\n"
                                           "REMAP = M428 modalgroup=10 ngc=428remap\nREMAP = M429 modalgroup=10 ngc=429remap\n"))
    with open(folder + "/test.hal", encoding="utf-8") as file:
        hal = file.read()
    for pin_name, value in (("x-rot-point", 0), ("y-rot-point", 0), ("z-rot-point", 0), ("z-offset", 10)):
        hal = re.sub(f"setp xyzac-trt-kins.{pin_name} .*", f"setp xyzac-trt-kins.{pin_name} {value}", hal)
    write(folder + "/test.hal", hal)


# Scenarios that are also run with the stock planner.
COMPARED = {"same_path": same_path, "five_axes_same_path": five_axes_same_path}

# The programs of tests/planted for LinuxCNC whose set-ups have three axes, by set-up.
PLANTED = ("plate", "plate_stud", "plate_tall")


def planted_programs(setup):
    """Pairs of a program with a mistake and its harmless twin."""
    with open(SOURCE + "/tests/planted/table.txt", encoding="utf-8") as table:
        rows = [line.split() for line in table if line.strip() and line[0] != "#"]
    rows = [row for row in rows if row[1] == "linuxcnc" and row[7] == "-"]
    return [(row[2], row[5]) for row in rows if row[4] == setup and row[6] == setup]


def first_problem(program, setup):
    """The line of the first motion that a check calls a violation or a collision, 0 if there is none; empty
    if the program has findings of another kind. A tool change is held before the next motion."""
    checked = subprocess.run(
        [FEELER, "check", program, "--setup", setup, "--format", "json"], capture_output=True, text=True, check=False)
    if checked.returncode not in (0, 1):
        return None
    report = json.loads(checked.stdout)
    is_wrong = False
    for block in report["blocks"]:
        is_wrong = is_wrong or block["verdict"] in ("violation", "collision")
        if is_wrong and block["motion"] != "none":
            return block["line"]
    return 0 if checked.returncode == 0 else None


def planted(m):
    """Every planted mistake is held before its block, and every harmless program runs to its end."""
    with open(m.folder + "/expected.json", encoding="utf-8") as file:
        expected = json.load(file)
    home = [m.status.position[axis] for axis in range(3)]
    for name, line in expected:
        m.start_guard()
        m.messages.clear()
        m.run(name)
        pause(0.3)
        if line == 0:
            m.wait(lambda s: s.interp_state == m.api.INTERP_IDLE and s.inpos, f"{name} ends")
            expect(not m.told("Feeler stops"), f"{name} is harmless: {m.messages}")
        else:
            m.wait(lambda s: pin("feeler-tp.holding") == "TRUE" and m.told("Feeler stops"), f"{name} is held", 120)
            m.wait_at_rest()
            held = int(pin("feeler-tp.line"))
            expect(held <= line, f"{name} is held before line {held}, and line {line} is a problem")
            m.abort()
            m.clear()
        m.stop_guard()
        m.command.mode(m.api.MODE_MANUAL)
        m.command.wait_complete()
        go_home(m, home)


def go_home(m, home):
    """Moves by hand, which nothing watches."""
    m.command.teleop_enable(1)
    m.command.wait_complete()
    for axis in (2, 0, 1):
        for _ in range(3):
            m.poll()
            way = home[axis] - m.status.position[axis]
            if abs(way) > 1e-6:
                m.command.jog(m.api.JOG_INCREMENT, 0, axis, 100 if way > 0 else -100, abs(way))
                m.wait_at_rest()


def make_planted_files(folder, setup):
    """The set-up, the machine and the programs, which feed faster than they were written."""
    import tomllib

    with open(f"{SOURCE}/tests/planted/setups/{setup}.toml", "rb") as file:
        text = file.read()
    table = tomllib.loads(text.decode())
    write(folder + "/mill.toml", text.decode())
    start = table["program"]["start"]
    lengths = {
        tool["number"]: tool["flute_length"] + sum(part[2] for part in tool.get("shank", []) + tool["holder"])
        for tool in table["tool"]
    }
    write(folder + "/tool.tbl", "".join(f"T{n} P{n} Z{length}\n" for n, length in lengths.items()))
    write_parameters(folder, [table["offsets"]["G54"].get(axis, 0.0) for axis in "XYZ"])
    with open(folder + "/sim.ini", encoding="utf-8") as file:
        ini = file.read()
    for joint, letter in enumerate("XYZ"):
        ini = ini.replace(f"[JOINT_{joint}]\nTYPE = LINEAR\nHOME = 0\n",
                          f"[JOINT_{joint}]\nTYPE = LINEAR\nHOME_OFFSET = {start[letter]}\nHOME = {start[letter]}\n")
    write(folder + "/sim.ini", ini.replace("-500", "-1000").replace("= 500", "= 1000"))


    def faster(program):
        with open(f"{SOURCE}/tests/planted/{program}", encoding="latin-1") as file:
            code = re.sub(r"F(\d+)", lambda match: "F" + str(20 * int(match[1])), file.read())
        name = program.replace("/", "-")
        write(f"{folder}/{name}", code)
        return name, first_problem(f"{folder}/{name}", folder + "/mill.toml")

    expected = []
    for pair in planted_programs(setup):
        wrong, right = (faster(program) for program in pair)
        if wrong[1]:
            expected.append(wrong)
            if right[1] == 0:
                expected.append(right)
    write(folder + "/expected.json", json.dumps(expected))
    print("  " + ", ".join(f"{name} ({line or 'harmless'})" for name, line in expected))
    expect(expected, f"there are no planted programs for {setup}")


def read_samples(folder):
    with open(folder + "/samples.txt", encoding="utf-8") as file:
        rows = [tuple(map(float, line.split())) for line in file if line[0].isdigit() or line[0] == "-"]
    return [row for i, row in enumerate(rows) if i == 0 or row != rows[i - 1]]  # while it moves


def distance_to_segment(point, a, b):
    along = [q - p for p, q in zip(a, b)]
    square = sum(c * c for c in along)
    t = sum((x - p) * c for x, p, c in zip(point, a, along)) / square if square else 0.0
    t = min(1.0, max(0.0, t))
    return math.dist(point, [p + t * c for p, c in zip(a, along)])


def distance_of_paths(path, other):
    """The largest distance of a sample of `path` from `other`, where both are about as far."""
    worst, shift = 0.0, 0

    def gap(index):
        return distance_to_segment(path[i], other[index], other[index + 1]) if 0 <= index < len(other) - 1 else math.inf

    for i in range(len(path) - 1):
        least = gap(i + shift)
        if least > 1e-4:  # one of them is some cycles ahead
            least, shift = min((gap(i + near), near) for near in range(shift - 6, shift + 7))
        worst = max(worst, least)
    return worst


def compare_paths(name):
    """Problems with the path and the time of a scenario with and without the guard."""
    samples = {}
    for planner in ("tpmod", "feeler_tp"):
        with tempfile.TemporaryDirectory() as kept:
            problem = run_scenario(name, planner, kept)
            if problem != "passed":
                return problem
            samples[planner] = read_samples(kept)
    stock, guarded = samples["tpmod"], samples["feeler_tp"]
    worst = distance_of_paths(guarded, stock)
    print(f"  servo cycles in motion: {len(stock)} with tpmod, {len(guarded)} with feeler_tp; "
          f"largest distance of the paths {worst:.2e} mm")
    if len(stock) < 5000 or worst > 1e-3 or len(guarded) > 1.01 * len(stock):
        return "the guard changes the path or the time"
    return "passed"


def build_module(folder):
    for name in ("feeler_tp.c", "feeler_ring.h"):
        shutil.copy(f"{SOURCE}/assets/linuxcnc/feeler_tp/{name}", folder)
    built = subprocess.run(["halcompile", "--compile", "feeler_tp.c"], cwd=folder, capture_output=True, text=True)
    expect(built.returncode == 0, "feeler_tp cannot be built:\n" + built.stdout + built.stderr)
    return folder + "/feeler_tp.so"


def install_module(built):
    """Whether LinuxCNC finds the module. It only looks in its own folder."""
    target = MODULES + "/feeler_tp.so"
    if os.path.exists(target) and filecmp.cmp(built, target, shallow=False):
        return True
    try:
        shutil.copy(built, target + ".new")
        os.replace(target + ".new", target)
    except OSError:
        return False
    return True


def make_files(folder, name, planner):
    display = f"{folder}/display"
    # Installed here, since LinuxCNC may run as a user who cannot read the folders of the build.
    for path in ("bin", "share/feeler/linuxcnc"):
        os.makedirs(f"{folder}/{path}")
    shutil.copy(FEELER, folder + "/bin/feeler")
    shutil.copy(SOURCE + "/assets/linuxcnc/feeler_status.py", folder + "/share/feeler/linuxcnc")
    shutil.copy(__file__, folder + "/driver.py")
    write(display, f"#!/bin/sh\nexec python3 driver.py --drive {folder} {name}\n")
    os.chmod(display, 0o755)
    axes = "".join(AXIS.format(letter=letter, joint=joint, **LINEAR) for joint, letter in enumerate("XYZ"))
    if name == "waits_while_an_external_offset_is_in_use":
        axes = re.sub(r"(\[AXIS_.\]\n)", r"\1OFFSET_AV_RATIO = 0.5\n", axes)
    ini, hal = INI.format(display=display, planner=planner), HAL
    if name.startswith("five_axes"):
        for old, new in FIVE_AXES_INI.items():
            ini = ini.replace(old, new)
        hal = FIVE_AXES_HAL
        axes += "".join(AXIS.format(letter=letter, joint=joint, **ANGULAR) for joint, letter in ((3, "A"), (4, "C")))
    write(folder + "/sim.ini", ini + axes)
    write(folder + "/test.hal", hal + (HAL_GUARDED if planner == "feeler_tp" else ""))
    write(folder + "/tool.tbl", "T1 P1 Z100 D10\n")
    write_parameters(folder, [0.0, 0.0, -200.0])
    write(folder + "/mill.toml", SETUP)
    if name == "five_axes_same_path":
        make_dome_files(folder)
    if name.startswith("planted:"):
        make_planted_files(folder, name.split(":")[1])


def write_parameters(folder, origin):
    numbers = {number: 0.0 for first in (5161, 5181, 5211) for number in range(first, first + 9)}
    numbers[5210] = 0.0
    numbers[5220] = 1.0
    for system in range(9):
        for axis in range(10):
            numbers[5221 + 20 * system + axis] = origin[axis] if system == 0 and axis < 3 else 0.0
    write(folder + "/sim.var", "".join(f"{n}\t{v:.6f}\n" for n, v in sorted(numbers.items())))


def run_scenario(name, planner="feeler_tp", keep=None):
    with tempfile.TemporaryDirectory(prefix="feeler-guard-") as folder:
        make_files(folder, name, planner)
        command = ["linuxcnc", "-r", "sim.ini"]
        environment = {k: v for k, v in os.environ.items() if k != "DISPLAY"}
        environment["HOME"] = folder
        if os.geteuid() == 0:
            for path, folders, files in os.walk(folder):
                for each in [path] + [f"{path}/{file}" for file in folders + files]:
                    shutil.chown(each, "nobody", "nogroup")
            command = ["runuser", "-u", "nobody", "--", "env", "HOME=" + folder] + command
        with open(folder + "/output", "w", encoding="utf-8") as output:
            try:
                subprocess.run(command, cwd=folder, env=environment, stdout=output, stderr=output, check=False, timeout=5000 * PATIENCE)  # clock: a test that hangs
            except subprocess.TimeoutExpired:
                pass
        if keep and os.path.exists(folder + "/samples.txt"):
            shutil.copy(folder + "/samples.txt", keep)
        result = folder + "/result"
        problem = open(result, encoding="utf-8").read() if os.path.exists(result) else "it did not come to an end"
        if problem == "passed" and name == "keeps_its_distance_in_random_motion":
            least = nearest_to_clamp(read_samples(folder))
            print(f"  least distance: {least:.4f} mm, of which 2 must be kept")
            if least < 2.0 - 1e-4:
                problem = "the tool came too near to the clamp"
        if problem == "passed" and name == "five_axes_keep_their_distance":
            least, tilt = nearest_on_five_axes(read_samples(folder))
            print(f"  least distance: {least:.4f} mm, of which 2 must be kept; tilted by up to {tilt:.0f} degrees")
            if least < 2.0 - 1e-4 or tilt < 20.0:
                problem = "the tool came too near to the clamp, or did not tilt"
        if problem != "passed":
            with open(folder + "/output", encoding="utf-8", errors="replace") as output:
                problem += "\n" + "".join(output.readlines()[-40:])
            if os.path.exists(folder + "/guard.err"):
                problem += "\nthe guard says:\n" + open(folder + "/guard.err", encoding="utf-8").read()
        return problem


def drive(folder, name):
    machine = Machine(folder)
    problem = "passed"
    try:
        machine.start()
        (planted if name.startswith("planted:") else COMPARED.get(name) or SCENARIOS[name])(machine)
        machine.end_samples()
    except Exception as error:  # whatever goes wrong is the result of the scenario
        problem = f"{type(error).__name__}: {error}"
    if machine.guard and machine.guard.poll() is None:
        machine.guard.kill()
    write(folder + "/result", problem)


def main(arguments):
    global FEELER, SOURCE
    if arguments[0] == "--drive":
        FEELER = arguments[1] + "/bin/feeler"
        return drive(*arguments[1:3])
    FEELER, SOURCE = (os.path.abspath(path) for path in arguments[:2])
    names = arguments[2:] or [*SCENARIOS, *COMPARED, *("planted:" + setup for setup in PLANTED)]
    if not shutil.which("linuxcnc") or not shutil.which("halcompile"):
        print("skipped: linuxcnc-uspace and linuxcnc-uspace-dev are not installed")
        return 77
    with tempfile.TemporaryDirectory(prefix="feeler-tp-") as folder:
        if not install_module(build_module(folder)):
            print(f"skipped: {MODULES} cannot be written; run as root once: halcompile --install feeler_tp.c")
            return 77
    failed = []
    for name in names:
        problem = compare_paths(name) if name in COMPARED else run_scenario(name)
        print(f"{'passed' if problem == 'passed' else 'FAILED'} {name}", flush=True)
        if problem != "passed":
            print(problem, flush=True)
            failed.append(name)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
