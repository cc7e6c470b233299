#!/usr/bin/env python3
"""Proves by induction, with yosys, what permit_proof.sv states about the permit unit of the circuit.

Usage: permit_proof.py SOURCE_DIRECTORY [CIRCUIT_DIRECTORY]

The unit has one element of two threads and a FIFO of two entries. What a slot holds is left open, and so is all that
depends on outputs without a statement about them; so the proof covers any contents of the slots.
"""

import pathlib
import subprocess
import sys

SIZE = {"ELEMENTS": 1, "THREADS": 2, "FIFO_DEPTH": 2}
WITHOUT_STATEMENT = ("found", "found_sequence", "query", "longest", "missed", "least_slack", "retired", "stop_sequence",
                     "stop_line")


def main(source, circuit=None):
    circuit, proof = circuit or pathlib.Path(source, "hwsim/rtl"), pathlib.Path(source, "tests/hwsim/rtl")
    outputs = " ".join(f"permit_unit/o:{name}" for name in WITHOUT_STATEMENT)
    commands = "; ".join((
        f"read_verilog -formal -sv -DPROOF -I{proof} {circuit}/device.sv {circuit}/permit_unit.sv",
        "chparam " + " ".join(f"-set {name} {value}" for name, value in SIZE.items()) + " permit_unit",
        "hierarchy -top permit_unit; proc",
        "cutpoint permit_unit/w:work_model permit_unit/w:tool_model",
        f"delete -port {outputs}",
        "flatten; opt_clean; memory -nomap; memory_map; opt -full; chformal -assume -early; clean",
        "select -assert-min 16 t:$assert",
        "sat -verify -prove-asserts -set-assumes -tempinduct -maxsteps 8",
    ))
    result = subprocess.run(["yosys", "-p", commands], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if result.returncode != 0 or "Induction step proven: SUCCESS!" not in result.stdout:
        sys.exit(f"not proven: {result.stdout[-2000:]}")
    print("proven")


if __name__ == "__main__":
    main(*sys.argv[1:])
