#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Cycles of 18 kernels of our own, written after GreenWaves' CNN benchmark, on board gap8 beside those that are published
of the benchmark on a GAPuino (cycles.json): a table in Markdown. Seven are fits, eight validations, three not comparable.

Usage: cycles.py BUILD [--check]

BUILD is a build folder. --check ends with 1 when forms of one kernel have other results, a fit is off by more than 5 %,
or a validation by more than 15 %. Needs riscv64-unknown-elf-gcc.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = pathlib.Path(__file__).parent
MOST_OFF = {"fit": 0.05, "validation": 0.15}
# Its filter lies elsewhere, as in the benchmark: it is another layer.
OTHER_FILTER = ("linear, vector", 8)


def measured(build):
    """Cycles and sum of the output of each row."""
    with tempfile.TemporaryDirectory() as out:
        program = pathlib.Path(out) / "cycles.elf"
        signature = pathlib.Path(out) / "signature"
        subprocess.run(["riscv64-unknown-elf-gcc", "-march=rv32imc_zicsr", "-mabi=ilp32", "-nostdlib", "-nostartfiles",
                        "-Wl,--build-id=none,-Ttext-segment=0x1C000000", HERE / "cycles.S", "-o", program], check=True)
        subprocess.run([build / "bin/mebots-soc", "run", program, "--board", ROOT / "configs/boards/gap8.json",
                        "--signature", signature], check=True, capture_output=True)
        words = [int(word, 16) for word in signature.read_text().split()]
    return list(zip(words[::2], words[1::2]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    data = json.loads((HERE / "cycles.json").read_text())
    runs = data["runs"]
    failures = []
    sums = {}
    found = measured(arguments.build)
    if len(found) != len(data["rows"]):
        raise SystemExit(f"{len(found)} rows measured, {len(data['rows'])} in cycles.json")
    print("| kernel | cores | a run on silicon | here | off | cycles less than silicon | use |\n|---|---|---|---|---|---|---|")
    for row, (cycles, total) in zip(data["rows"], found):
        name = f"{row['kernel']}, {row['cores']} cores"
        off = cycles / row["cycles"] - 1
        less = (row["cycles"] - cycles) / runs
        print(f"| {row['kernel']} | {row['cores']} | {row['cycles'] / runs:.0f} | {cycles / runs:.0f} | {off * 100:+.1f} % "
              f"| {less:.0f} | {row['use']} |")
        if abs(off) > MOST_OFF.get(row["use"], 1):
            failures.append(f"{name}: {off * 100:+.1f} % off silicon")
        kernel = row["kernel"].removesuffix(", vector")
        if (row["kernel"], row["cores"]) != OTHER_FILTER and sums.setdefault(kernel, total) != total:
            failures.append(f"{name}: another result than with its other forms")
    if arguments.check and failures:
        print("\n".join(failures), file=sys.stderr)
        raise SystemExit(1)


if __name__ == "__main__":
    main()
