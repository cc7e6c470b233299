"""A simulator of a Grbl 1.1h controller, for tests of programs that talk to one.

It follows the firmware's own structure (main loop, real-time check points, planner queue), so
that replies, buffering and errors come in the firmware's order. One thread plays the main program;
whoever delivers bytes plays the serial interrupt. Motion is worked out from the clock at every
check point: constant speed along the exact path, no acceleration.

    sim = GrblSimulator(speed=20, settings={110: 3000}, offsets={"G54": (-300, -200, -50)})
    port = sim.serve_tcp()          # or path = sim.serve_pty(), or sim.attach(callback)
    ...
    sim.path, sim.executed, sim.overflows
    sim.stop()
"""

import argparse
import bisect
import collections
import copy
import dataclasses
import json
import math
import os
import queue
import re
import socket
import sys
import threading
import time  # clock: simulated motion follows real time
import tty

VERSION, BUILD = "1.1h", "20190830"
LINE_BUFFER = 80  # bytes of the firmware's line buffer, with the final zero
INCH = 25.4
AXES = "XYZ"
PLACES = ("G54", "G55", "G56", "G57", "G58", "G59", "G28", "G30")
IDLE, RUN, HOLD, JOG, ALARM = "Idle", "Run", "Hold", "Jog", "Alarm"
CHECK, HOME, DOOR, SLEEP = "Check", "Home", "Door", "Sleep"
BUSY = (HOME, RUN, HOLD, JOG, DOOR)

# Requests that interrupts leave for the next check point of the main program.
RESET, STATUS, CYCLE_START, CYCLE_STOP = "reset", "status", "cycle start", "cycle stop"
FEED_HOLD, MOTION_CANCEL, DOOR_OPEN, GO_TO_SLEEP = "hold", "cancel", "door", "sleep"
HOLD_REQUESTS = {FEED_HOLD, MOTION_CANCEL, DOOR_OPEN, GO_TO_SLEEP}
REALTIME = {ord("?"): STATUS, ord("~"): CYCLE_START, ord("!"): FEED_HOLD, 0x84: DOOR_OPEN}
MOTION_OVERRIDES, OTHER_OVERRIDES = range(0x90, 0x98), (*range(0x99, 0x9F), 0xA0, 0xA1)

# Why and how far the main program is suspended.
HOLD_COMPLETE, JOG_CANCEL, AJAR, RETRACTED = "held", "jog cancel", "ajar", "retracted"
RESTORE, RESTORED, RESTART_RETRACT = "restore", "restored", "restart retract"

INTEGERS = {0: 10, 1: 25, 2: 0, 3: 0, 10: 1, 23: 0, 26: 250}
SWITCHES = {4: 0, 5: 0, 6: 0, 13: 0, 20: 0, 21: 0, 22: 0, 32: 0}
NUMBERS = {11: 0.01, 12: 0.002, 24: 25.0, 25: 500.0, 27: 1.0, 30: 1000.0, 31: 0.0}
PER_AXIS = {100: 250.0, 110: 500.0, 120: 10.0, 130: 200.0}
DEFAULTS = {**INTEGERS, **SWITCHES, **NUMBERS}
DEFAULTS |= {base + axis: value for base, value in PER_AXIS.items() for axis in range(3)}

PathPoint = collections.namedtuple("PathPoint", "position line spindle kind")


class GcodeError(Exception):
    """A line is refused with this error number."""

    def __init__(self, code):
        super().__init__(code)
        self.code = code


class _Shutdown(Exception):
    """The simulator ends."""


class _PowerCycle(Exception):
    """The processor restarts."""


@dataclasses.dataclass
class Modal:
    """The modes that last from line to line; each starts as after a reset."""

    motion: str = "G0"
    feed: str = "G94"
    units: str = "G21"
    distance: str = "G90"
    plane: str = "G17"
    tool_length: str = "G49"
    coordinates: int = 0
    flow: str = ""
    spindle: str = "M5"
    coolant: frozenset = frozenset()


@dataclasses.dataclass
class Parser:
    """What the G-code parser remembers."""

    modal: Modal = dataclasses.field(default_factory=Modal)
    feed: float = 0.0
    speed: float = 0.0
    tool: int = 0
    position: list = dataclasses.field(default_factory=lambda: [0.0] * 3)
    coordinates: list = dataclasses.field(default_factory=lambda: [0.0] * 3)
    g92: list = dataclasses.field(default_factory=lambda: [0.0] * 3)
    tool_length: float = 0.0


@dataclasses.dataclass
class GcodeBlock:
    """One line as the parser reads it."""

    modal: Modal
    jog: bool = False
    non_modal: str = ""
    axis_command: str = ""  # "", "non-modal", "motion" or "tool length"
    groups: set = dataclasses.field(default_factory=set)
    unused: set = dataclasses.field(default_factory=set)
    axes: set = dataclasses.field(default_factory=set)
    centres: set = dataclasses.field(default_factory=set)
    values: dict = dataclasses.field(default_factory=lambda: collections.defaultdict(float))
    xyz: list = dataclasses.field(default_factory=lambda: [0.0] * 3)
    ijk: list = dataclasses.field(default_factory=lambda: [0.0] * 3)
    place: int = 0


@dataclasses.dataclass
class Plan:
    """What a motion asks of the planner besides its target."""

    feed: float
    kind: str
    spindle: tuple
    line: str
    inverse_time: bool = False
    overridable: bool = True


@dataclasses.dataclass
class Motion:
    """A block in the planner's queue."""

    start: tuple
    end: tuple
    length: float
    rate: float
    rapid_rate: float
    acceleration: float
    plan: Plan
    travelled: float = 0.0

    def at(self, distance):
        """The position after some distance along the block."""
        share = min(1.0, distance / self.length)
        return tuple(a + (b - a) * share for a, b in zip(self.start, self.end))


def round_half_away(value):
    """Round like the firmware's lround, to 32 bits."""
    return int(math.copysign(math.floor(min(abs(value), 2.0**31 - 1) + 0.5), value))


def printed(value, decimals):
    """A number as the firmware prints it."""
    digits = str(int(abs(value) * 10**decimals + 0.5)).rjust(decimals + 1, "0")
    whole, part = digits[: len(digits) - decimals], digits[len(digits) - decimals :]
    return ("-" if value < 0 else "") + whole + ("." + part if decimals else "")


def read_number(text, at):
    """The number at a place in a line and the place after it, or None when there is none."""
    found = re.compile(r"[+-]?(\d*)(\.?)(\d*)").match(text, at)
    whole, part = found[1], found[3]
    if not whole + part:
        return None, at
    # The firmware keeps eight digits; further ones only scale.
    if len(whole) > 8:
        value = float(whole[:8]) * 10 ** (len(whole) - 8)
    else:
        value = float((whole or "0") + "." + (part[: 8 - len(whole)] or "0"))
    return (-value if text[at] == "-" else value), found.end()


class GrblSimulator:
    """One simulated controller with its machine.

    For tests to read:
    path        PathPoints: the tool moved on a straight line from the point before to this one.
                Kinds: start, rapid, feed, probe, jog, homing, and power for a restart, where the
                controller takes its place for zero. The spindle is its mode and real speed.
    executed    lines of G-code, as the firmware keeps them (upper case, no blanks or comments),
                that ran without error and without a reset; checked: the same in check mode
    errors      pairs of a line and its error number
    overflows   bytes lost because the receive buffer was full
    oks, gcode_lines, received    how many oks, lines of G-code and bytes there were
    state, settings, places, parser, spindle, coolant, planner, rx    what they are now
    """

    def __init__(
        self,
        rx=128,
        planner=15,
        speed=1.0,
        settings=None,
        offsets=None,
        position=(0.0, 0.0, 0.0),
        alarm_at_start=False,
        probe=None,
        log=None,
        drop_ok=None,
        error_at=None,
        slow=0.0,
        mute=False,
        no_opt=False,
        mist=False,
        hold_time=None,
    ):
        self.rx_size, self.planner_size, self.speed = rx, planner, float(speed)
        self.alarm_at_start, self.mist, self.hold_time = alarm_at_start, mist, hold_time
        self.drop_ok, self.error_at, self.slow = drop_ok, error_at, slow
        self.mute, self.no_opt = mute, no_opt
        self.probe_option = probe
        self.probe = probe if callable(probe) or probe is None else _plane(probe)
        self.settings = dict(DEFAULTS)
        self.places = {name: [0.0] * 3 for name in PLACES}
        self.startup_lines, self.build_info = ["", ""], ""
        self.lock = threading.RLock()
        self.changed = threading.Condition(self.lock)
        self.rx, self.overflows, self.received = collections.deque(), 0, 0
        self.path, self.executed, self.checked, self.errors = [], [], [], []
        self.oks, self.gcode_lines = 0, 0
        self._log = open(log, "w", encoding="utf-8") if log else None
        self._outbox, self._pending = None, []
        self._threads, self._listener, self._connection, self._pty = [], None, None, None
        self._closing = self._power_cycled = self._booted = self._ready = False
        self.state, self.line = IDLE, ""
        self._forget()
        for number, value in sorted((settings or {}).items(), key=lambda pair: pair[0] == 20):
            if self._store_setting(int(number), float(value)):
                raise ValueError(f"${number}={value} is no setting")
        for name, values in (offsets or {}).items():
            self.places[name] = [float(value) for value in values]
        self.position = self._on_steps(position)
        self.drift = (0.0, 0.0, 0.0)  # where the machine really is, from there
        self._point("start")

    # ---- In-process interface -------------------------------------------------------------

    def boot(self):
        """Switch the controller on; the first connection does it, too."""
        with self.lock:
            if not self._booted:
                self._booted = True
                self._start_thread(self._run)
                self.changed.wait_for(lambda: self._ready or self._closing)

    def attach(self, send):
        """Send all output to a function from now on, after output that nobody has had yet.

        The function must not wait for anything: the controller stands still until it returns.
        """
        with self.lock:
            self._outbox = send
            for data in self._pending:
                send(data)
            self._pending = []
            self.boot()

    def detach(self):
        """Lose the output from now on, as on an unplugged cable."""
        with self.lock:
            self._outbox = _nowhere

    def receive(self, data):
        """Take bytes from the sender; real-time bytes act at once."""
        with self.lock:
            self.boot()
            for byte in data:
                self._serial_interrupt(byte)
            self.received += len(data)
            self.changed.notify_all()

    def reset_button(self):
        """Press the reset button on the controller's abort pin: the same as byte 0x18."""
        with self.lock:
            self._mc_reset()
            self.changed.notify_all()

    def power_cycle(self):
        """Restart the processor, as the Arduino's reset button or DTR does: position is zero."""
        with self.lock:
            self._power_cycled = True
            self.changed.notify_all()

    def hard_limit(self):
        """Trip a limit switch."""
        with self.lock:
            if self.state != ALARM and not self.alarm:
                self._mc_reset()
                self.alarm = 1
                self.changed.notify_all()

    def machine_position(self):
        """Where the tool is now, on whole steps."""
        with self.lock:
            self._advance()
            return self._on_steps(self.position)

    def wait_for(self, condition, patience=10.0):
        """Wait until a function of the simulator is true; tell whether it came true in time."""
        end = time.monotonic() + patience  # clock: gives up in the end
        while time.monotonic() < end:  # clock: gives up in the end
            with self.lock:
                self._advance()
                if condition(self):
                    return True
            time.sleep(0.002)  # clock: polls the simulator
        return False

    def wait_idle(self, patience=10.0):
        """Wait until the machine is idle and all lines that arrived are done."""
        return self.wait_for(lambda sim: sim._at_rest(), patience)

    def stop(self):
        """End all threads and close everything."""
        with self.lock:
            self._closing = True
            self.changed.notify_all()
        for end in (self._connection, self._listener):
            _close_socket(end)
        if self._pty:
            os.write(self._pty[1], b"\n")  # Wakes the thread that reads.
        for thread in self._threads:
            if thread is not threading.current_thread():
                thread.join(2)  # clock: gives up on a stuck thread
        for descriptor in self._pty or ():
            os.close(descriptor)
        if self._log:
            self._log.close()

    def _at_rest(self):
        quiet = not (self.rx or self.planner or self.requests or self.busy)
        return quiet and self.state in (IDLE, ALARM, CHECK)

    # ---- Connections ----------------------------------------------------------------------

    def serve_tcp(self, port=0, host="127.0.0.1"):
        """Serve one TCP connection after the other; return the port."""
        self._listener = socket.create_server((host, port), backlog=5)
        self._start_thread(self._accept)
        return self._listener.getsockname()[1]

    def serve_pty(self):
        """Serve a pseudo terminal; return the path of its slave."""
        self._pty = os.openpty()
        tty.setraw(self._pty[1])
        master = self._pty[0]
        self._start_thread(lambda: self._serve(lambda: os.read(master, 4096), master))
        return os.ttyname(self._pty[1])

    def _accept(self):
        while not self._closing:
            try:
                self._connection, _ = self._listener.accept()
            except OSError:
                return
            self._connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            end = self._connection
            self._serve(lambda: end.recv(4096), end.fileno())
            _close_socket(end)

    def _serve(self, read, descriptor):
        """Pass bytes both ways until the other side hangs up."""
        output = queue.SimpleQueue()
        writer = threading.Thread(target=_write_all, args=(output, descriptor), daemon=True)
        writer.start()
        self.attach(output.put)
        try:
            while (data := read()) and not self._closing:
                self.receive(data)
        except OSError:
            pass
        self.detach()
        output.put(None)
        writer.join(2)  # clock: gives up on a reader that does not read

    def _start_thread(self, work):
        thread = threading.Thread(target=work, daemon=True)
        self._threads.append(thread)
        thread.start()

    # ---- Serial line ----------------------------------------------------------------------

    def _serial_interrupt(self, byte):
        if byte == 0x18:
            self._mc_reset()
        elif byte in REALTIME:
            self.requests.add(REALTIME[byte])
        elif byte == 0x85:
            if self.state == JOG:
                self.requests.add(MOTION_CANCEL)
        elif byte in MOTION_OVERRIDES or byte in OTHER_OVERRIDES:
            self.overrides.add(byte)
        elif byte < 0x80:
            if len(self.rx) < self.rx_size:
                self.rx.append(byte)
            else:
                self.overflows += 1
                self._note("overflow", byte=byte)

    def _send(self, text):
        data = (text + "\r\n").encode("latin-1")
        if self.mute:
            return
        if self._outbox:
            self._outbox(data)
        else:
            self._pending.append(data)

    def _message(self, text):
        self._send(f"[MSG:{text}]")

    def _reply(self, code, prefix=""):
        """Answer a line with ok or its error."""
        if code:
            self._send(f"{prefix}error:{code}")
            self._note("error", code=code, line=self.line)
            self.errors.append((self.line, code))
            return
        self.oks += 1
        dropped = self.drop_ok if hasattr(self.drop_ok, "__contains__") else (self.drop_ok,)
        if self.oks not in dropped:
            self._send(prefix + "ok")

    # ---- Records --------------------------------------------------------------------------

    def _note(self, event, **facts):
        if self._log and not self._log.closed:
            self._log.write(json.dumps({"event": event, **facts}) + "\n")
            self._log.flush()

    def _point(self, kind, line=""):
        """Record that the tool has moved on a straight line to where it is now."""
        if self.path and self.path[-1].position == self.position:
            return
        self.path.append(PathPoint(self.position, line, self.spindle, kind))
        self._note("point", **self.path[-1]._asdict())

    # ---- Start, reset and main loop -------------------------------------------------------

    def _forget(self):
        """Clear all that a reset clears, except the state."""
        self.requests, self.overrides, self.alarm = set(), set(), 0
        self.suspended, self.abort, self.soft_limit = set(), False, False
        self.holding, self.hold_end, self.stepping = False, None, False
        self.feed_override, self.rapid_override, self.spindle_override = 100, 100, 100
        self.spindle_stop = ""
        self.wco_counter, self.override_counter = 0, 0
        self.spindle, self.coolant = ("M5", 0.0), frozenset()
        self.probe_position, self.probe_succeeded = (0.0, 0.0, 0.0), False
        self.probing, self.probe_away, self.trigger = False, False, None
        self.planner, self.busy, self.moved_at = collections.deque(), False, 0.0
        self.parser = Parser()

    def _run(self):
        with self.lock:
            try:
                self._power_up()
            except _Shutdown:
                pass

    def _power_up(self):
        locked = self.alarm_at_start or self.settings[22]
        self.state = ALARM if locked else IDLE
        while True:
            try:
                self._initialise()
                self._main_loop()
            except _PowerCycle:
                self._power_cycled = False
                self._stop_stepping()
                self.state = ALARM if self.alarm_at_start or self.settings[22] else IDLE
                self.position = (0.0, 0.0, 0.0)
                self._point("power")

    def _initialise(self):
        self._forget()
        self.rx.clear()
        self.parser.coordinates = list(self.places["G54"])
        self._sync_positions()
        self._note("banner")
        self._send(f"\r\nGrbl {VERSION} ['$' for help]")
        self._ready = True
        self.changed.notify_all()

    def _sync_positions(self):
        """Planner and parser take over the machine's position."""
        self.position = self._on_steps(self.position)
        self.planned = self._steps(self.position)
        self.parser.position = list(self.position)

    def _main_loop(self):
        if self.state in (ALARM, SLEEP):
            self._message("'$H'|'$X' to unlock")
            self.state = ALARM
        else:
            self.state = IDLE
            self._run_startup_lines()
        text, flag = "", ""
        while True:
            while self.rx:
                byte = self.rx.popleft()
                if byte not in b"\r\n":
                    text, flag = self._collect(byte, text, flag)
                    continue
                self._realtime()
                if self.abort:
                    return
                self._answer(text, flag)
                text, flag = "", ""
            self._auto_cycle_start()
            self._realtime()
            if self.abort:
                return
            if not self.rx:
                self._wait()

    @staticmethod
    def _collect(byte, text, flag):
        """Add a byte to the line, without comments, blanks and control characters."""
        if flag:
            return text, "" if byte == ord(")") and flag == "(" else flag
        if byte <= ord(" ") or byte == ord("/"):
            return text, ""
        if byte in b"(;":
            return text, chr(byte)
        if len(text) >= LINE_BUFFER - 1:
            return text, "overflow"
        return text + chr(byte).upper(), ""

    def _answer(self, text, flag):
        """Run one line to its end and answer it."""
        self.line, self.busy = text, True
        if self.slow:
            self._delay(self.slow * self.speed)
        if flag == "overflow":
            self._reply(11)
        elif not text:
            self._reply(0)
        elif text[0] == "$":
            self._reply(self._system_line(text))
        else:
            self._reply(self._gcode_line(text))
        self.busy = False

    def _gcode_line(self, text):
        self.gcode_lines += 1
        if self.error_at == self.gcode_lines:
            return 20
        if self.state in (ALARM, JOG):
            return 9
        checking = self.state == CHECK
        code = self._execute(text)
        if not code and not self.abort:
            (self.checked if checking else self.executed).append(text)
            self._note("checked" if checking else "executed", line=text)
        return code

    def _run_startup_lines(self):
        for text in self.startup_lines:
            if text:
                self.line = text
                self._reply(self._execute(text), f">{text}:")

    # ---- Waiting --------------------------------------------------------------------------

    def _now(self):
        return time.monotonic()  # clock: simulated motion follows real time

    def _sleep(self, seconds):
        """Let the serial line work, until something changes or the time is over."""
        longest = None if seconds is None else min(seconds, 3600.0)
        self.changed.wait(longest)  # clock: simulated motion follows real time
        if self._closing:
            raise _Shutdown
        self._advance()
        if self._power_cycled:
            raise _PowerCycle

    def _wait(self):
        """Wait for the next request or the end of the current motion."""
        self._advance()
        if not (self.requests or self.alarm or self.overrides):
            self._sleep(self._time_to_next_event())

    def _pause(self, seconds):
        """Wait a simulated time, blind to requests."""
        end = self._now() + seconds / self.speed
        while (left := end - self._now()) > 0:
            self._sleep(left)

    def _delay(self, seconds, check=None):
        """Wait a simulated time in the firmware's steps, with a check point at each."""
        for _ in range(math.ceil(20 * seconds) % 65536):  # The firmware counts in 16 bits.
            if self.abort:
                return
            (check or self._realtime)()
            if check and RESTART_RETRACT in self.suspended:
                return
            self._pause(min(0.05, seconds))

    # ---- Real-time requests ---------------------------------------------------------------

    def _realtime(self):
        """A check point of the main program."""
        self._serve_requests()
        if self.suspended:
            self._stay_suspended()

    def _serve_requests(self):
        self._advance()
        if self.alarm:
            self._raise_alarm()
        asked = set(self.requests)
        if RESET in asked:
            self.abort = True
            return
        if STATUS in asked:
            self._report_status()
            self.requests.discard(STATUS)
        if asked & HOLD_REQUESTS:
            self._begin_hold(asked)
            self.requests -= HOLD_REQUESTS
        if CYCLE_START in asked:
            if not asked & {FEED_HOLD, MOTION_CANCEL, DOOR_OPEN}:
                self._cycle_start()
            self.requests.discard(CYCLE_START)
        if CYCLE_STOP in asked:
            self._cycle_stop()
            self.requests.discard(CYCLE_STOP)
        if self.overrides:
            self._serve_overrides()

    def _raise_alarm(self):
        self.state = ALARM
        self._send(f"ALARM:{self.alarm}")
        self._note("alarm", code=self.alarm)
        self._pause(0.5)
        if self.alarm in (1, 2):
            self._message("Reset to continue")
            self.requests.discard(RESET)
            while RESET not in self.requests:
                self._sleep(None)
        self.alarm = 0

    def _begin_hold(self, asked):
        if self.state not in (ALARM, CHECK):
            if self.state in (RUN, JOG) and not self.suspended & {MOTION_CANCEL, JOG_CANCEL}:
                self._halt()
                if self.state == JOG and GO_TO_SLEEP not in asked:
                    self.suspended.add(JOG_CANCEL)
            if self.state == IDLE:
                self.suspended = {HOLD_COMPLETE}
            if MOTION_CANCEL in asked and self.state != JOG:
                self.suspended.add(MOTION_CANCEL)
            if FEED_HOLD in asked and self.state not in (DOOR, JOG, SLEEP):
                self.state = HOLD
            if DOOR_OPEN in asked:
                self._open_door()
        if GO_TO_SLEEP in asked:
            if self.state == ALARM:
                self.suspended |= {RETRACTED, HOLD_COMPLETE}
            self.state = SLEEP

    def _open_door(self):
        self._message("Check Door")
        if JOG_CANCEL not in self.suspended:
            if self.state == DOOR and RESTORE in self.suspended:
                self.suspended -= {RETRACTED, RESTORE, RESTORED}
                self.suspended.add(RESTART_RETRACT)
            if self.state != SLEEP:
                self.state = DOOR
        self.suspended.add(AJAR)

    def _cycle_start(self):
        if self.state == DOOR and AJAR not in self.suspended:
            if RESTORED in self.suspended:
                self.state = IDLE
            elif RETRACTED in self.suspended:
                self.suspended.add(RESTORE)
        held = self.state == HOLD and HOLD_COMPLETE in self.suspended
        if self.state != IDLE and not held:
            return
        if held and self.spindle_stop:
            self.spindle_stop = "restore cycle"
            return
        run = bool(self.planner) and MOTION_CANCEL not in self.suspended
        self.suspended = set()
        self.holding = False
        self.state = RUN if run else IDLE
        if run:
            self._start_stepping()

    def _cycle_stop(self):
        held = self.state in (HOLD, DOOR, SLEEP) and not self.soft_limit
        if held and JOG_CANCEL not in self.suspended:
            if self.holding:
                self.suspended.add(HOLD_COMPLETE)
            self.holding = False
            return
        if JOG_CANCEL in self.suspended:
            self.planner.clear()
            self._sync_positions()
        self.holding = False
        if AJAR in self.suspended:
            self.suspended.discard(JOG_CANCEL)
            self.suspended.add(HOLD_COMPLETE)
            self.state = DOOR
        else:
            self.suspended = set()
            self.state = IDLE

    def _mc_reset(self):
        """Stop everything at once and ask the main program to start again."""
        if RESET in self.requests:
            return
        self._advance()
        self.requests.add(RESET)
        self._note("reset", state=self.state)
        if self.state in (RUN, JOG) or self.holding:
            self.alarm = 3
        elif self.state == HOME and not self.alarm:
            self.alarm = 6
        if self.stepping:
            self._stop_stepping()
        self.hold_end = None
        self.spindle, self.coolant = ("M5", 0.0), frozenset()

    def _serve_overrides(self):
        asked, self.overrides = self.overrides, set()
        feed, rapid = self.feed_override, self.rapid_override
        feed = 100 if 0x90 in asked else feed
        for byte, change in ((0x91, 10), (0x92, -10), (0x93, 1), (0x94, -1)):
            feed += change if byte in asked else 0
        for byte, value in ((0x95, 100), (0x96, 50), (0x97, 25)):
            rapid = value if byte in asked else rapid
        speed = 100 if 0x99 in asked else self.spindle_override
        for byte, change in ((0x9A, 10), (0x9B, -10), (0x9C, 1), (0x9D, -1)):
            speed += change if byte in asked else 0
        before = (self.feed_override, self.rapid_override, self.spindle_override)
        after = (min(max(feed, 10), 200), rapid, min(max(speed, 10), 200))
        self.feed_override, self.rapid_override, self.spindle_override = after
        if after != before:
            self.override_counter = 0
        if after[2] != before[2]:
            self.spindle = (self.spindle[0], self._turning(self.spindle[0], self.parser.speed))
        if 0x9E in asked and self.state == HOLD:
            self.spindle_stop = {"": "initiate", "enabled": "restore"}.get(
                self.spindle_stop, self.spindle_stop
            )
        for byte, coolant in ((0xA0, "M8"), (0xA1, "M7" if self.mist else "")):
            if byte in asked and coolant and self.state in (IDLE, RUN, HOLD, JOG):
                self.parser.modal.coolant ^= {coolant}
                self._set_coolant(self.parser.modal.coolant)

    # ---- Suspension -----------------------------------------------------------------------

    def _stay_suspended(self):
        """Block the main program until it may go on."""
        spindle = self.planner[0].plan.spindle if self.planner else None
        spindle = spindle or (self.parser.modal.spindle, self.parser.speed)
        coolant = self.coolant
        while self.suspended and not self.abort:
            before = (self.state, set(self.suspended), self.spindle_stop)
            if HOLD_COMPLETE in self.suspended:
                if self.state in (DOOR, SLEEP):
                    self._park(spindle, coolant)
                else:
                    self._stop_or_restore_spindle(spindle)
            self._serve_requests()
            if before == (self.state, self.suspended, self.spindle_stop) and not self.abort:
                self._wait()

    def _park(self, spindle, coolant):
        if RETRACTED not in self.suspended:
            self.spindle_stop = ""
            self._set_spindle("M5", 0.0)
            self._set_coolant(frozenset())
            self.suspended.discard(RESTART_RETRACT)
            self.suspended.add(RETRACTED)
            return
        if self.state == SLEEP:
            self._message("Sleeping")
            self._set_spindle("M5", 0.0)
            self._set_coolant(frozenset())
            while not self.abort:
                self._serve_requests()
                if not self.abort:
                    self._wait()
            return
        self.suspended.discard(AJAR)
        if RESTORE in self.suspended:
            self._restore_from_door(spindle, coolant)

    def _restore_from_door(self, spindle, coolant):
        if self.parser.modal.spindle != "M5" and not self.settings[32]:
            self._set_spindle(*spindle)
            self._delay(4.0, self._serve_requests)
        if self.parser.modal.coolant and RESTART_RETRACT not in self.suspended:
            self._set_coolant(coolant)
            self._delay(1.0, self._serve_requests)
        if RESTART_RETRACT not in self.suspended:
            self.suspended.add(RESTORED)
            self.requests.add(CYCLE_START)

    def _stop_or_restore_spindle(self, spindle):
        on = self.parser.modal.spindle != "M5"
        if self.spindle_stop == "initiate":
            if on:
                self._set_spindle("M5", 0.0)
            self.spindle_stop = "enabled" if on else ""
        elif self.spindle_stop.startswith("restore"):
            if on:
                self._message("Restoring spindle")
                self._set_spindle(*spindle)
            if self.spindle_stop == "restore cycle":
                self.requests.add(CYCLE_START)
            self.spindle_stop = ""

    # ---- Spindle and coolant --------------------------------------------------------------

    def _turning(self, mode, speed):
        """The speed the spindle really gets."""
        if mode == "M5":
            return 0.0
        speed *= self.spindle_override / 100
        lowest, highest = self.settings[31], self.settings[30]
        if lowest >= highest or speed >= highest:
            return highest
        return max(speed, lowest) if speed else 0.0

    def _set_spindle(self, mode, speed):
        if not self.abort:
            self.spindle = (mode, self._turning(mode, speed))
            self.override_counter = 0

    def _sync_spindle(self, mode, speed):
        if self.state != CHECK:
            self._synchronise()
            self._set_spindle(mode, speed)

    def _set_coolant(self, coolant):
        if not self.abort:
            self.coolant = frozenset(coolant)
            self.override_counter = 0

    # ---- Planner and stepper --------------------------------------------------------------

    def _steps(self, position):
        return [round_half_away(v * self.settings[100 + i]) for i, v in enumerate(position)]

    def _on_steps(self, position):
        return self._from_steps(self._steps(position))

    def _from_steps(self, steps):
        return tuple(s / (self.settings[100 + i] or 1.0) for i, s in enumerate(steps))

    def _auto_cycle_start(self):
        if self.planner:
            self.requests.add(CYCLE_START)

    def _synchronise(self):
        """Wait until all queued motion has ended."""
        self._auto_cycle_start()
        while True:
            self._realtime()
            if self.abort or not (self.planner or self.state == RUN):
                return
            self._wait()

    def _mc_line(self, target, plan):
        if self.settings[20] and self.state != JOG and self._beyond(target):
            self._soft_limit_alarm()
        if self.state == CHECK:
            return
        while True:
            self._realtime()
            if self.abort:
                return
            if len(self.planner) < self.planner_size:
                break
            if self.state == IDLE:  # In any other state it would have no effect.
                self._auto_cycle_start()
            self._wait()
        if not self._queue_motion(target, plan) and self.settings[32] and plan.spindle[0] == "M3":
            self._sync_spindle(*plan.spindle)

    def _beyond(self, target):
        return any(v > 0 or v < -self.settings[130 + i] for i, v in enumerate(target))

    def _soft_limit_alarm(self):
        self.soft_limit = True
        if self.state == RUN:
            self.requests.add(FEED_HOLD)
            while True:
                self._realtime()
                if self.abort:
                    return
                if self.state == IDLE:
                    break
                self._wait()
        self._mc_reset()
        self.alarm = 2
        self._realtime()

    def _queue_motion(self, target, plan):
        """Add a block to the planner, or return False for a motion of no steps."""
        steps = self._steps(target)
        if steps == self.planned:
            return False
        start, end = self._from_steps(self.planned), self._from_steps(steps)
        length = math.dist(start, end)
        share = [abs(b - a) / length for a, b in zip(start, end)]
        rapid, acceleration = (
            min(self.settings[base + i] / part for i, part in enumerate(share) if part)
            for base in (110, 120)
        )
        rate = plan.feed * length if plan.inverse_time else plan.feed
        self.planner.append(Motion(start, end, length, rate, rapid, acceleration, plan))
        self.planned = steps
        return True

    def _rate(self, motion):
        """The speed of a block in mm/min, with overrides."""
        if motion.plan.kind == "rapid":
            rate = motion.rapid_rate * self.rapid_override / 100
        else:
            share = self.feed_override / 100 if motion.plan.overridable else 1.0
            rate = min(motion.rate * share, motion.rapid_rate)
        return max(rate, 1.0)

    def _start_stepping(self):
        self.stepping, self.moved_at = True, self._now()

    def _stop_stepping(self):
        self.stepping = False
        if self.planner and self.planner[0].travelled:
            self._point(self.planner[0].plan.kind, self.planner[0].plan.line)

    def _halt(self):
        """Stop for a hold; the time of the deceleration passes before the hold is complete."""
        self.holding = True
        if not self.stepping:
            return
        motion = self.planner[0]
        self._stop_stepping()
        seconds = self._rate(motion) / 60 / max(motion.acceleration, 1e-3)
        seconds = seconds if self.hold_time is None else self.hold_time
        self.hold_end = self._now() + seconds / self.speed

    def _time_to_next_event(self):
        if self.hold_end is not None:
            return max(0.0, self.hold_end - self._now())
        if not self.stepping or not self.planner:
            return None
        motion = self.planner[0]
        end = motion.length if self.trigger is None else self.trigger
        left = (end - motion.travelled) * 60 / self._rate(motion) / self.speed
        return max(0.001, left)

    def _advance(self):
        """Move the tool along the queued blocks up to now."""
        if self.hold_end is not None and self._now() >= self.hold_end:
            self.hold_end = None
            self.requests.add(CYCLE_STOP)
        if not self.stepping:
            return
        now = self._now()
        seconds, self.moved_at = (now - self.moved_at) * self.speed, now
        while self.stepping and seconds > 0:
            seconds = self._move(seconds)

    def _move(self, seconds):
        """Move along the first block and return the time that is left after it."""
        motion = self.planner[0]
        if self.settings[32]:
            mode, speed = motion.plan.spindle
            self.spindle = (mode, self._turning(mode, speed))
        speed = self._rate(motion) / 60
        reached = motion.travelled + speed * seconds
        if self.probing and self.trigger is not None and reached >= self.trigger:
            motion.travelled = self.trigger
            self.position = self._on_steps(motion.at(self.trigger))
            self.probe_position, self.probing, self.trigger = self.position, False, None
            self.requests.add(MOTION_CANCEL)
            self._stop_stepping()
            self.hold_end = self._now()
            return 0.0
        if reached < motion.length:
            motion.travelled, self.position = reached, motion.at(reached)
            return 0.0
        left = seconds - (motion.length - motion.travelled) / speed
        self.position = motion.end
        self._point(motion.plan.kind, motion.plan.line)
        self.planner.popleft()
        if not self.planner:
            self.stepping = False
            self.requests.add(CYCLE_STOP)
        self.changed.notify_all()
        return left

    # ---- Arc, dwell, probe, homing --------------------------------------------------------

    def _mc_arc(self, block, plan, axes, clockwise):
        first, second, linear = axes
        position, target, offset = self.parser.position, block.xyz, block.ijk
        centre = position[first] + offset[first], position[second] + offset[second]
        r0, r1 = -offset[first], -offset[second]
        t0, t1 = target[first] - centre[0], target[second] - centre[1]
        angle = math.atan2(r0 * t1 - r1 * t0, r0 * t0 + r1 * t1)
        if clockwise and angle >= -5e-7:
            angle -= 2 * math.pi
        elif not clockwise and angle <= 5e-7:
            angle += 2 * math.pi
        radius, tolerance = block.values["R"], self.settings[12]
        square, half = tolerance * (2 * radius - tolerance), abs(0.5 * angle * radius)
        possible = square > 0 and math.isfinite(half)
        segments = int(half / math.sqrt(square)) % 65536 if possible else 0
        if segments and plan.inverse_time:
            plan = dataclasses.replace(plan, feed=plan.feed * segments, inverse_time=False)
        rise = (target[linear] - position[linear]) / segments if segments else 0.0
        for i in range(1, segments):
            cos, sin = math.cos(i * angle / segments), math.sin(i * angle / segments)
            position[first] = centre[0] + r0 * cos - r1 * sin
            position[second] = centre[1] + r0 * sin + r1 * cos
            position[linear] += rise
            self._mc_line(list(position), plan)
            if self.abort:
                return
        self._mc_line(target, plan)

    def _dwell(self, seconds):
        if self.state != CHECK:
            self._synchronise()
            self._delay(seconds)

    def _touches(self, position):
        """Whether the probe input is on, inverted for a probe that moves away."""
        return (bool(self.probe and self.probe(position))) != self.probe_away

    def _probe_cycle(self, target, plan, away, forgiving):
        """Run a probe motion; return which position the parser takes over."""
        if self.state == CHECK:
            return "target"
        self._synchronise()
        if self.abort:
            return "none"
        self.probe_succeeded, self.probe_away = False, away
        if self._touches(self.position):
            self.alarm = 4
            self._realtime()
            self.probe_away = False
            return "none"
        self._mc_line(target, plan)
        self.probing, self.trigger = True, self._find_trigger()
        self.requests.add(CYCLE_START)
        while True:
            self._realtime()
            if self.abort:
                return "none"
            if self.state == IDLE:
                break
            self._wait()
        if not self.probing:
            self.probe_succeeded = True
        elif forgiving:
            self.probe_position = self._on_steps(self.position)
        else:
            self.alarm = 5
        self.probing = self.probe_away = False
        self.trigger = None
        self._realtime()
        self.planner.clear()
        self.position = self._on_steps(self.position)
        self.planned = self._steps(self.position)
        self._report_probe()
        return "machine" if self.probe_succeeded else "target"

    def _find_trigger(self):
        """The distance along the probe's block at which it first touches, if it does."""
        if not self.planner:
            return None
        motion = self.planner[0]
        steps = zip(self._steps(motion.start), self._steps(motion.end))
        count = max(abs(b - a) for a, b in steps)

        def touches(i):
            return self._touches(self._on_steps(motion.at(motion.length * i / count)))

        if not callable(self.probe_option):
            # One plane: the probe touches from some step on.
            first = bisect.bisect_left(range(count + 1), True, key=touches)
        else:
            first = next((i for i in range(count + 1) if touches(i)), count + 1)
        return motion.length * first / count if first <= count else None

    def _home(self):
        """Find the limit switches at the ends of travel: Z first, then X and Y."""
        for axes in ((2,), (0, 1)):
            switches, clear = list(self.position), list(self.position)
            for i in axes:
                negative = int(self.settings[23]) & (1 << i)
                pull_off = self.settings[27]
                switches[i] = -self.settings[130 + i] if negative else 0.0
                clear[i] = switches[i] + (pull_off if negative else -pull_off)
            for target in (switches, clear):
                if not self._homing_move(self._on_steps(target)):
                    return
        self._realtime()
        if not self.abort:
            self.drift = (0.0, 0.0, 0.0)
            self._sync_positions()

    def _homing_move(self, target):
        start, began = self.position, self._now()
        seconds = math.dist(start, target) * 60 / max(self.settings[25], 1.0) / self.speed
        stops = {RESET, DOOR_OPEN}
        while (gone := self._now() - began) < seconds and not self.requests & stops:
            self._sleep(seconds - gone)
        share = min(1.0, gone / seconds) if seconds else 1.0
        self.position = tuple(a + (b - a) * share for a, b in zip(start, target))
        if not self.requests & stops:
            self.position = target
            self._point("homing", self.line)
            return True
        # Grbl counts the steps of each phase from 0.
        moves = [a != b for a, b in zip(start, target)]
        counted = tuple(p - s if m else p for p, s, m in zip(self.position, start, moves))
        self.drift = tuple(s if m else 0.0 for s, m in zip(start, moves))
        self.position = self._on_steps(counted)
        self._point("homing", self.line)
        self.alarm = 7 if DOOR_OPEN in self.requests else 6
        self._mc_reset()
        self._realtime()
        return False

    # ---- G-code: reading a line -----------------------------------------------------------

    def _execute(self, text):
        """Run a line of G-code or a jog and return its error number, 0 for ok."""
        try:
            block = GcodeBlock(copy.copy(self.parser.modal), jog=text.startswith("$"))
            if block.jog:
                block.modal.motion, block.modal.feed = "G1", "G94"
            self._read_words(text, 3 if block.jog else 0, block)
            flags = self._check(block)
            return self._run_block(block, flags)
        except GcodeError as refused:
            return refused.code

    def _read_words(self, text, at, block):
        while at < len(text):
            letter = text[at]
            if not "A" <= letter <= "Z":
                raise GcodeError(1)
            value, at = read_number(text, at + 1)
            if value is None:
                raise GcodeError(2)
            number = int(value) & 0xFF
            mantissa = round_half_away(100 * (value - number)) & 0xFFFF
            if letter == "G":
                self._read_g(number, mantissa, block)
            elif letter == "M":
                self._read_m(number, mantissa, block)
            else:
                self._read_value(letter, value, number, block)

    @staticmethod
    def _claim_axes(block, command):
        if block.axis_command:
            raise GcodeError(24)
        block.axis_command = command

    @staticmethod
    def _claim_group(block, group):
        if group in block.groups:
            raise GcodeError(21)
        block.groups.add(group)

    def _read_g(self, number, mantissa, block):
        modal, name, group = block.modal, f"G{number}", ""
        if number in (10, 28, 30, 92, 4, 53):
            if number not in (4, 53) and not mantissa:
                self._claim_axes(block, "non-modal")
            group, block.non_modal = "non-modal", name
            if number in (28, 30, 92):
                if mantissa not in (0, 10):
                    raise GcodeError(20)
                block.non_modal += ".1" if mantissa else ""
                mantissa = 0
        elif number in (0, 1, 2, 3, 38, 80):
            if number != 80:
                self._claim_axes(block, "motion")
            if number == 38:
                if mantissa not in (20, 30, 40, 50):
                    raise GcodeError(20)
                name, mantissa = f"G38.{mantissa // 10}", 0
            group, modal.motion = "motion", name
        elif number in (17, 18, 19):
            group, modal.plane = "plane", name
        elif number in (90, 91) and not mantissa:
            group, modal.distance = "distance", name
        elif number in (90, 91):
            if mantissa != 10 or number == 90:
                raise GcodeError(20)
            group, mantissa = "arc distance", 0
        elif number in (93, 94):
            group, modal.feed = "feed", name
        elif number in (20, 21):
            group, modal.units = "units", name
        elif number == 40:
            group = "cutter"
        elif number in (43, 49):
            self._claim_axes(block, "tool length")
            if number == 43 and mantissa != 10:
                raise GcodeError(20)
            group, mantissa = "tool length", 0
            modal.tool_length = "G49" if number == 49 else "G43.1"
        elif 54 <= number <= 59:
            group, modal.coordinates = "coordinates", number - 54
        elif number == 61 and not mantissa:
            group = "control"
        else:
            raise GcodeError(20)
        if mantissa:
            raise GcodeError(23)
        self._claim_group(block, group)

    def _read_m(self, number, mantissa, block):
        if mantissa:
            raise GcodeError(23)
        modal, name = block.modal, f"M{number}"
        if number in (0, 1, 2, 30):
            group = "flow"
            if number != 1:
                modal.flow = name
        elif number in (3, 4, 5):
            group, modal.spindle = "spindle", name
        elif number in (8, 9) or (number == 7 and self.mist):
            group = "coolant"
            modal.coolant = frozenset() if number == 9 else modal.coolant | {name}
        else:
            raise GcodeError(20)
        self._claim_group(block, group)

    @staticmethod
    def _read_value(letter, value, number, block):
        if letter not in "FIJKLNPRSTXYZ":
            raise GcodeError(20)
        if letter == "T" and value > 255:
            raise GcodeError(38)
        if letter in AXES:
            block.xyz[AXES.index(letter)] = value
            block.axes.add(AXES.index(letter))
        elif letter in "IJK":
            block.ijk["IJK".index(letter)] = value
            block.centres.add("IJK".index(letter))
        if letter in block.unused:
            raise GcodeError(25)
        if letter in "FNPTS" and value < 0:
            raise GcodeError(4)
        block.values[letter] = number if letter in "LT" else value
        block.unused.add(letter)

    # ---- G-code: checking a line ----------------------------------------------------------

    def _check(self, block):
        """Refuse a faulty line and work out its targets; return what the run needs to know."""
        modal, values = block.modal, block.values
        if block.axes and not block.axis_command:
            block.axis_command = "motion"
        if values["N"] > 10_000_000:
            raise GcodeError(27)
        self._check_feed(block)
        if "S" not in block.unused:
            values["S"] = self.parser.speed
        if block.non_modal == "G4":
            if "P" not in block.unused:
                raise GcodeError(28)
            block.unused.discard("P")
        axes = {"G17": (0, 1, 2), "G18": (2, 0, 1), "G19": (1, 2, 0)}[modal.plane]
        if modal.units == "G20":
            for i in block.axes:
                block.xyz[i] *= INCH
        if block.axis_command == "tool length" and modal.tool_length == "G43.1":
            if block.axes != {2}:
                raise GcodeError(37)
        # Like the firmware, read a coordinate system anew only when it changes.
        coordinates = self.parser.coordinates
        if self.parser.modal.coordinates != modal.coordinates:
            coordinates = self.places[PLACES[modal.coordinates]]
        self._check_non_modal(block, coordinates)
        self._check_motion(block, axes)
        used = "NF" if block.jog else "NFST"
        used += AXES if block.axis_command else ""
        if block.unused - set(used):
            raise GcodeError(36)
        return axes, list(coordinates)

    def _check_feed(self, block):
        values, given = block.values, "F" in block.unused
        inches = block.modal.units == "G20"
        if block.jog:
            if not given:
                raise GcodeError(22)
            values["F"] *= INCH if inches else 1
        elif block.modal.feed == "G93":
            moves = block.axis_command == "motion" and block.modal.motion not in ("G80", "G0")
            if moves and not given:
                raise GcodeError(22)
        elif self.parser.modal.feed == "G94":
            if not given:
                values["F"] = self.parser.feed
            elif inches:
                values["F"] *= INCH

    def _check_non_modal(self, block, coordinates):
        if block.non_modal == "G10":
            self._check_g10(block)
        elif block.non_modal == "G92":
            if not block.axes:
                raise GcodeError(26)
            for i in range(3):
                shift = coordinates[i] + (self.parser.tool_length if i == 2 else 0.0)
                here = self.parser.position[i] - shift - block.xyz[i]
                block.xyz[i] = here if i in block.axes else self.parser.g92[i]
        else:
            if block.axis_command != "tool length" and block.axes:
                self._find_target(block, coordinates)
            if block.non_modal in ("G28", "G30"):
                place = self.places[block.non_modal]
                if block.axes:
                    here = self.parser.position
                    place = [place[i] if i in block.axes else here[i] for i in range(3)]
                else:
                    block.axis_command = ""
                block.ijk = list(place)
            elif block.non_modal == "G53" and block.modal.motion not in ("G0", "G1"):
                raise GcodeError(30)

    def _check_g10(self, block):
        values = block.values
        if not block.axes:
            raise GcodeError(26)
        # The firmware misses only both words together; P then means the active system.
        if not block.unused & {"P", "L"}:
            raise GcodeError(28)
        if int(values["P"]) & 0xFF > 6:
            raise GcodeError(29)
        if values["L"] not in (2, 20) or (values["L"] == 2 and "R" in block.unused):
            raise GcodeError(20)
        block.unused -= {"P", "L"}
        chosen = int(values["P"]) & 0xFF
        block.place = chosen - 1 if chosen else block.modal.coordinates
        block.ijk = list(self.places[PLACES[block.place]])
        for i in block.axes:
            block.ijk[i] = block.xyz[i]
            if values["L"] == 20:
                shift = self.parser.g92[i] + (self.parser.tool_length if i == 2 else 0.0)
                block.ijk[i] = self.parser.position[i] - shift - block.xyz[i]

    def _find_target(self, block, coordinates):
        for i in range(3):
            if i not in block.axes:
                block.xyz[i] = self.parser.position[i]
            elif block.non_modal == "G53":
                continue
            elif block.modal.distance == "G90":
                shift = coordinates[i] + self.parser.g92[i]
                block.xyz[i] += shift + (self.parser.tool_length if i == 2 else 0.0)
            else:
                block.xyz[i] += self.parser.position[i]

    def _check_motion(self, block, axes):
        motion = block.modal.motion
        if motion == "G80":
            if block.axes:
                raise GcodeError(31)
            return
        if block.axis_command != "motion":
            return
        if motion != "G0" and not block.values["F"]:
            raise GcodeError(22)
        if motion in ("G0", "G1"):
            block.axis_command = "motion" if block.axes else ""
            return
        if not block.axes:
            raise GcodeError(26)
        if motion in ("G2", "G3"):
            self._check_arc(block, axes)
        elif block.xyz == self.parser.position:
            raise GcodeError(33)

    def _check_arc(self, block, axes):
        first, second, _ = axes
        if not block.axes & {first, second}:
            raise GcodeError(32)
        x = block.xyz[first] - self.parser.position[first]
        y = block.xyz[second] - self.parser.position[second]
        scale = INCH if block.modal.units == "G20" else 1.0
        if "R" in block.unused:
            block.unused.discard("R")
            if block.xyz == self.parser.position:
                raise GcodeError(33)
            self._centre_from_radius(block, axes, x, y, block.values["R"] * scale)
            return
        if not block.centres & {first, second}:
            raise GcodeError(35)
        block.unused -= set("IJK")
        block.ijk = [value * scale for value in block.ijk]
        radius = math.hypot(block.ijk[first], block.ijk[second])
        block.values["R"] = radius
        off = abs(math.hypot(x - block.ijk[first], y - block.ijk[second]) - radius)
        if off > 0.005 and (off > 0.5 or off > 0.001 * radius):
            raise GcodeError(33)

    @staticmethod
    def _centre_from_radius(block, axes, x, y, radius):
        square = 4 * radius * radius - x * x - y * y
        if square < 0:
            raise GcodeError(34)
        distance = math.hypot(x, y)
        side = -math.sqrt(square) / distance if distance else -math.inf
        if (block.modal.motion == "G3") != (radius < 0):
            side = -side
        block.values["R"] = abs(radius)
        block.ijk[axes[0]] = 0.5 * (x - y * side)
        block.ijk[axes[1]] = 0.5 * (y + x * side)

    # ---- G-code: running a line -----------------------------------------------------------

    def _run_block(self, block, flags):
        if block.jog:
            return self._jog(block)
        axes, coordinates = flags
        state, modal, values = self.parser, block.modal, block.values
        dark, moving, forced = self._laser(block)
        state.modal.feed, state.feed = modal.feed, values["F"]
        if state.speed != values["S"] or forced:
            if state.modal.spindle != "M5" and not moving:
                self._sync_spindle(state.modal.spindle, 0.0 if dark else values["S"])
            state.speed = values["S"]
        planned_speed = 0.0 if dark else state.speed
        state.tool = int(values["T"])
        if state.modal.spindle != modal.spindle:
            self._sync_spindle(modal.spindle, planned_speed)
            state.modal.spindle = modal.spindle
        if state.modal.coolant != modal.coolant:
            if self.state != CHECK:
                self._synchronise()
                self._set_coolant(modal.coolant)
            state.modal.coolant = modal.coolant
        plan = Plan(state.feed, "feed", (modal.spindle, planned_speed), self.line)
        plan.inverse_time = modal.feed == "G93"
        if block.non_modal == "G4":
            self._dwell(values["P"])
        state.modal.plane, state.modal.units = modal.plane, modal.units
        if block.axis_command == "tool length":
            self._set_tool_length(block)
        if state.modal.coordinates != modal.coordinates:
            state.modal.coordinates, state.coordinates = modal.coordinates, coordinates
            self._offsets_changed()
        state.modal.distance = modal.distance
        self._run_non_modal(block, plan)
        state.modal.motion = modal.motion
        if modal.motion != "G80" and block.axis_command == "motion":
            self._run_motion(block, plan, axes)
        state.modal.flow = modal.flow
        if modal.flow:
            self._run_flow()
        return 0

    def _laser(self, block):
        """In laser mode: whether the beam is off, the line moves, and motion must end first."""
        if not self.settings[32]:
            return False, False, False
        cutting = ("G1", "G2", "G3")
        dark = block.modal.motion not in cutting
        moving = bool(block.axes) and block.axis_command == "motion"
        was_cutting = self.parser.modal.motion in cutting
        forced = not moving and self.parser.modal.spindle == "M3" and was_cutting == dark
        return dark, moving, forced

    def _jog(self, block):
        if block.groups - {"non-modal", "distance", "units"} or block.non_modal not in ("", "G53"):
            return 16
        if self.settings[20] and self._beyond(block.xyz):
            return 15
        spindle = (self.parser.modal.spindle, self.parser.speed)
        plan = Plan(block.values["F"], "jog", spindle, self.line, overridable=False)
        self._mc_line(block.xyz, plan)
        if self.state == IDLE and self.planner:
            self.state = JOG
            self._start_stepping()
        self.parser.position = list(block.xyz)
        return 0

    def _offsets_changed(self):
        self._synchronise()
        self.wco_counter = 0

    def _set_tool_length(self, block):
        self.parser.modal.tool_length = block.modal.tool_length
        length = 0.0 if block.modal.tool_length == "G49" else block.xyz[2]
        if length != self.parser.tool_length:
            self.parser.tool_length = length
            self._offsets_changed()

    def _run_non_modal(self, block, plan):
        state, command = self.parser, block.non_modal
        if command == "G10":
            self._synchronise()
            self.places[PLACES[block.place]] = list(block.ijk)
            if state.modal.coordinates == block.place:
                state.coordinates = list(block.ijk)
                self._offsets_changed()
        elif command in ("G28", "G30"):
            plan.kind = "rapid"
            if block.axis_command:
                self._mc_line(block.xyz, plan)
            self._mc_line(block.ijk, plan)
            state.position = list(block.ijk)
        elif command in ("G28.1", "G30.1"):
            self._synchronise()
            self.places[command[:3]] = list(state.position)
        elif command in ("G92", "G92.1"):
            state.g92 = list(block.xyz) if command == "G92" else [0.0] * 3
            self._offsets_changed()

    def _run_motion(self, block, plan, axes):
        motion, taken = block.modal.motion, "target"
        if motion in ("G0", "G1"):
            plan.kind = "rapid" if motion == "G0" else "feed"
            self._mc_line(block.xyz, plan)
        elif motion in ("G2", "G3"):
            self._mc_arc(block, plan, axes, motion == "G2")
        else:
            plan.kind, plan.overridable = "probe", False
            away, forgiving = motion in ("G38.4", "G38.5"), motion in ("G38.3", "G38.5")
            taken = self._probe_cycle(block.xyz, plan, away, forgiving)
        if taken == "target":
            self.parser.position = list(block.xyz)
        elif taken == "machine":
            self.parser.position = list(self._on_steps(self.position))

    def _run_flow(self):
        self._synchronise()
        modal = self.parser.modal
        if modal.flow == "M0":
            if self.state != CHECK:
                self.requests.add(FEED_HOLD)
                self._realtime()
        else:
            modal.motion, modal.plane, modal.distance, modal.feed = "G1", "G17", "G90", "G94"
            modal.coordinates, modal.spindle, modal.coolant = 0, "M5", frozenset()
            self.feed_override = self.rapid_override = self.spindle_override = 100
            if self.state != CHECK:
                self.parser.coordinates = list(self.places["G54"])
                self._offsets_changed()
                self._set_spindle("M5", 0.0)
                self._set_coolant(frozenset())
            self._message("Pgm End")
        modal.flow = ""

    # ---- Commands that start with $ -------------------------------------------------------

    def _system_line(self, text):
        """Run a line that starts with $ and return its error number, 0 for ok."""
        command, rest = text[1:2], text[2:]
        if not command:
            self._send("[HLP:$$ $# $G $I $N $x=val $Nx=line $J=line $SLP $C $X $H ~ ! ? ctrl-x]")
            return 0
        if command == "J":
            if self.state not in (IDLE, JOG):
                return 8
            return self._execute(text) if rest.startswith("=") else 3
        if command in "$GCX":
            return 3 if rest else self._simple_command(command)
        if self.state not in (IDLE, ALARM):
            return 8
        handlers = {"#": self._parameters, "H": self._homing, "S": self._sleep_command}
        handlers |= {"I": self._information, "R": self._restore, "N": self._startup_command}
        if command in handlers:
            return handlers[command](rest)
        return self._assign(text)

    def _simple_command(self, command):
        if command == "$":
            if self.state in (RUN, HOLD):
                return 8
            self._report_settings()
        elif command == "G":
            self._report_modes()
        elif command == "X":
            if self.state == ALARM:
                self._message("Caution: Unlocked")
                self.state = IDLE
        elif self.state == CHECK:
            self._mc_reset()
            self._message("Disabled")
        elif self.state != IDLE:
            return 8
        else:
            self.state = CHECK
            self._message("Enabled")
        return 0

    def _homing(self, rest):
        if not self.settings[22]:
            return 5
        self.state = HOME
        if rest:
            return 3  # As in the firmware, which stays in the state Home.
        self._home()
        if not self.abort:
            self.state = IDLE
            self._run_startup_lines()
        return 0

    def _sleep_command(self, rest):
        if rest != "LP":
            return 3
        self.requests.add(GO_TO_SLEEP)
        return 0

    def _restore(self, rest):
        if not re.fullmatch(r"ST=[$#*]", rest):
            return 3
        if rest[3] in "$*":
            self._change_settings(DEFAULTS)
        if rest[3] in "#*":
            self.places = {name: [0.0] * 3 for name in PLACES}
        if rest[3] == "*":
            self.startup_lines, self.build_info = ["", ""], ""
        self._message("Restoring defaults")
        self._mc_reset()
        return 0

    def _startup_command(self, rest):
        if not rest:
            for number, line in enumerate(self.startup_lines):
                self._send(f"$N{number}={line}")
            return 0
        if self.state != IDLE:
            return 8
        number, at = read_number(rest, 0)
        if number is None:
            return 2
        if rest[at : at + 1] != "=":
            return 3
        line = rest[at + 1 :]
        # The firmware runs the line to check it.
        code = self._execute(line)
        if not code and int(number) in (0, 1):
            self._synchronise()
            self.startup_lines[int(number)] = line
        return code

    def _information(self, rest):
        if not rest:
            self._send(f"[VER:{VERSION}.{BUILD}:{self.build_info}]")
            if not self.no_opt:
                options = "VM" if self.mist else "V"
                self._send(f"[OPT:{options},{self.planner_size},{self.rx_size}]")
            return 0
        if rest[0] != "=":
            return 3
        self.build_info = rest[1:]
        return 0

    def _assign(self, text):
        number, at = read_number(text, 1)
        if number is None:
            return 2
        if text[at : at + 1] != "=":
            return 3
        value, at = read_number(text, at + 1)
        if value is None:
            return 2
        if at < len(text) or number > 255:
            return 3
        return self._store_setting(int(number) & 0xFF, value)

    def _store_setting(self, number, value):
        if value < 0:
            return 4
        if number not in self.settings:
            return 3
        if number in INTEGERS or number in SWITCHES:
            value = int(value) & 0xFF
        if number == 0 and value < 3:
            return 6
        if number == 20 and value and not self.settings[22]:
            return 10
        if number in SWITCHES:
            value = int(bool(value))
        self._change_settings({number: value})
        if number == 22 and not value:
            self.settings[20] = 0
        if number == 13:
            self._offsets_changed()
        return 0

    def _change_settings(self, changes):
        """Change settings; the machine keeps its position in steps."""
        steps = self._steps(self.position) if hasattr(self, "position") else None
        self.settings.update(changes)
        if steps:
            self.position = self._from_steps(steps)

    # ---- Reports --------------------------------------------------------------------------

    def _coordinate(self, value):
        return printed(value / INCH, 4) if self.settings[13] else printed(value, 3)

    def _vector(self, values):
        return ",".join(self._coordinate(value) for value in values)

    def _speed_text(self, value):
        return printed(value / INCH, 1) if self.settings[13] else printed(value, 0)

    def _parameters(self, rest):
        if rest:
            return 3
        for name in PLACES:
            self._send(f"[{name}:{self._vector(self.places[name])}]")
        self._send(f"[G92:{self._vector(self.parser.g92)}]")
        self._send(f"[TLO:{self._coordinate(self.parser.tool_length)}]")
        self._report_probe()
        return 0

    def _report_probe(self):
        self._send(f"[PRB:{self._vector(self.probe_position)}:{int(self.probe_succeeded)}]")

    def _report_settings(self):
        for number, value in sorted(self.settings.items()):
            whole = number in INTEGERS or number in SWITCHES or number in (30, 31)
            self._send(f"${number}={printed(value, 0 if whole else 3)}")

    def _report_modes(self):
        state = self.parser
        modal = state.modal
        words = [modal.motion, PLACES[modal.coordinates], modal.plane, modal.units]
        words += [modal.distance, modal.feed, modal.flow, modal.spindle]
        words += sorted(modal.coolant) or ["M9"]
        words += [f"T{state.tool}", f"F{self._speed_text(state.feed)}"]
        words += [f"S{printed(state.speed, 0)}"]
        self._send(f"[GC:{' '.join(word for word in words if word)}]")

    def _state_text(self):
        if self.state == HOLD:
            return "Hold:0" if HOLD_COMPLETE in self.suspended else "Hold:1"
        if self.state != DOOR:
            return self.state
        if RESTORE in self.suspended:
            return "Door:3"
        if RETRACTED not in self.suspended:
            return "Door:2"
        return "Door:1" if AJAR in self.suspended else "Door:0"

    def _report_status(self):
        state, mask = self.parser, int(self.settings[10])
        shift = [a + b for a, b in zip(state.coordinates, state.g92)]
        shift[2] += state.tool_length
        position = self._on_steps(self.position)
        if mask & 1:
            fields = [self._state_text(), f"MPos:{self._vector(position)}"]
        else:
            work = [a - b for a, b in zip(position, shift)]
            fields = [self._state_text(), f"WPos:{self._vector(work)}"]
        if mask & 2:
            blocks, room = self.planner_size - len(self.planner), self.rx_size - len(self.rx)
            fields.append(f"Bf:{blocks},{room}")
        rate = self._rate(self.planner[0]) if self.stepping and self.planner else 0.0
        fields.append(f"FS:{self._speed_text(rate)},{printed(self.spindle[1], 0)}")
        if self._touches(position):
            fields.append("Pn:P")
        fields += self._occasional_fields(shift)
        self._send(f"<{'|'.join(fields)}>")

    def _occasional_fields(self, shift):
        """The offsets and overrides, which come only now and then."""
        fields = []
        if self.wco_counter > 0:
            self.wco_counter -= 1
        else:
            self.wco_counter = 29 if self.state in BUSY else 9
            self.override_counter = max(self.override_counter, 1)
            fields.append(f"WCO:{self._vector(shift)}")
        if self.override_counter > 0:
            self.override_counter -= 1
            return fields
        self.override_counter = 19 if self.state in BUSY else 9
        overrides = (self.feed_override, self.rapid_override, self.spindle_override)
        fields.append("Ov:" + ",".join(map(str, overrides)))
        accessories = {"M3": "S", "M4": "C"}.get(self.spindle[0], "") if self.spindle[1] else ""
        accessories += "F" if "M8" in self.coolant else ""
        accessories += "M" if "M7" in self.coolant else ""
        return fields + ([f"A:{accessories}"] if accessories else [])


def _plane(height):
    """A probe that touches at a machine Z and below."""
    return lambda position: position[2] <= float(height) + 1e-9


def _nowhere(_data):
    """Lose output."""


def _close_socket(end):
    if end:
        try:
            end.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass
        end.close()


def _write_all(output, descriptor):
    """Write queued output until there is no more or nobody listens."""
    while (data := output.get()) is not None:
        try:
            while data:
                data = data[os.write(descriptor, data) :]
        except OSError:
            return


def _vector_argument(text):
    return tuple(float(value) for value in text.split(","))


def _arguments():
    parser = argparse.ArgumentParser(description="Simulate a Grbl 1.1h controller.")
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("--tcp", type=int, metavar="PORT", help="serve TCP; 0 takes a free port")
    where.add_argument("--pty", action="store_true", help="serve a pseudo terminal")
    parser.add_argument("--rx", type=int, default=128, help="bytes of the receive buffer")
    parser.add_argument("--planner", type=int, default=15, help="blocks of the planner")
    parser.add_argument("--speed", type=float, default=1.0, help="run so many times faster")
    parser.add_argument("--set", action="append", default=[], metavar="$N=V")
    parser.add_argument("--offset", action="append", default=[], metavar="G54=X,Y,Z")
    parser.add_argument("--position", type=_vector_argument, default=(0, 0, 0), metavar="X,Y,Z")
    parser.add_argument("--probe-plane", metavar="z=Z", help="machine Z where the probe touches")
    parser.add_argument("--hold-time", type=float, help="seconds until a hold is complete")
    parser.add_argument("--drop-ok", type=int, help="never send the Nth ok")
    parser.add_argument("--error-at", type=int, help="refuse the Nth line of G-code")
    parser.add_argument("--slow", type=float, default=0.0, help="seconds before each line")
    parser.add_argument("--log", help="write what happens as JSON lines")
    for name in ("alarm-at-start", "mute", "no-opt", "mist"):
        parser.add_argument("--" + name, action="store_true")
    words = sys.argv[1:]
    if "--position" in words:  # Its value may start with a minus, which argparse dislikes.
        at = words.index("--position")
        words[at : at + 2] = ["=".join(words[at : at + 2])]
    return parser.parse_args(words)


def main():
    """Serve until interrupted."""
    options = vars(_arguments())
    port, pty = options.pop("tcp"), options.pop("pty")
    pairs = [text.lstrip("$").split("=") for text in options.pop("set")]
    options["settings"] = {int(number): float(value) for number, value in pairs}
    pairs = [text.split("=") for text in options.pop("offset")]
    options["offsets"] = {name.upper(): _vector_argument(value) for name, value in pairs}
    plane = options.pop("probe_plane")
    options["probe"] = float(plane.lower().removeprefix("z=")) if plane else None
    simulator = GrblSimulator(**options)
    if pty:
        print(simulator.serve_pty(), flush=True)
    else:
        print("port", simulator.serve_tcp(port), flush=True)
    try:
        threading.Event().wait()  # clock: sleeps until interrupted
    except KeyboardInterrupt:
        simulator.stop()


if __name__ == "__main__":
    main()
