# SPDX-License-Identifier: Apache-2.0
"""GVSoC, where there is one: the program that the variable MEBOTS_GVSOC names, else the one on the PATH."""

import os
import pathlib
import resource
import shutil
import subprocess

LONGEST_S = 600
MISSING = "GVSoC is missing: name its program in MEBOTS_GVSOC, or put `gvsoc` on the PATH"


def path():
    """None: there is none, or what is named does not exist."""
    return shutil.which(os.environ.get("MEBOTS_GVSOC") or "gvsoc")


def processor_time(command, folder):
    """(what the command printed, its exit code or None when it took too long, its processor time [s])."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    try:
        done = subprocess.run([str(part) for part in command], cwd=folder, capture_output=True, text=True,
                              errors="replace", timeout=LONGEST_S)
        text, code = done.stdout + done.stderr, done.returncode
    except subprocess.TimeoutExpired as late:
        text, code = (late.stdout or b"").decode(errors="replace"), None
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return text, code, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def run(program, folder):
    """Runs an ELF on GVSoC's open PULP chip (target pulp-open), in a folder of its own."""
    gvsoc = pathlib.Path(path()).absolute()
    return processor_time([gvsoc, "--target=pulp-open", f"--work-dir={folder}", "--binary", pathlib.Path(program).absolute(),
                           "image", "flash", "run"], folder)
