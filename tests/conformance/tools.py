# SPDX-License-Identifier: Apache-2.0
"""Builds and runs the programs of the suites, and returns their output."""

import dataclasses
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "bench/soc"))
from run import GCC, spike_path  # noqa: E402

COMPILER = GCC[0]
BARE = [COMPILER, "-static", "-mcmodel=medany", "-fvisibility=hidden", "-nostdlib", "-nostartfiles"]
WAYS = ((), ("--interpret",))  # each program runs translated and interpreted
SECONDS = 120  # wall time for one program in one simulator


def soc_run(soc, isa="rv32imc"):
    """Returns the command of mebots-soc with a core that has no properties beyond the specification. Other cores require a
    larger alignment of trap handlers than the 4 bytes in the suites.
    """
    return [soc, "run", "--core", isa]


@dataclasses.dataclass
class Verdict:
    """The verdict of a test: passed, or the reason of the failure."""

    name: str
    passed: bool
    note: str = ""


class CannotRun(Exception):
    """Raised if a checkout or a tool is missing."""


def run(command, **options):
    """Returns exit code and output. After a timeout, the exit code is None."""
    try:
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True, errors="replace", timeout=SECONDS,
                              **options)
    except subprocess.TimeoutExpired:
        return None, f"not done after {SECONDS} s"
    return done.returncode, done.stdout + done.stderr


def build(command):
    """Returns the compiler's error message; empty if the compilation succeeded."""
    code, text = run(command)
    return None if code == 0 else f"does not compile: {text.strip().splitlines()[0] if text.strip() else code}"


def spike():
    path = spike_path()
    if path is None:
        raise CannotRun("Spike is missing: scripts/setup.sh bench installs it")
    return path


def checkout(folder, name, address):
    path = folder / name
    if not path.is_dir():
        raise CannotRun(f"{path} is missing: git clone {address} {path}")
    return path


def commit(path):
    code, text = run(["git", "-C", path, "log", "-1", "--format=%h of %cs"])
    return text.strip() if code == 0 else "no checkout of git"
