#!/usr/bin/env python3
"""Puts tables into a page: those on standard input replace the ones with the same heading.

usage: COMMAND | readme_tables.py PAGE.md [--check] [--of COMMAND]

With --of, the tables are what that command prints. Rows are found by their first cell; those of the page that are not in the input stay, new ones come last. It fails
if the page has no table with the heading. With --check it writes nothing and fails if something would change.
"""

import subprocess
import sys


def tables_in(lines):
    """(first line, line after the last) of each table."""
    found, at = [], 0
    while at < len(lines):
        end = at
        while end < len(lines) and lines[end].startswith("|"):
            end += 1
        if end > at + 1 and lines[at + 1].startswith("|---"):
            found.append((at, end))
        at = max(end, at + 1)
    return found


def first_cell(row):
    return row.split("|")[1].strip()


def merged(old, new):
    """The rows of a table with those of a new one."""
    fresh = {first_cell(row): row for row in new[2:]}
    rows = [fresh.pop(first_cell(row), row) for row in old[2:]]
    return old[:2] + rows + list(fresh.values())


def updated(page, text):
    """The page with the tables of a text, and the headings that it does not have."""
    lines, source = page.split("\n"), text.split("\n")
    missing = []
    for first, end in tables_in(source):
        table = source[first:end]
        places = [place for place in tables_in(lines) if lines[place[0]] == table[0]]
        if len(places) != 1:
            missing.append(table[0])
            continue
        start, stop = places[0]
        lines[start:stop] = merged(lines[start:stop], table)
    return "\n".join(lines), missing


def main(path, *options):
    with open(path, encoding="utf-8") as file:
        page = file.read()
    if "--of" in options:
        command = options[options.index("--of") + 1]
        tables = subprocess.run([command], stdout=subprocess.PIPE, text=True, check=True).stdout
    else:
        tables = sys.stdin.read()
    text, missing = updated(page, tables)
    if missing:
        sys.exit(f"{path} has not one table with the heading:\n" + "\n".join(missing))
    if "--check" in options:
        sys.exit(f"{path} has other figures" if text != page else 0)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


if __name__ == "__main__":
    main(*sys.argv[1:])
