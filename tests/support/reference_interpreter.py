#!/usr/bin/python3
"""Runs NC programs with LinuxCNC's interpreter and prints the results as plain lines.

usage: reference_interpreter.py TOOLS SECONDS PROGRAM...

TOOLS is a tool table in mm. Each program is run twice: by `rs274`, which lists every call but with few
digits, six axes and no line numbers, and by the module `gcode`, which gives exact numbers, nine axes and
lines but neither spindle nor coolant nor modes. The two lists are merged. Each program gets a new process,
a new variables file and at most SECONDS.

Output lines (lengths in mm, angles in degrees, seconds, mm/min):

    program INDEX
    state KEY VALUE...          applies from here on; a key that never appears is unknown
    LINE EVENT VALUE...         motions: x y z a b c u v w, for arcs also: centre centre turns
    no_actions                  spindle, coolant, tools and modes are not reported
    print TEXT                  from (print, ...), after the events
    doubt TEXT                  the two lists disagree in numbers; those of the module are given
    problem TEXT                the two lists contradict each other
    accepted | refused LINE TEXT | endless
"""
import ctypes
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile

MM = 25.4
LENGTHS = (1, 1, 1, 0, 0, 0, 1, 1, 1)  # which of the nine axes are lengths
PLANES = {1: 'XY', 2: 'YZ', 3: 'ZX', 4: 'UV', 5: 'VW', 6: 'WU'}
RS_PLANES = {'XY': 'XY', 'YZ': 'YZ', 'XZ': 'ZX', 'UV': 'UV', 'VW': 'VW', 'UW': 'WU'}
ARC_AXES = {'XY': (0, 1, 2), 'YZ': (1, 2, 0), 'ZX': (2, 0, 1)}
MODULE_NAMES = {
    'STRAIGHT_TRAVERSE': 'straight_traverse', 'STRAIGHT_FEED': 'straight_feed',
    'ARC_FEED': 'arc_feed', 'STRAIGHT_PROBE': 'straight_probe', 'RIGID_TAP': 'rigid_tap',
    'DWELL': 'dwell', 'SET_G5X_OFFSET': 'set_g5x_offset', 'SET_G92_OFFSET': 'set_g92_offset',
    'SET_XY_ROTATION': 'set_xy_rotation', 'USE_TOOL_LENGTH_OFFSET': 'tool_offset',
    'SET_FEED_RATE': 'set_feed_rate', 'SELECT_PLANE': 'set_plane', 'MESSAGE': 'message'}
SWITCHES = {
    'MIST_ON': ('mist', 1), 'MIST_OFF': ('mist', 0), 'FLOOD_ON': ('flood', 1),
    'FLOOD_OFF': ('flood', 0),
    'ENABLE_FEED_OVERRIDE': ('feed_override', 1), 'DISABLE_FEED_OVERRIDE': ('feed_override', 0),
    'ENABLE_SPEED_OVERRIDE': ('speed_override', 1), 'DISABLE_SPEED_OVERRIDE': ('speed_override', 0),
    'ENABLE_ADAPTIVE_FEED': ('adaptive_feed', 1), 'DISABLE_ADAPTIVE_FEED': ('adaptive_feed', 0),
    'ENABLE_FEED_HOLD': ('feed_hold', 1), 'DISABLE_FEED_HOLD': ('feed_hold', 0),
    'START_SPINDLE_CLOCKWISE': ('spindle', 'clockwise'),
    'START_SPINDLE_COUNTERCLOCKWISE': ('spindle', 'counterclockwise'),
    'STOP_SPINDLE_TURNING': ('spindle', 'stopped')}
STOPS = {'PROGRAM_STOP': 'program_stop', 'OPTIONAL_PROGRAM_STOP': 'optional_stop',
         'PROGRAM_END': 'program_end', 'PALLET_SHUTTLE': 'pallet_shuttle'}


def read_tools(path):
    """The rows of a tool table, as dictionaries by letter."""
    rows = []
    with open(path) as table:
        for line in table:
            words = line.split(';')[0].split()
            if words:
                rows.append({word[0].upper(): float(word[1:]) for word in words})
    return rows


def inch_table(rows):
    """The tool table for rs274, whose machine unit is the inch."""
    text = ''
    for row in rows:
        for letter, value in row.items():
            if letter in 'TPQ':
                text += '%s%d ' % (letter, value)
            else:
                text += '%s%r ' % (letter, value / MM if letter in 'XYZUVWD' else value)
        text += ';\n'
    return text


class Canon:
    """Receives and stores the calls of the module `gcode`."""

    def __init__(self, rows, folder):
        self.parameter_file = folder + '/module.var'
        self.line = 0
        self.calls = []
        self.loaded = 0
        self.tools = [self.tuple_of(row) for row in sorted(rows, key=lambda row: row['T'])]

    @staticmethod
    def tuple_of(row):
        return ((int(row['T']),) + tuple(row.get(letter, 0.0) for letter in 'XYZABCUVWDIJ')
                + (int(row.get('Q', 0)),))

    def get_axis_mask(self):
        return 0b111111111

    def get_external_length_units(self):
        return 1.0

    def get_external_angular_units(self):
        return 1.0

    def get_block_delete(self):
        return 0

    def check_abort(self):
        return False

    def get_tool(self, index):
        if index == 0:
            index = self.loaded
        if 1 <= index <= len(self.tools):
            return self.tools[index - 1]
        return (-1,) + (0.0,) * 12 + (0,)

    def next_line(self, state):
        if state.sequence_number > 0:  # G70 to G72 give -1 from their first move on
            self.line = state.sequence_number

    def change_tool(self, index):
        self.loaded = index

    def __getattr__(self, name):
        if name.startswith('_'):
            raise AttributeError(name)
        return lambda *values: self.calls.append((self.line, name, values))


def module_calls(gcode, path, rows, folder, seconds):
    """Returns the calls of the module and how the run ended: ('accepted'|'refused'|'endless', line, text)."""
    answer = folder + '/answer'
    child = os.fork()
    if child == 0:
        signal.alarm(seconds)  # clock: 180 s, ends only what never ends
        silent = os.open(os.devnull, os.O_WRONLY)
        os.dup2(silent, 1)
        os.dup2(silent, 2)
        canon = Canon(rows, folder)
        result, line = gcode.parse(path, canon, 'G21')
        refused = result > gcode.MIN_ERROR
        ending = ('refused', line, gcode.strerror(result)) if refused else ('accepted', line, '')
        with open(answer, 'w') as out:
            out.write(repr((canon.calls, ending)))
        os._exit(0)
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGALRM:
        return [], ('endless', 0, '')
    if status != 0 or not os.path.exists(answer):
        return [], ('crashed', 0, 'status %d' % status)
    with open(answer) as text:
        return eval(text.read(), {'__builtins__': {}, 'nan': float('nan'), 'inf': float('inf')})


def rs_calls(path, folder, seconds):
    """Returns the calls that rs274 prints, how the run ended, and the output of the program."""
    out = folder + '/out'
    try:
        ran = subprocess.run(['/usr/bin/rs274', '-t', folder + '/tool.tbl', '-v',
                              folder + '/rs.var', '-g', path, out], timeout=seconds,  # clock: as above
                             stdin=subprocess.DEVNULL, capture_output=True, cwd=folder)
    except subprocess.TimeoutExpired:
        return [], ('endless', 0, ''), []
    prints = ran.stdout.decode('latin-1').splitlines()
    said = ran.stderr.decode('latin-1').splitlines()
    calls = []
    with open(out, encoding='latin-1') as text:
        for line in text:
            match = re.match(r'\s*\d+ N\S*\s+([A-Z0-9_.]+)\((.*)\)$', line)
            if match:
                calls.append((match[1], match[2]))
    if ran.returncode == 0:
        return calls, ('accepted', 0, ''), prints
    message, line = said[-2:] if len(said) > 1 else ('', '')
    return calls, ('refused', line, message), prints


def line_of_refusal(path, line, text, message):
    """The faulty line. After a line that could not be read the module counts one too many, and for a line
    in a subprogram it names the call; rs274 prints the text of the line."""
    with open(path, encoding='latin-1') as program:
        lines = [''] + [each.strip() for each in program]
    sought = re.search(r'seeking o-word: .* from line: (\d+)', message)
    if sought:
        return int(sought[1])
    if line < len(lines) and lines[line] == text.strip():
        return line
    if 0 < line <= len(lines) and lines[line - 1] == text.strip():
        return line - 1
    same = [number for number, each in enumerate(lines) if each == text.strip() and each]
    called = re.match(r'(o\S+) *call', lines[line] if line < len(lines) else '', re.I)
    if len(same) > 1 and called:
        ends = [number for number, each in enumerate(lines)
                if re.match(re.escape(called[1]) + r' *(sub|endsub)\b', each, re.I)]
        same = [number for number in same if len(ends) == 2 and ends[0] < number < ends[1]]
    return same[0] if len(same) == 1 else line


def line_of_module_refusal(gcode, path, line, rows, folder, seconds):
    """The line refused by the module, if rs274 does not give it because the lines before it are missing."""
    with open(path, encoding='latin-1') as program:
        lines = program.readlines()
    before = folder + '/before.ngc'
    with open(before, 'w', encoding='latin-1') as out:
        out.writelines(lines[:line - 1] + ['M2\n'])
    _, ending = module_calls(gcode, before, rows, folder, seconds)
    return line - 1 if ending[0] == 'refused' else line


def numbers(text):
    return [float(word) for word in re.split(r'[,\s]+', text.strip()) if word]


class Plain:
    """Converts calls to output lines."""

    def __init__(self, write):
        self.write = write
        self.state = {'plane': ('XY',)}
        self.said = {}
        self.line = 0
        self.threading = False
        self.feed = 0.0
        self.feed_unit = 1.0
        self.is_per_turn = False

    def say_feed(self):
        """The feed rate in mm/min, also with G95; and that of rotary axes alone, which is in degrees also if it was
        programmed in inches (emccanon.cc, SET_FEED_RATE)."""
        turns = self.state.get('speed', (0.0,))[0] if self.is_per_turn else 1.0
        self.state['feed'] = (self.feed * turns,)
        self.state['turning_feed'] = (self.feed * turns if self.is_per_turn else self.feed / self.feed_unit,)

    def event(self, name, *values):
        for key, value in self.state.items():
            if self.said.get(key) != value:
                self.said[key] = value
                self.write('state %s %s\n' % (key, ' '.join(map(str, value))))
        self.write('%d %s %s\n' % (self.line, name, ' '.join(map(str, values))))

    def place(self, values):
        return [value * MM if length else value for value, length in zip(values, LENGTHS)]

    def from_module(self, line, name, values):
        """A call with exact numbers, in inches."""
        self.line = line
        if name in ('straight_traverse', 'straight_feed', 'straight_probe'):
            if self.threading and name == 'straight_feed':
                name = 'thread_feed'
            self.event(name, *self.place(values))
        elif name == 'arc_feed':
            first_end, second_end, first, second, turns, normal_end = values[:6]
            end = [0.0] * 3
            for axis, value in zip(ARC_AXES[self.state['plane'][0]],
                                   (first_end, second_end, normal_end)):
                end[axis] = value
            self.event(name, *self.place(tuple(end) + values[6:]), first * MM, second * MM, turns)
        elif name == 'rigid_tap':
            self.event(name, *(value * MM for value in values))
        elif name == 'dwell':
            self.event(name, *values)
        elif name == 'set_g5x_offset':
            self.state['work'] = (values[0], *self.place(values[1:]))
        elif name == 'set_g92_offset':
            self.state['axis'] = tuple(self.place(values))
        elif name == 'tool_offset':
            self.state['tool_offset'] = tuple(self.place(values))
        elif name == 'set_xy_rotation':
            self.state['rotation'] = values
        elif name == 'set_feed_rate':
            self.feed = values[0] * MM
            self.say_feed()
        elif name == 'set_plane':
            self.state['plane'] = (PLANES[values[0]],)
        elif name == 'message':
            self.event('message', values[0])

    def from_rs(self, name, text, unit):
        """A call that only rs274 reports."""
        if name in SWITCHES:
            key, value = SWITCHES[name]
            self.state[key] = (value,)
        elif name in STOPS:
            self.event(STOPS[name])
        elif name == 'SET_SPINDLE_SPEED':
            self.state['speed'] = (numbers(text)[1],)
            self.say_feed()
        elif name == 'SET_SPINDLE_MODE':
            fastest = numbers(text)[1]  # 1e30 is no limit
            self.state['fastest_speed'] = (fastest if fastest < 1e29 else 0.0,)
        elif name == 'SET_FEED_MODE':
            self.is_per_turn = int(numbers(text)[1]) == 1
            self.say_feed()
        elif name == 'SELECT_TOOL':
            self.state['selected'] = (int(text),)
        elif name == 'CHANGE_TOOL':
            self.state['tool'] = self.state.get('selected', (0,))
            self.event('change_tool', *self.state['tool'])
        elif name == 'CHANGE_TOOL_NUMBER':
            self.state['tool'] = (int(text),)
        elif name == 'SET_MOTION_CONTROL_MODE':
            mode, _, tolerance = text.partition(', ')
            self.state['path'] = (mode.replace('CANON_', '').lower(),)
            self.state['tolerance'] = (float(tolerance) * unit if tolerance else 0.0,)
        elif name == 'SET_NAIVECAM_TOLERANCE':
            self.state['naive_tolerance'] = (float(text) * unit,)
        elif name == 'START_SPEED_FEED_SYNC':
            self.state['pitch'] = (numbers(text)[0] * unit,)
            self.threading = True
        elif name == 'STOP_SPEED_FEED_SYNCH':
            self.threading = False
        elif name in ('SET_MOTION_OUTPUT_BIT', 'CLEAR_MOTION_OUTPUT_BIT', 'SET_AUX_OUTPUT_BIT',
                      'CLEAR_AUX_OUTPUT_BIT'):
            self.event('set_output', int(text), int(name[0] == 'S'), 0, int('MOTION' in name))
        elif name in ('SET_MOTION_OUTPUT_VALUE', 'SET_AUX_OUTPUT_VALUE'):
            self.event('set_output', *numbers(text), 1, int('MOTION' in name))
        elif name == 'ORIENT_SPINDLE':
            self.state['spindle'] = ('stopped',)  # the interpreter leaves this to the machine
            self.event('orient_spindle', *numbers(text)[1:])


def near_what_rs_printed(name, values, text, unit):
    """Whether a call of the module corresponds to the one that rs274 printed."""
    if name in ('MESSAGE', 'SELECT_PLANE'):
        return True
    printed = numbers(text)
    if name in ('STRAIGHT_TRAVERSE', 'STRAIGHT_FEED', 'STRAIGHT_PROBE', 'RIGID_TAP'):
        return all(abs(value * MM / unit - there) < 1e-3 + 1e-9 * abs(there)
                   for value, there in list(zip(values, printed))[:3])
    return True


def lay_together(module, rs, plain):
    """Writes the events in the order of rs274 with the numbers of the module."""
    waiting = [call for call in module if call[1] in set(MODULE_NAMES.values())]
    waiting.reverse()
    unit = 1.0
    for name, text in rs:
        if name == 'USE_LENGTH_UNITS':
            unit = 1.0 if text.endswith('MM') else MM
        elif name == 'NURBS_FEED':
            points = []
            while (waiting and waiting[-1][1] == 'straight_feed'
                   and (not points or points[-1][0] == waiting[-1][0])):
                points.append(waiting.pop())
            if points:
                plain.line = points[-1][0]
                plain.event('nurbs_feed', *plain.place(points[-1][2]))
        elif name == 'SET_FEED_RATE':
            # The module has no machine to query for the feed, so M72 restores a wrong one there.
            feed = float(text) * unit
            if waiting and waiting[-1][1] == name.lower():
                line, _, values = waiting.pop()
                if abs(values[0] * MM - feed) < 1e-3 * unit:
                    feed = values[0] * MM
            plain.feed, plain.feed_unit = feed, unit
            plain.say_feed()
        elif name in MODULE_NAMES:
            while waiting and waiting[-1][1] == 'set_feed_rate':
                waiting.pop()
            if name == 'SELECT_PLANE' and (not waiting or waiting[-1][1] != 'set_plane'):
                continue
            if not waiting:
                return 'rs274 goes on with %s(%s)' % (name, text)
            line, module_name, values = waiting.pop()
            contrast = 'line %d: rs274 has %s(%s), the module %s%r' % (line, name, text,
                                                                       module_name, values)
            if module_name != MODULE_NAMES[name]:
                return contrast
            if not near_what_rs_printed(name, values, text, unit):
                plain.write('doubt %s\n' % contrast)
            plain.from_module(line, module_name, values)
        else:
            plain.from_rs(name, text, unit)
    waiting = [call for call in waiting if call[1] != 'set_feed_rate']
    return 'the module goes on with %s' % (waiting[-1],) if waiting else ''


def answer(gcode, path, rows, fresh, seconds, write):
    with tempfile.TemporaryDirectory(prefix='reference') as folder:
        shutil.copy(fresh + '/tool.tbl', folder)
        for name in ('rs.var', 'module.var'):
            open(folder + '/' + name, 'w').close()
        shutil.copy(fresh + '/pristine.mmap', fresh + '/.tool.mmap')
        module, ending = module_calls(gcode, path, rows, folder, seconds)
        shutil.copy(fresh + '/pristine.mmap', fresh + '/.tool.mmap')
        rs, rs_ending, prints = rs_calls(path, folder, seconds)
        six_axes = re.match("Bad character '[uvw]'", rs_ending[2]) and ending[2] != rs_ending[2]
        if six_axes and ending[0] == 'refused':
            line = line_of_module_refusal(gcode, path, ending[1], rows, folder, seconds)
            ending = ('refused', line, ending[2])
    if ending[0] == rs_ending[0] == 'refused' and not six_axes:
        ending = ('refused', line_of_refusal(path, ending[1], rs_ending[1], rs_ending[2]), ending[2])
    elif rs_ending[2] == 'Cannot do g1 with zero feed rate' and ending[0] == 'accepted':
        # The module starts with its own feed rate.
        ending = ('refused', line_of_refusal(path, 0, rs_ending[1], ''), rs_ending[2])
        rs_ending = ending
    plain = Plain(write)
    if six_axes:
        write('no_actions\n')  # rs274 has only six axes
        for call in module:
            plain.from_module(*call)
    else:
        problem = lay_together(module, rs, plain)
        if ending[0] != rs_ending[0]:
            problem = 'rs274: %s, the module: %s' % (rs_ending, ending)
        if problem:
            write('problem %s\n' % problem)
    for line in prints:
        write('print %s\n' % line)
    write(' '.join(map(str, ending)) + '\n' if ending[0] == 'refused' else ending[0] + '\n')


def main():
    tools, seconds, paths = sys.argv[1], int(sys.argv[2]), sys.argv[3:]
    rows = read_tools(tools)
    with tempfile.TemporaryDirectory(prefix='reference') as home:
        # The interpreter's tool table is in HOME; rs274 writes it there.
        os.environ['HOME'] = home
        ctypes.CDLL(None).setenv(b'HOME', home.encode(), 1)
        for name, text in (('tool.tbl', inch_table(rows)), ('empty.ngc', 'M2\n'), ('e.var', '')):
            with open(home + '/' + name, 'w') as out:
                out.write(text)
        subprocess.run(['/usr/bin/rs274', '-t', home + '/tool.tbl', '-v', home + '/e.var', '-g',
                        home + '/empty.ngc'], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        shutil.copy(home + '/.tool.mmap', home + '/pristine.mmap')
        library = ctypes.CDLL('libtooldata.so.0', mode=ctypes.RTLD_GLOBAL)
        library._Z14tool_mmap_userv()
        import gcode  # only once the tool table exists
        for index, path in enumerate(paths):
            sys.stdout.write('program %d\n' % index)
            answer(gcode, os.path.abspath(path), rows, home, seconds, sys.stdout.write)
            sys.stdout.flush()


if __name__ == '__main__':
    main()
