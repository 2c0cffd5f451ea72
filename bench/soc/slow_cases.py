#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures the cases in which mebots-soc is slowest, next to QEMU and Spike, in one run.

    scripts/setup.sh bench
    bench/soc/slow_cases.py [--build build/release] [--before OTHER/BUILD] [--repeats 5] [--embench CHECKOUT]

| case | what is measured |
|---|---|
| hot code | the rate of code of 5.7, 11, 44 and 175 KiB on mebots-soc with GAP8's cache, on QEMU -icount and on Spike (code_size.py) |
| device register, mcycle, trap | the time of a load from a register of the PLIC, of a read of mcycle, and of ecall with a handler (below) |
| barrier, DMA | the time of a barrier of eight cores, and of a DMA copy of 256 bytes with its wait (programs/cluster_events.c) |
| RAM | processor time and memory of a short run with 128 MiB of RAM |
| Embench | the rate of nettle-sha256, the slowest program (embench.py), with --embench |

The time of an event is that of a loop with the event minus that of the same loop without it (programs/events.c, on board virt and on
QEMU's machine virt). Spike has the same addresses. The trap's handler has four instructions. All times are processor time; simulators
and builds alternate. Times are the least of the repeats, and rates are the median. With `--before`, the times of another build of
mebots-soc follow. The exit code is 1 if a program's checksums differ.
"""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile

import code_size
import embench
from run import GCC, HERE, ROOT, build_cluster_program, run, simulators

SIZES_KIB = (5.7, 11, 44, 175)
EVENTS = {"loop alone": 0, "load of a device register": 1, "csrr mcycle": 2, "ecall and mret": 3}
CLUSTER_EVENTS = {"barrier of eight cores": 1, "DMA copy of 256 bytes with its wait": 2}
SHORT_TURNS, LONG_TURNS = 100_000, 2_100_000
CLUSTER_TURNS = {False: 2_000, True: 102_000}
SLOWEST = "nettle-sha256"
SPIKE = "Spike"
OTHERS = ("QEMU -icount", SPIKE)


def event_program(event, turns, folder, for_spike=False):
    path = folder / f"event-{event}-{turns}{'-spike' if for_spike else ''}.elf"
    subprocess.run(GCC + ([] if for_spike else ["-DFOR_QEMU"]) + [f"-DEVENT={event}", f"-DTURNS={turns}", "-T", HERE / "programs/link.ld",
                          HERE / "programs/start.S", HERE / "programs/events.c", "-o", path], check=True)
    return path


def event_files(event, folder, for_spike=False):
    return {False: event_program(event, SHORT_TURNS, folder, for_spike),
            True: event_program(event, LONG_TURNS, folder, for_spike)}


def least_times(commands, files, repeats, turns, files_of=None):
    """Returns for each simulator the least time of one turn [ns], and whether all exit codes are equal. `files_of`
    maps a simulator to its programs if it cannot run `files`."""
    best = {}
    codes, good = {}, True
    for _ in range(repeats):
        for sim, command in commands.items():
            seconds = {}
            for is_long, file in (files_of or {}).get(sim, files).items():
                text, code, seconds[is_long] = run(command + [file])
                if code != codes.setdefault(is_long, code):
                    print(f"{sim}: {file.name} ends with {code}, not {codes[is_long]}\n{text}", file=sys.stderr)
                    good = False
            for is_long, value in seconds.items():
                best[sim, is_long] = min(value, best.get((sim, is_long), value))
    return {sim: 1e9 * (best[sim, True] - best[sim, False]) / turns for sim in commands}, good


def print_row(name, times):
    print(f"| {name} | " + " | ".join(f"{time:.0f}" for time in times.values()) + " |", flush=True)


def measure_events(builds, sims, repeats, folder):
    """Prints the time of each event [ns], without the time of the loop around it. Returns whether the checksums are equal."""
    board = ["--board", ROOT / "configs/boards/virt.json"]
    commands = {}
    for name, soc in builds.items():
        commands |= {name: [soc, "run", *board], f"{name}, interpreted": [soc, "run", "--interpret", *board]}
    commands |= {sim: command for sim, (command, for_qemu) in sims.items() if for_qemu or sim == SPIKE}
    print("\nTime of one event [ns]\n\n| event | " + " | ".join(commands) + " |\n|---|" + "---|" * len(commands))
    loop, good = {}, True
    for name, event in EVENTS.items():
        times, right = least_times(commands, event_files(event, folder), repeats, LONG_TURNS - SHORT_TURNS,
                                   {SPIKE: event_files(event, folder, True)} if SPIKE in commands else None)
        good = good and right
        loop = loop or times
        print_row(name, times if event == 0 else {sim: time - loop[sim] for sim, time in times.items()})
    return good


def measure_cluster(builds, build, repeats, folder):
    board = ["--board", ROOT / "configs/boards/gap8_bare.json", "--max-instructions", "1000000000"]
    commands = {name: [soc, "run", *board] for name, soc in builds.items()}
    print("\nTime of one event [ns]\n\n| event | " + " | ".join(commands) + " |\n|---|" + "---|" * len(commands))
    good = True
    for name, event in CLUSTER_EVENTS.items():
        files = {is_long: cluster_program(build, event, turns, folder) for is_long, turns in CLUSTER_TURNS.items()}
        times, right = least_times(commands, files, repeats, CLUSTER_TURNS[True] - CLUSTER_TURNS[False])
        good = good and right
        print_row(name, times)
    return good


def cluster_program(build, event, turns, folder):
    path = folder / f"cluster-event-{event}-{turns}.elf"
    build_cluster_program(build, "cluster_events.c", [f"-DEVENT={event}", f"-DTURNS={turns}"], path)
    return path


def measure_ram(builds, folder):
    """Prints the cost of 128 MiB of RAM. Returns whether the exit code, which is the program's checksum, is 0."""
    program, good = event_program(0, 1, folder), True
    print("\n| 128 MiB of RAM | processor time [ms] | memory [MiB] |\n|---|---|---|")
    for name, soc in builds.items():
        process = subprocess.Popen([soc, "run", program, "--board", "virt", "--ram", "0x80000000:128M"],
                                   stdout=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        good = good and process.returncode == 0
        print(f"| {name} | {1e3 * (usage.ru_utime + usage.ru_stime):.0f} | {usage.ru_maxrss / 1024:.0f} |", flush=True)
    return good


def print_rates(name, rates, ours):
    cells = [f"{rates[ours]:.0f}"]
    for other in OTHERS:
        cells += [f"{rates[other]:.0f}", f"{rates[ours] / rates[other]:.2f}"] if other in rates else ["", ""]
    print(f"| {name} | " + " | ".join(cells) + " |", flush=True)


def measure_rates(build, options, folder):
    """Prints the rates of mebots-soc and QEMU -icount, in million instructions per second. Returns whether the
    checksums are equal."""
    sims = {name: one for name, one in code_size.contenders(build).items() if name in (code_size.CACHED, *OTHERS)}
    print("| code | mebots behind 4 KiB [MIPS] | QEMU -icount [MIPS] | ratio | Spike [MIPS] | ratio |\n|---|---|---|---|---|---|",
          flush=True)
    good = True
    for size in SIZES_KIB:
        rates, right = code_size.measure(size, sims, int(options.instructions), options.repeats, folder)
        print_rates(f"{size} KiB", rates, code_size.CACHED)
        good = good and right
    if options.embench:
        found = simulators(build)
        ours = found["mebots translated"][0] + ["--board", ROOT / "configs/boards/gap8_bare.json"]
        both = {"mebots": (ours, False)} | {sim: one for sim, one in found.items() if sim in OTHERS}
        program = embench.embench_programs(options.embench.resolve(), folder)[SLOWEST]
        rates, right = embench.measure(SLOWEST, program, both, options.repeats, folder)
        print_rates(SLOWEST, rates, "mebots")
        good = good and right
    return good


def main():
    parser = argparse.ArgumentParser(description="The slowest cases of mebots-soc next to QEMU")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--before", type=pathlib.Path, help="another build, measured in alternation")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--instructions", type=float, default=6e8, help="of hot code, between short and long run")
    parser.add_argument("--embench", type=pathlib.Path, help="checkout of embench/embench-iot")
    options = parser.parse_args()
    build = options.build.resolve()
    builds = {"mebots": build / "bin/mebots-soc"}
    if options.before:
        builds["mebots before"] = options.before.resolve() / "bin/mebots-soc"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        good = measure_rates(build, options, folder)
        good = measure_events(builds, simulators(build), options.repeats, folder) and good
        good = measure_cluster(builds, build, options.repeats, folder) and good
        good = measure_ram(builds, folder) and good
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
