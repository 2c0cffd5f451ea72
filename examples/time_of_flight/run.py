#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs a firmware that reads a time-of-flight sensor which exists only as an entry of board.json.

Usage: run.py [--build build/release] [--out BUILD/time_of_flight]
"""

import argparse
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
FIRMWARE = ROOT / "fmu_soc/firmware"
COMPILER = "riscv64-unknown-elf-gcc"
RUNTIME = ["crt0.S", "console.c", "exit.c", "memory.c", "sleep.c", "trap.c"]


def tool(*command):
    done = subprocess.run([str(part) for part in command], text=True, capture_output=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{command[0]} failed:\n{done.stdout}{done.stderr}")
    return done.stdout


def build(binaries, board, out):
    out.mkdir(parents=True, exist_ok=True)
    tool(binaries / "mebots-boardgen", board, "--c", out / "board.h", "--cpp", out / "board.hpp")
    tool(COMPILER, "-E", "-P", "-x", "assembler-with-cpp", "-include", out / "board.h", FIRMWARE / "runtime/link.ld.in",
         "-o", out / "link.ld")
    library = tool(COMPILER, "-march=rv32im", "-mabi=ilp32", "-print-libgcc-file-name").strip()
    compiled = []
    for source in [*(FIRMWARE / "runtime" / name for name in RUNTIME), HERE / "firmware/main.c"]:
        compiled.append(out / f"{source.name}.o")
        tool(COMPILER, "-march=rv32imc_zicsr", "-mabi=ilp32", "-mcmodel=medany", "-O2", "-g", "-ffreestanding", "-Wall",
             "-Wextra", "-Werror", f"-I{FIRMWARE}", f"-I{out}", "-c", source, "-o", compiled[-1])
    elf = out / "range.elf"
    tool(COMPILER, "-march=rv32imc", "-mabi=ilp32", "-nostdlib", "-T", out / "link.ld", *compiled, library, "-o", elf)
    return elf


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--out", type=pathlib.Path)
    arguments = parser.parse_args()
    out = arguments.out or arguments.build / "time_of_flight"
    binaries = arguments.build.resolve() / "bin"
    elf = build(binaries, HERE / "board.json", out)
    report = tool(binaries / "mebots-soc", "run", elf, "--board", HERE / "board.json")
    print(report, end="")
    distances = [line for line in report.splitlines() if line.startswith("distance")]
    if distances != ["distance 1250 mm"] * 5:
        sys.exit(f"expected five times the 1.25 m of board.json, got {distances}")


if __name__ == "__main__":
    main()
