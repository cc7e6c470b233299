"""Tells feeler guard what LinuxCNC's status says, and passes on its messages to the operator.

Copyright (C) 2026 the Feeler developers
SPDX-License-Identifier: GPL-2.0-or-later

feeler guard starts it. It writes a JSON object in a line whenever the status has changed, and at
once for a line "?". A line "say TEXT" becomes a message of LinuxCNC.
"""
import json
import os
import select

import linuxcnc

INTERVAL = 0.05  # seconds between looks at the status


def stored_offset(stat):
    """Work offset, origin and rotation as LinuxCNC found them in its file of parameters."""
    ini = linuxcnc.ini(stat.ini_filename)
    name = ini.find("RS274NGC", "PARAMETER_FILE") or "rs274ngc.var"
    path = os.path.join(os.path.dirname(stat.ini_filename), os.path.expanduser(name))
    values = {}
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            for line in file:
                words = line.split()
                if len(words) == 2 and words[0].isdigit():
                    values[int(words[0])] = float(words[1])
    except (OSError, ValueError):
        return 0, [0.0] * 9, 0.0
    index = int(values.get(5220, 1))
    first = 5221 + 20 * (index - 1)
    origin = [values.get(first + axis, 0.0) for axis in range(9)]
    return index, origin, values.get(first + 9, 0.0)


def status_of(stat):
    length = next((tool.zoffset for tool in stat.tool_table if tool.id == stat.tool_in_spindle), 0.0)
    offset = stat.g5x_index, list(stat.g5x_offset), stat.rotation_xy
    if offset[0] == 0:  # no work offset was selected or changed since LinuxCNC has started
        offset = stored_offset(stat)
    return {
        "work_offset": offset[0],
        "origin": offset[1],
        "rotation": offset[2],
        "tool": stat.tool_in_spindle,
        "tool_length": length,
        "homed": all(stat.homed[: stat.joints]),
        "mdi": stat.task_mode == linuxcnc.MODE_MDI,
    }


def main():
    stat, command = linuxcnc.stat(), linuxcnc.command()
    last, rest = None, b""
    while True:
        readable, _, _ = select.select([0], [], [], INTERVAL)
        is_asked = False
        if readable:
            read = os.read(0, 65536)
            if not read:
                return
            *lines, rest = (rest + read).split(b"\n")
            for line in lines:
                if line.startswith(b"say "):
                    command.error_msg(line[4:].decode("utf-8", "replace"))
                is_asked = is_asked or line == b"?"
        try:
            stat.poll()
        except linuxcnc.error:
            return  # LinuxCNC has ended
        if not stat.ini_filename:
            continue  # it has not told its status yet
        now = status_of(stat)
        if now != last or is_asked:
            print(json.dumps(now), flush=True)
            last = now


if __name__ == "__main__":
    main()
