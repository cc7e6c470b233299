#!/usr/bin/env python3
"""Checks the documentation: every relative link and #anchor in every *.md resolves, every source that a
page names and every type in the glossary exists, and the pages that must stay short are short.

    documentation.py ROOT           checks the tree at ROOT; prints each mistake, exits with 1 if there is one
    documentation.py ROOT FEELER    checks that the manual lists every subcommand, option, rule and dialect of the program
    documentation.py ROOT FEELER --update    first writes severity, meaning and cure of each rule, and the lists of
                                             dialects, into the manual
    documentation.py --installed FOLDER      checks the links in an installed tree
    documentation.py --install BUILD         installs a build into a temporary folder and checks the links there
    documentation.py --self-check   checks this script against a small tree with known mistakes
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import urllib.parse

SKIPPED_FOLDERS = {".git", "build", "node_modules", ".feeler", "__pycache__"}
MAX_LINES = {"README.md": 150, "app/README.md": 40}
MAX_BYTES = {"docs/architecture.md": 8 * 1024}

FENCE = re.compile(r"^ {0,3}(`{3,}|~{3,})")
HEADING = re.compile(r"^ {0,3}#{1,6}\s+(.*?)\s*#*\s*$")
HTML_ANCHOR = re.compile(r"""<[a-zA-Z][^>]*\b(?:id|name)\s*=\s*["']([^"']+)["']""")
INLINE_CODE = re.compile(r"(`+)(?:.*?)\1")
LINK = re.compile(r"\[(?:[^\[\]]|\[[^\]]*\])*\]\(\s*(<[^>]*>|[^()\s]*(?:\([^()]*\)[^()\s]*)*)"
                  r"""(?:\s+(?:"[^"]*"|'[^']*'))?\s*\)""")
DEFINITION = re.compile(r"^ {0,3}\[[^\]]+\]:\s*(<[^>]*>|\S+)")
SOURCE_NAME = re.compile(r"`([a-z][\w./-]*\.(?:h|cpp))`")
TYPE = re.compile(r"\b(?:struct|class|enum class|using) (\w+)(?= final\b| :|:| \{|;| =)")
HTML_SOURCE = re.compile(r"""<(?:img|a)\b[^>]*\b(?:src|href)\s*=\s*["']([^"']+)["']""")
EXTERNAL = re.compile(r"^[a-zA-Z][a-zA-Z0-9+.-]*:")


def prose_lines(text):
    """Line numbers and lines of a page without fenced blocks; or indented blocks."""
    fence = None
    after_blank = True
    in_block = False
    in_list = False
    for number, line in enumerate(text.splitlines(), 1):
        opening = FENCE.match(line)
        if fence:
            if opening and opening.group(1)[0] == fence[0] and len(opening.group(1)) >= len(fence):
                fence = None
            continue
        if opening:
            fence = opening.group(1)
            continue
        if re.match(r"^ {0,3}([-*+]|\d+[.)])\s", line):
            in_list = True
        elif line.strip() and not line.startswith(" "):
            in_list = False
        in_block = line.startswith("    ") and (after_blank or in_block) and not in_list
        after_blank = not line.strip()
        if not in_block:
            yield number, line


def slug(heading):
    """The anchor that GitHub generates for a heading."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading.replace("`", ""))
    text = re.sub(r"<[^>]*>", "", text)
    return re.sub(r"[^\w\- ]", "", text.strip().lower()).replace(" ", "-")


def anchors(text):
    found = set()
    for _, line in prose_lines(text):
        found.update(HTML_ANCHOR.findall(INLINE_CODE.sub("", line)))
        heading = HEADING.match(line)
        if heading:
            name = slug(heading.group(1))
            unique, count = name, 0
            while unique in found:
                count += 1
                unique = f"{name}-{count}"
            found.add(unique)
    return found


def links(text):
    for number, line in prose_lines(text):
        plain = INLINE_CODE.sub(lambda code: "`" * len(code.group()), line)
        for pattern in (LINK, DEFINITION, HTML_SOURCE):
            for target in pattern.findall(plain):
                yield number, target.strip("<>")


def unknown_sources(text, sources):
    """Line numbers and names of C++ files that do not exist in the tree."""
    for number, line in prose_lines(text):
        for name in SOURCE_NAME.findall(line):
            if not any(f"/{source}".endswith(f"/{name}") for source in sources):
                yield number, name


def sources_of(root):
    return [file.relative_to(root).as_posix() for ending in ("*.h", "*.cpp") for file in root.rglob(ending)
            if not SKIPPED_FOLDERS.intersection(file.relative_to(root).parts)]


def unknown_types(root, sources):
    """Types in the last column of the glossary that no header declares."""
    glossary = root / "docs" / "glossary.md"
    if not glossary.exists():
        return
    declared = set()
    for name in sources:
        if name.endswith(".h"):
            declared.update(TYPE.findall((root / name).read_text(encoding="utf-8")))
    for number, line in prose_lines(glossary.read_text(encoding="utf-8")):
        last = line.rstrip("| ").rpartition("|")[2] if line.startswith("|") else ""
        for name in re.findall(r"`(\w+)(?:::\w+)?`", last):
            if name not in declared:
                yield number, name


def pages_of(root):
    for page in sorted(root.rglob("*.md")):
        if not SKIPPED_FOLDERS.intersection(page.relative_to(root).parts):
            yield page


def mistake_of(root, page, target, anchors_of):
    if not target:
        return "an empty link"
    if EXTERNAL.match(target) or target.startswith("//"):
        return None
    path, _, anchor = target.partition("#")
    path = urllib.parse.unquote(path)
    if path.startswith("/"):
        return f"{target}: write a path relative to this page"
    file = (page.parent / path).resolve() if path else page
    if not file.exists():
        return f"{target}: there is no such file"
    if not file.is_relative_to(root):
        return f"{target}: leads out of the repository"
    if anchor and file.suffix == ".md" and urllib.parse.unquote(anchor) not in anchors_of(file):
        return f"{target}: {file.relative_to(root)} has no heading #{anchor}"
    return None


def wrong_links(root):
    known = {}

    def anchors_of(file):
        if file not in known:
            known[file] = anchors(file.read_text(encoding="utf-8"))
        return known[file]

    found = []
    for page in pages_of(root):
        name = page.relative_to(root).as_posix()
        for number, target in links(page.read_text(encoding="utf-8")):
            mistake = mistake_of(root, page, target, anchors_of)
            if mistake:
                found.append(f"{name}:{number}: {mistake}")
    return found


def wrong_links_installed(build):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["cmake", "--install", build, "--prefix", folder], stdout=subprocess.DEVNULL, check=True)
        return wrong_links(pathlib.Path(folder).resolve())


def mistakes(root):
    found, sources = wrong_links(root), sources_of(root)
    for page in pages_of(root):
        name = page.relative_to(root).as_posix()
        text = page.read_text(encoding="utf-8")
        for number, source in unknown_sources(text, sources):
            found.append(f"{name}:{number}: there is no {source}")
        if name in MAX_LINES and len(text.splitlines()) > MAX_LINES[name]:
            found.append(f"{name}: {len(text.splitlines())} lines; at most {MAX_LINES[name]} are allowed")
        if name in MAX_BYTES and len(text.encode()) > MAX_BYTES[name]:
            found.append(f"{name}: {len(text.encode())} bytes; at most {MAX_BYTES[name]} are allowed")
    found += [f"docs/glossary.md:{number}: no header declares {name}" for number, name in unknown_types(root, sources)]
    return found


def section_of(text, heading):
    """The lines below a heading of the second level."""
    parts = re.split(rf"^## {re.escape(heading)}$", text, flags=re.M)
    return re.split(r"^## ", parts[1], flags=re.M)[0] if len(parts) > 1 else ""


def undocumented_arguments(help_text, section):
    """Positional arguments in the help of a subcommand that the synopsis, in capitals, lacks.

    An argument with a choice of words may stand there as one of them."""
    synopsis = re.search(r"^    feeler .*$", section, flags=re.M)
    words = set(re.findall(r"\w+", synopsis.group())) if synopsis else set()
    for name, choices in re.findall(r"^  (\w+) TEXT(?::\{(.*?)\})?", help_text, flags=re.M):
        if not words.intersection({name.upper(), *choices.split(",")}):
            yield name.upper()


def undocumented(root, feeler):
    """Subcommands and options that --help lists and the command reference does not."""
    def help_of(*arguments):
        return subprocess.run([feeler, *arguments, "--help"], capture_output=True, text=True, check=True).stdout

    text = (root / "docs" / "manual" / "commands.md").read_text(encoding="utf-8")
    shared = "--help" + section_of(text, "Options for reading a program") + section_of(text, "Options for a check")
    found = []
    commands = re.findall(r"^  ([a-z]+) ", help_of().split("Subcommands:")[1], flags=re.M)
    for command in commands:
        own = section_of(text, command)
        if not own:
            found.append(f"docs/manual/commands.md: nothing about feeler {command}")
        text_of_help = help_of(command)
        for name in undocumented_arguments(text_of_help, own):
            found.append(f"docs/manual/commands.md: feeler {command} takes {name}, which its synopsis lacks")
        for names in re.findall(r"^  (-[^ ]+)", text_of_help, flags=re.M):
            if not any(re.search(rf"(?<![\w-]){name}(?![\w-])", own + shared) for name in names.split(",")):
                found.append(f"docs/manual/commands.md: feeler {command} has {names}, which is not listed")
    return found


RULE_ROW = re.compile(r"^\| `([a-z-]+)` \| .*\|$", flags=re.M)


def cell(sentence):
    """A sentence of the table of rules as a cell of the manual: no full stop, lower-case first letter."""
    text = sentence.removesuffix(".")
    return text[0].lower() + text[1:] if re.match(r"A |[A-Z][a-z]", text) else text


def rule_rows(root, feeler):
    """The rows that docs/manual/rules.md should have, by rule."""
    program = root / "assets" / "programs" / "clamped_plate.nc"
    sarif = subprocess.run([feeler, "check", str(program), "--format", "sarif"], capture_output=True, text=True,
                           check=False).stdout
    return {rule["id"]: f"| `{rule['id']}` | {rule['defaultConfiguration']['level']} | "
                        f"{cell(rule['shortDescription']['text'])} | {cell(rule['help']['text'])} |"
            for rule in json.loads(sarif)["runs"][0]["tool"]["driver"]["rules"]}


def undocumented_rules(root, feeler):
    """Rules in SARIF that the manual lacks or describes differently."""
    text = (root / "docs" / "manual" / "rules.md").read_text(encoding="utf-8")
    return [f"docs/manual/rules.md: missing: {row}" for row in rule_rows(root, feeler).values()
            if row not in text.splitlines()]


def update_rules(root, feeler):
    """Writes the rows into the manual; a new row goes below that of the preceding rule."""
    page = root / "docs" / "manual" / "rules.md"
    rows = rule_rows(root, feeler)
    text = RULE_ROW.sub(lambda old: rows.get(old[1], old[0]), page.read_text(encoding="utf-8"))
    before = None
    for row in rows.values():
        if row not in text.splitlines():
            text = text.replace(before, before + "\n" + row)
        before = row
    page.write_text(text, encoding="utf-8")


# Lists of dialects in sentences of the manual: page, text before and after the list, word before the last name.
DIALECT_LISTS = (("commands.md", "language of the control: ", ". Otherwise", " or "),
                 ("set-up-file.md", "| `dialect` | ", "; otherwise", ", "))


def dialects_of(feeler):
    text = subprocess.run([feeler, "check", "--help"], capture_output=True, text=True, check=True).stdout
    return re.search(r"--dialect [A-Z]+:\{([^}]+)\}", text)[1].split(",")


def dialect_list(names, around):
    before, after, last = around
    quoted = [f"`{name}`" for name in names]
    return before + ", ".join(quoted[:-1]) + last + quoted[-1] + after


def undocumented_dialects(root, feeler):
    """Pages whose list of dialects differs from the program's, and dialects without a row in the table."""
    names, found = dialects_of(feeler), []
    for page, *around in DIALECT_LISTS:
        text = (root / "docs" / "manual" / page).read_text(encoding="utf-8")
        if dialect_list(names, around) not in text:
            found.append(f"docs/manual/{page}: the list of dialects is not {', '.join(names)}")
    table = (root / "docs" / "manual" / "controls-and-dialects.md").read_text(encoding="utf-8")
    return found + [f"docs/manual/controls-and-dialects.md: the table has no row for {name}" for name in names
                    if not re.search(rf"^\| `{name}` \| \w[^|]*\| \w[^|]*\|$", table, flags=re.M)]


def update_dialects(root, feeler):
    """Writes the lists of dialects; a row in the table of dialects needs an author."""
    listed = dialects_of(feeler)
    for name, *around in DIALECT_LISTS:
        page = root / "docs" / "manual" / name
        old = f"{re.escape(around[0])}`[^.;]*`{re.escape(around[1])}"
        text = re.sub(old, dialect_list(listed, around), page.read_text(encoding="utf-8"))
        page.write_text(text, encoding="utf-8")


def self_check():
    """Runs the check over a small tree; each line with a mistake must be reported, and no other."""
    readme = "\n".join([
        "# The first `page`",
        "[right](docs/a.md) [right](docs/a.md#two-words) [right](#the-first-page) <http://x.invalid>",
        "[right](docs/a.md#two-words-1) ![right](docs/p.png) `[no](link.md)` [web](https://x.invalid/#a)",
        "[wrong](docs/b.md)",
        "[wrong](docs/a.md#three-words)",
        "[wrong](#second-page)",
        "![wrong](docs/q.png)",
        "[ref]: docs/c.md",
        "<img src=\"docs/r.png\">",
        "```", "[no](link.md)", "```",
        "", "    [no](link.md)", "",
        "[wrong](/docs/a.md)", "[wrong](../outside.md)",
        "`a.h` and `docs/a.h` are there", "`s/a.h` is not"])
    long_readme = readme + "\n" * 150 + "end"
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder).resolve() / "tree"
        (root / "docs").mkdir(parents=True)
        (root / "build").mkdir()
        (root / "build" / "skipped.md").write_text("[no](link.md)")
        (root.parent / "outside.md").write_text("")
        (root / "docs" / "a.md").write_text("## Two words\n\n[up](../README.md)\n\n## Two words\n")
        (root / "docs" / "p.png").write_bytes(b"")
        (root / "docs" / "a.h").write_text("struct Body {\n};\n")
        (root / "docs" / "glossary.md").write_text("| a | `b` | `Body`, `Body::part` |\n| b | c | |\n| c | d | `Bodies` |\n")
        (root / "README.md").write_text(readme)
        lines = [int(m.split(":")[1]) for m in mistakes(root)]
        assert sorted(lines) == [3, 4, 5, 6, 7, 8, 9, 16, 17, 19], mistakes(root)
        (root / "README.md").write_text(long_readme)
        (root / "docs" / "architecture.md").write_text("x" * 8193)
        lengths = [m for m in mistakes(root) if "allowed" in m]
        assert len(lengths) == 2, lengths


def unlisted(root, feeler):
    """Whatever the program has and the manual lacks."""
    return undocumented(root, feeler) + undocumented_rules(root, feeler) + undocumented_dialects(root, feeler)


def main(arguments):
    if arguments == ["--self-check"]:
        self_check()
        return 0
    if arguments[:1] == ["--installed"]:
        found = wrong_links(pathlib.Path(arguments[1]).resolve())
    elif arguments[:1] == ["--install"]:
        found = wrong_links_installed(arguments[1])
    else:
        root = pathlib.Path(arguments[0] if arguments else ".").resolve()
        if arguments[2:] == ["--update"]:
            update_rules(root, arguments[1])
            update_dialects(root, arguments[1])
        found = unlisted(root, arguments[1]) if len(arguments) > 1 else mistakes(root)
    for mistake in found:
        print(mistake)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
