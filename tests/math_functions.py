#!/usr/bin/env python3
"""Finds functions of the C library that differ from system to system, such as std::sin, where core::sin of
core/base/math.h belongs: results must have the same bits everywhere.

    math_functions.py ROOT            checks the tree at ROOT; prints each line found, exits with 1 if there is one
    math_functions.py ROOT PROGRAM    also checks which functions the program takes from the C library
    math_functions.py --self-check    checks this script against a small tree with known lines
"""
import pathlib
import re
import subprocess
import sys
import tempfile

NAMES = ("a?(sin|cos|tan)h?", "atan2", "hypot", "pow", "exp2?", "expm1", "log(2|10|1p)?", "cbrt", "erfc?", "[lt]gamma", "fma", "l?l?round")
CALL = re.compile(r"(?:\bstd::|\bglm::|(?<![\w:.>]))(?:" + "|".join(NAMES) + r")[fl]?\s*\(")
TURNS = re.compile(r"\bglm::(rotate|angleAxis|slerp|perspective\w*|eulerAngle\w*|polar|euclidean)\b")
COMMENT = re.compile(r"//.*|\"(?:[^\"\\]|\\.)*\"")
FOLDERS = ("app", "core", "gcode", "hwsim", "render")
# Shaders only draw.
OWN = ("core/base/math.h", "render/shaders.cpp")
# Functions that calls of other names become, such as std::abs of a complex number. ImGui uses log and pow to draw.
IMPORTS = re.compile(r" U ((?:cabs|carg|cexp|cpow|fma|a?(?:sin|cos|tan)h?|sincos|atan2|hypot|exp2?|log(?:2|10)|l?l?round|__divdc3)\b\S*)")


def found_in(root):
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            name = path.relative_to(root).as_posix()
            if path.suffix not in (".cpp", ".h") or name in OWN or name.startswith("core/base/libm/"):
                continue
            for number, line in enumerate(path.read_text().splitlines(), 1):
                code = COMMENT.sub("", line)
                if CALL.search(code) or TURNS.search(code):
                    yield f"{name}:{number}: {line.strip()}"


def imported(program):
    symbols = subprocess.run(["nm", "-D", "--undefined-only", program], capture_output=True, text=True, check=True)
    for name in IMPORTS.findall(symbols.stdout):
        yield f"{program} calls {name}"


def self_check():
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name in FOLDERS:
            (root / name).mkdir()
        (root / "core/a.cpp").write_text(
            "x = std::sin(y);\nx = core::sin(y);\n// std::cos(y)\nx = atan2(y, x);\nx = a.exp(y);\n"
            "x = glm::rotate(m, a);\nx = sin_cos(y);\nx = std::sqrt(y);\nx = powf(y, 2);\nx = \"tan(y)\";\nx = std::fma(x, y, z);\n"
            "x = std::lround(y);\nx = core::round(y);\n")
        numbers = [int(line.split(":")[1]) for line in found_in(root)]
        assert numbers == [1, 4, 6, 9, 11, 12], numbers
        assert IMPORTS.findall("                 U cabs@GLIBC_2.2.5\n   U sincosf@GLIBC_2\n   U fmaf@G\n") == \
            ["cabs@GLIBC_2.2.5"]
    print("the self-check passes")


def main():
    if sys.argv[1:] == ["--self-check"]:
        return self_check()
    arguments = sys.argv[1:]
    # The circuit of the coprocessor calls it, in what Verilator adds; nothing is computed by it.
    of_verilator = "exp2" if "--with-circuit" in arguments else None
    arguments = [argument for argument in arguments if argument != "--with-circuit"]
    lines = list(found_in(pathlib.Path(arguments[0])))
    for program in arguments[1:]:
        lines += (line for line in imported(program) if not of_verilator or f" calls {of_verilator}@" not in line)
    for line in lines:
        print(line)
    return 1 if lines else 0


if __name__ == "__main__":
    sys.exit(main())
