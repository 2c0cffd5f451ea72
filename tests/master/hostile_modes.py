#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints a Markdown table: the effect of each fault of the FMU in tests/fmus/probe.c, by kind of process.

Usage: hostile_modes.py MEBOTS PROBE.fmu [--compare FILE]

Every cell is a run of two instances, of which the second one fails half-way. With --compare, all rows must be in FILE:
exits with 1 if one is not, and with 77 on a kernel that cannot block signals from a sandbox (before Linux 6.12) or cannot
create a sandbox.
"""

import argparse
import concurrent.futures
import ctypes
import json
import os
import pathlib
import resource
import signal
import subprocess
import sys
import tempfile
import time

PROCESSES = ("shared", "own", "sandboxed")
PATIENCE_S = 60  # time limit of a run; a run that exceeds it hangs
SHARED_HANGS_S = 8  # time limit if the FMU runs in the master's process, which cannot end a call
MEMORY_BYTES = 1 << 30  # memory limit for runs that use all memory
SKIPPED = 77

MODES = {
    "null": "writes to address 0",
    "bus": "reads beyond the end of a mapped file",
    "division": "divides by zero",
    "illegal": "illegal instruction",
    "abort": "abort()",
    "stack": "overflows its stack",
    "memory": "takes all memory",
    "exit": "exit(3)",
    "quick_exit": "quick_exit(0)",
    "_exit": "_exit(0)",
    "kernel_exit": "exit_group(0) by the kernel",
    "pthread_exit": "pthread_exit() on the thread that called it",
    "cancel": "pthread_cancel() of the thread that called it",
    "exec": "execl() of another program",
    "alarm": "SIGALRM of a timer that it started",
    "usr1": "raise(SIGUSR1)",
    "block": "blocks all signals",
    "fork_returns": "a process that it forks returns from the call",
    "vfork_returns": "the same with vfork()",
    "throw": "a C++ exception through the C interface",
    "throw_number": "the same with a number",
    "bad_string": "a text output at an unmapped address",
    "child_exit": "a process that it forks calls exit(3)",
    "hang": "a step does not return",
    "error": "fmi2Error",
    "fatal": "fmi2Fatal",
    "nan": "an output is NaN",
    "infinity": "an output is infinite",
    "huge_state": "claims a state of 32 TiB",
    "log_foreign": "messages with a foreign or null environment",
    "log_thread": "messages from a separate thread",
    "log_format": "messages with hostile formats",
    "log_bytes": "messages with control characters, not UTF-8",
    "log_errors": "the same error message in every step",
    "log_flood": "600 messages of 65 KB in one step",
    "upward": "changes the rounding of floating point",
    "meddle": "changes file mask, folder, limits and a signal handler, closes a descriptor",
    "meddle_thread": "changes signal mask, timers, priority, affinity and data of a thread",
    "close": "closes all descriptors",
    "own_file": "opens a file",
    "thread_stays": "leaves a thread",
    "orphan": "starts a process that continues after the run",
    "daemon": "starts a process in a new session, and hangs",
    "kill_group": "SIGKILL to its process group",
    "harm_others": "signals, limits, memory and tracing of two other processes",
    "forge_log": "forges the length of its messages",
    "forge_length": "forges the length of its answer",
    "forge_answer": "forges its answer",
    "forge_calls": "forges the count of calls, and hangs",
    "free_crash": "crashes when it is freed",
    "free_hang": "hangs when it is freed",
    "free_exit": "exit(0) when it is freed",
    "free_throw": "a C++ exception when it is freed",
    "destructor": "crashes when its library is unloaded",
}
NEEDS_CHECKPOINT = {"huge_state"}
WHEN_FREED = {"free_crash", "free_hang", "free_exit", "free_throw", "destructor"}


def config_of(fmu, process):
    misbehaving = {"fmu": fmu, "process": process}
    if process != "shared":
        misbehaving |= {"deadline": 3, "memory_limit_mb": 200}
    return {"step": 0.01, "stop_time": 1, "instances": {"a": {"fmu": fmu, "parameters": {"gain": 0.5, "offset": 1}},
                                                        "b": misbehaving},
            "connections": [{"from": "a.real_out", "to": "b.real_in"}, {"from": "b.real_out", "to": "a.real_in"},
                            {"from": "b.string_out", "to": "a.string_in"}],
            "record": ["a.real_out", "b.real_out", "b.integral", "b.last_end", "b.steps"]}


def processes_with(folder):
    """Returns processes with the folder in their environment, and sandboxed processes with the unpacked FMU in their command line."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and (f"MEBOTS_TEST={folder}".encode() in (entry / "environ").read_bytes()
                                         or f"{folder}/mebots".encode() in (entry / "cmdline").read_bytes()):
                found.append(int(entry.name))
        except OSError:
            continue
    return found


def end_all(folder):
    """Ends the remaining processes of a run. Returns True if there were any."""
    found = processes_with(folder)
    for number in found:
        try:
            os.kill(number, signal.SIGKILL)
        except ProcessLookupError:
            pass
    return bool(found)


class Bystander:
    """A process of the same user outside the run."""

    def __enter__(self):
        self.process = subprocess.Popen(["sleep", "1000"], start_new_session=True)
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()

    def lives(self):
        return self.process.poll() is None


class Outcome:
    def __init__(self, code, text, rows, caller_lives, bystander_lives, left):
        self.code, self.text, self.rows = code, text, rows
        self.caller_lives, self.bystander_lives, self.left = caller_lives, bystander_lives, left


def run(program, fmu, process, mode, limit_memory=False):
    """Runs the program in a new session with its own parent process, which the FMU may harm."""
    with tempfile.TemporaryDirectory(prefix="mebots-hostile-") as name, Bystander() as bystander:
        folder = pathlib.Path(name)
        (folder / "two.json").write_text(json.dumps(config_of(fmu, process)))
        (folder / "secret.txt").write_text("of the user")
        at = 9 if mode in WHEN_FREED | NEEDS_CHECKPOINT else 0.5
        command = [program, "run", "two.json", "--out", "out", "--set", f"b.fault={mode}", "--set", f"b.fault_time={at}"]
        if mode in NEEDS_CHECKPOINT:
            command += ["--checkpoint-every", "0.5"]
        environment = os.environ | {"MEBOTS_TEST": name, "MEBOTS_TEST_BYSTANDER": str(bystander.process.pid),
                                    "MEBOTS_TEST_SECRET": str(folder / "secret.txt"), "TMPDIR": name}
        limit = (lambda: resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))) if limit_memory else None
        with open(folder / "errors", "wb") as errors:
            caller = subprocess.Popen(["sh", "-c", '"$@"; echo $? > code', "sh", *map(str, command)], cwd=folder, env=environment,
                                      stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=errors, start_new_session=True,
                                      preexec_fn=limit)
            try:
                caller.wait(SHARED_HANGS_S if process == "shared" else PATIENCE_S)
                hangs = False
            except subprocess.TimeoutExpired:
                hangs = True
            code = "hangs" if hangs else int((folder / "code").read_text()) if (folder / "code").exists() else None
            caller_lives = hangs or caller.returncode >= 0
            time.sleep(0.1)  # an ending process may still be in the list
            left = end_all(name)
            caller.wait()
        results = folder / "out" / "results.csv"
        rows = results.read_text().splitlines() if results.exists() else []
        text = (folder / "errors").read_text(errors="replace")
        for trace in (pathlib.Path("/tmp/mebots-probe-was-here"),):
            trace.unlink(missing_ok=True)
        return Outcome(code, text, rows, caller_lives, bystander.lives(), left and not hangs)


def is_named(text):
    """True if the text names the instance or, after it was freed, its FMU."""
    return "'b'" in text or "probe.fmu" in text or "] b: " in text


def cell(mode, outcome, good_rows):
    if not outcome.caller_lives:
        return "ends its caller as well"
    complete = len(outcome.rows) == len(good_rows)
    if outcome.code == "hangs":
        said = ["hangs until it is killed"]
    elif outcome.code > 128:
        said = [f"dies of {signal.Signals(outcome.code - 128).name}"]
    else:
        said = [{0: "continues", 1: "fails"}.get(outcome.code, "refused") if complete or outcome.code else "ends with exit code 0"]
    if is_named(outcome.text):
        said.append("reported" if said == ["continues"] else "named")
    elif outcome.code == 0 and outcome.rows == good_rows:
        said = ["harmless"]
    elif outcome.code != "hangs":
        said.append("no message")
    if mode == "escape":
        inside = outcome.rows and outcome.rows[-1].split(",")[-1] == "1000"
        return "refused" if inside else "succeeds"
    if outcome.rows != good_rows:
        last = outcome.rows[-1].split(",")[0] if len(outcome.rows) > 1 else None
        said.append(f"results to {last} s" if last and last != "1" else "no results" if last is None else "other results")
    elif outcome.code != 0:
        said.append("all results")
    if not outcome.bystander_lives:
        said.append("others die")
    if outcome.left:
        said.append("processes stay")
    return ", ".join(said)


def lacks_kernel(program, fmu):
    create_ruleset, ask_version = 444, 1
    version = ctypes.CDLL(None).syscall(create_ruleset, None, ctypes.c_size_t(0), ask_version)
    return version < 6 or "refuses a part of its sandbox" in run(program, fmu, "sandboxed", "").text


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("fmu", type=pathlib.Path)
    parser.add_argument("--compare", type=pathlib.Path)
    arguments = parser.parse_args()
    program, fmu = arguments.program.resolve(), str(arguments.fmu.resolve())
    if arguments.compare and lacks_kernel(program, fmu):
        print("this kernel gives no whole sandbox, or does not keep signals inside")
        return SKIPPED
    good_rows = run(program, fmu, "shared", "").rows
    if len(good_rows) != 102:
        print("the run without a fault does not come to its end", file=sys.stderr)
        return 1

    def line(mode):
        cells = [cell(mode, run(program, fmu, process, mode, mode == "memory" and process == "shared"), good_rows) for process in PROCESSES]
        return f"| {MODES[mode]} | {' | '.join(cells)} |"

    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        lines = ["| the FMU | in the master's process | `own` | `sandboxed` |", "|---|---|---|---|", *pool.map(line, MODES)]
    print("\n".join(lines))
    if not arguments.compare:
        return 0
    table = arguments.compare.read_text().splitlines()
    missing = [one for one in lines if one not in table]
    for one in missing:
        print(f"not in {arguments.compare}: {one}", file=sys.stderr)
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
