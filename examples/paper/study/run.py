# SPDX-License-Identifier: Apache-2.0
"""Flies flights by `mebots run`, several at a time, and keeps what they gave."""

import concurrent.futures
import json
import pathlib
import subprocess
import sys
import time

from missions import ROOT, config


def fly(flight, build, results):
    """Flies one flight into results/<name>; returns its summary with the place of its files."""
    folder = pathlib.Path(results) / flight.name
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "config.json"
    path.write_text(json.dumps(config(flight, build / "fmus"), indent=2) + "\n")
    command = [str(build / "bin/mebots"), "run", str(path), "--out", str(folder), "--quiet"]
    start = time.monotonic()
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{flight.name}: {' '.join(command)} ended with {done.returncode}: {done.stderr.strip()}")
    summary = json.loads((folder / "summary.json").read_text())
    summary["folder"] = str(folder)
    summary["seconds"] = time.monotonic() - start
    return summary


def bar(done, total, started):
    """A progress bar on standard error."""
    width = 40
    full = width * done // total
    passed = time.monotonic() - started
    left = f", {passed / done * (total - done):.0f} s to go" if done else ""
    print(f"\r[{'#' * full}{'.' * (width - full)}] {done}/{total} flights, {passed:.0f} s{left}   ", end="",
          file=sys.stderr, flush=True)


def fly_all(flights, build, results, jobs):
    """Flies all flights, `jobs` at a time; returns {name: summary}. Stops at the first that fails."""
    summaries = {}
    started = time.monotonic()
    bar(0, len(flights), started)
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        futures = {pool.submit(fly, flight, build, results): flight for flight in flights}
        try:
            for future in concurrent.futures.as_completed(futures):
                summaries[futures[future].name] = future.result()
                bar(len(summaries), len(flights), started)
        except BaseException:
            for future in futures:
                future.cancel()
            raise
    print(file=sys.stderr)
    return summaries
