#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the micro programs of tests/soc/rtl on a core of the cluster, in mebots-soc and in GVSoC. Prints the cycles per iteration
of the programs whose cycles differ.

Usage: micro.py BUILD

The cycles of an iteration are derived from the difference between 64 and 32 iterations. This excludes one-time costs: filling
instruction caches, and the code around the loop. A test (soc_rtl_test) compares the cycles of mebots-soc with the RTL's. gvsoc.py
states how GVSoC is found.
"""
import csv
import pathlib
import subprocess
import sys
import tempfile

import gvsoc

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = pathlib.Path(__file__).parent
RTL = ROOT / "tests/soc/rtl"
MCYCLE = "0xb00"
TURNS = 32, 64


def compiled(turns, folder):
    program = folder / f"micro{turns}.elf"
    subprocess.run([gvsoc.compiler(), "-DRI5CY", f"-DCYC={MCYCLE}", f"-DINS={MCYCLE}", f"-DL={turns}",
                    "-march=rv32imc_zicsr", "-mabi=ilp32", "-nostdlib", "-nostartfiles", f"-I{HERE}", "-T", HERE / "link.ld",
                    "-Wl,--no-warn-rwx-segments,--build-id=none", HERE / "micro.S", RTL / "micro.S", "-o", program], check=True)
    return program


def noted(simulator, done, folder):
    """Returns the cycles of each micro program, in the order of the programs."""
    count, *words = gvsoc.words_left_by(simulator, done, folder)
    return words[1::16][:count]


def main():
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    gvsoc.peer()
    soc = gvsoc.built(pathlib.Path(sys.argv[1]), "mebots-soc")
    ours, its = [], []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for turns in TURNS:
            program = compiled(turns, folder)
            command = [soc, "run", program, "--board", ROOT / "configs/boards/gap8.json", "--host-files", folder]
            ours.append(noted("mebots-soc", gvsoc.processor_time(command, folder), folder))
            its.append(noted("GVSoC", gvsoc.run(program, folder), folder))
    with open(RTL / "micro.csv", newline="") as file:
        names = [row["name"] for row in csv.DictReader(file) if row["ri32_cycles"]]
    if {len(names)} != {len(each) for each in ours + its}:
        raise SystemExit(f"{[len(each) for each in ours + its]} micro programs ran, {len(names)} are in micro.csv")
    more = TURNS[1] - TURNS[0]
    turns = [[(after - before) / more for before, after in zip(*one)] for one in (ours, its)]
    rows = list(zip(names, *turns))
    differ = [row for row in rows if row[1] != row[2]]
    print("| a turn of | cycles here | in GVSoC |\n|---|---|---|")
    for name, mine, theirs in differ:
        print(f"| {name} | {mine:g} | {theirs:g} |")
    print(f"\n{len(rows) - len(differ)} of {len(rows)} micro programs take the same cycles.")


if __name__ == "__main__":
    main()
