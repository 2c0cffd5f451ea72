#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures the costs of mebots-soc in addition to instructions: starting, observing a run, changing code.

    scripts/setup.sh bench
    bench/soc/events.py [--build build/release] [--repeats 5]

| case | what is measured |
|---|---|
| start | a run of exactly a million instructions of programs/mixed.c, from the start of the process to its end |
| profile, power trace | a long run with `--profile` or `--power-trace`, divided by the same run without; mixed code and cluster |
| patch | a run with 200,000 stores into code (programs/patches.c) minus one with 100,000, here and on Spike |

Processor time; medians of alternating pairs. The exit code is 1 if a program's checksums differ.
"""

import argparse
import pathlib
import statistics
import subprocess
import sys
import tempfile

from run import GCC, HERE, ROOT, TURNS, build_cluster_programs, build_programs, run, simulators

PATCHES = 100000


def say(name, values, unit):
    print(f"| {name} | {statistics.median(values):.2f} {unit} | {min(values):.2f} to {max(values):.2f} |", flush=True)


def measure_start(soc, program, repeats):
    seconds = [run(soc + [program, "--max-instructions", "1000000"])[2] for _ in range(repeats)]
    say("start and a million instructions", [1e3 * s for s in seconds], "ms")


def measure_watchers(soc, programs, folder, repeats):
    for name, (program, options) in programs.items():
        watchers = {"profile": ["--profile", folder / "profile.json"],
                    "power trace": ["--power-trace", folder / "power.json"]}
        ratios = {watcher: [] for watcher in watchers}
        for _ in range(repeats):
            plain = run(soc + [program] + options)[2]
            for watcher, watch in watchers.items():
                ratios[watcher].append(run(soc + [program] + options + watch)[2] / plain)
        for watcher, values in ratios.items():
            say(f"{name} with {watcher} / without", values, "x")


def build_patches(turns, folder):
    path = folder / f"patches-{turns}.elf"
    subprocess.run(GCC + ["-march=rv32imc_zicsr_zifencei", f"-DTURNS={turns}", "-Wl,-N", "-T", HERE / "programs/link.ld",
                          HERE / "programs/start.S", HERE / "programs/patches.c", "-o", path], check=True)
    return path


def measure_patches(sims, folder, repeats):
    """Returns microseconds per patch by simulator. Also returns whether the checksums are equal."""
    files = [build_patches(turns, folder) for turns in (PATCHES, 2 * PATCHES)]
    micros, codes, good = {sim: [] for sim in sims}, {}, True
    for _ in range(repeats):
        for sim, command in sims.items():
            seconds = []
            for file in files:
                _, code, time = run(command + [file])
                seconds.append(time)
                if codes.setdefault(file, code) != code:
                    print(f"{sim}: {file.name} ends with {code}, not {codes[file]}", file=sys.stderr)
                    good = False
            micros[sim].append(1e6 * (seconds[1] - seconds[0]) / PATCHES)
    for sim, values in micros.items():
        say(f"{sim}: store into code, fence.i, call", values, "us")
    if "Spike" in sims:
        print(f"\npatch, mebots / Spike: {statistics.median(micros['mebots']) / statistics.median(micros['Spike']):.2f}")
    return good


def main():
    parser = argparse.ArgumentParser(description="Time of mebots-soc in addition to instructions")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    build = options.build.resolve()
    found = simulators(build)
    soc = found["mebots translated"][0]
    sims = {"mebots": soc} | {name: command for name, (command, _) in found.items() if name == "Spike"}
    print("| case | median | least to most |\n|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        mixed = build_programs(["mixed"], 0.1, folder)["mixed", True, False]
        cluster = build_cluster_programs(build, 0.1, folder)[8, True]
        measure_start(soc, mixed, options.repeats)
        board = ["--board", ROOT / "configs/boards/ai_deck.json", "--max-instructions", "1000000000"]
        programs = {f"mixed, {round(0.1 * TURNS['mixed'])} turns": (mixed, []), "cluster": (cluster, board)}
        measure_watchers(soc, programs, folder, options.repeats)
        good = measure_patches(sims, folder, options.repeats)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
