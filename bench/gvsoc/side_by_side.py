#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Programs on mebots-soc and on GVSoC (target pulp-open), the same ELF on both: a table in Markdown.

Usage: side_by_side.py BUILD [--hello ELF] [--coremark CHECKOUT] [--repeats N]

BUILD is a build folder; GVSoC is found as bench/gvsoc/gvsoc.py says. Programs of bench/soc and CoreMark run on one core of
the cluster, with code in L2 behind the instruction cache and data in L1, hello on the fabric controller of board
pulp_open. Processor time is that of the whole process, the least of the repeats, which take turns. It ends with 1 when
results differ. Needs riscv64-unknown-elf-gcc and picolibc.
"""
import argparse
import pathlib
import struct
import subprocess
import sys
import tempfile

import gvsoc

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = pathlib.Path(__file__).parent
sys.path.insert(0, str(ROOT / "bench/soc"))

import embench  # noqa: E402

TURNS = {"convolution": 40, "mixed": 3000}
COREMARK_TURNS = 60


def compiled(name, sources, options, folder):
    program = folder / f"{name}.elf"
    subprocess.run(["riscv64-unknown-elf-gcc", "-O2", "-march=rv32imc", "-mabi=ilp32", "-mcmodel=medany",
                    "--specs=picolibc.specs", "-nostartfiles", "-w", "-Wl,--no-warn-rwx-segments,--build-id=none",
                    f"-I{HERE}", *options, "-T", HERE / "link.ld", HERE / "start.S", *sources, "-lm", "-o", program],
                   check=True)
    return program


def programs(options, folder):
    """Name, ELF and board of each."""
    if options.hello:
        yield "pulp-open's hello", options.hello.resolve(), "pulp_open"
    for name, turns in TURNS.items():
        source = ROOT / f"bench/soc/programs/{name}.c"
        yield f"{name} of bench/soc", compiled(name, [source], [f"-DTURNS={turns}", "-ffreestanding"], folder), "gap8"
    if options.coremark:
        sources, flags = embench.coremark_program(options.coremark.resolve())(COREMARK_TURNS)
        yield f"CoreMark, {COREMARK_TURNS} turns", compiled("coremark", sources, flags, folder), "gap8"


def outcome(simulator, name, done, folder):
    """(what it computed or printed, cycles or None, processor time) of a run."""
    text, code, seconds = done
    file = folder / "result"
    if code != 0:
        raise SystemExit(f"{name}: {simulator} ended with {code}:\n{text}")
    if not file.exists():
        return [line for line in text.splitlines() if line.startswith("Hello")], None, seconds
    result, cycles = struct.unpack("<2I", file.read_bytes())
    file.unlink()
    return result, cycles, seconds


def measure(name, program, board, build, repeats, folder):
    """The outcome of each simulator, with the least processor time."""
    soc = [build / "bin/mebots-soc", "run", program, "--board", ROOT / f"configs/boards/{board}.json",
           "--host-files", folder]
    best = {}
    for _ in range(repeats):
        for simulator, run in (("mebots-soc", lambda: gvsoc.processor_time(soc, folder)),
                               ("GVSoC", lambda: gvsoc.run(program, folder))):
            found = outcome(simulator, name, run(), folder)
            best[simulator] = min(best.get(simulator, found), found, key=lambda each: each[2])
    return best["mebots-soc"], best["GVSoC"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--hello", type=pathlib.Path)
    parser.add_argument("--coremark", type=pathlib.Path)
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    if not gvsoc.path():
        raise SystemExit(gvsoc.MISSING)
    differ = 0
    print("| program | results | cycles here | in GVSoC | off | seconds here | in GVSoC | times |\n|" + "---|" * 8)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for name, program, board in programs(options, folder):
            mine, its = measure(name, program, board, options.build.resolve(), options.repeats, folder)
            same = mine[0] == its[0]
            differ += not same
            said = mine[0][0] if isinstance(mine[0], list) and mine[0] else mine[0]
            result = f"both: {said}" if same else f"**{mine[0]} and {its[0]}**"
            cycles = [mine[1], its[1], f"{(mine[1] / its[1] - 1) * 100:+.2f} %"] if mine[1] else ["", "", ""]
            print("| " + " | ".join(map(str, [name, result, *cycles, f"{mine[2]:.3f}", f"{its[2]:.2f}",
                                              f"{its[2] / mine[2]:.0f}"])) + " |", flush=True)
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
