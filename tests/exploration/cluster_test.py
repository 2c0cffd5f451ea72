#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests `mebots.sweep` with Dask distributed: two workers on this machine, one of which is killed."""

import os
import pathlib
import pickle
import signal
import sys
import unittest

import distributed

import mebots
from mebots.exploration import flying
from mebots.exploration.inputs import content_of
from mebots.exploration.missions import FILE_MARK, Missions
from mebots.exploration.orders import Orders, packed
from mebots.exploration.replies import reply_from
from mebots.exploration.study import read_study
from support import StudyCase


class Dask(StudyCase):
    def test_gives_the_same_bytes_with_a_worker_killed_in_the_middle(self):
        self.mission(fault="slow", fault_time=0)  # 20 ms a step
        file = self.study()
        self.sweep(out="local")
        killed = []

        def kill_one(progress):
            if progress.flown >= 5 and not killed:
                killed.extend(client.run(os.getpid).values())
                os.kill(killed[0], signal.SIGKILL)

        with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None,
                                      local_directory=str(self.folder)) as cluster, distributed.Client(cluster) as client:
            result = mebots.sweep(file, self.folder / "dask", executor=client.get_executor(), jobs=4, progress=kill_one)
        self.assertEqual(len(killed), 2)
        self.assertEqual((result.missions, result.failed), (20, 0))
        for name in ("missions.csv", "designs.csv"):
            self.assertEqual(self.bytes_of(name, "dask"), self.bytes_of(name, "local"))


class Files(StudyCase):
    def test_travel_by_hash_to_a_machine_that_lacks_them(self):
        """A worker requests a missing file, caches it, and does not request it again."""
        os.environ["XDG_CACHE_HOME"] = str(self.folder / "cache")
        order = Missions(read_study(self.study())).order({"a.gain": 1, "a.real_in": 2})
        def fly(order, **more):
            return flying.fly_all(pickle.loads(pickle.dumps(packed([Orders.of([order])]))) | more)

        here = fly(order)
        (digest, (path, name)), = order["files"].items()
        away = order | {"files": {digest: ["/nowhere/" + name, name]}}
        self.assertEqual(fly(away)["lacks"], [digest])
        with open(path, "rb") as file:
            there = fly(away, contents={digest: file.read()})
        again = fly(away)
        here, there, again = (reply_from(answer).records() for answer in (here, there, again))
        for (record,) in (here, there, again):
            record.pop("processor_time")
        self.assertEqual(there, here)
        self.assertEqual(again, here)
        flying.close_all()

    def test_the_folder_of_a_network_travels_with_all_of_its_files(self):
        os.environ["XDG_CACHE_HOME"] = str(self.folder / "cache")
        network = self.folder / "net"
        (network / "vectors").mkdir(parents=True)
        (network / "network.json").write_text("{}")
        (network / "vectors/000.picture").write_bytes(b"1")

        def order(**settings):
            return Missions(read_study(self.study())).order({f"a.{name}": value for name, value in settings.items()})

        first = order(network="net")
        digest = first["settings"]["a.network"].removeprefix(FILE_MARK)
        self.assertEqual(first["files"][digest], [str(network), "net"])
        self.assertEqual(order(gain="net")["settings"], {"a.gain": "net"})  # such a text may name something inside the FMU

        def at_a_worker(**contents):
            batch = {"files": {digest: ["/nowhere/net", "net"]}} | contents
            return flying._find_files(batch), pathlib.Path(batch["files"][digest][0])

        self.assertEqual(at_a_worker()[0], [digest])
        for contents in ({"contents": {digest: content_of(network)}}, {}):  # sent, then cached
            lacking, path = at_a_worker(**contents)
            self.assertEqual(lacking, [])
            self.assertEqual(content_of(path), content_of(network))
            self.assertNotEqual(path, network)
        (network / "vectors/000.picture").write_bytes(b"2")
        self.assertNotEqual(order(network="net")["mission"], first["mission"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv)
