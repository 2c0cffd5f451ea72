# SPDX-License-Identifier: Apache-2.0
"""Builds the library of io_faults.c, and runs programs with it. The library makes calls of the C library for the files of one
folder fail."""

import array
import errno
import os
import pathlib
import shutil
import subprocess

KINDS = ("write", "pwrite", "fsync", "fdatasync", "rename", "link", "close", "ftruncate")
"""The kinds of calls, in the order of io_faults.c."""
SHORT = -1
FAULTS = {"ENOSPC": errno.ENOSPC, "EIO": errno.EIO, "EINTR": errno.EINTR, "short write": SHORT}
HARMLESS = ("EINTR", "short write")
"""Faults after which the program must continue unaffected."""
STICKY = " from then on"


def faults_of(kind):
    """Returns the names of the possible faults of a kind of calls. EINTR is never sticky, because a call that is always
    interrupted would never end."""
    once = [name for name in FAULTS if name != "short write" or kind in ("write", "pwrite")]
    return once + [name + STICKY for name in once if name != "EINTR"]


def library(folder):
    """Compiles the library. Returns its path. If there is no C compiler, returns None."""
    compiler = shutil.which("cc")
    if compiler is None:
        return None
    file = pathlib.Path(folder) / "io_faults.so"
    source = pathlib.Path(__file__).with_name("io_faults.c")
    subprocess.run([compiler, "-shared", "-fPIC", "-O1", "-o", str(file), str(source), "-ldl"], check=True)
    return file


def run(preload, command, folder, kind="", fault="", nth=0):
    """Runs a command with or without a fault. Returns the result of subprocess, and the number of calls of each kind."""
    counts = pathlib.Path(preload).with_suffix(".counts")
    counts.write_bytes(bytes(8 * len(KINDS)))
    environment = os.environ | {
        "LD_PRELOAD": str(preload),
        "IO_FAULTS_COUNTS": str(counts),
        "IO_FAULTS_FOLDER": str(folder),
        "IO_FAULTS_KIND": str(KINDS.index(kind) if kind else 0),
        "IO_FAULTS_ERROR": str(FAULTS[fault.removesuffix(STICKY)] if fault else 0),
        "IO_FAULTS_STICKY": str(int(fault.endswith(STICKY))),
        "IO_FAULTS_NTH": str(nth),
    }
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120)
    numbers = array.array("l", counts.read_bytes())
    return done, dict(zip(KINDS, numbers, strict=True))


def numbers(count, most):
    """Returns the numbers of the calls to fail: all calls, or `most` calls that include the first and the last."""
    return range(1, count + 1) if count <= most else sorted({1 + round(at * (count - 1) / (most - 1)) for at in range(most)})


def table_row(files, kind, fault, count, ends):
    """Returns a row of the Markdown table of faults. ``ends`` is a Counter of the outcomes. An empty text means the required
    outcome."""
    others = "; ".join(f"{number}: {text}" for text, number in ends.items() if text)
    return f"| {files} | {kind} | {fault} | {ends.total()} of {count} | {ends['']} | {others} |"


TABLE_HEAD = "| files | call | fault | calls | as required | otherwise |\n|---|---|---|---|---|---|"
