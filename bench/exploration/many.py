#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures missions per second of a study whose missions compute nothing: the overhead of orders, journal, answers and tables.

Usage: many.py FMU MISSIONS DESIGNS [OUT]     with the package mebots in PYTHONPATH; the FMU's real input 'motors.power' or
'real_in' is drawn. Prints missions, processor time, missions per second, and peak memory and disk space of the study's process.

The executor answers immediately in the calling thread, with lines of 330 bytes. It also supports the protocols of older versions
(before batches and before columns), so that versions can be compared.
"""

import concurrent.futures
import json
import pathlib
import resource
import shutil
import sys
import tempfile
import time
import zlib

import mebots

PADDING = "x" * 40


def line(mission, build, number):
    """Returns the journal's line for a mission."""
    body = (f'{{"mission":"{mission}","flown_by":"{build}","outcome":"far","error":"","code":"","simulated_time":1.0,'
            f'"values":{{"integral":{number!r},"out":2.5,"padding":"{PADDING}"}}').encode()
    return b'%b,"crc32":"%08x"}\n' % (body, zlib.crc32(body))


def record(order):
    return {"mission": order["mission"], "flown_by": order["build"], "outcome": "far", "error": "", "code": "", "simulated_time": 1.0,
            "values": {"integral": order["settings"]["a.real_in"], "out": 2.5, "padding": PADDING}}


class Instant(concurrent.futures.Executor):
    """Executes no mission. Returns results immediately."""

    def submit(self, function, order):
        del function
        future = concurrent.futures.Future()
        future.set_result(answer(order))
        return future


def answer(order):
    if "shared" not in order:  # a single order, not a batch
        return record(order)
    build = order["shared"]["build"]
    if "missions" in order:
        lines = [line(one["mission"], build, one["settings"]["a.real_in"]) for one in order["missions"]]
        return {"duration_s": 1e-9 * len(lines), "unfinished": {}, "lines": lines}
    return columns(order["groups"], build)


def columns(groups, build):
    import numpy as np

    digests = b"".join(group["digests"] for group in groups)
    drawn = [value for group in groups for value in _drawn(group)]
    text = digests.hex()
    lines = [line(text[64 * at : 64 * at + 64], build, value) for at, value in enumerate(drawn)]
    joined = b"".join(lines)
    count = len(lines)
    return {"duration_s": 1e-9 * count, "unfinished": {}, "digests": digests, "lines": joined, "lines_crc32": zlib.crc32(joined),
            "lengths": np.array([len(one) for one in lines]), "outcome_names": ["far"], "outcomes": np.zeros(count, np.uint16),
            "failed": np.zeros(count, bool), "times_s": np.ones(count),
            "numbers": {("values", "integral"): np.array(drawn, float), ("values", "out"): np.full(count, 2.5)}}


def _drawn(group):
    if "own" in group:
        return [one["settings"]["a.real_in"] for one in group["own"]]
    return group["columns"]["a.real_in"]


def study(folder, fmu, missions, designs):
    (folder / "mission.json").write_text(json.dumps({
        "step": 0.1, "stop_time": 1, "instances": {"a": {"fmu": fmu, "parameters": {"gain": 2}}}, "connections": [],
        "outcomes": [{"outcome": "far", "when": [{"variable": "a.integral", "above": 2}]}, {"outcome": "near"}],
        "summary": {"integral": "a.integral", "out": "a.real_out"}}))
    file = folder / "study.json"
    file.write_text(json.dumps({
        "mission": "mission.json", "design": {"kind": "grid", "factors": {"a.gain": [1 + one / designs for one in range(designs)]}},
        "draws": {"replicates": missions // designs, "seed": 1, "variables": {"a.real_in": {"uniform": [0, 3]}}},
        "objectives": {"integral": {"summary": "integral"}, "out": {"summary": "out"}}}))
    return file


def main():
    if len(sys.argv) < 4:
        sys.exit("usage: many.py FMU MISSIONS DESIGNS [OUT]")
    fmu, missions, designs = str(pathlib.Path(sys.argv[1]).resolve()), int(sys.argv[2]), int(sys.argv[3])
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        out = folder / "out"
        file = study(folder, fmu, missions, designs)
        begun, wall = resource.getrusage(resource.RUSAGE_SELF), time.monotonic()
        mebots.sweep(file, out, executor=Instant(), jobs=4)
        ended, wall = resource.getrusage(resource.RUSAGE_SELF), time.monotonic() - wall
        processor_s = ended.ru_utime + ended.ru_stime - begun.ru_utime - begun.ru_stime
        disk = sum(one.stat().st_size for one in out.rglob("*") if one.is_file())
        print(f"| {missions} | {designs} | {processor_s:.2f} s (user {ended.ru_utime - begun.ru_utime:.2f}) | {missions / processor_s:.0f} | "
              f"{ended.ru_maxrss / 1024:.0f} MB | {disk / 1e6:.1f} MB | {wall:.2f} s |")
        if len(sys.argv) > 4:
            shutil.copytree(out, sys.argv[4], dirs_exist_ok=True)


if __name__ == "__main__":
    main()
