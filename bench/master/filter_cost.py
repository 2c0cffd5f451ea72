# SPDX-License-Identifier: Apache-2.0
"""Measures the cost of the system call filter and of Landlock for a step of an FMU in a separate process. Alternates runs with
both and runs without them. For the latter, a preloaded library prevents their set-up. Usage: filter_cost.py MEBOTS
PASSTHROUGH.fmu [--pairs 20] [--steps 50000] [--core 0]

Measures the processor time of mebots and all its processes on one core, so that no process spins in parallel. Prints medians and
quartiles. The ratio of a pair compares two consecutive runs, so that other work on the machine affects both. First, a run of each
kind checks in /proc/PID/status whether the FMU's process has the filter. (The kernel does not show Landlock there.)
"""

import argparse
import json
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile
import time

# Runs with and runs without the filters preload this library, so that both have the cost of preloading.
LIBRARY = """
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdarg.h>
#include <stdlib.h>
#include <sys/syscall.h>
static long (*next)(long, ...);
static int (*load)(void*);
static int without;
__attribute__((constructor)) static void begin(void) {
  next = (long (*)(long, ...))dlsym(RTLD_NEXT, "syscall");
  load = (int (*)(void*))dlsym(RTLD_NEXT, "seccomp_load");
  without = getenv("WITHOUT_FILTER") != NULL;
}
int seccomp_load(void* filter) { return without ? 0 : load(filter); }
long syscall(long number, ...) {
  va_list list;
  va_start(list, number);
  long a[6];
  for (int i = 0; i < 6; ++i) a[i] = va_arg(list, long);
  va_end(list);
  if (without && number == SYS_landlock_restrict_self) return 0;
  return next(number, a[0], a[1], a[2], a[3], a[4], a[5]);
}
"""


def start(program, config, core, library, without):
    environment = os.environ | {"LD_PRELOAD": str(library)} | ({"WITHOUT_FILTER": "1"} if without else {})
    return subprocess.Popen([program, "run", config, "--quiet", "--out", config.parent / "out"], cwd=config.parent, env=environment,
                            preexec_fn=lambda: os.sched_setaffinity(0, {core}))


def ended(run):
    if run.wait() != 0:
        sys.exit(f"filter_cost.py: {run.args[0]} ended with {run.returncode}")


def microseconds_a_step(steps, *what):
    def used():
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return usage.ru_utime + usage.ru_stime
    before = used()
    ended(start(*what))
    return 1e6 * (used() - before) / steps


def status(pid):
    """Returns the kernel's status of a process. If the process has ended, returns an empty dict."""
    try:
        return dict(line.split(":", 1) for line in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines())
    except (FileNotFoundError, ProcessLookupError):
        return {}


def below(pid):
    """Yields the descendants of a process."""
    for file in pathlib.Path(f"/proc/{pid}/task").glob("*/children"):
        try:
            children = file.read_text().split()
        except (FileNotFoundError, ProcessLookupError):
            continue
        for child in children:
            yield child
            yield from below(child)


def check_the_filter(*what):
    """Exits if no process of an FMU has a filter in a run with filters, or if a process has a filter in a run without them.
    Ignores the filters of this process, which a container may have added.
    """
    def filters(of):
        return int(of.get("Seccomp_filters", 0))
    own = status("self")
    if "Seccomp_filters" not in own:
        sys.exit("filter_cost.py: /proc/PID/status has no line Seccomp_filters here (Linux 5.9), so the filter cannot be detected")
    run = start(*what)
    seen = set()
    while run.poll() is None:
        hosts = [of for of in map(status, below(run.pid)) if of.get("Name", "").strip() == "mebots-fmu-host"]
        seen |= {filters(of) - filters(own) for of in hosts}
        time.sleep(0.001)
    ended(run)
    without = what[-1]
    if not seen or (max(seen) > 0) == without:
        sys.exit(f"filter_cost.py: mebots-fmu-host had {max(seen, default='no process, and so no')} filters in the run "
                 f"{'without' if without else 'with'} them; the comparison would mean nothing")


def row(name, values):
    least, middle, most = statistics.quantiles(values, n=4)
    return f"| {name} | {least:.3g} | {middle:.3g} | {most:.3g} |"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("fmu", type=pathlib.Path)
    parser.add_argument("--pairs", type=int, default=20)
    parser.add_argument("--steps", type=int, default=50_000)
    parser.add_argument("--core", type=int, default=0)
    arguments = parser.parse_args()
    program, fmu = arguments.program.resolve(), arguments.fmu.resolve()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        source, library = folder / "before.c", folder / "before.so"
        source.write_text(LIBRARY)
        subprocess.run(["cc", "-shared", "-fPIC", "-O2", "-o", library, source, "-ldl"], check=True)
        config = folder / "one.json"
        config.write_text(json.dumps({"step": 0.1, "stop_time": round(0.1 * arguments.steps, 1), "record": ["a.y"], "connections": [],
                                      "instances": {"a": {"fmu": str(fmu), "process": "own"}}}))
        for left_out in (False, True):
            check_the_filter(program, config, arguments.core, library, left_out)
        with_them, without = [], []
        for pair in range(arguments.pairs):
            kinds = [(with_them, False), (without, True)]
            for values, left_out in kinds if pair % 2 == 0 else reversed(kinds):
                values.append(microseconds_a_step(arguments.steps, program, config, arguments.core, library, left_out))
    print("| us a step | lower quartile | median | upper quartile |\n|---|---|---|---|")
    print(row("with filter and Landlock", with_them))
    print(row("without", without))
    print(row("ratio of a pair", [a / b for a, b in zip(with_them, without)]))


if __name__ == "__main__":
    main()
