#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs clang-tidy with the rules of .clang-tidy over all C++ sources, tests and benchmarks included.

The build folder must have been built with GCC and a preset with unity builds. Most of clang-tidy's time is spent in library
headers, so sources with common headers are checked together. A group is checked only if the group, one of its headers or a rule
has changed since the group was last clean. ~/.cache/mebots-lint lists the clean groups. clang-tidy comes from PyPI: Debian's
version also checks library headers, which takes four times as long. clang-tidy does not support all of GCC's warnings.

Usage: scripts/lint.py [BUILD_DIR]
"""
import concurrent.futures
import functools
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
TIDY = ROOT / ".venv/bin/clang-tidy"
REMEMBERED = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache") / "mebots-lint"
OPTIONS = ["-quiet", "-extra-arg=-Wno-unknown-warning-option", "-extra-arg=-Wno-deprecated-declarations"]
PRODUCT = re.compile(r"(modeldesc|fmu_[a-z]+|master)/")
# Exempts tests from these rules. Tests start other programs, check that code throws, use reproducible random numbers, count in
# whole pixels and ticks, and need not be fast.
OFF_IN_TESTS = ("bugprone-command-processor bugprone-empty-catch bugprone-implicit-widening-of-multiplication-result "
                "bugprone-derived-method-shadowing-base-method bugprone-reserved-identifier bugprone-integer-division "
                "bugprone-unchecked-string-to-number-conversion bugprone-random-generator-seed bugprone-float-loop-counter "
                "clang-analyzer-security.FloatLoopCounter performance-* readability-redundant-declaration").split()


def groups(build):
    """Returns the compile commands of the unity sources that contain C++."""
    commands = json.loads((build / "compile_commands.json").read_text())
    return [entry for entry in commands if re.search(r"/Unity/unity_\d+_cxx\.cxx$", entry["file"])]


def dependencies(build):
    """Maps each object file, by its path in the build folder, to the files that its compilation has read. Ninja recorded them."""
    found, files = {}, []
    for line in subprocess.run(["ninja", "-C", build, "-t", "deps"], capture_output=True, text=True, check=True).stdout.splitlines():
        if line.startswith("    "):
            files.append(line.strip())
        elif ": #deps" in line:
            files = found[line.split(":")[0]] = []
    return found


@functools.cache
def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


@functools.cache
def version():
    return subprocess.run([TIDY, "--version"], capture_output=True, text=True, check=True).stdout


def key(build, entry, options, files):
    """Returns a hash of everything that affects clang-tidy's result for a group of sources. The path of the checkout does
    not affect it."""
    text = [version(), digest(ROOT / ".clang-tidy"), *options, entry["command"]]
    text += [f"{file} {digest(build / file)}" for file in files if not file.endswith("_cxx.cxx")]
    text += [pathlib.Path(entry["file"]).read_text()]
    return hashlib.sha256("\n".join(text).replace(str(ROOT), "").encode()).hexdigest()


def check(build, entry, files):
    """Runs clang-tidy on a group. Returns its output, and true if it found no fault."""
    in_product = PRODUCT.match(str(pathlib.Path(entry["file"]).relative_to(build)))
    options = OPTIONS if in_product else [*OPTIONS, "-checks=" + ",".join(f"-{name}" for name in OFF_IN_TESTS)]
    remembered = REMEMBERED / key(build, entry, options, files) if files else None
    if remembered and remembered.exists():
        return "", True
    result = subprocess.run([TIDY, "-p", build, *options, entry["file"]], capture_output=True, text=True)
    if result.returncode == 0 and remembered:
        remembered.touch()
    return result.stdout + result.stderr, result.returncode == 0


def main(build):
    todo = groups(build)
    if not todo:
        sys.exit(f"{build} has no unity sources: configure it with cmake --preset ci")
    files_of = dependencies(build)
    REMEMBERED.mkdir(parents=True, exist_ok=True)
    complaints = set()
    failed = False
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as threads:
        def run(entry):
            return check(build, entry, files_of.get(entry["command"].split(" -o ")[1].split()[0]))
        for output, clean in threads.map(run, todo):
            failed |= not clean
            complaints |= set(re.findall(r"^.*(?:error|warning):.*$", output, re.M)) if not clean else set()
    if failed:
        print(*sorted(complaints), "clang-tidy found problems", sep="\n", file=sys.stderr)
        sys.exit(1)
    print(f"clang-tidy: nothing to say about {len(todo)} groups of sources")


main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build/ci").resolve())
