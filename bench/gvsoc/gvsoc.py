# SPDX-License-Identifier: Apache-2.0
"""Runs GVSoC, programs of a build folder and the cross compiler for scripts of this folder. Reads the files that programs write.
The variable MEBOTS_GVSOC contains the path of GVSoC; otherwise, GVSoC is `gvsoc` on PATH."""

import os
import pathlib
import re
import resource
import shutil
import signal
import struct
import subprocess

LONGEST_S = 600


def program(name, mend):
    """Returns the program's path. If the program is missing, prints the remedy `mend` and exits."""
    path = shutil.which(name)
    if not path:
        raise SystemExit(f"{name} is missing: {mend}")
    return pathlib.Path(path).absolute()


def peer():
    return program(os.environ.get("MEBOTS_GVSOC") or "gvsoc",
                   "name GVSoC's program in MEBOTS_GVSOC, or put `gvsoc` on the PATH")


def built(build, name):
    return program(build / "bin" / name, f"name a build folder, and build it: cmake --build {build} --target {name}")


def compiler():
    return program("riscv64-unknown-elf-gcc", "scripts/setup.sh installs it")


def processor_time(command, folder):
    """Runs a command. Returns (output, exit code, processor time [s])."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    # GVSoC's program starts other programs. A separate session makes it possible to end all of them together.
    with subprocess.Popen([str(part) for part in command], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True, errors="replace", start_new_session=True) as running:
        try:
            out, err = running.communicate(timeout=LONGEST_S)
        except subprocess.TimeoutExpired:
            os.killpg(running.pid, signal.SIGKILL)
            out, err = running.communicate()
            raise SystemExit(f"{command[0]}: not done after {LONGEST_S} s:\n{out}{err}")
        except BaseException:
            os.killpg(running.pid, signal.SIGKILL)
            raise
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return out + err, running.returncode, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def run(program, folder):
    """Runs an ELF in a separate folder on GVSoC's open PULP chip (target pulp-open)."""
    return processor_time([peer(), "--target=pulp-open", f"--work-dir={folder}", "--binary", pathlib.Path(program).absolute(),
                           "image", "flash", "run"], folder)


def instructions_of(done):
    """Returns the instructions of all cores, from the output of mebots-soc."""
    return sum(map(int, re.findall(r"^instructions .*", done[0], re.MULTILINE)[-1].split()[1:]))


def left_by(simulator, done, folder):
    """Returns the content of the file "result" of a successful program, and deletes the file."""
    text, code, _ = done
    file = folder / "result"
    if code != 0:
        raise SystemExit(f"{simulator}: the program ended with {code}:\n{text}")
    if not file.exists():
        raise SystemExit(f"{simulator}: the program left no result:\n{text}")
    data = file.read_bytes()
    file.unlink()
    return data


def words_left_by(simulator, done, folder):
    data = left_by(simulator, done, folder)
    if not data or len(data) % 4:
        raise SystemExit(f"{simulator}: the program left {len(data)} bytes, no whole number of words")
    return struct.unpack(f"<{len(data) // 4}I", data)
