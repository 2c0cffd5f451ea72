#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the instruction log of mebots-soc with Spike's, line by line.

Usage: spike_trace.py PROGRAM.elf [--tool build/release/bin/mebots-soc] [--spike spike] [--keep FOLDER]

Runs the program in both. Removes Spike's boot code and everything after the store to tohost. Omits items that only Spike logs:
the value of mstatus after mret, the registers mstatush and tcontrol, reads of counters that count cycles. Prints the number of
compared lines. If a line differs, prints it, and the exit code is 1.
"""

import argparse
import itertools
import pathlib
import re
import subprocess
import sys
import tempfile

ONLY_SPIKE = re.compile(r" c(?:784_mstatush|1957_tcontrol|768_mstatus) 0x[0-9a-f]+")


def symbols(program):
    listing = subprocess.run(["riscv64-unknown-elf-nm", program], check=True, capture_output=True, text=True).stdout
    return {name: int(address, 16) for address, _, name in (line.split() for line in listing.splitlines() if len(line.split()) == 3)}


def lines(path, tohost, first_pc=None):
    """Yields the lines of a log from the instruction at `first_pc` up to the store to tohost."""
    started = first_pc is None
    with path.open() as file:
        for line in file:
            if not line.startswith("core"):
                continue
            fields = line.split()
            if len(fields) < 5 or fields[2] != "3":
                continue
            started = started or int(fields[3], 16) == first_pc
            if not started:
                continue
            yield ONLY_SPIKE.sub("", line.split(" # ")[0].rstrip())
            if tohost is not None and re.search(rf"mem 0x{tohost:08x} 0x0*[1-9a-f]", line):
                return


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--tool", default="build/release/bin/mebots-soc")
    parser.add_argument("--spike", default="spike")
    parser.add_argument("--isa", default="rv32imc_zicsr_zifencei_zicntr_zihpm_zicclsm")
    parser.add_argument("--max-instructions", type=int, default=100000)
    parser.add_argument("--keep", type=pathlib.Path, help="folder for the two logs")
    arguments = parser.parse_args()

    table = symbols(arguments.program)
    header = arguments.program.read_bytes()[:52]
    entry = int.from_bytes(header[24:28], "little")
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.keep or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        ours, theirs = folder / "mebots.log", folder / "spike.log"
        subprocess.run([arguments.tool, "run", "--core", "rv32imc", arguments.program, "--trace", ours,
                        "--max-instructions", str(arguments.max_instructions)], check=False, stdout=subprocess.DEVNULL)
        base = entry & ~0xFFF
        subprocess.run(["timeout", "20", arguments.spike, f"--isa={arguments.isa}", "--priv=m", f"-m0x{base:x}:0x400000",
                        "--log-commits", f"--log={theirs}", arguments.program], check=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        count = 0
        tohost = table.get("tohost")
        # mebots stops after max_instructions. Spike's log is cut off there, because Spike has no limit that works with
        # traps.
        expected = itertools.islice(lines(theirs, tohost, entry), arguments.max_instructions)
        for a, b in itertools.zip_longest(lines(ours, tohost), expected):
            if a != b:
                sys.exit(f"line {count + 1} differs\n  mebots: {a}\n  spike:  {b}")
            count += 1
    print(f"{arguments.program}: {count} lines the same")
    if count == 0:
        sys.exit("nothing was compared")


if __name__ == "__main__":
    main()
