#!/usr/bin/env python3
"""Runs feeler gate between a sender and a simulated Grbl controller.

    gate_test.py FEELER [SCENARIO ...]

The controller (grbl_simulator.py) records the path that its tool really makes. Distances of that
path to bodies are computed here, without Feeler.
"""
import contextlib
import fcntl
import json
import math
import os
import pathlib
import random
import re
import select
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time  # clock: the simulated machine runs in real time; limits only end tests that hang

from grbl_simulator import GrblSimulator

FEELER = ""
PATIENCE = float(os.environ.get("FEELER_PATIENCE", "1"))

# A block in the middle of the program's coordinates, and a clamp beside it. The tool is touched off.
BODIES = """mesh_size = 0.5
[stock]
box = [[-50, -30, -20], [50, 30, 0]]
[[fixture]]
name = "clamp"
box = [[60, -40, -20], [80, 40, 30]]
"""
TOOL_1 = """[[tool]]
number = 1
shape = "flat"
diameter = 10
flute_length = 30
stick_out = 100
touched_off = 0
"""
TOOL_2 = """[[tool]]
number = 2
shape = "flat"
diameter = 6
flute_length = 20
stick_out = 60
touched_off = 0
"""
ZERO = (-200.0, -150.0, -60.0)  # of G54
CLAMP = ((60.0, -40.0, -20.0), (80.0, 40.0, 30.0))
START = (0.0, 0.0, -0.5)  # at 0, the controller may have been restarted
FAST = {110: 3000, 111: 3000, 112: 3000}


class Rig:
    """A controller, a gate and a sender."""

    def __init__(self, setup=BODIES + TOOL_1, arguments=("--zero-is-set",), **controller):
        controller.setdefault("speed", 60)
        controller.setdefault("position", START)
        controller.setdefault("offsets", {"G54": ZERO})
        controller["settings"] = {**FAST, **controller.get("settings", {})}
        self.folder = tempfile.TemporaryDirectory()
        self.setup = os.path.join(self.folder.name, "router.toml")
        with open(self.setup, "w", encoding="utf-8") as file:
            file.write(setup)
        self.simulator = GrblSimulator(**controller)
        port = self.simulator.serve_tcp()
        words = [FEELER, "gate", "--setup", self.setup, "--controller", f"127.0.0.1:{port}"]
        words += ["--listen", "127.0.0.1:0", *arguments]
        self.gate = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)
        self.notes, self.lines, self.unfinished = [], [], b""
        threading.Thread(target=self._read_notes, daemon=True).start()
        self.connect()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.gate.poll() is None:
            self.gate.kill()
        self.gate.wait()
        self.socket.close()
        self.simulator.stop()
        self.folder.cleanup()

    def _read_notes(self):
        for line in self.gate.stderr:
            self.notes.append(line.rstrip())

    def connect(self):
        until(lambda: any("connects to" in note for note in self.notes), "the gate listens")
        address = next(note for note in self.notes if "connects to" in note)
        self.socket = socket.create_connection(("127.0.0.1", int(address.rpartition(":")[2])))
        self.socket.setblocking(False)
        until(lambda: any(line.startswith("Grbl") for line in self.read()), "the greeting")

    def read(self):
        """Take in what the gate has written; the lines from the sender's first unread one."""
        with contextlib.suppress(BlockingIOError):
            self.unfinished += self.socket.recv(1 << 16)
        *whole, self.unfinished = self.unfinished.split(b"\r\n")
        self.lines += [line.decode() for line in whole]
        return self.lines

    def write(self, data):
        self.socket.setblocking(True)
        self.socket.sendall(data if isinstance(data, bytes) else data.encode())
        self.socket.setblocking(False)

    def reset(self):
        begin = len(self.lines)
        self.write(b"\x18")
        until(lambda: any(line.startswith("Grbl") for line in self.read()[begin:]), "the greeting")

    def replies(self):
        return [line for line in self.read() if line == "ok" or line.startswith("error:")]

    def ask(self, line):
        """Send one line and wait: all that came up to its reply."""
        begin, count = len(self.lines), len(self.replies())
        self.write(line + "\n")
        until(lambda: len(self.replies()) > count, f"a reply to {line}")
        return [line for line in self.lines[begin:] if not line.startswith("<")]

    def expect(self, line, reply="ok"):
        answer = self.ask(line)
        assert answer[-1] == reply, (line, answer)
        return " ".join(answer[:-1])

    def say(self, word, reply="ok"):
        """A word of the operator, who reads the number that the gate shows."""
        message = self.expect(word)
        return self.expect(re.search(re.escape(word) + r"-\d+", message)[0], reply)

    def refused(self, line, *words, error=9):
        message = self.expect(line, f"error:{error}")
        for word in words:
            assert word in message, (line, word, message)

    def stream(self, lines, buffer=127):
        """Send lines as senders do that count characters. The replies."""
        first, sent, done = len(self.replies()), [], 0
        for line in lines:
            while True:
                done = len(self.replies()) - first
                if sum(sent[done:]) + len(line) + 1 <= buffer or done == len(sent):
                    break
                time.sleep(0.0005)  # clock: polls
            sent.append(len(line) + 1)
            self.write(line + "\n")
        until(lambda: len(self.replies()) - first == len(sent), "all replies")
        return self.replies()[first:]

    def settle(self):
        assert self.simulator.wait_idle(60 * PATIENCE), "the machine does not come to rest"
        time.sleep(0.4)  # clock: Idle counts when it has lasted a while

    def position(self):
        """Of the tool's tip, in G54."""
        return tuple(m - z for m, z in zip(self.simulator.machine_position(), ZERO))

    def end(self):
        self.gate.send_signal(signal.SIGINT)
        return self.gate.wait(20)

    def path(self):
        """The points that the tip has passed, in G54, each with whether the way to it was a feed."""
        with self.simulator.lock:
            points = list(self.simulator.path)
        return [tuple(m - z for m, z in zip(point.position, ZERO)) for point in points]


def until(condition, what, seconds=20):
    end = time.monotonic() + seconds * PATIENCE  # clock: gives up
    while not condition():
        assert time.monotonic() < end, f"not in time: {what}"  # clock: gives up
        time.sleep(0.002)  # clock: polls


def near(a, b, tolerance=0.02):
    return all(abs(x - y) <= tolerance for x, y in zip(a, b))


def distance_to_box(point, box, radius):
    """From an upright cylinder whose lower end has its centre at a point, and that has no upper
    end, to a box."""
    low, high = box
    across = [max(low[i] - point[i], point[i] - high[i], 0.0) for i in (0, 1)]
    sideways = max(math.hypot(*across) - radius, 0.0)
    return math.hypot(sideways, max(point[2] - high[2], 0.0))


def least_distance(path, box, radius):
    """Along a whole path, to within 0.05 mm."""
    least = math.inf
    for a, b in zip(path, path[1:]):
        steps = max(1, math.ceil(math.dist(a, b) / 0.05))
        for i in range(steps + 1):
            point = [x + (y - x) * i / steps for x, y in zip(a, b)]
            least = min(least, distance_to_box(point, box, radius))
    return least


# --- scenarios -----------------------------------------------------------------------------------


def stops_before_the_violation():
    with Rig() as rig:
        for line in ("G21 G90", "M3 S1000", "G0 X-60 Y0 Z30", "G0 Z-2", "G1 X40 F1000", "G0 Z20"):
            rig.expect(line)
        rig.refused("G0 X54", "clamp", "1.000 mm", "stops before G0X54")
        rig.refused("G0 X-60")
        rig.refused("$J=X-60 F500")
        rig.settle()
        assert near(rig.position(), (40, 0, 20)), rig.position()
        rig.expect("$X")
        rig.expect("G0 X53")  # 2 mm are enough
        rig.settle()
        assert near(rig.position(), (53, 0, 20))
        assert rig.simulator.overflows == 0
        assert rig.end() == 1


def needs_a_reset_or_an_unlock():
    with Rig() as rig:
        rig.expect("G21G90G0X0Y0Z40")
        rig.refused("G0X70Z-5", "clamp")
        rig.settle()
        rig.reset()
        rig.expect("G0X10Z40")
        rig.settle()
        assert near(rig.position(), (10, 0, 40))


def streams_a_program():
    """The controller runs what it would run without a gate, and the sender's count of characters
    holds."""
    program = ["G21 G90 G17", "M3 S12000", "G0 X-60 Y-20 Z10", "G0 Z-1"]
    for i in range(150):
        y = -20 + 40 * i / 150
        program += [f"G1 X{50 - i % 3} Y{y:.3f} F2400", f"x-60 (back) y{y + 0.1:.3f} ; next"]
    program += ["G0 Z10", "G0 X-60 Y-10", "G2 X-50 Y0 I10 F900", "", "(end)", "M5", "M30"]
    with Rig() as rig:
        replies = rig.stream(program)
        assert replies == ["ok"] * len(program), [r for r in replies if r != "ok"]
        rig.settle()
        with_gate, executed = rig.path(), list(rig.simulator.executed)
        assert rig.simulator.overflows == 0
        assert rig.end() == 0
    alone = GrblSimulator(speed=60, offsets={"G54": ZERO}, settings=FAST, position=START)
    answers = []
    alone.attach(lambda data: answers.append(data))
    for line in program:
        alone.receive(line.encode() + b"\n")
        alone.wait_for(lambda sim: not sim.rx and not sim.busy)
    assert alone.wait_idle(60 * PATIENCE)
    direct = [tuple(m - z for m, z in zip(p.position, ZERO)) for p in alone.path]
    alone.stop()
    assert executed == [line for line in alone.executed if line]
    # Feed holds and resets would have left more points.
    assert all(near(a, b) for a, b in zip(with_gate, direct)) and len(with_gate) == len(direct)


def random_line(rng, state):
    """A line of a program that a sloppy person might write. The end point is in `state`."""
    choice = rng.random()
    goal = [rng.uniform(-70, 75), rng.uniform(-50, 50), rng.choice((35, 33, 12, 5, -1, -3))]
    words = ""
    if choice < 0.25:
        state["incremental"] = not state["incremental"]
        words += "G91" if state["incremental"] else "G90"
    if rng.random() < 0.1:
        state["inches"] = not state["inches"]
        words += "G20" if state["inches"] else "G21"
    scale = 25.4 if state["inches"] else 1.0
    axes = [axis for axis in range(3) if rng.random() < 0.6] or [2]
    if rng.random() < 0.7 and state["at"][2] < 31:
        axes = [2]
        goal[2] = rng.choice((34.0, 36.0))
    kind = rng.choice(("G0", "G1", "G0", "G1", "G2", "G3"))
    if kind in ("G2", "G3"):
        axes = [0, 1]
        chord = math.dist(state["at"][:2], goal[:2])
        radius = chord / 2 * rng.uniform(1.02, 1.6) + 0.01
        words += f"{kind}G17"
    else:
        words += kind
    for axis in axes:
        value = goal[axis] - (state["at"][axis] if state["incremental"] else 0.0)
        words += f"{'XYZ'[axis]}{value / scale:.4f}"
    if kind in ("G2", "G3"):
        words += f"R{radius * rng.choice((1, 1, -1)) / scale:.4f}"
    if kind != "G0":
        words += f"F{1500 / scale:.1f}"
    state["next"] = [goal[axis] if axis in axes else state["at"][axis] for axis in range(3)]
    return words


def keeps_its_distance_in_random_motion():
    """No path comes nearer to the clamp than the minimum. What stays well away is not refused for
    it."""
    rounds = int(os.environ.get("FEELER_GATE_ROUNDS", "3"))
    rng = random.Random(int(os.environ.get("FEELER_GATE_SEED", "1")))
    passed = refused = 0
    for _ in range(rounds):
        with Rig(speed=200) as rig:
            rig.expect("G21G90M3S1000")
            rig.expect("G0Z35")
            state = {"at": [200.0 - 0, 150.0, 35.0], "incremental": False, "inches": False}
            rig.expect("G0X0Y0")
            state["at"] = [0.0, 0.0, 35.0]
            for _ in range(80):
                before = dict(state)
                line = random_line(rng, state)
                answer = rig.ask(line)
                if answer[-1] == "ok":
                    passed += 1
                    state["at"] = state["next"]
                    continue
                assert answer[-1] == "error:9", (line, answer)
                refused += 1
                far = least_distance([state["at"], state["next"]], CLAMP, 5) > 2.1
                straight = "R" not in line
                if far and straight:
                    assert "clamp" not in " ".join(answer), (line, state, answer)
                state.update(incremental=before["incremental"], inches=before["inches"])
                if rng.random() < 0.5:
                    rig.settle()
                    rig.reset()
                    rig.expect("M3S1000")
                    state.update(incremental=False, inches=False)
                else:
                    rig.expect("$X")
            rig.settle()
            least = least_distance(rig.path(), CLAMP, 5)
            assert least >= 2.0 - 0.02, least  # steps and rounded reports
            assert near(rig.position(), state["at"], 0.05), (rig.position(), state["at"])
            assert rig.simulator.overflows == 0
    print(f"{passed} lines passed, {refused} refused")
    assert passed > 20 * rounds and refused > 5 * rounds


def agrees_with_the_check():
    """The first line that the gate refuses is the first one that feeler check finds fault with."""
    rng = random.Random(3)
    stated = BODIES + "[offsets]\nG54 = { X = -200, Y = -150, Z = -60 }\n" + TOOL_1
    faults = 0
    for _ in range(6):
        lines, state = ["G21G90", "M3S1000", "G0Z35", "G0X0Y0"], {}
        state.update(at=[0.0, 0.0, 35.0], incremental=False, inches=False)
        for _ in range(60):
            lines.append(random_line(rng, state))
            state["at"] = state["next"]
        with Rig(setup=stated, speed=1000) as rig:
            program = os.path.join(rig.folder.name, "p.nc")
            result = os.path.join(rig.folder.name, "p.json")
            with open(program, "w", encoding="utf-8") as file:
                file.write("\n".join(lines) + "\n")
            subprocess.run([FEELER, "check", program, "--setup", rig.setup, "--dialect", "grbl", "--format",
                            "json", "-o", result], check=False, stderr=subprocess.DEVNULL,
                           timeout=120)  # clock: gives up
            with open(result, encoding="utf-8") as file:
                report = json.load(file)
            wrong = [block["line"] for block in report["blocks"] if block["verdict"] != "clear"]
            wrong += [finding["line"] for finding in report["findings"]
                      if finding["severity"] == "error" and "line" in finding]
            first = min(wrong, default=None)
            faults += first is not None
            for number, line in enumerate(lines, start=1):
                reply = rig.ask(line)[-1]
                assert (reply == "ok") == (number != first), (number, line, reply, first, program)
                if reply != "ok":
                    break
    assert 3 <= faults, faults


def takes_only_what_was_made_for_cut():
    with Rig(speed=1) as rig:
        rig.expect("G21G90M3S1000")
        rig.expect("G0X-60Y0Z30")
        rig.expect("G0Z-5")
        rig.expect("G1X40F300")  # 20 seconds
        rig.expect("G0Z5")
        rig.expect("G0Z-5")  # in the slot that is not there yet
        until(lambda: rig.position()[2] < 0 and rig.position()[0] > -30, "the machine cuts", 60)
        rig.write(b"!")
        until(lambda: rig.simulator.state == "Hold", "the hold")
        rig.reset()
        rig.expect("$X")
        x = rig.position()[0]
        assert x < 40, rig.position()
        rig.expect("G21G90M5")
        rig.expect("G0Z5")  # straight up, out of what may not have been cut
        rig.expect("G0X-45")
        rig.refused("G0Z-5", "stock")
        rig.expect("$X")
        rig.expect("M3S1000")
        rig.expect("G0X-60")
        rig.expect("G0Z-5")
        rig.expect("G1X-40F3000")
        rig.expect("G0X-60")  # along what was cut now


def takes_nothing_for_cut_by_a_wait_that_a_reset_ended():
    """Grbl answers a dwell and a probing with ok when the button on the board has ended them."""
    for wait in ("G4P1", "G38.3Z10F100"):
        with Rig(speed=1, hold_time=0.05, probe=-1000) as rig:
            rig.simulator.speed = 60
            rig.expect("G21G90M3S1000")
            rig.expect("G0X-60Y0Z30")
            rig.expect("G0Z-2")
            rig.settle()
            rig.simulator.speed = 1
            rig.write(f"G1X40F1200\n{wait}\n")
            until(lambda: rig.position()[0] > -45, "the cut")
            rig.write(b"!")
            until(lambda: rig.simulator.state == "Hold", "the hold")
            begin = len(rig.read())
            rig.simulator.reset_button()
            until(lambda: any(line.startswith("Grbl") for line in rig.read()[begin:]), "the greeting")
            rig.expect("$X")
            rig.expect("G21G90G0Z5")
            rig.expect("G0X-60")
            rig.expect("G0Z-2")
            rig.refused("G0X30", "stock")


def trusts_no_homing_that_was_not_finished():
    """Grbl counts the steps of each phase from 0, answers with ok, and unlocks."""
    for end in (b"\x18", b"\x84"):
        with Rig(settings={22: 1, 25: 600, 26: 1}) as rig:
            rig.expect("$H")
            rig.say("$FEELER=ZERO")
            rig.expect("G21G90G0Z40")
            rig.expect("G0X0Y0")
            rig.settle()
            rig.simulator.speed = 1
            rig.write("$H\n")
            until(lambda: near(rig.position()[2:], (59,)), "the second phase of homing")
            rig.write(end)
            until(lambda: any(line.startswith("ALARM") for line in rig.read()), "the alarm")
            rig.simulator.speed = 60
            rig.settle()
            assert any(rig.simulator.drift)
            rig.expect("$X")
            rig.refused("G21G90G0X70Y0", "homing was not finished", "$FEELER=ZERO")
            rig.expect("$X")
            rig.expect("$H")
            rig.say("$FEELER=ZERO")
            rig.expect("G21G90G0X10Y0")


def asks_for_a_finer_arc_tolerance_than_none():
    with Rig(settings={12: 0}) as rig:
        rig.expect("G21G90G0X0Y0Z35")
        rig.refused("G2X10Y0R-20F1000", "$12 is 0")
        rig.expect("$X")
        rig.expect("G1X10F1000")


def compares_reports_of_the_work_too():
    """With $10=0 the controller reports where it is in the work."""
    for settings in ({10: 0}, {10: 1}):
        with Rig(settings=settings) as rig:
            rig.expect("G21G90G0X59Y0Z40")
            rig.expect("G0X0")
            rig.settle()
            with rig.simulator.lock:
                x, y, z = rig.simulator.position
                rig.simulator.position = (x, y, z - 25)
                rig.simulator._sync_positions()
            for _ in range(5):
                rig.write(b"?")
                time.sleep(0.3)  # clock: Idle counts when it has lasted a while
            until(lambda: any("does not stand where" in line for line in rig.read()), "the message")
            rig.refused("G0X59", "clamp")


def remembers_a_tool_that_was_called():
    with Rig() as rig:
        rig.expect("G21G90G0X0Y0Z35")
        rig.refused("T2M6", "M6", error=20)
        rig.refused("G0X5", "tool 2")
    with Rig() as rig:
        rig.expect("G21G90G0X0Y0Z35")
        rig.expect("T2")
        rig.refused("G0X5", "tool 2")
        rig.reset()
        rig.expect("$X")
        rig.refused("G21G90G0X5", "tool 2")
        rig.expect("$X")
        rig.expect("T1")
        rig.expect("G0X5")


def gates_jogs():
    with Rig() as rig:
        rig.expect("$J=G90G21X0Y0Z35F3000")
        rig.refused("$J=G91X70Z-30F500", "clamp", "does not pass")
        rig.expect("$J=G91X-10F3000")  # one that is refused locks nothing
        rig.expect("$J=G91G20X-1F100")
        rig.expect("G0X0Z34")  # waits until the jogs have ended
        rig.settle()
        assert near(rig.position(), (0, 0, 34)), rig.position()
        rig.refused("$J=G53X-130Z-60F500", "clamp")  # X70 Z0 of G54
        rig.expect("$J=G53X-200Z-20F500")
        rig.settle()
        assert near(rig.position(), (0, 0, 40)), rig.position()


def follows_a_cancelled_jog():
    with Rig(speed=1) as rig:
        rig.expect("$J=G90G21X0Y0Z35F200000")
        rig.settle()
        rig.expect("$J=G91X30F300")
        rig.expect("$J=G91Y30F300")
        until(lambda: rig.position()[0] > 1, "the jog moves")
        rig.write(b"\x85")
        rig.settle()
        x, y, z = rig.position()
        assert x < 29 and y == 0
        # From here an incremental motion ends before the clamp, and from where the jog would have
        # ended it would not; and the other way round.
        rig.expect("G91")
        rig.refused(f"G0X{56 - x:.3f}Z-30", "clamp")
        rig.expect("$X")
        rig.expect(f"G0X{50 - x:.3f}Z-20")
        rig.settle()
        assert near(rig.position(), (50, 0, 15), 0.05), rig.position()


def follows_a_jog_that_the_board_cancels():
    with Rig(speed=5) as rig:
        rig.expect("G21G90G0X100Y0Z40")
        rig.expect("G0Z5")
        rig.settle()
        rig.expect("$J=Y60F1500")
        until(lambda: rig.position()[1] > 5, "the jog moves")
        rig.simulator.receive(b"!")  # a button
        rig.settle()
        assert 5 < rig.position()[1] < 55, rig.position()
        rig.refused("$J=X0F1500", "clamp", "does not pass")


def passes_what_acts_at_once():
    """Also while a check takes long."""
    with Rig(setup=BODIES.replace("mesh_size = 0.5", "mesh_size = 0.1") + TOOL_1, speed=1,
             hold_time=0.05) as rig:
        rig.write("G21G90G0Z30\n" * 3 + "G1X-40F200\n")
        slowest = 0.0
        for _ in range(50):
            count = sum(line.startswith("<") for line in rig.read())
            begin = time.monotonic()  # clock: measures the answer
            rig.write(b"?")
            until(lambda: sum(line.startswith("<") for line in rig.read()) > count, "a status")
            slowest = max(slowest, time.monotonic() - begin)  # clock: measures the answer
            time.sleep(0.02)  # clock: spreads the requests
        print(f"slowest status: {1000 * slowest:.0f} ms")
        assert slowest < 0.5 * PATIENCE
        until(lambda: len(rig.replies()) >= 4, "replies", 60)
        until(lambda: rig.simulator.state == "Run", "the motion")
        rig.write(b"!")
        until(lambda: rig.simulator.state == "Hold", "the hold")
        held = rig.position()
        time.sleep(0.2)  # clock: nothing may move
        assert near(rig.position(), held, 0.001)
        rig.write(b"~")
        until(lambda: rig.simulator.state == "Run", "the motion")


def refuses_what_would_change_the_machine():
    with Rig() as rig:
        rig.expect("G21G90G0Z35")
        for line in ("$100=20", "$N0=G0X1", "$RST=*", "$I=abc", "[ESP220]/run.nc", "$F=run.nc", "$SD"):
            rig.refused(line, "does not pass", error=3)
        for line in ("M6", "M98", "T1M6"):
            rig.refused(line, "Grbl has no M", error=20)
        rig.refused("G0X#1", error=2)
        rig.refused("G81X1Z2R3", error=20)
        rig.refused("G0A5", error=20)
        rig.refused("G1X1", error=22)  # no feed yet
        for line in ("$$", "$#", "$G", "$I", "$N", "$"):
            rig.expect(line)
        rig.settle()
        assert rig.simulator.settings[100] == 250
        assert near(rig.position(), (200, 150, 35)), rig.position()


def notices_a_restart():
    """Without homing, the zero of a board that restarts is where it stands."""
    for settings in ({}, {10: 0}):
        with Rig(settings=settings) as rig:
            rig.expect("G21G90G0X0Y0Z40")
            rig.settle()
            begin = len(rig.lines)
            rig.simulator.power_cycle()
            until(lambda: any(line.startswith("Grbl") for line in rig.read()[begin:]), "the greeting")
            rig.refused("G0X100", "was restarted", "$FEELER=ZERO")
            rig.expect("$X")
            rig.expect("$J=G91X1F500")
            rig.expect("G10L20P1X0Y0Z40")
            rig.say("$FEELER=ZERO")
            rig.refused("G0X70Z5", "clamp")
    with Rig(position=(0, 0, 0)) as rig:  # when the port was opened
        rig.refused("G21G90G0X0", "was restarted")


def refuses_stored_lines():
    with Rig(setup=BODIES + TOOL_1) as rig:
        rig.simulator.startup_lines[0] = "G0X5"
        rig.write(b"\x18")
        rig.settle()
        rig.refused("G0X0", "stored line")


def compares_offsets_with_the_setup():
    stated = BODIES + "[offsets]\nG54 = { X = -200, Y = -150, Z = -60 }\n" + TOOL_1
    with Rig(setup=stated) as rig:
        rig.expect("G21G90G0Z35")
        rig.refused("G55G0X-10", "G55", "does not state")
        rig.expect("$X")
        rig.expect("G10L2P1X-201")
        rig.refused("G54G0X0", "G54 X is -201.000 on the control and -200.000 in the set-up")
        rig.expect("$X")
        rig.expect("G10L2P1X-200")
        rig.expect("G43.1Z3")
        rig.refused("G0X0", "length of tool 1 is 3.000")
        rig.expect("$X")
        rig.expect("G49")
        rig.expect("G0X0Y0")
        rig.expect("G92X1")
        rig.refused("G0X2", "G92")
        rig.expect("$X")
        rig.expect("G92.1")
        rig.expect("G0X3")
        rig.settle()
        assert near(rig.position(), (3, 0, 35)), rig.position()


def takes_the_zero_from_the_control():
    """The bodies stand where the program's zero is when the operator says so."""
    with Rig(arguments=(), offsets={"G54": (-10, -10, -10)}, position=(-200, -150, -20)) as rig:
        rig.expect("G21G90")
        rig.refused("G0X0", "$FEELER=ZERO")
        rig.expect("$X")
        rig.expect("$J=G91X-1F5000")  # unchecked
        rig.expect("$J=G91X1F5000")
        rig.expect("G0Z-5")  # up
        rig.expect("G0Z0")
        rig.settle()
        assert rig.simulator.machine_position()[2] == -10
        rig.expect("$J=G53G90Z-20F5000")
        rig.expect("G10L20P1X0Y0Z40")  # so G54 is at ZERO
        rig.say("$FEELER=ZERO")
        rig.refused("G0X70Z5", "clamp")
        rig.expect("$X")
        rig.expect("M3S1000")
        rig.expect("G0X-60")
        rig.expect("G0Z-2")
        rig.expect("G1X0F2000")
        rig.expect("G0Z30")
        rig.settle()
        assert near(rig.position(), (0, 0, 30)), rig.position()
        rig.expect("G10L20P1X50")
        rig.refused("G0X51", "when the zero was set", "$FEELER=ZERO")
        rig.expect("$X")
        assert "$FEELER=NEW" in rig.say("$FEELER=ZERO", "error:3")  # the stock is cut
        rig.say("$FEELER=NEW")
        rig.expect("G0X20")
        rig.refused("G0Z-2", "stock")


def follows_a_tool_change():
    """The new tool is touched off, and what was cut stays cut."""
    with Rig(setup=BODIES + TOOL_1 + TOOL_2, arguments=("--tool", "1", "--zero-is-set")) as rig:
        for line in ("G21G90M3S1000", "T1", "G0X-60Y0Z30", "G0Z-5", "G1X40F3000", "G0Z30", "T2"):
            rig.expect(line)
        rig.refused("G0X0", "calls tool 2", "$FEELER=T2")
        rig.expect("$X")
        rig.refused("$FEELER=T2-123", "first", error=3)
        assert "does not describe" in rig.say("$FEELER=T7", "error:3")
        rig.say("$FEELER=T2")
        rig.refused("G0X0", "$FEELER=ZERO")
        rig.expect("$X")
        # Tool 2 is 17 mm shorter: the same place is lower on the machine.
        rig.expect("$J=G91Z-17F5000")
        rig.expect("G10L2P1Z-77")
        rig.say("$FEELER=ZERO")
        rig.expect("G0X0")
        rig.expect("G0Z-4.5")  # in the slot
        rig.refused("G0Y8", "stock")
        rig.expect("$X")
        rig.expect("G0Z31")
        rig.settle()
        assert near(rig.simulator.machine_position(), (-200, -150, -46)), rig.position()
        rig.say("$FEELER=T2")  # another one of the same kind
        rig.expect("G10L2P1Z-76")
        rig.say("$FEELER=ZERO")
        rig.expect("G0Z-4.5")


def probes():
    with Rig(probe=ZERO[2] + 0.0, speed=20) as rig:
        rig.expect("G21G90G0Z40")
        rig.expect("G0X0Y0")
        rig.expect("G0Z20")
        rig.expect("G38.2Z-5F300")
        rig.settle()
        assert near(rig.position(), (0, 0, 0)), rig.position()
        rig.expect("G0Z10")  # from where it has stopped
        rig.expect("G0Z15")
        rig.expect("G91")
        rig.refused("G38.2X70Z-5F300", "clamp")


def survives_an_error_that_it_did_not_expect():
    # The controller is slow, so the other lines are on their way. In a hold it reads none of them.
    with Rig(speed=1, error_at=4, slow=0.1, hold_time=0.05) as rig:
        rig.write("G21G90G0Z35\nG1X0Y0F5000\nG1X10\nG1Y40\nG1X20\nG1X0\n")
        until(lambda: any("Grbl refused G1Y40" in line for line in rig.read()), "the message")
        until(lambda: rig.simulator.state in ("Hold", "Idle"), "the hold")
        assert "error:20" in rig.replies(), rig.lines
        rig.write(b"~")  # does not pass
        time.sleep(0.5)  # clock: nothing may move
        assert rig.simulator.state in ("Hold", "Idle")
        rig.reset()
        rig.expect("$X")
        rig.expect("G21G90G0Z36")
        rig.settle()
        assert near(rig.position()[2:], (36,)), rig.position()


def starts_in_alarm():
    with Rig(alarm_at_start=True, settings={22: 1}, position=(-50, -50, -5)) as rig:
        rig.refused("G0X0")
        rig.refused("$J=G91X1F500")
        rig.expect("$H")
        rig.expect("G21G90G0Z40")
        rig.settle()
        assert near(rig.position(), (199, 149, 40)), rig.position()


def stops_in_an_alarm():
    with Rig(speed=1) as rig:
        rig.expect("G21G90G0Z40")
        rig.expect("G1X0F600")
        until(lambda: rig.simulator.state == "Run", "the motion")
        rig.simulator.hard_limit()
        until(lambda: any(line == "ALARM:1" for line in rig.read()), "the alarm")
        until(lambda: any("Reset to continue" in line for line in rig.read()), "the request")
        rig.reset()
        rig.refused("G0X0")
        rig.expect("$X")
        rig.expect("G90G0Z41")


def works_in_check_mode():
    with Rig() as rig:
        rig.expect("G21G90G0X0Y0Z35")
        rig.settle()
        rig.expect("$C")
        rig.expect("G17G21G40G49G80G90")  # changes nothing
        rig.expect("$X")
        rig.expect("M3S1000")
        rig.expect("G0X-60Y0")
        rig.expect("G0Z-5")
        rig.expect("G1X0F500")
        rig.expect("G0Z5")
        rig.refused("G0X70", "clamp")
        count = len(rig.replies())
        rig.write("$C\n")
        until(lambda: any(line.startswith("Grbl") for line in rig.read()[3:]), "the greeting")
        assert rig.replies()[count:] == ["ok"], rig.lines
        rig.settle()
        assert near(rig.position(), (0, 0, 35)), rig.position()
        rig.expect("G90G0X-20Y0")
        rig.refused("G0Z-5", "stock")  # nothing was cut


def lets_senders_come_and_go():
    with Rig(speed=1) as rig:
        rig.expect("G21G90G0Z40")
        rig.expect("G1X150F1000")
        other = socket.create_connection(rig.socket.getpeername())
        other.settimeout(10 * PATIENCE)
        assert b"a sender is connected" in other.recv(100)
        other.close()
        rig.write("G1X100\nG1X50\nG1X0\n" + "G1X1\nG1X2\n" * 40)
        rig.socket.close()
        until(lambda: any("is gone" in note for note in rig.notes), "the end of the connection")
        rig.lines = ["Grbl is running, so no greeting comes"]
        rig.connect()
        rig.write(b"!")
        until(lambda: rig.simulator.state == "Hold", "the hold")
        rig.reset()
        rig.expect("$X")
        rig.expect("G90G0Z41")
        rig.simulator.stop()
        assert rig.gate.wait(20) == 2
        until(lambda: any("controller is gone" in note for note in rig.notes), "the message")


def reads_reports_of_all_kinds():
    for settings in ({10: 0}, {10: 2}, {13: 1}, {13: 1, 10: 0}):
        with Rig(settings=settings, no_opt=settings == {10: 2}) as rig:
            rig.expect("G21G90G0Z35")
            rig.expect("G91")
            rig.expect("G0X-200Y-150")
            rig.refused("G0X70Z-30", "clamp")
            rig.expect("$X")
            rig.expect("G0X53")
            rig.refused("G0X1Z-20", "1.000 mm of clamp")
            rig.settle()
            assert near(rig.position(), (53, 0, 35), 0.03), (settings, rig.position())


def says_what_is_missing():
    for text, word in ((BODIES, "tool"), (TOOL_1, "the stock"), (BODIES + TOOL_1 + TOOL_2, "--tool"),
                       (BODIES + TOOL_1.replace("= 10\n", "= 'x'\n"), "diameter"),
                       ('[program]\ndialect = "fanuc"\n' + BODIES + TOOL_1, "fanuc")):
        with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
            file.write(text.replace("mesh_size = 0.5\n", ""))
            file.flush()
            ran = subprocess.run([FEELER, "gate", "--setup", file.name, "--controller", "127.0.0.1:1"],
                                 capture_output=True, text=True, timeout=60)  # clock: gives up
            assert ran.returncode == 2 and word in ran.stderr, (word, ran)
    with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
        file.write(BODIES + TOOL_1)
        file.flush()
        for port in ("127.0.0.1:1", "/dev/no-such-port"):
            ran = subprocess.run([FEELER, "gate", "--setup", file.name, "--controller", port],
                                 capture_output=True, text=True, timeout=60)  # clock: gives up
            assert ran.returncode == 2 and port in ran.stderr, ran


def notices_that_the_setup_has_changed():
    """Also while nothing has made it ask the controller again."""
    with Rig(speed=20) as rig:
        rig.expect("G21G90G0X0Y0Z40")
        rig.settle()
        text = pathlib.Path(rig.setup).read_text(encoding="utf-8")
        pathlib.Path(rig.setup).write_text(text + "\n# moved\n", encoding="utf-8")
        rig.refused("G0X1", "set-up file has changed")
        rig.settle()
        assert near(rig.position(), (0, 0, 40)), rig.position()


def leaves_links_of_others_alone():
    with tempfile.TemporaryDirectory() as folder, Rig(arguments=()) as rig:
        port = rig.simulator._listener.getsockname()[1]
        link = os.path.join(folder, "grbl")
        command = [FEELER, "gate", "--setup", rig.setup, "--controller", f"127.0.0.1:{port}", "--pty", link]
        for target in ("/dev/null", "/dev/pts/ptmx"):
            os.symlink(target, link)
            ran = subprocess.run(command, capture_output=True, text=True, timeout=60)  # clock: gives up
            assert ran.returncode == 2 and "exists already" in ran.stderr, ran
            assert os.readlink(link) == target
            os.remove(link)
        os.symlink("/dev/pts/99999", link)  # of a gate that was killed
        gate = subprocess.Popen(command)
        until(lambda: os.path.exists(link), "the terminal")
        os.remove(link)
        os.symlink("/dev/null", link)
        gate.send_signal(signal.SIGINT)
        gate.wait(20)
        assert os.readlink(link) == "/dev/null"


def read_terminal(end, is_enough):
    """What comes from a terminal until it is enough."""
    text = b""
    while not is_enough(text):
        assert select.select([end], [], [], 20 * PATIENCE)[0], text
        text += os.read(end, 4096)
    return text


def serves_a_terminal():
    with tempfile.TemporaryDirectory() as folder, Rig(arguments=()) as rig:
        rig.gate.kill()
        rig.gate.wait()
        link = os.path.join(folder, "grbl")
        port = rig.simulator._listener.getsockname()[1]
        gate = subprocess.Popen([FEELER, "gate", "--setup", rig.setup, "--controller",
                                 f"127.0.0.1:{port}", "--zero-is-set", "--pty", link])
        try:
            for _ in range(2):
                until(lambda: os.path.exists(link), "the terminal")
                end = os.open(link, os.O_RDWR | os.O_NOCTTY)
                # As from a sender that sets nothing; Grbl answers each carriage return and each line feed.
                os.write(end, b"\r\n\r\nG21G90G0X0Y0Z35\r\nG0X70Z5\r\n$X\r\n")
                text = read_terminal(end, lambda text: text.count(b"ok\r\n") >= 2 and b"error:9" in text)
                time.sleep(0.5)  # clock: lets more come
                os.set_blocking(end, False)
                with contextlib.suppress(BlockingIOError):
                    text += os.read(end, 4096)
                assert b"clamp" in text
                assert text.count(b"ok\r\n") == 9, text
                os.close(end)
        finally:
            gate.send_signal(signal.SIGINT)
            assert gate.wait(20) == 1
        assert not os.path.lexists(link)


def keeps_what_the_next_sender_writes():
    """Into a terminal, before the gate has done with the last sender."""
    with tempfile.TemporaryDirectory() as folder, Rig(arguments=()) as rig:
        rig.gate.kill()
        rig.gate.wait()
        link = os.path.join(folder, "grbl")
        port = rig.simulator._listener.getsockname()[1]
        said, says = os.pipe()
        fcntl.fcntl(says, fcntl.F_SETPIPE_SZ, 4096)
        filler = os.open(f"/proc/self/fd/{says}", os.O_WRONLY | os.O_NONBLOCK)
        gate = subprocess.Popen([FEELER, "gate", "--setup", rig.setup, "--controller",
                                 f"127.0.0.1:{port}", "--zero-is-set", "--pty", link],
                                stdout=says, stderr=says)
        try:
            until(lambda: os.path.exists(link), "the terminal")
            end = os.open(link, os.O_RDWR | os.O_NOCTTY)
            for _ in range(40):
                os.write(end, b"$FEELER\n")
                text = read_terminal(end, lambda text: b"ok\r\n" in text)
                assert b"lines passed" in text, text
                # The gate stops where it says that the sender is gone.
                with contextlib.suppress(BlockingIOError):
                    while os.write(filler, b" "):
                        pass
                os.close(end)
                time.sleep(0.05)  # clock: lets it come so far
                end = os.open(link, os.O_RDWR | os.O_NOCTTY)
                os.write(end, b"$G\n")
                os.read(said, 4096)
                text = read_terminal(end, lambda text: b"ok\r\n" in text)
                assert b"[GC:" in text and b"lines passed" not in text, text
            os.close(end)
        finally:
            gate.send_signal(signal.SIGINT)
            assert gate.wait(20) == 0
            for each in (said, says, filler):
                os.close(each)


def main():
    global FEELER
    FEELER = os.path.abspath(sys.argv[1])
    scenarios = {name: value for name, value in globals().items()
                 if callable(value) and getattr(value, "__code__", None)
                 and value.__code__.co_argcount == 0 and name not in ("main",)}
    for name in sys.argv[2:] or scenarios:
        scenarios[name]()
        print(f"{name}: ok", flush=True)


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    main()
