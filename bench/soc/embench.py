#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures the speed of mebots-soc on Embench-IoT and CoreMark, and compares it with QEMU -icount.

    git clone https://github.com/embench/embench-iot; git clone https://github.com/eembc/coremark
    bench/soc/embench.py --embench embench-iot --coremark coremark [--build build/release] [--repeats 3] [--only crc32,ud]

Every program is compiled with Debian's cross compiler (-O2), and runs behind GAP8's instruction cache of 4 KiB
(configs/boards/gap8_bare.json). The rate is computed as in run.py: difference of a long and a short run, processor time, median
of the repeats, simulators alternate. Every program checks its own result. The exit code is 1 if a result is wrong, or if the
ratios miss their targets: a geometric mean of 2, none below 0.4.
"""

import argparse
import math
import pathlib
import statistics
import subprocess
import sys
import tempfile

from run import GCC, HERE, ROOT, run, simulators

BASE = 0x1C000000
LEAST_MEAN = 2.0
LEAST = 0.4
# Approximate numbers of instructions in the short and the long run. The programs' repetitions are chosen accordingly.
SHORT_INSTRUCTIONS, LONG_INSTRUCTIONS = 30e6, 300e6
BOARD_SUPPORT = "void initialise_board(void) {}\nvoid start_trigger(void) {}\nvoid stop_trigger(void) {}\n"


def compile_command(sources, options, place, path):
    # Selects the C library for this architecture, because the compiler has no suitable default.
    flags = [flag for flag in GCC if flag not in ("-nostdlib", "-ffreestanding")]
    return (flags + ["-march=rv32imc", "--specs=picolibc.specs", "-nostartfiles", "-w"] + place + options +
            ["-T", HERE / "programs/link.ld", HERE / "programs/start.S", *sources, "-lm", "-o", path])


def compile_program(sources, options, kind, path):
    place = {"mebots": [f"-Wl,--defsym=BASE={BASE}"], "QEMU": ["-DFOR_QEMU"], "Spike": []}[kind]
    subprocess.run(compile_command(sources, options, place, path), check=True)


def embench_programs(checkout, support):
    """Returns {name: function}. The function takes a scale of the program's length, and returns sources and options."""
    common = [checkout / "support" / name for name in ("main.c", "beebsc.c", "board.c")]
    options = [f"-I{support}", f"-I{checkout / 'support'}", "-DWARMUP_HEAT=1", "-DHAVE_CONFIG_H"]
    (support / "config.h").write_text("")
    (support / "boardsupport.c").write_text(BOARD_SUPPORT)
    return {folder.name: lambda scale, folder=folder: (
                common + sorted(folder.glob("*.c")), options + [f"-I{folder}", f"-DGLOBAL_SCALE_FACTOR={scale}"])
            for folder in sorted((checkout / "src").iterdir()) if folder.is_dir()}


def coremark_program(checkout):
    port = HERE / "programs/coremark"
    sources = sorted(checkout.glob("core_*.c")) + [port / "core_portme.c"]
    return lambda scale: (sources, [f"-I{port}", f"-I{checkout}", f"-DITERATIONS={scale}"])


def instructions_of(text):
    return int(next(line for line in text.splitlines() if line.startswith("instructions ")).split()[1])


def scales(name, program, soc, folder):
    """Measures the program once. Returns the scales of the program's length for the short and for the long run."""
    path = folder / f"{name}-once.elf"
    compile_program(*program(1), "mebots", path)
    once = instructions_of(run(soc + [path])[0])
    return {False: math.ceil(SHORT_INSTRUCTIONS / once), True: math.ceil(LONG_INSTRUCTIONS / once)}


def measure(name, program, sims, repeats, folder):
    """Returns simulator -> rate [million instructions per second]. Also returns whether all results are correct."""
    files = {}
    kinds = {sim: sim.split()[0] for sim in sims}
    for is_long, scale in scales(name, program, sims["mebots"][0], folder).items():
        sources, options = program(scale)
        for kind in set(kinds.values()):
            files[is_long, kind] = folder / f"{name}-{is_long}-{kind}.elf"
            compile_program(sources, options, kind, files[is_long, kind])
    rates, counts, good = {sim: [] for sim in sims}, {}, True
    for _ in range(repeats):
        for sim, (command, _) in sims.items():
            seconds = {}
            for is_long in (False, True):
                text, code, seconds[is_long] = run(command + [files[is_long, kinds[sim]]])
                if code != 0:
                    print(f"{name}: {sim} ends with {code}\n{text}", file=sys.stderr)
                    good = False
                if kinds[sim] == "mebots":
                    counts[is_long] = instructions_of(text)
            rates[sim].append((counts[True] - counts[False]) / (seconds[True] - seconds[False]) / 1e6)
    return {sim: statistics.median(values) for sim, values in rates.items()}, good


def main():
    parser = argparse.ArgumentParser(description="Speed of mebots-soc on Embench-IoT and CoreMark")
    parser.add_argument("--embench", type=pathlib.Path, help="checkout of embench/embench-iot")
    parser.add_argument("--coremark", type=pathlib.Path, help="checkout of eembc/coremark")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--only", default="", help="these programs")
    options = parser.parse_args()
    found = simulators(options.build.resolve())
    if "QEMU -icount" not in found:
        return 1
    ours = found["mebots translated"][0] + ["--board", ROOT / "configs/boards/gap8_bare.json"]
    sims = {"mebots": (ours, False), "QEMU -icount": found["QEMU -icount"]}
    ratios, good = {}, True
    print("| program | " + " | ".join(f"{sim} [MIPS]" for sim in sims) + " | ratio |\n|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        programs = embench_programs(options.embench.resolve(), folder) if options.embench else {}
        if options.coremark:
            programs["coremark"] = coremark_program(options.coremark.resolve())
        only = set(filter(None, options.only.split(",")))
        for program in only - set(programs):
            parser.error(f"there is no program {program}; there are {', '.join(programs)}")
        for program in programs if not only else [p for p in programs if p in only]:
            rates, right = measure(program, programs[program], sims, options.repeats, folder)
            good = good and right
            ratios[program] = rates["mebots"] / rates["QEMU -icount"]
            print(f"| {program} | {rates['mebots']:.0f} | {rates['QEMU -icount']:.0f} | {ratios[program]:.2f} |", flush=True)
    if not ratios:
        parser.error("nothing to run: name checkouts with --embench, --coremark")
    mean = statistics.geometric_mean(ratios.values())
    least = min(ratios, key=ratios.get)
    print(f"\ngeometric mean {mean:.2f} (aim {LEAST_MEAN}), least {ratios[least]:.2f}: {least} (aim {LEAST})")
    return 0 if good and mean >= LEAST_MEAN and ratios[least] >= LEAST else 1


if __name__ == "__main__":
    sys.exit(main())
