#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs many missions on a Dask cluster of two workers on this machine. Kills one worker after a third of the missions.

Usage: cluster.py FMU MISSIONS (with the package mebots in PYTHONPATH). The FMU must have the parameters and inputs of the probe
FMU (tests/fmus). Prints the duration, the time at which the worker was killed, and how many times each mission is in the journal.
"""

import collections
import json
import os
import pathlib
import signal
import sys
import tempfile
import time

import distributed
from many import study

import mebots


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: cluster.py FMU MISSIONS")
    fmu, missions = str(pathlib.Path(sys.argv[1]).resolve()), int(sys.argv[2])
    killed = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        file = study(folder, fmu, missions, 10)
        with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None,
                                      local_directory=name) as cluster, distributed.Client(cluster) as client:
            def kill_one(progress):
                if progress.flown >= missions / 3 and not killed:
                    os.kill(next(iter(client.run(os.getpid).values())), signal.SIGKILL)
                    killed.append(progress.flown)

            begun_s = time.monotonic()
            result = mebots.sweep(file, folder / "out", executor=client.get_executor(), jobs=8, progress=kill_one)
            wall_s = time.monotonic() - begun_s
        lines = (folder / "out" / "journal.jsonl").read_text().splitlines()
        times = collections.Counter(json.loads(line)["mission"] for line in lines)
        print(f"{result.missions} missions in {wall_s:.0f} s, {result.failed} failed; a worker was killed after {killed}; "
              f"in the journal {len(times)} missions, the most frequent one {max(times.values())} times")


if __name__ == "__main__":
    main()
