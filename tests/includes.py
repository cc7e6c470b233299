#!/usr/bin/env python3
"""Checks how much each source reads: at most 60 headers of the project, included directly or through
others, in chains of at most 16 files.

    includes.py ROOT            checks the tree at ROOT; prints each mistake, exits with 1 if there is one
    includes.py --self-check    checks this script against a small tree with known mistakes
"""
import pathlib
import re
import sys
import tempfile

FOLDERS = ["app", "core", "gcode", "hwsim", "render", "tests"]
MAX_HEADERS = 60
MAX_CHAIN = 16

INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)


def includes_of(root):
    """The headers of the project that each header and source includes itself."""
    texts = {str(path.relative_to(root)): path.read_text(encoding="utf-8")
             for folder in FOLDERS for path in sorted((root / folder).rglob("*"))
             if path.suffix in (".h", ".cpp")}
    return {file: [name for name in INCLUDE.findall(text) if name in texts] for file, text in texts.items()}


def headers_of(file, includes, without=None):
    """All headers that a file includes, but for those that come only through `without`."""
    found, waiting = set(), [file]
    while waiting:
        new = set(includes[waiting.pop()]) - found - {without}
        found |= new
        waiting += new
    return found


def longest_chain(file, includes, known, above=()):
    """The longest chain of files that begins here; a file that includes itself ends it."""
    if file not in known:
        chains = [longest_chain(name, includes, known, above + (file,))
                  for name in includes[file] if name not in above + (file,)]
        known[file] = [file] + max(chains, key=len, default=[])
    return known[file]


def mistakes(root):
    includes = includes_of(root)
    found, known = [], {}
    for file in includes:
        headers = headers_of(file, includes)
        if file.endswith(".cpp") and len(headers) > MAX_HEADERS:
            alone = {name: len(headers) - len(headers_of(file, includes, name)) for name in includes[file]}
            most = sorted(alone.items(), key=lambda item: -item[1])[:5]
            found.append(f"{file}: includes {len(headers)} headers, at most {MAX_HEADERS} are allowed. So many come "
                         "through one include alone: " + ", ".join(f"{count} {name}" for name, count in most))
        chain = longest_chain(file, includes, known)
        if len(chain) > MAX_CHAIN and file.endswith(".cpp"):
            found.append(f"{file}: includes a chain of {len(chain)} files, at most {MAX_CHAIN} are allowed: "
                         + " -> ".join(chain))
    return found


def self_check():
    """Runs the check over a small tree: sources at a limit are right, those beyond it are reported."""
    def text(names):
        return "#include <vector>\n" + "".join(f'#include "core/{name}.h"\n' for name in names)

    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        (root / "core").mkdir()
        for i in range(MAX_HEADERS):
            (root / f"core/wide{i}.h").write_text("")
        for i in range(MAX_CHAIN):
            (root / f"core/deep{i}.h").write_text(text([f"deep{i - 1}"] if i > 0 else []))
        wide = [f"wide{i}" for i in range(MAX_HEADERS)]
        (root / "core/all.h").write_text(text(wide))
        (root / "core/wide.cpp").write_text(text(wide))
        (root / "core/wider.cpp").write_text(text(["wide0", "all"]))
        (root / "core/deep.cpp").write_text(text([f"deep{MAX_CHAIN - 2}"]))
        (root / "core/deeper.cpp").write_text(text([f"deep{MAX_CHAIN - 1}"]))
        found = mistakes(root)
    assert [mistake.split(":")[0] for mistake in found] == ["core/deeper.cpp", "core/wider.cpp"], found
    assert "17 files" in found[0] and "61 headers" in found[1] and "60 core/all.h" in found[1], found


def main(arguments):
    if arguments == ["--self-check"]:
        self_check()
        return 0
    found = mistakes(pathlib.Path(arguments[0] if arguments else ".").resolve())
    for mistake in found:
        print(mistake)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
