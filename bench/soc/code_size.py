#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures the speed of mebots-soc over the code size, and compares it with QEMU and Spike on the same programs.

    scripts/setup.sh bench
    bench/soc/code_size.py [--build build/release] [--repeats 3] [--sizes 1,4,16,64,256,512] [--plot FILE.png]

For each size [KiB], generates a program of branchy functions that are called in turn, so that all code is hot (branchy.py).
mebots-soc runs it bare (configs/boards/ri5cy.json) and behind GAP8's instruction cache of 4 KiB (configs/boards/gap8_bare.json,
up to 448 KiB, because its L2 has 512). Each simulator runs a short and a long version. The rate is

    (instructions of the long run - of the short run) / (processor time of the long run - of the short run)

The short run is long enough to translate the hot code. Prints the median of the repeats; the simulators alternate. The exit code is 1
if a program's checksums differ.
"""

import argparse
import pathlib
import statistics
import subprocess
import sys
import tempfile

import branchy
from run import GCC, HERE, ROOT, run, simulators

INSTRUCTIONS_PER_KIB = 243  # approximate number of instructions in one turn
SHORT_TURNS = 100           # enough turns, because hot code is translated after 64
CACHED = "mebots behind 4 KiB"
LARGEST_CACHED_KIB = 448
CACHED_BASE = 0x1C000000


def build_programs(size, instructions, folder):
    """Builds the programs. Returns a dict of ELF files. The key is (True for the long version, kind of program). The kind is
    "bare", "qemu" or "cached"."""
    source = folder / f"branchy-{size}.c"
    code = folder / f"branchy-{size}.o"
    source.write_text(branchy.source(size * 1024))
    flags = [flag for flag in GCC if flag != "-O2"] + ["-O1"]
    subprocess.run(flags + ["-c", source, "-o", code], check=True)
    per_turn = INSTRUCTIONS_PER_KIB * size
    kinds = {"bare": [], "qemu": ["-DFOR_QEMU"], "cached": [f"-Wl,--defsym=BASE={CACHED_BASE}"]}
    if size > LARGEST_CACHED_KIB:
        del kinds["cached"]
    files = {}
    for is_long in (False, True):
        turns = max(SHORT_TURNS, instructions // 10 // per_turn) + (max(1, instructions // per_turn) if is_long else 0)
        for kind, options in kinds.items():
            path = folder / f"branchy-{size}-{'long' if is_long else 'short'}-{kind}.elf"
            subprocess.run(flags + options + [f"-DTURNS={turns}", "-T", HERE / "programs/link.ld",
                                              HERE / "programs/start.S", HERE / "programs/branchy.c", code, "-o", path],
                           check=True)
            files[is_long, kind] = path
    return files


def contenders(build):
    """Returns the simulators as name -> (start of the command line, kind of program)."""
    found = {name: (command, "qemu" if for_qemu else "bare") for name, (command, for_qemu) in simulators(build).items()
             if name != "mebots interpreter"}
    soc, _ = found.pop("mebots translated")
    boards = ROOT / "configs/boards"
    return {"mebots bare": (soc + ["--board", str(boards / "ri5cy.json")], "bare"),
            CACHED: (soc + ["--board", str(boards / "gap8_bare.json")], "cached")} | found


def instructions_of(text):
    return int(next(line for line in text.splitlines() if line.startswith("instructions ")).split()[1])


def measure(size, sims, instructions, repeats, folder):
    """Returns simulator -> rates [million instructions per second]. Also returns whether all checksums are equal."""
    files = build_programs(size, instructions, folder)
    rates = {sim: [] for sim, (_, kind) in sims.items() if (False, kind) in files}
    counts, checksums, good = {}, {}, True
    for _ in range(repeats):
        for sim in rates:
            command, kind = sims[sim]
            seconds = {}
            for is_long in (False, True):
                text, code, seconds[is_long] = run(command + [str(files[is_long, kind])])
                if code != checksums.setdefault(is_long, code):
                    print(f"{size} KiB: {sim} ends with {code}, not {checksums[is_long]}\n{text}", file=sys.stderr)
                    good = False
                if sim.startswith("mebots"):
                    counts[is_long] = instructions_of(text)
            rates[sim].append((counts[True] - counts[False]) / (seconds[True] - seconds[False]) / 1e6)
    return {sim: statistics.median(values) for sim, values in rates.items()}, good


def spread(heights, least):
    """Returns heights for the labels of a plot, in the order of the argument. Raises heights so that neighbours differ by at
    least `least`."""
    lifted, below = {}, float("-inf")
    for i in sorted(range(len(heights)), key=heights.__getitem__):
        below = lifted[i] = max(heights[i], below + least)
    return [lifted[i] for i in range(len(heights))]


def plot(sizes, rates, path):
    sys.path.insert(0, str(ROOT / "scripts"))
    from figure_style import label_line, plt, save

    figure, axes = plt.subplots(figsize=(8, 4.2), constrained_layout=True)
    for sim in rates[sizes[0]]:
        points = [(size, rates[size][sim]) for size in sizes if sim in rates[size]]
        axes.plot(*zip(*points), marker="o", markersize=4, linestyle="-" if sim.startswith("mebots") else "--", label=sim)
    axes.set(xscale="log", yscale="log", xticks=sizes, xticklabels=sizes, xlabel="hot code [KiB]",
             ylabel="million instructions per second")
    axes.minorticks_off()
    axes.set_title("Branchy functions called in turn, processor time", loc="left")
    figure.canvas.draw()  # computes the positions of points in pixels
    ends = [axes.transData.transform((line.get_xdata()[-1], line.get_ydata()[-1]))[1] * 72 / figure.dpi
            for line in axes.lines]
    for line, end, height in zip(axes.lines, ends, spread(ends, 11)):
        label_line(axes, line.get_label(), line.get_color(), line=line, offset=(6, height - end))
    save(figure, path)


def main():
    parser = argparse.ArgumentParser(description="Speed of mebots-soc over the size of the code")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--sizes", default="1,2,4,8,16,32,64,128,256,512", help="of the code [KiB]")
    parser.add_argument("--instructions", type=float, default=2e8, help="between short and long run")
    parser.add_argument("--plot", type=pathlib.Path, help="draws the curves into this picture")
    options = parser.parse_args()
    sizes = [int(size) for size in options.sizes.split(",")]
    sims = contenders(options.build.resolve())
    rates, good = {}, True
    print("Million instructions per second of processor time, and how many times QEMU -icount\n")
    print("| KiB | " + " | ".join(sims) + " |\n|---|" + "---|" * len(sims), flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for size in sizes:
            rates[size], agree = measure(size, sims, int(options.instructions), options.repeats, pathlib.Path(folder))
            good = good and agree
            counted = rates[size].get("QEMU -icount")
            cells = []
            for sim in sims:
                rate = rates[size].get(sim)
                ratio = f" ({rate / counted:.2f} x)" if rate and counted and sim.startswith("mebots") else ""
                cells.append(f"{rate:.0f}{ratio}" if rate else "")
            print(f"| {size} | " + " | ".join(cells) + " |", flush=True)
    if options.plot:
        plot(sizes, rates, options.plot)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
