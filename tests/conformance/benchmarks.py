# SPDX-License-Identifier: Apache-2.0
"""Runs Embench-IoT and CoreMark, whose programs check their own results. Compares the instruction counts with Spike's.
"""

import re

import embench
from tools import COMPILER, WAYS, Verdict, build, checkout, run, soc_run, spike

EMBENCH = "https://github.com/embench/embench-iot"
COREMARK = "https://github.com/eembc/coremark"
LEVELS = ("-O2", "-Os")
BASE = 0x80000000  # where start.S and Spike's memory are


def count_of_spike(reference, program):
    """Returns the number of instructions up to the store that ends the program. Spike itself detects this store only some
    thousand instructions later.
    """
    _, symbols = run([COMPILER.replace("-gcc", "-nm"), program])
    ended = int(re.search(r"^(\w+) \w ended$", symbols, re.MULTILINE)[1], 16)
    code, text = run([reference, "-g", "--isa=rv32imc", "--priv=m", f"-m{BASE:#x}:0x400000", program])
    counts = {int(address, 16) & 0xFFFFFFFF: int(count) for address, count in re.findall(r"^([0-9a-f]+) (\d+)$", text, re.MULTILINE)}
    return code, sum(count for address, count in counts.items() if address >= BASE and address != ended)


def judge(folder, soc, work, each):
    """Returns verdicts. The note of each verdict is the number of instructions."""
    reference = spike()
    programs = embench.embench_programs(checkout(folder, "embench-iot", EMBENCH).resolve(), work)
    programs["coremark"] = embench.coremark_program(checkout(folder, "coremark", COREMARK).resolve())

    def verdict(test):
        name, level = test
        sources, options = programs[name](1)
        program = work / f"{name}{level}.elf"
        wrong = build(embench.compile_command(sources, [*options, level], place=[], path=program))
        counts = set()
        for way in WAYS if wrong is None else ():
            code, text = run([*soc_run(soc), *way, program])
            if code != 0:
                wrong = wrong or f"ends with {code}: {text.strip()[-80:]}"
            else:
                counts.add(embench.instructions_of(text))
        if wrong is None:
            code, theirs = count_of_spike(reference, program)
            if code != 0 or counts != {theirs}:
                wrong = f"{sorted(counts)} instructions; Spike: {theirs}, code {code}"
        return Verdict(f"{name} {level}", wrong is None, wrong or f"{counts.pop():,}".replace(",", " "))

    return each(verdict, [(name, level) for name in programs for level in LEVELS])
