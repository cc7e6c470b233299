#!/usr/bin/env python3
"""Applies the recipes of docs/recipes.md to a copy of the files that they change.

    recipes.py ROOT BUILD      fails with the first recipe step that is out of date
    recipes.py --self-check    checks this script against a small tree with known mistakes

The first words after the ``` of a code block give its kind:

    ```diff FILE       an edit of FILE: the lines that begin with a blank or - must occur in it once, in
                       sequence; a line of three dots separates two edits
    ```LANGUAGE FILE   a new file
    ```console         commands ($ ...) with their output, run in ROOT with the feeler of the recipes

All recipes are applied to the same copy. Only the changed sources, and those beside a changed header,
are compiled; they are linked before the libraries in BUILD. So an edit of a header must not change the
layout of data that other sources read, and an example must not change a function that the compiler
inlines elsewhere. Rows that a recipe
adds to tests/planted/table.txt are run like the existing ones.
"""
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

import documentation
import tutorial

PLANTED = "tests/planted/table.txt"


class Stale(Exception):
    """A step of a recipe that no longer matches the code."""


def blocks_of(text):
    """Line number, info string and lines of each fenced block."""
    lines, at = text.splitlines(), 0
    while at < len(lines):
        at += 1
        if not lines[at - 1].startswith("```"):
            continue
        end = lines.index("```", at)
        yield at, lines[at - 1][3:].split(), lines[at:end]
        at = end + 1


def hunks_of(lines):
    """The edits of a diff: lines to be found, and lines that replace them."""
    old, new = [], []
    for line in [*lines, "..."]:
        if line == "...":
            yield old, new
            old, new = [], []
            continue
        if line[:1] != "+":
            old.append(line[1:])
        if line[:1] != "-":
            new.append(line[1:])


def edited(text, lines):
    content = text.splitlines()
    for old, new in hunks_of(lines):
        places = [at for at in range(len(content) - len(old) + 1) if content[at:at + len(old)] == old]
        if len(places) != 1:
            raise Stale(f"these lines are in the file {len(places)} times, not once:\n" + "\n".join(old))
        content[places[0]:places[0] + len(old)] = new
    return "\n".join(content) + "\n"


class Overlay:
    """The files that recipes change or add, in a separate folder."""

    def __init__(self, root, folder):
        self.root, self.folder, self.added = root, folder, []
        self.names = set()
        self.planted_rows = []

    def edit(self, name, lines):
        source = self.path_of(name)
        if not source.is_file():
            raise Stale(f"{name}: there is no such file")
        before = source.read_text(encoding="utf-8")
        try:
            after = edited(before, lines)
        except Stale as stale:
            raise Stale(f"{name}: {stale}") from None
        if name == PLANTED:
            self.planted_rows += [line[1:].split() for line in lines if line.startswith("+")]
        self.write(name, after)

    def add(self, name, lines):
        if (self.root / name).exists() or name in self.names:
            raise Stale(f"{name}: a new file, and it exists already")
        self.write(name, "\n".join(lines) + "\n")
        self.added.append(name)

    def path_of(self, name):
        return (self.folder if name in self.names else self.root) / name

    def copy(self, name):
        self.write(name, self.path_of(name).read_text(encoding="utf-8"))

    def write(self, name, text):
        self.names.add(name)
        file = self.folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")

    def complete_folders_of_tests(self):
        """Links to the unchanged files in `tests` and `docs` that commands and tests read."""
        for name in ("assets", "tests/planted", "docs/manual"):
            self.link(name)

    def link(self, name):
        if not (self.folder / name).exists():
            (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
            (self.folder / name).symlink_to(self.root / name)
        elif (self.folder / name).is_dir():
            for entry in (self.root / name).iterdir():
                self.link(f"{name}/{entry.name}")


def apply_recipes(text, overlay):
    """Edits and adds the files of all recipes; returns the console blocks."""
    consoles = []
    for number, info, lines in blocks_of(text):
        try:
            if info == ["console"]:
                consoles.append((number, lines))
            elif len(info) == 2 and info[0] == "diff":
                overlay.edit(info[1], lines)
            elif len(info) == 2:
                overlay.add(info[1], lines)
        except Stale as stale:
            raise Stale(f"docs/recipes.md:{number}: {stale}") from None
    return consoles


# --- building -------------------------------------------------------------------------------------

def run(command, **options):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, **options)
    if done.returncode:
        raise Stale(f"{shlex.join(command) if isinstance(command, list) else command}\n{done.stdout}")
    return done.stdout


def compile_commands(build):
    """The compile command of each source, and whether it is part of a unity build."""
    found = {}
    for entry in json.loads((build / "compile_commands.json").read_text(encoding="utf-8")):
        file = entry["file"]
        if "/tests/" in file:
            continue
        if "/Unity/" not in file:
            found[file] = (entry["command"], False)
            continue
        for source in re.findall(r'#include "(.*)"', pathlib.Path(file).read_text(encoding="utf-8")):
            found[source] = (entry["command"], True)
    return found


def changed_sources(overlay):
    """The sources of the program that recipes change or add, or whose own header they change."""
    names = {name for name in overlay.names if name.endswith(".cpp")}
    names.update(name[:-1] + "cpp" for name in overlay.names if name.endswith(".h"))
    return sorted(name for name in names if not name.startswith("tests/")
                  and (name in overlay.names or (overlay.root / name).is_file()))


def is_built(overlay, name):
    """Whether the CMakeLists.txt of its folder names a new source, or takes all sources there."""
    listing = os.path.join(os.path.dirname(name), "CMakeLists.txt")
    text = overlay.path_of(listing).read_text(encoding="utf-8")
    return os.path.basename(name) in text or re.search(r"file\(GLOB \w+ CONFIGURE_DEPENDS \*\.cpp\)", text)


def objects_of(overlay, build):
    """Compiles the sources that the recipes change or add. In a unity build, those of one library are
    compiled together; new sources are compiled like the others of their folder."""
    commands = compile_commands(build)
    neighbours = {os.path.dirname(source): command for source, command in commands.items()}
    groups = {}
    for name in changed_sources(overlay):
        source = str(overlay.root / name)
        if name in overlay.added and not is_built(overlay, name):
            raise Stale(f"{name}: a new source that the CMakeLists.txt of its folder does not build")
        if name not in overlay.added and source not in commands:
            raise Stale(f"{name}: no library has this source")
        command, grouped = commands.get(source) or neighbours[os.path.dirname(source)]
        library = re.search(r" -o (\S+\.dir)/", command)[1]
        groups.setdefault(library if grouped else name, (command, []))[1].append(name)
    return [compiled_object(overlay, build, command, names, number)
            for number, (command, names) in enumerate(groups.values())]


def compiled_object(overlay, build, command, names, number):
    group, target = overlay.folder / f"group{number}.cpp", overlay.folder / f"group{number}.o"
    group.write_text("".join(f'#include "{overlay.path_of(name)}"\n' for name in names), encoding="utf-8")
    words = shlex.split(command)
    words[words.index("-o") + 1] = str(target)
    words[words.index("-c") + 1] = str(group)
    words = ["-O1" if re.fullmatch("-O[23]", word) else word for word in words if word != "-fpch-preprocess"]
    at = words.index(f"-I{overlay.root}")
    run([*words[:at], f"-I{overlay.folder}", *words[at:]], cwd=build)
    return str(target)


def link_feeler(overlay, build, objects):
    """Links a feeler with the sources of the recipes, which come before the libraries."""
    feeler = overlay.folder / "bin" / "feeler"
    feeler.parent.mkdir()
    command = run(["ninja", "-C", str(build), "-t", "commands", "-s", "app/feeler"]).strip().splitlines()[-1]
    first = f"-Wl,--allow-multiple-definition -o {shlex.quote(str(feeler))} {shlex.join(objects)}"
    command = command.replace("-o app/feeler", first)
    run(command, cwd=build, shell=True)
    return feeler


# --- running --------------------------------------------------------------------------------------

def check_planted(overlay, feeler):
    """Each new program must have its finding, and its twin neither warnings nor errors."""
    for rule, dialect, program, line, setup, twin, twin_setup, option, twin_option in overlay.planted_rows:
        at = {(f["rule"], f["line"]) for f in findings_of(overlay, feeler, dialect, program, setup, option)}
        if (rule, int(line) or None) not in at:
            raise Stale(f"{program}: {rule} is not found in line {line}, but {sorted(map(str, at))}")
        loud = [f for f in findings_of(overlay, feeler, dialect, twin, twin_setup, twin_option) if f["severity"] != "note"]
        if loud:
            raise Stale(f"{twin}: {loud}")


def findings_of(overlay, feeler, dialect, program, setup, option):
    folder = overlay.folder / "tests" / "planted"
    words = [str(feeler), "check", str(folder / program), "--dialect", dialect, "--format", "json",
             "--setup", str(folder / "setups" / f"{setup}.toml"), *([] if option == "-" else [option])]
    done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode > 1:
        raise Stale(shlex.join(words) + "\n" + done.stderr)
    return json.loads(done.stdout)["findings"]


def check_consoles(overlay, feeler, consoles):
    with tempfile.TemporaryDirectory() as home:
        shell = tutorial.Shell(feeler, overlay.folder, home)
        for number, lines in consoles:
            for command, shown in tutorial.commands_of(lines):
                printed = shell.run(command)
                if not tutorial.matches(shown, printed):
                    raise Stale(f"docs/recipes.md:{number}: $ {command}\nprints\n" + "\n".join(printed)
                                + "\nthe recipe shows\n" + "\n".join(shown))


def carry_out(root, build):
    text = (root / "docs" / "recipes.md").read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        overlay = Overlay(root, pathlib.Path(folder).resolve())
        consoles = apply_recipes(text, overlay)
        feeler = link_feeler(overlay, build, objects_of(overlay, build))
        for page, *_ in documentation.DIALECT_LISTS:
            overlay.copy(f"docs/manual/{page}")
        overlay.complete_folders_of_tests()
        documentation.update_dialects(overlay.folder, str(feeler))
        check_planted(overlay, feeler)
        check_consoles(overlay, feeler, consoles)
        mistakes = documentation.unlisted(overlay.folder, str(feeler))
        if mistakes:
            raise Stale("\n".join(mistakes))


def self_check():
    """Self-check with edits that match and edits that do not."""
    text = "one\ntwo\nthree\ntwo\n"
    assert edited(text, [" one", "+one and a half", "...", "-three"]) == "one\none and a half\ntwo\ntwo\n"
    for wrong in (["+x", " two"], [" four"], [" one", " three"]):
        try:
            edited(text, wrong)
        except Stale:
            continue
        raise AssertionError(wrong)
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder) / "tree"
        root.mkdir()
        (root / "a.txt").write_text("one\n")
        overlay = Overlay(root, pathlib.Path(folder) / "overlay")
        recipe = "```diff a.txt\n one\n+two\n```\n```text b/c.txt\nnew\n```\n```\nleft alone\n```\n```console\n$ true\n```"
        assert apply_recipes(recipe, overlay) == [(11, ["$ true"])]
        assert (root / "a.txt").read_text() == "one\n"
        assert (overlay.folder / "a.txt").read_text() == "one\ntwo\n"
        assert (overlay.folder / "b" / "c.txt").read_text() == "new\n"
        for wrong in ("```diff z.txt\n one\n```", "```diff a.txt\n three\n```", "```text a.txt\nnew\n```"):
            try:
                apply_recipes(wrong, overlay)
            except Stale:
                continue
            raise AssertionError(wrong)


def main(arguments):
    if arguments == ["--self-check"]:
        self_check()
        return 0
    try:
        carry_out(pathlib.Path(arguments[0]).resolve(), pathlib.Path(arguments[1]).resolve())
    except Stale as stale:
        print(stale)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
