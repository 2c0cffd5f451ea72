# SPDX-License-Identifier: Apache-2.0
"""What the filter of system calls and Landlock cost a step of an FMU in a process of its own: the same run with and without them, in
turns, by a preloaded library that leaves them out. Usage: filter_cost.py MEBOTS PASSTHROUGH.fmu [--pairs 20] [--steps 50000] [--core 0]

Processor time of mebots and all its processes on one core, so that nobody spins beside the other. Medians and quartiles; a pair's
ratio is of two runs that follow each other, so that what else the machine does counts in both.
"""

import argparse
import json
import os
import pathlib
import resource
import statistics
import subprocess
import tempfile

# In front of both runs, so that it costs both the same.
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


def microseconds_a_step(program, config, steps, core, library, without):
    def used():
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return usage.ru_utime + usage.ru_stime
    environment = os.environ | {"LD_PRELOAD": str(library)} | ({"WITHOUT_FILTER": "1"} if without else {})
    before = used()
    subprocess.run([program, "run", config, "--quiet", "--out", config.parent / "out"], check=True, cwd=config.parent, env=environment,
                   preexec_fn=lambda: os.sched_setaffinity(0, {core}))
    return 1e6 * (used() - before) / steps


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
        with_them, without = [], []
        for pair in range(arguments.pairs):
            kinds = [(with_them, False), (without, True)]
            for values, left_out in kinds if pair % 2 == 0 else reversed(kinds):
                values.append(microseconds_a_step(program, config, arguments.steps, arguments.core, library, left_out))
    print("| us a step | lower quartile | median | upper quartile |\n|---|---|---|---|")
    print(row("with filter and Landlock", with_them))
    print(row("without", without))
    print(row("ratio of a pair", [a / b for a, b in zip(with_them, without)]))


if __name__ == "__main__":
    main()
