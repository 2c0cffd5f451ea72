#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the cycles of 18 kernels on board gap8 with published cycles of GreenWaves' CNN benchmark on a GAPuino (cycles.json).
The kernels follow this benchmark. Prints a table in Markdown: seven rows are fits, eight are validations, and three are not
comparable.

Usage: cycles.py BUILD [--check] [--gvsoc]

BUILD is a build folder. The exit code is 1 if forms of a kernel have different results. With --check, it is also 1 if a fit
deviates by more than 5 %, or a validation by more than 15 %. --gvsoc also runs the same ELF on GVSoC (see bench/gvsoc/gvsoc.py),
whose results must be equal. Needs riscv64-unknown-elf-gcc.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = pathlib.Path(__file__).parent
sys.path.insert(0, str(ROOT / "bench/gvsoc"))

import gvsoc  # noqa: E402

MOST_OFF = {"fit": 0.05, "validation": 0.15}
# In this row, the filter is at another address than in the other rows of the layer, as in the benchmark. Therefore its result is
# not compared with theirs.
OTHER_FILTER = ("linear, vector", 8)


def compiled(runs, folder):
    program = folder / "cycles.elf"
    subprocess.run([gvsoc.compiler(), f"-DRUNS={runs}", "-march=rv32imc_zicsr", "-mabi=ilp32", "-nostdlib",
                    "-nostartfiles", "-Wl,--build-id=none,-n,-Ttext=0x1C000000,--no-warn-rwx-segments",
                    f"-I{ROOT / 'bench/gvsoc'}", HERE / "cycles.S", "-o", program], check=True)
    return program


def rows_of(simulator, done, folder, rows):
    """Returns the cycles and the output sum of each row of a finished program, and its processor time."""
    words = gvsoc.words_left_by(simulator, done, folder)
    if len(words) != 2 * rows:
        raise SystemExit(f"{simulator}: {len(words)} words measured, two for each of {rows} rows in cycles.json are wanted")
    return list(zip(words[::2], words[1::2])), done[2]


def measured(soc, data, with_gvsoc):
    """Returns the rows and the processor time of each simulator."""
    with tempfile.TemporaryDirectory() as name:
        out = pathlib.Path(name)
        program = compiled(data["runs"], out)
        command = [soc, "run", program, "--board", ROOT / "configs/boards/gap8.json", "--host-files", out]
        found = [rows_of("mebots-soc", gvsoc.processor_time(command, out), out, len(data["rows"]))]
        if with_gvsoc:
            found.append(rows_of("GVSoC", gvsoc.run(program, out), out, len(data["rows"])))
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--gvsoc", action="store_true")
    arguments = parser.parse_args()
    data = json.loads((HERE / "cycles.json").read_text())
    runs = data["runs"]
    wrong, far = [], []
    sums = {}
    if arguments.gvsoc:
        gvsoc.peer()
    (found, seconds), *peer = measured(gvsoc.built(arguments.build, "mebots-soc"), data, arguments.gvsoc)
    heads = ["kernel", "cores", "silicon", "MEbots", "off", "missing"]
    heads += ["GVSoC", "off"] if peer else []
    print("| " + " | ".join([*heads, "use"]) + " |\n|" + "---|" * (len(heads) + 1))
    for index, (row, (cycles, total)) in enumerate(zip(data["rows"], found)):
        name = f"{row['kernel']}, {row['cores']} cores"
        off = cycles / row["cycles"] - 1
        less = (row["cycles"] - cycles) / runs
        cells = [row["kernel"], row["cores"], f"{row['cycles'] / runs:.0f}", f"{cycles / runs:.0f}", f"{off * 100:+.1f} %",
                 f"{less:.0f}"]
        if peer:
            its_cycles, its_total = peer[0][0][index]
            cells += [f"{its_cycles / runs:.0f}", f"{(its_cycles / row['cycles'] - 1) * 100:+.1f} %"]
            if its_total != total:
                wrong.append(f"{name}: another result than GVSoC's")
        print("| " + " | ".join(map(str, [*cells, row["use"]])) + " |")
        if abs(off) > MOST_OFF.get(row["use"], 1):
            far.append(f"{name}: {off * 100:+.1f} % off silicon")
        kernel = row["kernel"].removesuffix(", vector")
        if (row["kernel"], row["cores"]) != OTHER_FILTER and sums.setdefault(kernel, total) != total:
            wrong.append(f"{name}: another result than with its other forms")
    if peer:
        print(f"\nProcessor time: {seconds:.2f} s here, {peer[0][1]:.1f} s in GVSoC: {peer[0][1] / seconds:.0f} times as much.")
    for each in wrong + far:
        print(each, file=sys.stderr)
    return 1 if wrong or (arguments.check and far) else 0


if __name__ == "__main__":
    sys.exit(main())
