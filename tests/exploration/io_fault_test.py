#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests studies on a failing disk. In each run, a different call that writes files fails. Also tests a disk that is temporarily full. With
MEBOTS_FAULTS=all, every call fails in some run, and a table is printed.
"""

import collections
import concurrent.futures
import ctypes
import json
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

import mebots
from mebots.exploration.dispatch import Unfinished
from mebots.exploration.orders import unpacked
from mebots.exploration.replies import reply_of
from support import MEBOTS, SOURCE, StudyCase

sys.path.insert(0, str(SOURCE / "tests" / "support"))
import io_faults

TABLES = ("missions.csv", "designs.csv", "report.html", "study.json", "tables.h5", "missions.parquet", "designs.parquet")
MOST_CALLS = sys.maxsize if os.environ.get("MEBOTS_FAULTS") == "all" else 6
"""The maximum number of calls that fail in turn, for each kind of call and each fault."""


def library(folder):
    """Compiles io_faults.c, or skips the test."""
    file = io_faults.library(folder)
    if file is None:
        raise unittest.SkipTest("there is no C compiler")
    return file


class Invented(concurrent.futures.Executor):
    """An executor that returns results immediately, without a simulation."""

    def submit(self, function, batch):
        del function
        future = concurrent.futures.Future()
        future.set_result({"duration_s": 0.1, "unfinished": {}} | reply_of([
            {"mission": one["mission"], "flown_by": one["build"], "outcome": "far", "error": "", "code": "",
             "simulated_time": 1.0, "values": {"integral": one["settings"]["a.real_in"], "deep.out": 2.0}} for one in unpacked(batch)]))
        return future


def run_with_faults(study, out, faults):
    """Runs a study once for each fault, in a process with the library that injects faults. Prints the number of calls by kind, and a list
    for each fault: kind of call, fault, number of the call, the study's exception, files that remain or differ from those without faults,
    and the problems of the next run."""
    faults.arm.argtypes = [ctypes.c_char_p, ctypes.c_int, ctypes.c_int, ctypes.c_long, ctypes.c_int]
    faults.count.restype = ctypes.c_long

    def fly(kind=0, error=0, number=0, sticky=False):
        """Runs the study with this fault. Returns the text of its exception, or an empty text."""
        faults.arm(str(out).encode(), kind, error, number, sticky)
        try:
            mebots.sweep(study, out, executor=Invented(), jobs=2)
            return ""
        except mebots.Error as problem:
            return str(problem)
        finally:
            faults.arm(b"", 0, 0, 0, 0) if error else None

    def tables():
        return {name: (out / name).read_bytes() for name in TABLES if (out / name).exists()}

    fly()
    counts = [faults.count(kind) for kind in range(len(io_faults.KINDS))]
    faults.arm(b"", 0, 0, 0, 0)
    whole = tables()
    results = []
    for kind, name in enumerate(io_faults.KINDS):
        for fault in io_faults.faults_of(name):
            for number in io_faults.numbers(counts[kind], MOST_CALLS):
                shutil.rmtree(out)
                raised = fly(kind, io_faults.FAULTS[fault.removesuffix(io_faults.STICKY)], number, fault.endswith(io_faults.STICKY))
                torn = [one for one, content in tables().items() if content != whole[one]]
                torn += [one.name for one in out.iterdir() if one.name.endswith((".part", ".new"))]
                raised_again = fly()
                faults.arm(b"", 0, 0, 0, 0)
                again = [] if tables() == whole else ["tables"]
                results.append([name, fault, number, raised, torn, again + [raised_again] * bool(raised_again)])
    print(json.dumps([dict(zip(io_faults.KINDS, counts, strict=True)), results]))


def fault_of(fault, raised, torn, again):
    """Returns the reason why a run with a fault is wrong, or an empty text. The study must report the fault unless it is harmless, leave no
    incomplete file, and give the same tables in the next run."""
    if torn or again:
        return f"torn: {torn}" if torn else f"the next run: {again}"
    if fault.removesuffix(io_faults.STICKY) in io_faults.HARMLESS:
        return raised
    return "" if os.strerror(io_faults.FAULTS[fault.removesuffix(io_faults.STICKY)]) in raised else raised or "nothing reported"


class EachCall(StudyCase):
    def test_a_failed_write_gives_a_message_no_torn_file_and_the_same_tables_at_the_next_call(self):
        preload = library(self.folder)
        done = subprocess.run([sys.executable, __file__, "--faults", str(self.study()), str(self.folder / "out"), str(preload)],
                              env=dict(os.environ, LD_PRELOAD=str(preload)), capture_output=True, text=True, timeout=280)
        self.assertEqual(done.returncode, 0, done.stderr)
        counts, results = json.loads(done.stdout)
        self.assertGreater(sum(counts.values()), 40)
        found = collections.defaultdict(collections.Counter)
        for kind, fault, _, *outcome in results:
            found[kind, fault][fault_of(fault, *outcome)] += 1
        for (kind, fault), ends in found.items():
            if MOST_CALLS == sys.maxsize:
                print(io_faults.table_row("a study", kind, fault, counts[kind], ends))
        self.assertEqual({key: dict(ends) for key, ends in found.items() if set(ends) - {""}}, {})


class FullDisk(StudyCase):
    """Tests a disk that is full from the 15th of 30 missions on."""

    def fly(self, environment, code):
        command = [MEBOTS, "sweep", str(self.folder / "study.json"), "--out", str(self.folder / "out"), "--jobs", "1"]
        process = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        flights = self.folder / "out" / "flights"
        while code and process.poll() is None and len(list(flights.glob("??/*/summary.json"))) < 15:
            pass
        if code:
            self.flag.touch()
        told, _ = process.communicate(timeout=170)
        self.assertEqual(process.returncode, code, told)
        return told

    def test_costs_no_mission(self):
        self.mission(fault="slow", fault_time=0)  # 20 ms a step
        self.study(results=True, draws={"replicates": 15, "seed": 1, "variables": {"a.real_in": {"uniform": [0, 3]}}})
        self.sweep(out="sound")
        self.flag = self.folder / "full"
        environment = dict(os.environ, LD_PRELOAD=str(library(self.folder)), IO_FAULTS_FLAG=str(self.flag),
                           IO_FAULTS_FOLDER=str(self.folder / "out" / "flights"))
        told = self.fly(environment, 3)
        self.assertRegex(told, "the mission [0-9a-f]{64} had no result in 3 attempts: .*No space left on device|the mission .* had no result")
        self.assertNotIn("Traceback", told)
        journal = self.bytes_of("journal.jsonl").splitlines()
        self.assertTrue(all(json.loads(line)["outcome"] != "failed" for line in journal))
        rows = self.rows("missions.csv")
        missing = sum(row["outcome"] == "missing" for row in rows)
        self.assertEqual(missing, 30 - len(journal))
        self.assertEqual(sum(int(row["missing"]) for row in self.rows("designs.csv")), missing)
        self.assertEqual(sum(int(row["failed"]) for row in self.rows("designs.csv")), 0)
        self.assertFalse((self.folder / "out" / "report.html").exists())
        self.flag.unlink()
        self.fly(environment, 0)
        for name in ("missions.csv", "designs.csv"):
            self.assertEqual(self.bytes_of(name), self.bytes_of(name, "sound"))


class Killed(StudyCase):
    def test_missions_that_are_killed_three_times_stop_the_study_and_have_no_outcome(self):
        """The executor loses all batches with a mission with a.gain = 1."""
        self.study()

        class Losing(Invented):
            def submit(self, function, batch):
                if any("a.gain" in one["settings"] and one["settings"]["a.gain"] == 1 and "check" not in one for one in unpacked(batch)):
                    future = concurrent.futures.Future()
                    future.set_exception(RuntimeError("the worker was lost"))
                    return future
                return super().submit(function, batch)

        with self.assertRaises(Unfinished) as caught:
            mebots.sweep(self.folder / "study.json", self.folder / "out", executor=Losing(), jobs=2)
        self.assertIn("a.gain = 1", str(caught.exception))
        self.assertIn("the worker was lost", str(caught.exception))
        rows = self.rows("designs.csv")
        self.assertEqual([row["missing"] for row in rows], ["0", "10"])
        self.assertIn("not evaluated: 10 missions are missing", rows[0]["status"])
        mebots.sweep(self.folder / "study.json", self.folder / "out", executor=Invented(), jobs=2)
        mebots.sweep(self.folder / "study.json", self.folder / "whole", executor=Invented(), jobs=2)
        for name in ("missions.csv", "designs.csv"):
            self.assertEqual(self.bytes_of(name), self.bytes_of(name, "whole"))

    def test_a_lost_scheduler_gives_a_message_and_the_study_continues_with_another_one(self):
        """An executor like Dask without its scheduler: cancels its futures and accepts no more work."""
        self.study()

        class Closing(Invented):
            taken = 0

            def submit(self, function, batch):
                self.taken += 1
                if self.taken < 8:
                    return super().submit(function, batch)
                if self.taken > 8:
                    raise RuntimeError("Client is closed")
                future = concurrent.futures.Future()
                future.cancel()
                future.set_running_or_notify_cancel()
                return future

        with self.assertRaises(mebots.Error) as caught:
            mebots.sweep(self.folder / "study.json", self.folder / "out", executor=Closing(), jobs=2)
        self.assertIn("the executor accepts no more missions: Client is closed", str(caught.exception))
        self.assertEqual(mebots.sweep(self.folder / "study.json", self.folder / "out", executor=Invented(), jobs=2).missions, 20)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--faults"]:
        run_with_faults(pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3]), ctypes.CDLL(sys.argv[4]))
    else:
        unittest.main(argv=sys.argv)
