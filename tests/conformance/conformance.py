# SPDX-License-Identifier: Apache-2.0
"""Tests the chip with suites by others (scripts/conformance.sh). Prints the Markdown page docs/conformance.md.

Every program runs translated and interpreted. The exit code is 1 if a failure is not named in EXPLAINED, or if a named one
passes. If a checkout or a tool is missing, prints the command that fetches it, and the exit code is 2.
"""

import argparse
import concurrent.futures
import os
import pathlib
import sys
import tempfile

import arch_test
import benchmarks
import riscv_tests
from tools import COMPILER, CannotRun, commit, run, spike

EXPLAINED = {
    "rv32mi breakpoint": "The test needs triggers of the debug specification, which GAP8's cores and this model lack",
}


def each_on(jobs):
    """Runs the tests on several processors, and shows the progress. Returns the results in the order of the tests."""

    def each(function, tests):
        done = []
        with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
            for result in pool.map(function, tests):
                done.append(result)
                print(f"\r{len(done)} of {len(tests)} ", end="", file=sys.stderr, flush=True)
        print("\r" + 20 * " " + "\r", end="", file=sys.stderr)
        return done

    return each


def failures(verdicts):
    lines = []
    for verdict in verdicts:
        if not verdict.passed:
            lines.append(f"- `{verdict.name}`: {verdict.note}. " + (EXPLAINED[verdict.name] + "."
                                                                 if verdict.name in EXPLAINED else "**Not explained.**"))
    return lines


def page(versions, results):
    lines = ["# Conformance", "",
             "Look up which published test suites the model of the chip passes. `scripts/conformance.sh` generates this page. The comment at the start",
             "of this script names the sources of the programs. Every program runs twice: once translated to host code, and once interpreted. A program",
             "passes if both runs pass.", "",
             "| suite | criterion | passed |", "|---|---|---|"]
    for name, judged, verdicts in results:
        lines.append(f"| {name} | {judged} | {sum(v.passed for v in verdicts)} of {len(verdicts)} |")
    failed = [line for _, _, verdicts in results for line in failures(verdicts)]
    lines += ["", "## Failures", "", *(failed or ["None."])]
    lines += ["", "## Instructions of whole programs", "",
              "The table has the number of executed instructions. It must equal Spike's number exactly. Each program runs its main loop once and checks",
              "its own result.", "",
              "| program | " + " | ".join(f"`{level}`" for level in benchmarks.LEVELS) + " |", "|---|---|---|"]
    notes = {verdict.name: verdict.note for verdict in results[-1][2]}
    for program in dict.fromkeys(name.split()[0] for name in notes):
        lines.append(f"| {program} | " + " | ".join(notes[f"{program} {level}"] for level in benchmarks.LEVELS) + " |")
    return "\n".join([*lines, "", "## Versions", "", *(f"- {what}: {version}" for what, version in versions.items())]) + "\n"


def main():
    parser = argparse.ArgumentParser(description="Run published test suites on the model of the chip")
    parser.add_argument("folder", type=pathlib.Path, help="with checkouts of riscv-tests, riscv-arch-test, embench-iot, coremark")
    parser.add_argument("soc", type=pathlib.Path, help="the program mebots-soc")
    parser.add_argument("--out", type=pathlib.Path, help="write the page to this file too")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    options = parser.parse_args()
    folder, soc, each = options.folder.resolve(), options.soc.resolve(), each_on(options.jobs)
    try:
        with tempfile.TemporaryDirectory() as name:
            work = pathlib.Path(name)
            results = [("riscv-tests: " + ", ".join(riscv_tests.SUITES), "the check of each test", riscv_tests.judge(folder, soc, work, each)),
                       ("riscv-arch-test: " + ", ".join(arch_test.SUITES), "the signature is equal to Spike's", arch_test.judge(folder, soc, work, each)),
                       ("Embench-IoT, CoreMark", "the check of each program, and Spike's number of instructions", benchmarks.judge(folder, soc, work, each))]
        versions = {"Spike": run([spike(), "--help"])[1].splitlines()[0], "compiler": run([COMPILER, "--version"])[1].splitlines()[0]}
    except CannotRun as error:
        print(f"conformance.sh: {error}", file=sys.stderr)
        return 2
    versions |= {name: commit(folder / name) for name in ("riscv-tests", "riscv-arch-test", "embench-iot", "coremark")}
    text = page(versions, results)
    print(text, end="")
    if options.out:
        options.out.write_text(text)
    failed = {verdict.name for _, _, verdicts in results for verdict in verdicts if not verdict.passed}
    for name in sorted(EXPLAINED.keys() - failed):
        print(f"conformance.sh: {name} passes; take it out of EXPLAINED", file=sys.stderr)
    return 0 if failed == EXPLAINED.keys() else 1


if __name__ == "__main__":
    sys.exit(main())
