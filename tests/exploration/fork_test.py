#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests several runs from one saved state: missions that continue from it, and studies that fork."""

import concurrent.futures
import fractions
import json
import os
import sys
import unittest
import unittest.mock

import mebots
from mebots.exploration import pasts
from mebots.exploration.missions import Missions
from mebots.exploration.study import read_study
from mebots.exploration.worker import Worker
from support import BUILD, SOURCE, STEADY, StudyCase


def result(mission):
    summary = {key: value for key, value in mission.summary.items() if key not in ("wall_clock", "real_time_factor")}
    summary["inputs"].pop("writes", None)  # a run from a saved state does not list earlier writes
    summary.pop("notices", None)  # differs if the FMUs of other open missions share the process
    return summary, {name: mission._series(name)[1] for name in mission.variables}


class SavedState(StudyCase):
    FMU = STEADY

    def straight(self, writes):
        """Returns a mission in which these values are written at 0.5 s."""
        mission = mebots.Mission(self.folder / "mission.json", record=["a.*"])
        mission.run_until(0.5)
        for name, value in writes.items():
            mission.write(name, value)
        mission.run()
        return result(mission)

    def test_another_mission_continues_from_it_with_the_same_bits(self):
        past = mebots.Mission(self.folder / "mission.json", record=["a.*"])
        past.run_until(0.5)
        state = past.save_state()
        results = []
        for writes in ({"a.real_in": -7}, {"a.real_in": 0.1, "a.integer_in": 3}, {}):
            mission = mebots.Mission(self.folder / "mission.json", record=["a.*"])
            mission.start_from(state)
            mission.start()
            self.assertEqual((mission.time, mission.state), (0.5, "ready"))
            for name, value in writes.items():
                mission.write(name, value)
            mission.run()
            self.assertEqual(result(mission), self.straight(writes))
            results.append(mission.value("a.integral"))
        self.assertEqual(len(set(results)), 3)
        past.run()  # the original mission continues undisturbed
        self.assertEqual(result(past), self.straight({}))

    def test_an_fmu_is_not_set_back_it_is_made_anew(self):
        """The first run promises the FMU that no state before 0.8 s will be restored. Therefore the second run must create a new instance
        instead of restoring the state of 0.3 s in the first one."""
        mission = mebots.Mission(self.folder / "mission.json")
        mission.run_until(0.3)
        state = mission.save_state()
        mission.run_until(0.8)
        promised = mission.value("a.set_backs")
        mission.reset()
        mission.start_from(state)
        mission.run_until(0.8)
        self.assertEqual(mission.value("a.set_backs"), promised)
        mission.reset()
        mission.start()
        self.assertEqual(mission.time, 0, "a state counts for one run")

    def test_is_refused_where_it_does_not_belong(self):
        mission = mebots.Mission(self.folder / "mission.json")
        mission.run_until(0.5)
        state = mission.save_state()
        for wrong, code in ((b"no state", "state_of_other_build"), (state[:-1] + b"?", "state_damaged")):
            with self.assertRaises(mebots.InputError) as caught:
                mebots.Mission(self.folder / "mission.json").start_from(wrong)
            self.assertEqual(caught.exception.code, code)
        other = mebots.Mission(self.folder / "mission.json", set={"a.gain": 3})
        other.start_from(state)
        with self.assertRaises(mebots.InputError) as caught:
            other.start()
        self.assertEqual(caught.exception.code, "state_of_other_fmu")
        with self.assertRaises(mebots.InputError):
            mebots.Mission(self.folder / "mission.json", out=self.folder / "run").start_from(state)
        with self.assertRaises(mebots.InputError):
            mission.start_from(state)  # too late
        mission.run()
        with self.assertRaises(mebots.InputError):
            mission.save_state()

    def test_of_the_gate_mission_with_new_noise(self):
        config = SOURCE / "configs" / "gate_easy.json"
        variables = ["battery.*", "motors.*", "world.*", "soc.*"]
        past = mebots.Mission(config, record=variables, stop_time=2.5)
        past.run_until(2)
        state = past.save_state()

        def future(mission, seed):
            mission.write("world.sensors.seed", seed)
            mission.run()
            return result(mission)

        fork = mebots.Mission(config, record=variables, stop_time=2.5)
        fork.start_from(state)
        straight = future(past, 7)
        self.assertEqual(future(fork, 7), straight)
        other = mebots.Mission(config, record=variables, stop_time=2.5)
        other.start_from(state)
        changed = future(other, 8)
        self.assertNotEqual(changed[1]["world.range.down"], straight[1]["world.range.down"])
        rows = len(past.times)
        before = sum(time <= 2 for time in past.times)
        self.assertEqual(len(changed[1]["world.range.down"]), 8 * rows)
        self.assertEqual(changed[1]["world.range.down"][: 8 * before], straight[1]["world.range.down"][: 8 * before])


class Forks(StudyCase):
    FMU = STEADY
    FORK = {"at": 0.5, "variables": ["a.real_in"]}

    def test_a_row_holds_what_a_mission_gives_to_which_its_values_are_written_on_the_way(self):
        self.study(fork=self.FORK, objectives={
            "success": {"outcome": "far"}, "integral": {"summary": "integral"}, "mean": {"series": "a.real_out", "of": "mean"}})
        self.sweep()
        for row in self.rows("missions.csv"):
            mission = mebots.Mission(self.folder / "mission.json", set={"a.gain": float(row["a.gain"])}, record=["a.real_out"])
            mission.run_until(0.5)
            mission.write("a.real_in", float(row["a.real_in"]))
            mission.run()
            self.assertEqual(row["outcome"], mission.outcome)
            self.assertEqual(float(row["integral"]), mission.value("a.integral"))
            self.assertAlmostEqual(float(row["mean"]), sum(mission["a.real_out"]) / len(mission.times), 12)
        self.study()
        self.sweep(out="straight")
        self.assertFalse({row["mission"] for row in self.rows("missions.csv")} &
                         {row["mission"] for row in self.rows("missions.csv", "straight")})

    def test_the_same_bytes_come_for_any_jobs_and_after_a_kill(self):
        self.study(fork=self.FORK)
        self.sweep("--jobs", "1", out="one")
        self.sweep("--jobs", "2", out="two")
        lines = (self.folder / "one" / "journal.jsonl").read_text().splitlines(keepends=True)
        (self.folder / "again").mkdir()
        (self.folder / "again" / "journal.jsonl").write_text("".join(lines[:7]))
        self.sweep(out="again")
        for name in ("missions.csv", "designs.csv"):
            self.assertEqual(self.bytes_of(name, "one"), self.bytes_of(name, "two"))
            self.assertEqual(self.bytes_of(name, "one"), self.bytes_of(name, "again"))

    def test_the_past_is_flown_once_for_all_that_share_it(self):
        missions = Missions(read_study(self.study(fork=self.FORK)))
        folder = self.folder / "pasts"
        folder.mkdir()
        worker = Worker(str(self.folder), pasts.Pasts(folder))
        orders = [missions.order({"a.gain": gain, "a.real_in": drive}) for gain in (0.2, 1) for drive in (1, 2, 3)]
        records = [worker.answer(json.loads(json.dumps(order))) for order in orders]
        self.assertEqual(len(list(folder.iterdir())), 2)
        for state in folder.iterdir():  # makes the worker compute the states again
            state.unlink()
        alone = Worker(str(self.folder), pasts.Pasts(folder))
        for order, record in zip(reversed(orders), reversed(records), strict=True):
            again = alone.answer(json.loads(json.dumps(order)))
            self.assertEqual(again | {"processor_time": 0}, record | {"processor_time": 0})
            self.assertEqual(record["error"], "")

    def test_of_workers_that_need_the_same_past_one_flies_it_and_the_others_wait(self):
        self.mission(fault="slow", fault_time=0)  # 20 ms a step
        missions = Missions(read_study(self.study(fork=self.FORK)))
        folder = self.folder / "pasts"
        folder.mkdir()
        kept, waits = [], []

        class Counting(pasts.Pasts):
            def keep(self, name, state):
                kept.append(name)
                super().keep(name, state)

        def fly(drive):
            order = json.loads(json.dumps(missions.order({"a.gain": 1, "a.real_in": drive})))
            return Worker(str(self.folder), Counting(folder), lambda: waits.append(drive)).answer(order)

        with concurrent.futures.ThreadPoolExecutor(3) as threads:
            records = list(threads.map(fly, (1, 2, 3)))
        self.assertEqual(len(kept), 1)
        self.assertEqual(len(waits), 2)
        self.assertEqual([file.name for file in folder.iterdir()], kept)
        for record, drive in zip(records, (1, 2, 3), strict=True):
            alone = Worker(str(self.folder), pasts.Pasts(self.folder / "nowhere")).answer(missions.order({"a.gain": 1, "a.real_in": drive}))
            self.assertEqual(record | {"processor_time": 0}, alone | {"processor_time": 0})

    def test_states_beyond_the_room_for_them_go_those_used_longest_ago_first(self):
        folder = self.folder / "pasts"
        folder.mkdir()
        with unittest.mock.patch.multiple(pasts, MOST_BYTES=250, _LOOK_EVERY_BYTES=0):
            keeper = pasts.Pasts(folder)
            for number, name in enumerate("abc"):
                keeper.keep(name, b"x" * 100)
                os.utime(folder / name, (number + 1, number + 1))
            self.assertEqual(pasts.Pasts(folder).find("b"), b"x" * 100)  # used most recently
            keeper.keep("d", b"x" * 100)
        self.assertEqual(sorted(file.name for file in folder.iterdir()), ["b", "d"])
        self.assertIsNone(pasts.Pasts(folder).find("a"))

    def test_a_mission_that_ended_before_the_fork_has_one_future(self):
        config = json.loads((self.folder / "mission.json").read_text())
        config["stop_when"] = [{"variable": "a.integral", "above": 0.5}]
        (self.folder / "mission.json").write_text(json.dumps(config))
        self.study(fork=self.FORK)
        self.sweep()
        self.assertEqual({row["simulated_time [s]"] for row in self.rows("missions.csv")}, {"0.2"})

    def test_refuses_factors_that_cannot_change_during_a_mission(self):
        self.study(fork={"at": 0.5, "variables": ["a.gain"]})
        self.assertIn("only inputs and tunable parameters", self.sweep(code=2))
        self.study(fork={"at": 0.5, "variables": ["a.offset"]})
        self.assertIn("a.offset", self.sweep(code=2))
        self.study(fork={"at": 0, "variables": ["a.real_in"]})
        self.sweep(code=2)

    def test_a_fork_whose_values_would_never_count_is_bad_input(self):
        for at in (0.95, 1):  # the step is 0.1 s
            self.study(fork=self.FORK | {"at": at})
            self.assertIn(f"'fork': at {at:g} s or later there is no communication point before the mission's stop time, 1 s",
                          self.sweep(code=2))
        self.study(fork=self.FORK | {"at": 0.9})
        self.sweep()

    def test_a_study_of_a_ratio_forks_at_its_points(self):
        config = json.loads((self.folder / "mission.json").read_text()) | {"step": "1/60"}
        (self.folder / "mission.json").write_text(json.dumps(config))
        self.study(fork=self.FORK | {"at": 0.984})
        self.assertIn("no communication point before", self.sweep(code=2))
        self.study(fork=self.FORK | {"at": 59 / 60})
        self.sweep()
        straight = mebots.Mission(self.folder / "mission.json", set={"a.gain": 1, "a.real_in": 3}, record=["a.*"])
        straight.run_until(59 / 60)
        self.assertEqual(straight.time, 59 / 60)
        straight.write("a.real_in", 0.5)
        straight.run()
        self.assertEqual((straight.time, straight.step_size), (1, 1 / 60))
        self.assertEqual(straight.times.tolist(), [float(fractions.Fraction(k, 60)) for k in range(61)])

    def test_a_step_is_given_as_a_ratio(self):
        for step in ("1/60", fractions.Fraction(1, 60), 1 / 60):
            mission = mebots.Mission(self.folder / "mission.json", step=step)
            mission.run()
            self.assertEqual((mission.step_size, len(mission.times)), (1 / 60, 61))
        with self.assertRaises(mebots.InputError):
            mebots.Mission(self.folder / "mission.json", step=0.0166666666666)

    def test_an_fmu_that_cannot_write_its_state_is_named(self):
        mission = json.loads((self.folder / "mission.json").read_text())
        mission["instances"]["b"] = {"fmu": str(BUILD / "test_fmus" / "passthrough.fmu")}
        (self.folder / "mission.json").write_text(json.dumps(mission))
        self.study(fork=self.FORK)
        self.assertIn("instance 'b'", self.sweep(code=2))


if __name__ == "__main__":
    unittest.main(argv=sys.argv)
