#!/usr/bin/env python3
"""Runs the commands of the tutorial and of other pages of the manual and compares their output with the page.

    tutorial.py FEELER ROOT             fails with the first difference
    tutorial.py FEELER ROOT --update    writes the actual output into the pages

A block ```console holds commands ($ ...) with their output; a line [...] matches any lines. A block ```toml
FILE is written to that file, ```toml append FILE is appended to it. Seconds of computing time are not compared.
"""
import difflib
import os
import pathlib
import re
import subprocess
import sys
import tempfile

PAGES = ("tutorial.md", "reading-the-report.md")
LEFT_OUT = "[...]"
SECONDS = re.compile(r"\b\d+\.\d\d s$")


def without_seconds(line):
    return SECONDS.sub("S s", line.rstrip())


def matches(shown, printed):
    """Whether the printed lines equal the shown ones, where [...] matches any lines."""
    if not shown:
        return not printed
    if shown[0] == LEFT_OUT:
        return any(matches(shown[1:], printed[at:]) for at in range(len(printed) + 1))
    return bool(printed) and without_seconds(shown[0]) == without_seconds(printed[0]) \
        and matches(shown[1:], printed[1:])


def updated(shown, printed):
    """The output, shortened like the shown text: after a [...] it continues at the most similar line."""
    result, at, after_gap = [], 0, False
    for line in shown:
        if line == LEFT_OUT:
            result.append(line)
            after_gap = True
            continue
        rest = range(at, len(printed))
        if after_gap and rest:
            at = max(rest, key=lambda i: (difflib.SequenceMatcher(None, line, printed[i]).ratio(), -i))
        if at < len(printed):
            result.append(printed[at])
        at, after_gap = at + 1, False
    return result if after_gap or LEFT_OUT in shown else printed


class Shell:
    """A shell that keeps its folder and last exit status between commands."""

    def __init__(self, feeler, root, home):
        self.root, self.folder, self.status = root, root, 0
        self.environment = dict(os.environ, HOME=str(home), COLUMNS="80")
        self.environment["PATH"] = f"{pathlib.Path(feeler).resolve().parent}:{os.environ['PATH']}"

    def run(self, command):
        script = f"(exit {self.status})\n{command}\nstatus=$?\npwd >&3\nexit $status"
        read, write = os.pipe()
        done = subprocess.run(["bash", "-c", script.replace(">&3", f">&{write}")], cwd=self.folder,
                              env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                              pass_fds=[write], check=False, text=True)
        os.close(write)
        with os.fdopen(read) as folder:
            self.folder = pathlib.Path(folder.read().strip())
        self.status = done.returncode
        return done.stdout.splitlines()


def commands_of(block):
    """The commands of a console block with the output shown below each."""
    commands = []
    for line in block:
        if line.startswith("$ "):
            commands.append((line[2:], []))
        else:
            commands[-1][1].append(line)
    return commands


def write_file(shell, info, block):
    names = info.split()[1:]
    mode = "a" if names[0] == "append" else "w"
    with open(shell.folder / names[-1], mode, encoding="utf-8") as file:
        file.write("\n".join(block) + "\n")


def carried_out(text, shell, update):
    """The page with its current output; stops at the first difference unless updating."""
    lines, result = text.splitlines(), []
    at = 0
    while at < len(lines):
        result.append(lines[at])
        info = lines[at][3:] if lines[at].startswith("```") else ""
        at += 1
        if not info:
            continue
        end = lines.index("```", at)
        block = lines[at:end]
        if info == "console":
            block = [line for command, shown in commands_of(block)
                     for line in ["$ " + command] + compared(shell, command, shown, update)]
        elif info.startswith("toml "):
            write_file(shell, info, block)
        result += block + ["```"]
        at = end + 1
    return "\n".join(result) + "\n"


def compared(shell, command, shown, update):
    printed = shell.run(command)
    if matches(shown, printed):
        return shown
    if update:
        return updated(shown, printed)
    raise SystemExit(f"$ {command}\nprints\n" + "\n".join(printed) + "\nthe manual shows\n" + "\n".join(shown))


def main(feeler, root, *options):
    for name in PAGES:
        page = pathlib.Path(root) / "docs" / "manual" / name
        text = page.read_text(encoding="utf-8")
        with tempfile.TemporaryDirectory() as home:
            now = carried_out(text, Shell(feeler, pathlib.Path(root).resolve(), home), "--update" in options)
        if "--update" in options:
            page.write_text(now, encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
