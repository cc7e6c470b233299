#!/usr/bin/env python3
"""Places and routes parts of the circuit on an iCE40 HX8K with nextpnr, and prints their size and clock.

Usage: place.py SOURCE_DIRECTORY [--check] [UNIT...]

The inputs of a unit come from a shift register and its outputs go into one, so that no pins are needed; their
flip-flops are counted, and the paths from and to them count for the clock. Multipliers are built of LUTs, as this
part has none. Units with queues or caches are wider than all its memories, and an element does not fit.

With --check it fails if a unit is slower than its least clock below.
"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile

from cost import files_of

# The file of a unit, and its least clock in MHz; a placement differs from the next by some percent.
UNITS = {
    "offset_axis": ("path_unit", 55),
    "gap_axis": ("gap_unit", 65),
    "root_pipeline": ("gap_unit", 55),
    "squarer": ("gap_unit", 48),
    "search_limit": ("permit_unit", 38),
    "check_unit": ("check_unit", 80),
}


def run(*command):
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if result.returncode != 0:
        sys.exit(f"{command[0]}: {result.stdout[-2000:]}")
    return result.stdout


def ports_of(files, unit, folder):
    """(port, direction, width) of a unit with its usual parameters."""
    run("yosys", "-q", "-p", f"read_verilog -sv {files}; hierarchy -top {unit}; proc; write_json {folder}/ports.json")
    modules = json.loads(pathlib.Path(folder, "ports.json").read_text(encoding="utf-8"))["modules"]
    (top,) = (m for m in modules.values() if "top" in m["attributes"])
    return [(name, port["direction"], len(port["bits"])) for name, port in top["ports"].items()]


def wrapper(unit, ports):
    """The unit between two shift registers, and their length."""
    inputs = [(name, width) for name, direction, width in ports if direction == "input" and name != "clk"]
    outputs = [(name, width) for name, direction, width in ports if direction == "output"]
    wires, used = [f".{name}({name})" for name, _, _ in ports if name == "clk"], {"input": 1, "output": 0}
    for kind, group in (("input", inputs), ("output", outputs)):
        for name, width in group:
            wires.append(f".{name}({kind}s[{used[kind] + width - 1}:{used[kind]}])")
            used[kind] += width
    return f"""module placed(input clk, input in, output out);
  reg [{used['input'] - 1}:0] inputs;
  wire [{used['output'] - 1}:0] outputs;
  reg [{used['output'] - 1}:0] kept;
  always @(posedge clk) inputs <= {{inputs, in}};
  always @(posedge clk) kept <= inputs[0] ? outputs : kept << 1;
  assign out = kept[{used['output'] - 1}];
  {unit} placed_unit ({', '.join(wires)});
endmodule
""", used["input"] + used["output"]


def placed(source, unit):
    """Cells, those of the shift registers, clock in MHz."""
    files = " ".join(files_of(source, UNITS[unit][0]))
    with tempfile.TemporaryDirectory() as folder:
        text, ends = wrapper(unit, ports_of(files, unit, folder))
        pathlib.Path(folder, "placed.sv").write_text(text, encoding="utf-8")
        run("yosys", "-q", "-p", f"read_verilog -sv {files} {folder}/placed.sv; synth_ice40 -top placed -json {folder}/placed.json")
        log = run("nextpnr-ice40", "--hx8k", "--package", "ct256", "--json", f"{folder}/placed.json", "--pcf-allow-unconstrained",
                  "--seed", "1", "--freq", "100", "--timing-allow-fail")
    cells = re.search(r"ICESTORM_LC:\s+(\d+)/", log)[1]
    return int(cells), ends, float(re.findall(r"Max frequency for clock.*: ([\d.]+) MHz", log)[-1])


def main(source, *arguments):
    print("| unit on iCE40 HX8K | cells | of them shift registers | clock, MHz |")
    print("|---|---|---|---|")
    slow = []
    for unit in [a for a in arguments if not a.startswith("--")] or UNITS:
        cells, ends, clock = placed(source, unit)
        print(f"| `{unit}` | {cells:,} | {ends:,} | {clock:.0f} |", flush=True)
        if clock < UNITS[unit][1]:
            slow.append(f"{unit}: {clock:.0f} MHz is less than {UNITS[unit][1]}")
    if "--check" in arguments and slow:
        sys.exit("\n".join(slow))


if __name__ == "__main__":
    main(*sys.argv[1:])
