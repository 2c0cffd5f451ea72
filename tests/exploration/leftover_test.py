#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests FMUs that keep data outside their instances. Each mission gives the same result as `mebots run`, or is rejected."""

import json
import subprocess
import sys
import unittest

import mebots
from support import BUILD, MEBOTS, StudyCase

PLACES = ("nothing", "static_variable", "first_instance", "static_object", "thread_local", "library", "rand", "environment", "tokens")
UNCLEAN = PLACES[1:]
GAINS = [0.5, 1, 2, 3]


def fmu_of(place):
    return str(BUILD / "test_fmus" / f"leftover_{place}.fmu")


class LeftoverCase(StudyCase):
    def mission(self, **instances):
        """Writes a mission with these instances. Each value is a pair: the place where the FMU keeps data outside its instances, such as
        "static_variable", and a dict with further properties of the instance."""
        (self.folder / "mission.json").write_text(json.dumps({
            "step": 0.125, "stop_time": 1, "connections": [], "record": [f"{name}.sum" for name in instances],
            "instances": {name: {"fmu": fmu_of(place)} | more for name, (place, more) in instances.items()},
            "summary": {name: f"{name}.sum" for name in instances}}))

    def study(self, **sections):
        return super().study(**{
            "design": {"kind": "grid", "factors": {"a.gain": GAINS}}, "draws": None, "objectives": {"sum": {"summary": "a"}}} | sections)

    def single_runs(self):
        """Returns the final sum of `a` for each gain, from separate calls of `mebots run`."""
        sums = []
        for number, gain in enumerate(GAINS):
            out = self.folder / f"single{number}"
            command = [MEBOTS, "run", str(self.folder / "mission.json"), "--out", str(out), "--set", f"a.gain={gain}"]
            subprocess.run(command, check=True, capture_output=True, timeout=60)
            sums.append(json.loads((out / "summary.json").read_text())["a"])
        return sums


class Sweeps(LeftoverCase):
    def test_missions_give_what_single_runs_give_for_any_number_of_jobs(self):
        for place in PLACES:
            with self.subTest(place):
                self.mission(a=(place, {}))
                self.study()
                single = self.single_runs()
                self.assertEqual([value / single[1] for value in single], GAINS, "the FMU works")
                for jobs in (1, 2, 3):
                    self.sweep("--jobs", str(jobs), out=f"{place}{jobs}")
                    self.assertEqual([float(row["sum"]) for row in self.rows("missions.csv", f"{place}{jobs}")], single)
                    self.assertEqual(self.bytes_of("missions.csv", f"{place}{jobs}"), self.bytes_of("missions.csv", f"{place}1"))

    def test_so_do_missions_of_several_fmus_and_configs(self):
        """The factor changes the config, so a worker has several configs open."""
        self.mission(a=("static_variable", {}), b=("nothing", {}), c=("rand", {"process": "own"}))
        factors = {"/stop_time": [0.25, 0.5, 0.625, 0.75, 0.875, 1], "a.gain": [1, 2]}
        self.study(design={"kind": "grid", "factors": factors})
        self.sweep("--jobs", "2")
        for row in self.rows("missions.csv"):
            steps = round(float(row["/stop_time"]) / 0.125)
            self.assertEqual(float(row["sum"]), float(row["a.gain"]) * steps * (steps + 1) / 2)

    def test_kept_results_are_those_of_single_runs(self):
        for place in ("static_variable", "rand"):
            self.mission(a=(place, {}))
            self.study(results=True)
            self.sweep("--jobs", "1", out=place)
            for row, single in zip(self.rows("missions.csv", place), self.single_runs(), strict=True):
                self.assertEqual(float(row["sum"]), single)
                flight = self.flight(row, place)
                self.assertEqual(json.loads((flight / "summary.json").read_text())["a"], single)

    def test_a_fork_or_levels_are_refused_and_the_fmu_is_named(self):
        for place in UNCLEAN:
            for isolation in ({}, {"process": "own"}):
                with self.subTest(place, **isolation):
                    self.mission(a=(place, isolation))
                    self.study(fork={"at": 0.5, "variables": ["a.gain"]})
                    told = self.sweep(code=2, out=f"fork_{place}")
                    self.assertIn(f"the saved state of leftover_{place}.fmu is incomplete", told)
        self.study(objectives=None, draws={"replicates": 2, "variables": {"a.gain": {"uniform": [0, 1]}}}, design={"kind": "grid", "factors": {"/stop_time": [1]}},
                   splitting={"score": "a.sum", "above": 3, "missions": 4, "reseed": ["a.gain"]})
        self.assertIn("the saved state of leftover_tokens.fmu is incomplete", self.sweep(code=2, out="levels"))

    def test_a_fork_of_a_clean_fmu_gives_what_writing_on_the_way_gives(self):
        self.mission(a=("nothing", {}))
        self.study(fork={"at": 0.5, "variables": ["a.gain"]})
        self.sweep()
        self.assertEqual([float(row["sum"]) for row in self.rows("missions.csv")], [4 + 4 * gain for gain in GAINS])


class InOneProcess(LeftoverCase):
    """Tests missions that run one after the other in one program."""

    def sum_of(self, mission, gain):
        mission.set("a.gain", gain)
        mission.run()
        return mission.value("a.sum")

    def test_a_mission_that_was_reset_gives_what_a_single_run_gives(self):
        for place in PLACES:
            with self.subTest(place):
                self.mission(a=(place, {}))
                mission = mebots.Mission(self.folder / "mission.json")
                sums = []
                for gain in GAINS:
                    sums.append(self.sum_of(mission, gain))
                    mission.reset()
                self.assertEqual(sums, self.single_runs())

    def test_so_does_each_new_mission(self):
        for place in PLACES:
            with self.subTest(place):
                self.mission(a=(place, {}))
                sums = [self.sum_of(mebots.Mission(self.folder / "mission.json"), gain) for gain in GAINS]
                self.assertEqual(sums, self.single_runs())

    def test_two_that_would_change_each_other_are_refused(self):
        self.mission(a=("rand", {}))
        first = mebots.Mission(self.folder / "mission.json")
        first.step()
        second = mebots.Mission(self.folder / "mission.json")
        with self.assertRaises(mebots.InputError) as caught:
            second.step()
        self.assertIn("leftover_rand.fmu: it imports rand", str(caught.exception))
        self.assertIn('"process": "own"', str(caught.exception))

    def test_leftovers_are_reported(self):
        for place in PLACES:
            self.mission(a=(place, {}))
            mission = mebots.Mission(self.folder / "mission.json")
            mission.run()
            left = mission.free_instances()
            self.assertEqual([in_process for _, in_process in left], [] if place == "nothing" else [True], place)
            for text, _ in left:
                self.assertTrue(text.startswith(f"leftover_{place}.fmu: "), text)
            with self.assertRaises(mebots.InputError):
                mission.value("a.sum")

    def test_a_loaded_mission_is_not_begun(self):
        self.mission(a=("first_instance", {}))
        mission = mebots.Mission(self.folder / "mission.json")
        mission.load()
        self.assertEqual(mission.state, "open")
        self.assertEqual(self.sum_of(mission, 1), 8)


class States(LeftoverCase):
    def test_are_refused_of_fmus_that_are_not_clean(self):
        for place in UNCLEAN:
            for isolation in ({}, {"process": "own"}):
                self.mission(a=(place, isolation))
                mission = mebots.Mission(self.folder / "mission.json")
                mission.run_until(0.5)
                with self.assertRaises(mebots.InputError) as caught:
                    mission.save_state()
                self.assertEqual(caught.exception.code, "not_offered")
                self.assertIn(f"leftover_{place}.fmu", str(caught.exception))

    def test_of_a_clean_fmu_begin_another_mission(self):
        for isolation in ({}, {"process": "own"}):
            self.mission(a=("nothing", isolation))
            first = mebots.Mission(self.folder / "mission.json")
            first.run_until(0.5)
            second = mebots.Mission(self.folder / "mission.json")
            second.start_from(first.save_state())
            second.run()
            self.assertEqual(second.value("a.sum"), 8)


if __name__ == "__main__":
    unittest.main(argv=sys.argv)
