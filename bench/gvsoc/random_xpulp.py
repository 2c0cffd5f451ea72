#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs random Xpulp programs on mebots-soc and on GVSoC (target pulp-open). Compares the registers after each segment, and all
memory.

Usage: random_xpulp.py BUILD [--programs N] [--first SEED] [--segments N] [--alone]

BUILD is a build folder with tests. gvsoc.py states how GVSoC is found. --alone compares the translated with the interpreted run
of mebots-soc instead. The programs contain no encodings that GVSoC does not support. Four kinds of instructions are known to
differ for some operands (known()). If there is another difference, prints it, and the exit code is 1. Needs
riscv64-unknown-elf-gcc.
"""
import argparse
import collections
import pathlib
import struct
import subprocess
import sys
import tempfile

import gvsoc

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = pathlib.Path(__file__).parent
WATCHED = 0x80000000
# Approximate numbers of additional instructions: per program, and per segment with its two watched instructions.
AROUND_PROGRAM, AROUND_SEGMENT = 393_300, 89
DATA_BYTES = 0x40000
MOST_SEGMENTS = 230


def signed(value, bits):
    return value - (1 << bits) if value >> (bits - 1) & 1 else value


def known(word, rs1, rs2, rd):
    """Returns the class of instructions in which GVSoC is known to differ from RI5CY's RTL with these operands. If there is none,
    returns None.

    >>> known(0x0045250B, 0x1C060000, 0, 0x1C060000)   # p.lw x10, 4(x10!)
    'a load with post-increment into its own pointer'
    >>> known(0x14C5D533, 5, 0x80000000, 0), known(0x14C5D533, 5, 7, 0)   # p.clipr x10, x11, x12
    ('a clip with a negative bound', None)
    >>> known(0xCAA513AB, 0x1C060003, 0x1C060003, 0)   # p.sh x10, -857(x10!)
    'a store with post-increment of its own pointer, across a word'
    """
    opcode, funct3, funct7 = word & 0x7F, word >> 12 & 7, word >> 25
    if opcode == 0x0B and word >> 7 & 31 == word >> 15 & 31:
        return "a load with post-increment into its own pointer"
    if opcode == 0x2B and word >> 20 & 31 == word >> 15 & 31 and rs1 % 4 + (1 << (funct3 & 3)) > 4:
        return "a store with post-increment of its own pointer, across a word"
    if opcode == 0x33 and funct7 == 0x0A and funct3 in (5, 6) and rs2 >> 31:
        return "a clip with a negative bound"
    if opcode == 0x5B and funct3 == 5 and rounded_sum_overflows(word, rs1, rs2, rd):
        return "a rounded multiply-accumulate that overflows"
    return None


def rounded_sum_overflows(word, rs1, rs2, rd):
    """True if the sum of accumulator and product of halves exceeds 32 bits, with or without the half unit of the rounding.

    >>> rounded_sum_overflows(0xA28E5DDB, 0xFFFFFF60, 4, 0x80000000)   # the half unit brings it back
    True
    >>> rounded_sum_overflows(0xA28E5DDB, 0xFFFFFF60, 4, 0x90000000)
    False
    """
    is_signed, high, shift = bool(word >> 31), bool(word >> 30 & 1), word >> 25 & 31
    halves = [(value >> 16 if high else value) & 0xFFFF for value in (rs1, rs2)]
    if is_signed:
        halves = [signed(half, 16) for half in halves]
    total = (signed(rd, 32) if is_signed else rd) + halves[0] * halves[1]
    lowest = -(1 << 31) if is_signed else 0
    return any(not 0 <= each - lowest < 1 << 32 for each in (total, total + (1 << shift >> 1)))


def records(log):
    """Yields the entries of a log: ("segment", number, registers), ("watched", word, rs1, rs2, rd before, rd after),
    ("trap", pc).
    """
    words = struct.unpack(f"<{len(log) // 4}I", log)
    at = 0
    while at < len(words):
        if words[at] == WATCHED:
            yield ("watched", *words[at + 1:at + 6])
            at += 6
        elif at + 32 <= len(words):
            yield "segment", words[at], words[at + 1:at + 32]
            at += 32
        else:
            yield "trap", words[at]
            return


def build(author, seed, segments, folder):
    text = subprocess.run([author, str(seed), str(segments)], check=True, capture_output=True, text=True).stdout
    (folder / "segments.inc").write_text(text)
    program = folder / "random.elf"
    subprocess.run([gvsoc.compiler(), "-march=rv32imc_zicsr", "-mabi=ilp32", "-nostdlib", "-nostartfiles",
                    f"-I{folder}", f"-I{HERE}", "-Wl,--build-id=none,-n,-Ttext=0x1C000000,--no-warn-rwx-segments",
                    HERE / "random_xpulp.S", "-o", program], check=True)
    return program


def ours(soc, program, folder, *options):
    """Runs a program on mebots-soc. Returns its records, its memory, and the number of executed instructions."""
    done = gvsoc.processor_time([soc, "run", program, "--board", ROOT / "configs/boards/pulp_open.json", "--host-files", folder,
                                 *options], folder)
    return result("mebots-soc", done, folder), gvsoc.instructions_of(done)


def result(simulator, done, folder):
    data = gvsoc.left_by(simulator, done, folder)
    return list(records(data[:-DATA_BYTES])), data[-DATA_BYTES:]


def compare(one, other, seen):
    """Returns the first difference outside of the known classes as text, or None. Counts known cases in `seen`."""
    for mine, its in zip(one[0], other[0]):
        if mine[0] == "watched" and its[0] == "watched" and mine[:5] == its[:5]:
            kind = known(*mine[1:5])
            seen["watched"] += 1
            if mine != its:
                if kind is None:
                    return (f"watched 0x{mine[1]:08x}, rs1 0x{mine[2]:x}, rs2 0x{mine[3]:x}, rd 0x{mine[4]:x}: "
                            f"0x{mine[5]:x} and 0x{its[5]:x}")
                seen[kind] += 1
        elif mine != its:
            if "trap" in (mine[0], its[0]):
                simulator, pc = ("mebots-soc", mine[1]) if mine[0] == "trap" else ("GVSoC", its[1])
                return f"an instruction is unknown to {simulator}, at 0x{pc:x}"
            which = [f"x{i + 1} 0x{a:x} and 0x{b:x}" for i, (a, b) in enumerate(zip(mine[-1], its[-1])) if a != b]
            return f"after {mine[0]} {mine[1]}: {', '.join(which)}"
        else:
            seen["segments"] += 1
    if len(one[0]) != len(other[0]):
        return f"{len(one[0])} and {len(other[0])} records"
    at = next((i for i, (a, b) in enumerate(zip(one[1], other[1])) if a != b), None)
    return None if at is None else f"memory differs first at byte 0x{at:x} of the data"


def number(least, most):
    """Returns a function that converts an option to a number and checks its range."""
    def read(text):
        if not text.isdecimal() or not least <= int(text) <= most:
            raise argparse.ArgumentTypeError(f"{text}: want a number from {least} to {most}")
        return int(text)
    return read


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--programs", type=number(1, 1_000_000), default=210)
    parser.add_argument("--first", type=number(0, (1 << 64) - 1_000_001), default=1, help="seed of the first program")
    parser.add_argument("--segments", type=number(1, MOST_SEGMENTS), default=200,
                        help=f"in each program, 1 to {MOST_SEGMENTS}: so many have room in front of the log")
    parser.add_argument("--alone", action="store_true")
    options = parser.parse_args()
    author, soc = (gvsoc.built(options.build, name) for name in ("mebots-random-segments", "mebots-soc"))
    if not options.alone:
        gvsoc.peer()
    seen, instructions, failures = collections.Counter(), 0, 0
    for seed in range(options.first, options.first + options.programs):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            program = build(author, seed, options.segments, folder)
            mine, count = ours(soc, program, folder)
            if options.alone:
                its, _ = ours(soc, program, folder, "--interpret")
            else:
                its = result("GVSoC", gvsoc.run(program, folder), folder)
        instructions += count
        difference = compare(mine, its, seen)
        if difference:
            failures += 1
            print(f"program {seed}: {difference}")
    segments = options.programs * options.segments
    instructions -= options.programs * AROUND_PROGRAM + segments * AROUND_SEGMENT
    print(f"{options.programs} programs, about {instructions} random instructions, {seen.pop('segments', 0)} segments, "
          f"{seen.pop('watched', 0)} watched instructions, {failures} programs that differ")
    for kind, times in sorted(seen.items()):
        print(f"  known to differ: {kind}, {times} times")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
