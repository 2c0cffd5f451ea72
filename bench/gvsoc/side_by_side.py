#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the same ELF files on mebots-soc and on GVSoC (target pulp-open). Prints a table in Markdown.

Usage: side_by_side.py BUILD [--hello ELF] [--coremark CHECKOUT] [--repeats N]

BUILD is a build folder; bench/gvsoc/gvsoc.py states how GVSoC is found. Programs of bench/soc and CoreMark run on one core of the
cluster, with code in L2 behind the instruction cache and data in L1. hello runs on the fabric controller of board pulp_open. The
processor time is that of the whole process: the minimum of the repeats, which alternate between the simulators. Instructions are
those of all cores of mebots-soc. The exit code is 1 if results differ. Needs riscv64-unknown-elf-gcc and picolibc.
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile
import typing

import gvsoc

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = pathlib.Path(__file__).parent
sys.path.insert(0, str(ROOT / "bench/soc"))

import embench  # noqa: E402

TURNS = {"convolution": 40, "mixed": 3000}
COREMARK_TURNS = 60


def compiled(name, sources, options, folder):
    program = folder / f"{name}.elf"
    subprocess.run([gvsoc.compiler(), "-O2", "-march=rv32imc", "-mabi=ilp32", "-mcmodel=medany",
                    "--specs=picolibc.specs", "-nostartfiles", "-w", "-Wl,--no-warn-rwx-segments,--build-id=none",
                    f"-I{HERE}", *options, "-T", HERE / "link.ld", HERE / "start.S", *sources, "-lm", "-o", program],
                   check=True)
    return program


def programs(options, folder):
    """Returns name, ELF, board and reader of the result for each program."""
    if options.hello:
        yield "pulp-open's hello", options.hello.resolve(), "pulp_open", greeted
    for name, turns in TURNS.items():
        source = ROOT / f"bench/soc/programs/{name}.c"
        yield f"{name} of bench/soc", compiled(name, [source], [f"-DTURNS={turns}", "-ffreestanding"], folder), "gap8", computed
    if options.coremark:
        sources, flags = embench.coremark_program(options.coremark.resolve())(COREMARK_TURNS)
        yield f"CoreMark, {COREMARK_TURNS} turns", compiled("coremark", sources, flags, folder), "gap8", computed


class Outcome(typing.NamedTuple):
    said: object  # result that the program computed or printed
    cycles: int | None
    seconds: float


def greeted(simulator, done, folder):
    text, code, seconds = done
    line = next((line for line in text.splitlines() if line.startswith("Hello")), None)
    if code != 0 or not line:
        raise SystemExit(f"{simulator}: the program ended with {code}, and printed {line or 'no Hello'}:\n{text}")
    return Outcome(line, None, seconds)


def computed(simulator, done, folder):
    words = gvsoc.words_left_by(simulator, done, folder)
    if len(words) != 2:
        raise SystemExit(f"{simulator}: the program left {len(words)} words, not a result and its cycles")
    return Outcome(*words, done[2])


def measure(soc, program, board, read, repeats, folder):
    """Returns each simulator's run with the least processor time, and the number of instructions."""
    command = [soc, "run", program, "--board", ROOT / f"configs/boards/{board}.json", "--host-files", folder]
    ours, its = [], []
    for _ in range(repeats):
        done = gvsoc.processor_time(command, folder)
        ours.append(read("mebots-soc", done, folder))
        its.append(read("GVSoC", gvsoc.run(program, folder), folder))
    return *(min(each, key=lambda one: one.seconds) for each in (ours, its)), gvsoc.instructions_of(done)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--hello", type=pathlib.Path)
    parser.add_argument("--coremark", type=pathlib.Path)
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    if options.repeats < 1:
        parser.error(f"--repeats {options.repeats}: want 1 or more")
    if options.hello and not options.hello.is_file():
        parser.error(f"--hello {options.hello}: no such file")
    if options.coremark and not (options.coremark / "core_main.c").is_file():
        parser.error(f"--coremark {options.coremark}: no checkout of CoreMark, which has core_main.c")
    gvsoc.peer()
    soc = gvsoc.built(options.build, "mebots-soc")
    differ = 0
    heads = ["program", "results", "million instructions", "cycles here", "in GVSoC", "off", "seconds here", "in GVSoC", "times"]
    print("| " + " | ".join(heads) + " |\n|" + "---|" * len(heads))
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for name, program, board, read in programs(options, folder):
            mine, its, instructions = measure(soc, program, board, read, options.repeats, folder)
            same = mine.said == its.said
            differ += not same
            result = f"both: {mine.said}" if same else f"**{mine.said} and {its.said}**"
            cycles = [mine.cycles, its.cycles, f"{(mine.cycles / its.cycles - 1) * 100:+.2f} %"] if mine.cycles else ["", "", ""]
            print("| " + " | ".join(map(str, [name, result, f"{instructions / 1e6:.3g}", *cycles, f"{mine.seconds:.3f}",
                                              f"{its.seconds:.2f}", f"{its.seconds / mine.seconds:.0f}"])) + " |", flush=True)
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
