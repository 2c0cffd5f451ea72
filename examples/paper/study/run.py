# SPDX-License-Identifier: Apache-2.0
"""Flies flights by `mebots run`, several at a time, and keeps what they gave."""

import concurrent.futures
import dataclasses
import functools
import hashlib
import json
import os
import pathlib
import subprocess
import sys
import time

from missions import ROOT, config

FMUS = ("fmu_soc", "fmu_world", "fmu_motors", "fmu_battery")


@dataclasses.dataclass(frozen=True)
class Place:
    """Where the programs are, where results go, and how many flights may fly at a time."""
    build: pathlib.Path
    results: pathlib.Path
    jobs: int

    @functools.cached_property
    def programs(self):
        """Hash of all that flies a flight, but for its config."""
        files = [self.build / "bin/mebots", *(self.build / f"fmus/{name}.fmu" for name in FMUS)]
        return hashlib.sha256(b"".join(hashlib.sha256(file.read_bytes()).digest() for file in files)).hexdigest()


def run(command):
    """Runs a program; returns its exit code, output, seconds of processor and the most memory it held [MB]."""
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        output = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, output, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024 / 1e6


def fly(flight, place):
    """Flies one flight into results/<name>; returns its summary with the place of its files and what it cost. A
    flight that was flown with the same config and programs is not flown again."""
    folder = place.results / flight.name
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps(config(flight), indent=2) + "\n"
    fresh = False
    key = hashlib.sha256((text + place.programs).encode()).hexdigest()
    done = folder / "done.json"
    cost = json.loads(done.read_text()) if done.exists() else {}
    if cost.get("key") != key:
        fresh = True
        done.unlink(missing_ok=True)
        (folder / "config.json").write_text(text)
        start = time.monotonic()
        command = [str(place.build / "bin/mebots"), "run", str(folder / "config.json"), "--out", str(folder),
                   "--statistics", "--quiet"]
        code, output, processor_s, memory_mb = run(command)
        if code != 0:
            raise RuntimeError(f"{flight.name}: {' '.join(command)} ended with {code}: {output.strip()}")
        cost = {"key": key, "seconds": time.monotonic() - start, "processor_s": processor_s, "memory_mb": memory_mb}
        done.write_text(json.dumps(cost) + "\n")
    summary = json.loads((folder / "summary.json").read_text())
    return {**summary, **cost, "folder": str(folder), "fresh": fresh}


def bar(done, total, started):
    """A progress bar on standard error."""
    width = 40
    full = width * done // total
    passed = time.monotonic() - started
    left = f", {passed / done * (total - done):.0f} s to go" if done else ""
    print(f"\r[{'#' * full}{'.' * (width - full)}] {done}/{total} flights, {passed:.0f} s{left}   ", end="",
          file=sys.stderr, flush=True)


def fly_all(flights, place):
    """Flies all flights; returns {name: summary} in their order. Stops at the first that fails."""
    started = time.monotonic()
    bar(0, len(flights), started)
    with concurrent.futures.ThreadPoolExecutor(place.jobs) as pool:
        futures = {pool.submit(fly, flight, place): flight.name for flight in flights}
        try:
            for done, future in enumerate(concurrent.futures.as_completed(futures), 1):
                future.result()
                bar(done, len(flights), started)
        except BaseException:
            for future in futures:
                future.cancel()
            raise
    print(file=sys.stderr)
    return {name: future.result() for future, name in futures.items()}
