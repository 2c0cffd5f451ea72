#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the cycles of cores that access the same banks of L1 at the same time, on board gap8, with the RTL's arbitration.
Prints a table in Markdown with the mean deviation of a core and the deviation of the last core, for rotating orders and for the
tree's order.

Usage: banks.py BUILD [--each] [--quanta 32,64,128]

The rule of the RTL is that of pulp-platform/cluster_interconnect (ArbitrationTree.sv, FanInPrimitive_Req.sv): each bank counts
its grants modulo the number of cores. A binary tree over the cores selects a side at each node: if the side given by a bit of the
count requests access, it is selected. The nodes use the lowest bit at the leaves and the highest bit at the root. Thus the bank
grants access to the core with the least value of number XOR count. --each prints the cycles of every core. --quanta prints
instead the deviation with the tree's order for each of these lengths of a quantum [cycles]. Each value is the mean over runs with
six start times relative to a quantum. The fabric controller is awake here, which limits quanta to 256. Needs riscv64-unknown-elf-gcc.
"""
import argparse
import json
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "bench/gvsoc"))

import gvsoc  # noqa: E402

BANKS = 16
MOST_CORES = 8
LOADS = (16, 64, 256, 1024, 4096)
DELAYS = (0, 13, 27, 38, 51, 77)  # cycles of delay before each run


def any_bank(seed):
    """Returns instructions that load from random banks, mixed with other instructions. The indices of a core's words exceed those
    of the previous core by five."""
    pick = random.Random(seed)
    body = [pick.randrange(BANKS) for _ in range(16)] + [None] * 16
    pick.shuffle(body)
    return body, 5


# Maps each form of the loop to two values. The first value lists the instructions of one iteration of the loop: the word that a
# load reads, or None for another instruction. The second value is the distance in words between the words that the same load
# reads in two consecutive cores.
FORMS = {
    "one_bank": ([0] * 16, 0),                   # loads one bank in every cycle
    "straight": ([0] * 256, 0),                  # does the same without the end of a loop, in blocks of 64 instructions
    "every_second": ([0, None] * 8, 0),          # cores with even and odd numbers can share the bank without waiting
    "any_bank": any_bank(1),
}


def expected(form, cores, loads):
    """Returns each core's cycles by the RTL's rule, if all cores start in the same cycle."""
    body, step = FORMS[form]
    program = body * turns_of(form, loads)
    at = [0] * cores
    end = [0] * cores
    count = [0] * BANKS
    cycle = 0
    while not all(end):
        cycle += 1
        wanted = {}
        for core in range(cores):
            if end[core]:
                continue
            word = program[at[core]]
            if word is None:
                at[core] += 1
            else:
                wanted.setdefault((word + core * step) % BANKS, []).append(core)
        for bank, asking in wanted.items():
            at[min(asking, key=lambda core: core ^ count[bank])] += 1
            count[bank] = (count[bank] + 1) % MOST_CORES
        for core in range(cores):
            if at[core] == len(program) and not end[core]:
                end[core] = cycle
    return end


def turns_of(form, loads):
    """Returns the number of iterations in which the loop of this form executes `loads` loads. If it is not a whole number,
    returns None."""
    in_body = sum(word is not None for word in FORMS[form][0])
    return loads // in_body if loads % in_body == 0 else None


def source(cases, delay):
    lines = ["    .option norvc", "    .option norelax", "    .equ kEventUnit, 0x00204000", "    .equ kL1, 0x10001000",
             "    .equ kStarted, 0xff", '    .include "cluster_boot.inc"',
             "core: li s0, kEventUnit", "    li t0, 1 << 16 | 1 << 18", "    sw t0, 0x08(s0)", "    beqz a0, master",
             "1:  p.elw t0, 0x80, s0", "    p.elw a0, 0x80, s0", "    jalr t0", "    j 1b",
             "master: la s10, cases", "2:  lw s1, 0(s10)", "    beqz s1, 3f", "    lw t2, 12(s10)",
             "    sw t2, 0x84(s0)", "    sw t2, 0x200(s0)", "    sw t2, 0x20c(s0)", "    li t3, 1", "    beq t2, t3, 5f",
             "    sw s1, 0x80(s0)", "    sw s10, 0x80(s0)", "5:  mv a0, s10", "    jalr s1", "    addi s10, s10, 16",
             "    j 2b", "3:  la t0, done", "    li t1, 1", "    sw t1, 0(t0)", "4:  p.elw t0, 0x21c, s0", "    j 4b"]
    for form in sorted({case[0] for case in cases}):
        body, step = FORMS[form]
        lines += ["    .balign 16", f"{form}: lw s6, 4(a0)", "    lw s7, 8(a0)", "    csrr t1, mhartid",
                  "    andi t1, t1, 31", "    slli t2, t1, 2", "    add s7, s7, t2", f"    li t3, {4 * step}",
                  "    mul t3, t1, t3", "    li s5, kL1", "    add s5, s5, t3", "    li s8, 2", "    mv s9, s6",
                  # The first of two runs loads the code into the instruction cache.
                  "6:  mv s6, s9", "    li t0, kEventUnit", "    p.elw t0, 0x21c, t0", *["    addi t5, t5, 1"] * delay,
                  "    csrr s3, 0xB00",
                  f"    lp.setup 0, s6, {len(body)}"]
        for place, word in enumerate(body):
            lines.append("    addi t5, t5, 1" if word is None else f"    lw a{2 + place % 4}, {4 * word}(s5)")
        lines += ["    csrr s4, 0xB00", "    sub s4, s4, s3", "    addi s8, s8, -1", "    bnez s8, 6b", "    sw s4, 0(s7)",
                  "    li t0, kEventUnit", "    p.elw t0, 0x21c, t0", "    ret"]
    lines += ["    .balign 4", "cases:"]
    for index, (form, cores, loads) in enumerate(cases):
        lines.append(f"    .4byte {form}, {turns_of(form, loads)}, begin_signature + {4 * MOST_CORES * index}, {(1 << cores) - 1}")
    lines += ["    .4byte 0", '    .section .l2, "aw", @progbits', "    .balign 16",
              f"begin_signature: .fill {MOST_CORES * len(cases)}, 4, 0", "end_signature:", ""]
    macros = """
.macro p.elw rd, offset, rs
    .insn i 0x03, 6, \\rd, \\offset(\\rs)
.endm
.macro lp.setup loop, count, instructions
    .insn i 0x7b, 4, x\\loop, \\count, 2 * \\instructions
.endm
"""
    return macros + "\n".join(lines)


def measured(soc, folder, cases, **arbitration):
    """Returns each core's cycles in each case. `arbitration` contains options of the cluster's arbitration."""
    board = json.loads((ROOT / "configs/boards/gap8.json").read_text())
    for memory in board["memories"]:
        if memory.get("place") == "cluster":
            memory.update(arbitration)
    (folder / "board.json").write_text(json.dumps(board))
    command = [soc, "run", folder / "banks.elf", "--board", folder / "board.json", "--host-files", folder]
    words = gvsoc.words_left_by("mebots-soc", gvsoc.processor_time(command, folder), folder)
    return [words[MOST_CORES * i:MOST_CORES * i + cores] for i, (_, cores, _) in enumerate(cases)]


def assembled(folder, cases, delay=0):
    (folder / "banks.S").write_text(source(cases, delay))
    subprocess.run([gvsoc.compiler(), "-march=rv32imc_zicsr", "-mabi=ilp32", "-nostdlib", "-nostartfiles",
                    "-Wl,--build-id=none,-n,-Ttext=0x1C000000,--no-warn-rwx-segments", f"-I{ROOT / 'bench/gvsoc'}",
                    folder / "banks.S", "-o", folder / "banks.elf"], check=True)


def deviation(here, rtl):
    """Returns the mean relative deviation of the cores' cycles from the RTL's, and the relative deviation of the core that ends
    last."""
    return sum(abs(ours / its - 1) for ours, its in zip(here, rtl)) / len(rtl), max(here) / max(rtl) - 1


def print_quanta(soc, folder, cases, quanta):
    off = {}  # maps (quantum, case) to deviations
    rtl = {case: expected(*case) for case in cases}
    for delay in DELAYS:
        assembled(folder, cases, delay)
        for quantum in quanta:
            found = dict(zip(cases, measured(soc, folder, cases, arbitration_tree=True, quantum=quantum)))
            around = found[cases[0]][0] - rtl[cases[0]][0]  # of a single core
            for case, cycles in found.items():
                off.setdefault((quantum, case), []).append(deviation([each - around for each in cycles], rtl[case]))
    several = [case for case in cases if case[1] > 1]
    rows = {
        "16 and 64 loads; 2, 4 or 8 cores": lambda cores, loads: cores in (2, 4, 8) and loads <= 64,
        "256 loads and more; 2, 4 or 8 cores": lambda cores, loads: cores in (2, 4, 8) and loads > 64,
        "16 and 64 loads; 3, 5, 6 or 7 cores": lambda cores, loads: cores not in (2, 4, 8) and loads <= 64,
        "256 loads and more; 3, 5, 6 or 7 cores": lambda cores, loads: cores not in (2, 4, 8) and loads > 64,
        "all": lambda cores, loads: True,
    }
    print("| quantum | " + " | ".join(map(str, quanta)) + " |\n|" + "---|" * (len(quanta) + 1))
    for name, belongs in rows.items():
        cells = []
        for quantum in quanta:
            each = [one for case in several if belongs(*case[1:]) for one in off[quantum, case]]
            cells.append(f"{statistics.mean(one[0] for one in each) * 100:.1f} % "
                         f"({statistics.mean(abs(one[1]) for one in each) * 100:.1f})")
        print(f"| {name} | " + " | ".join(cells) + " |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--each", action="store_true")
    parser.add_argument("--quanta", type=lambda text: [int(quantum) for quantum in text.split(",")])
    arguments = parser.parse_args()
    soc = gvsoc.built(arguments.build, "mebots-soc")
    cases = [(form, cores, loads) for form in FORMS for loads in LOADS if turns_of(form, loads)
             for cores in range(1, MOST_CORES + 1)]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        if arguments.quanta:
            if max(arguments.quanta) > 256:
                parser.error("--quanta: the fabric controller, which is awake here, cuts quanta at 256")
            print_quanta(soc, folder, cases, arguments.quanta)
            return
        assembled(folder, cases)
        found = [measured(soc, folder, cases, arbitration_tree=tree) for tree in (False, True)]
    cells = {}
    around = 0  # cycles of a single core in addition to the loop
    for (form, cores, loads), *both in zip(cases, *found):
        rtl = expected(form, cores, loads)
        if cores == 1:
            around = both[0][0] - rtl[0]
            continue
        here = [[cycles - around for cycles in each] for each in both]
        (rotating, last_rotating), (tree, last_tree) = (deviation(each, rtl) for each in here)
        cells[form, loads, cores] = (f"{rotating * 100:.0f}, {tree * 100:.0f} % "
                                     f"({last_rotating * 100:+.0f}, {last_tree * 100:+.0f})")
        if arguments.each:
            print(f"{form}, {loads} loads: RTL {rtl}, rotating {here[0]}, tree {here[1]}")
    for form in FORMS:
        print(f"\n| {form}, loads | " + " | ".join(f"{cores} cores" for cores in range(2, MOST_CORES + 1)) + " |")
        print("|---|" + "---|" * (MOST_CORES - 1))
        for loads in LOADS:
            row = [cells.get((form, loads, cores)) for cores in range(2, MOST_CORES + 1)]
            if all(row):
                print(f"| {loads} | " + " | ".join(row) + " |")


if __name__ == "__main__":
    main()
