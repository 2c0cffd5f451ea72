#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests `mebots sweep` as a user runs it."""

import importlib.util
import json
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time
import unittest

import mebots
from support import BANK, MEBOTS, PROBE, SOURCE, STEADY, StudyCase


class Tables(StudyCase):
    def test_a_row_for_each_mission_holds_what_a_single_run_of_it_gives(self):
        self.study()
        self.sweep("--jobs", "1")
        rows = self.rows("missions.csv")
        self.assertEqual(len(rows), 20)
        for row in (rows[3], rows[17]):
            with mebots.Mission(self.folder / "mission.json", set={
                    "a.gain": float(row["a.gain"]), "a.real_in": float(row["a.real_in"])}) as mission:
                mission.run()
            self.assertEqual(row["outcome"], mission.outcome)
            self.assertEqual(float(row["integral"]), mission.summary["integral"])
            self.assertEqual(row["success"], "1" if mission.outcome == "far" else "0")

    def test_every_design_flies_the_same_draws(self):
        self.study()
        self.sweep()
        draws = [[row["a.real_in"] for row in self.rows("missions.csv") if row["design"] == one] for one in "01"]
        self.assertEqual(draws[0], draws[1])
        self.assertEqual(len(set(draws[0])), 10)

    def test_more_replicates_and_factors_leave_the_draws_as_they_are(self):
        self.study()
        self.sweep()
        self.study(draws={"replicates": 12, "seed": 1, "variables": {
            "a.offset": {"normal": [0, 1]}, "a.real_in": {"uniform": [0, 3]}}})
        self.sweep(out="more")
        few = [row["a.real_in"] for row in self.rows("missions.csv")][:10]
        self.assertEqual(few, [row["a.real_in"] for row in self.rows("missions.csv", "more")][:10])

    def test_designs_have_shares_with_wilsons_interval_and_means(self):
        self.study()
        self.sweep()
        design = self.rows("designs.csv")[0]
        own = [row for row in self.rows("missions.csv") if row["design"] == "0"]
        successes = sum(row["success"] == "1" for row in own)
        self.assertEqual(int(design["success: successes"]), successes)
        self.assertAlmostEqual(float(design["integral: mean"]), sum(float(row["integral"]) for row in own) / 10, 12)
        self.assertLess(float(design["success: low"]), successes / 10)
        self.assertGreater(float(design["success: high"]), successes / 10)

    def test_the_report_links_to_the_page_of_a_mission_that_was_flown_again_as_it_says(self):
        self.study()
        self.sweep()
        replay = self.report()["replay"]
        self.assertEqual(replay["pages"], [])
        folder = f"{replay['folder']}/design_1_mission_4"
        for line in (f"{replay['run']} --out {folder} {replay['designs'][1]} {replay['draws'][4]}", f"mebots report {folder}"):
            subprocess.run([MEBOTS, *shlex.split(line)[1:]], check=True, capture_output=True)
        self.sweep()
        (page,) = self.report()["replay"]["pages"]
        self.assertEqual(page, "replays/design_1_mission_4/flight.html")
        self.assertTrue((self.folder / "out" / page).is_file())

    def test_the_report_can_bring_a_mission_of_each_design_onto_one_page(self):
        self.study()
        self.sweep()
        replay = self.report()["replay"]
        folders = [f"{replay['folder']}/{design}" for design in range(2)]
        for design, folder in enumerate(folders):
            words = shlex.split(f"{replay['run']} --out {folder} {replay['designs'][design]} {replay['draws'][3]}")
            subprocess.run([MEBOTS, *words[1:]], check=True, capture_output=True)
            with open(pathlib.Path(shlex.split(folder)[0]) / "summary.json", encoding="utf-8") as file:
                row = next(row for row in self.rows("missions.csv") if (row["design"], row["replicate"]) == (str(design), "3"))
                self.assertAlmostEqual(json.load(file)["integral"], float(row["integral"]), 12)
        page = f"{replay['folder']}/compared.html"
        subprocess.run([MEBOTS, *shlex.split(f"report {' '.join(folders)} --out {page}")], check=True, capture_output=True)
        self.assertTrue(pathlib.Path(shlex.split(page)[0]).is_file())

    def test_objectives_come_from_summary_final_values_series_and_expressions(self):
        self.study(objectives={
            "out": {"final": "a.real_out"}, "top": {"series": "a.real_out", "of": "max"},
            "mean": {"series": "a.real_out", "of": "mean"}, "same": {"expression": "deep.out + 2 * integral - out"}})
        self.sweep()
        for row in self.rows("missions.csv"):
            out = float(row["a.gain"]) * float(row["a.real_in"])
            self.assertAlmostEqual(float(row["out"]), out, 12)
            self.assertAlmostEqual(float(row["top"]), out, 12)
            self.assertAlmostEqual(float(row["mean"]), out, 12)
            self.assertAlmostEqual(float(row["same"]), 2 * float(row["a.real_in"]), 12)

    def test_a_config_key_and_named_options_are_factors_too(self):
        self.study(design={"kind": "grid", "factors": {
            "/stop_time": [0.5, 1], "drive": {"options": {"weak": {"a.gain": 1, "a.offset": 0}, "strong": {"a.gain": 2}}}}},
            objectives={"integral": {"summary": "integral"}})
        self.sweep()
        rows = self.rows("missions.csv")
        self.assertEqual([row["drive"] for row in rows[::10]], ["weak", "strong", "weak", "strong"])
        self.assertEqual({row["simulated_time [s]"] for row in rows[:20]}, {"0.5"})
        self.assertEqual({row["simulated_time [s]"] for row in rows[20:]}, {"1"})

    def test_conditions_leave_designs_out(self):
        self.study(design={"kind": "grid", "factors": {"a.gain": [1, 2, 3], "a.offset": [0, 1]}, "conditions": [
            {"when": {"a.gain": {"min": 2}}, "only": {"a.offset": [1]}}]})
        self.sweep()
        self.assertEqual([(row["a.gain"], row["a.offset"]) for row in self.rows("designs.csv")],
                         [("1", "0"), ("1", "1"), ("2", "1"), ("3", "1")])

    def signals(self, **values):
        """Writes files of signals, each with one constant value."""
        for name, value in values.items():
            (self.folder / f"{name}.csv").write_text(f"time,u\n0,{value}\n1,{value}\n")

    def test_a_design_chooses_the_file_of_input_signals(self):
        self.signals(low=1, high=3)
        mission = json.loads((self.folder / "mission.json").read_text())
        del mission["instances"]["a"]["parameters"]["real_in"]
        mission["inputs"] = {"file": "low.csv", "to": {"u": "a.real_in"}}
        (self.folder / "mission.json").write_text(json.dumps(mission))
        self.study(design={"kind": "grid", "factors": {"/inputs/file": ["low.csv", "high.csv"]}}, draws=None,
                   objectives={"integral": {"summary": "integral"}})
        self.sweep()
        integrals = [float(row["integral"]) for row in self.rows("missions.csv")]
        self.assertAlmostEqual(integrals[0], 1, 12)
        self.assertAlmostEqual(integrals[1], 3, 12)
        self.signals(low=2)
        self.sweep()
        self.assertAlmostEqual(float(self.rows("missions.csv")[0]["integral"]), 2, 12)  # the file is part of the hash

    def test_the_mission_may_be_an_fmu(self):
        self.study(mission=PROBE, design={"kind": "grid", "factors": {"probe.real_in": [1, 2]}}, draws=None,
                   objectives={"integral": {"final": "probe.integral"}})
        self.sweep()
        self.assertEqual([round(float(row["integral"]), 12) for row in self.rows("missions.csv")], [1, 2])

    def test_a_list_of_designs_comes_from_a_csv_file(self):
        (self.folder / "designs.csv").write_text("a.gain,a.string_in\n0.5,one\n1.5,two\n")
        self.study(design={"kind": "list", "file": "designs.csv"})
        self.sweep()
        self.assertEqual([(row["a.gain"], row["a.string_in"]) for row in self.rows("designs.csv")],
                         [("0.5", "one"), ("1.5", "two")])

    def test_a_list_may_begin_with_the_mark_that_spreadsheets_write(self):
        (self.folder / "designs.csv").write_bytes(b"\xef\xbb\xbfa.gain\n0.5\n")
        self.study(design={"kind": "list", "file": "designs.csv"})
        self.sweep()
        self.assertEqual([row["a.gain"] for row in self.rows("designs.csv")], ["0.5"])

    def test_a_list_with_semicolons_is_refused_by_the_name_of_its_separator(self):
        (self.folder / "designs.csv").write_text("a.gain;a.offset\n0,5;1\n")
        self.study(design={"kind": "list", "file": "designs.csv"})
        self.assertIn("designs.csv:1: the cells are separated by semicolons", self.sweep(code=2))

    def test_a_latin_hypercube_has_one_design_in_each_stratum(self):
        self.study(design={"kind": "latin_hypercube", "points": 8, "seed": 3, "factors": {
            "a.gain": {"uniform": [0, 8]}, "a.offset": {"uniform": [0, 8]}}},
            draws={"replicates": 1})
        self.sweep()
        for factor in ("a.gain", "a.offset"):
            strata = sorted(int(float(row[factor])) for row in self.rows("designs.csv"))
            self.assertEqual(strata, list(range(8)))


class SameBytes(StudyCase):
    def test_for_one_job_and_for_two(self):
        self.study()
        self.sweep("--jobs", "1", out="one")
        self.sweep("--jobs", "2", out="two")
        for name in ("missions.csv", "designs.csv"):
            self.assertEqual(self.bytes_of(name, "one"), self.bytes_of(name, "two"))

    def test_after_kills_in_the_middle(self):
        self.mission(fault="slow", fault_time=0)  # 20 ms a step
        self.study()
        self.sweep(out="whole")
        command = [MEBOTS, "sweep", str(self.folder / "study.json"), "--out", str(self.folder / "out"), "--jobs", "2"]
        kills = 0
        flown = []
        for _ in range(3):
            process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            before = self.journal_lines()
            while process.poll() is None and self.journal_lines() < before + 3:
                time.sleep(0.02)
            kills += process.poll() is None
            process.send_signal(signal.SIGKILL)
            process.wait()
            flown.append(self.journal_lines())
        self.assertEqual(kills, 3)
        self.assertFalse((self.folder / "out" / "missions.csv").exists())
        self.assertIn(f"{flown[-1]} of at most 20 missions", self.status())
        self.sweep()
        self.assertEqual(self.bytes_of("missions.csv"), self.bytes_of("missions.csv", "whole"))
        self.assertEqual(self.journal_lines(), 20)  # no mission was repeated

    def test_after_a_torn_line(self):
        self.study()
        self.sweep()
        whole = self.bytes_of("missions.csv")
        journal = self.folder / "out" / "journal.jsonl"
        journal.write_bytes(journal.read_bytes()[:-40])
        self.sweep()
        self.assertEqual(self.bytes_of("missions.csv"), whole)
        self.assertEqual(self.journal_lines(), 20)

    def test_when_workers_are_killed(self):
        self.mission(fault="slow", fault_time=0)
        self.study()
        self.sweep(out="whole")
        command = [MEBOTS, "sweep", str(self.folder / "study.json"), "--out", str(self.folder / "out"), "--jobs", "2"]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        killed = 0
        while process.poll() is None and killed < 2:
            time.sleep(0.3)
            if self.journal_lines() < 2 + 4 * killed:
                continue
            for worker in self.workers_of(process.pid)[:1]:
                os.kill(worker, signal.SIGKILL)
                killed += 1
        self.assertEqual(process.wait(), 0)
        self.assertEqual(killed, 2)
        self.assertEqual(self.bytes_of("missions.csv"), self.bytes_of("missions.csv", "whole"))

    def test_workers_end_with_who_started_them(self):
        self.mission(fault="slow", fault_time=0)
        self.study()
        command = [MEBOTS, "sweep", str(self.folder / "study.json"), "--out", str(self.folder / "out"), "--jobs", "2"]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while self.journal_lines() < 2:
            time.sleep(0.02)
        workers = self.workers_of(process.pid)
        self.assertEqual(len(workers), 2)
        process.send_signal(signal.SIGKILL)
        process.wait()
        limit = time.monotonic() + 10
        while any(pathlib.Path(f"/proc/{one}/cwd").exists() and not self.is_zombie(one) for one in workers):
            self.assertLess(time.monotonic(), limit, "a worker outlived the program")
            time.sleep(0.05)

    def test_an_interrupt_ends_with_code_1_and_the_next_call_continues(self):
        self.mission(fault="slow", fault_time=0)
        self.study()
        command = [MEBOTS, "sweep", str(self.folder / "study.json"), "--out", str(self.folder / "out"), "--jobs", "2"]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        while self.journal_lines() < 3:
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        _, told = process.communicate(timeout=20)
        self.assertEqual(process.returncode, 1, told)
        before = self.journal_lines()
        self.sweep()
        self.assertEqual(self.journal_lines(), 20)
        self.assertLess(before, 20)

    @staticmethod
    def is_zombie(process):
        try:
            return pathlib.Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
        except OSError:
            return True

    @staticmethod
    def workers_of(process):
        found = []
        for task in pathlib.Path(f"/proc/{process}/task").iterdir():
            found += [int(one) for one in (task / "children").read_text().split()]
        return sorted(found)

    def journal_lines(self):
        try:
            return (self.folder / "out" / "journal.jsonl").read_bytes().count(b"\n")
        except FileNotFoundError:
            return 0

    def status(self):
        return subprocess.run([MEBOTS, "sweep", "--status", str(self.folder / "out")], check=True,
                              capture_output=True, text=True).stdout


class FailedMissions(StudyCase):
    def test_are_rows_with_their_message_and_give_code_1(self):
        self.study(design={"kind": "grid", "factors": {"a.fault": ["none", "error", "nan"], "a.fault_time": [0.5]}},
                   draws={"replicates": 2})
        self.sweep(code=1)
        rows = self.rows("missions.csv")
        self.assertEqual([row["outcome"] for row in rows], ["far", "far", "failed", "failed", "failed", "failed"])
        self.assertIn("instance 'a' at 0.4 s", rows[2]["message"])
        self.assertEqual([row["success"] for row in rows], ["1", "1", "0", "0", "0", "0"])
        self.assertEqual(rows[2]["integral"], "")
        self.assertEqual([row["failed"] for row in self.rows("designs.csv")], ["0", "2", "2"])

    def test_a_crash_is_one_mission_named(self):
        self.study(design={"kind": "grid", "factors": {"a.fault": ["none", "crash", "null", "exit"], "a.fault_time": [0.5]}},
                   draws=None)
        self.sweep(code=1)
        rows = self.rows("missions.csv")
        self.assertEqual([row["outcome"] for row in rows], ["far", "failed", "failed", "failed"])
        self.assertIn("SIGSEGV", rows[1]["message"])
        self.assertIn("SIGSEGV", rows[2]["message"])
        self.assertIn("called exit()", rows[3]["message"])

    def test_a_hang_is_one_mission_named(self):
        self.study(design={"kind": "grid", "factors": {"a.fault": ["none", "hang"], "a.fault_time": [0.5]}},
                   draws=None, limits={"processor_time": 1})
        self.sweep("--jobs", "2", code=1)
        rows = self.rows("missions.csv")
        self.assertEqual([row["outcome"] for row in rows], ["far", "failed"])

    def test_a_mission_that_needs_too_much_processor_time_has_failed(self):
        self.mission(gain=1)
        config = json.loads((self.folder / "mission.json").read_text())
        config["step"] = 1e-6
        config["stop_time"] = 10
        (self.folder / "mission.json").write_text(json.dumps(config))
        self.study(limits={"processor_time": 0.2}, draws=None, design={"kind": "grid", "factors": {"a.gain": [1]}})
        self.sweep(code=1)
        self.assertIn("limit of 0.2 s", self.rows("missions.csv")[0]["message"])

    def test_after_so_many_the_study_ends_at_the_same_mission_for_any_number_of_jobs(self):
        self.study(design={"kind": "grid", "factors": {"a.fault": ["none", "error", "nan"], "a.fault_time": [0.5]}},
                   limits={"failures": 3})
        self.sweep("--jobs", "1", out="one", code=1)
        self.sweep("--jobs", "2", out="two", code=1)
        self.assertEqual(self.bytes_of("missions.csv", "one"), self.bytes_of("missions.csv", "two"))
        self.assertEqual(len(self.rows("missions.csv", "one")), 13)

    def test_messages_name_no_path(self):
        self.mission()
        cell = self.folder / "cell.json"
        cell.write_text("{}")
        self.study(design={"kind": "grid", "factors": {"a.fault": ["error"], "a.fault_time": [0.5], "a.string_in": ["cell.json"]}},
                   draws=None)
        self.sweep(code=1)
        self.assertNotIn(str(self.folder), self.rows("missions.csv")[0]["message"])


class BadInput(StudyCase):
    def refused(self, *words):
        text = self.sweep(*words, code=2)
        self.assertFalse((self.folder / "out" / "missions.csv").exists())
        return text

    def test_all_mistakes_of_a_study_are_reported_at_once_with_their_places(self):
        self.study(design={"kind": "gird", "factors": {"a.gain": []}}, objectives={"x": {"outcom": "far"}}, limit={})
        text = self.refused()
        for words in ("/design/kind", "'grid'", "/design/factors/a.gain", "/objectives/x", "'outcome'", "/limit", "'limits'"):
            self.assertIn(words, text)

    def test_every_value_of_every_factor_is_tried_before_the_first_mission(self):
        self.study(design={"kind": "grid", "factors": {"a.gain": [1, "much"], "a.mode_in": ["on", "onn"], "a.fault": ["none", "initialisation"]}})
        text = self.refused()
        for words in ("a.gain", "much", "onn", "initialisation"):
            self.assertIn(words, text)
        self.assertEqual(self.bytes_of("journal.jsonl"), b"")

    def test_unknown_names_are_answered_by_the_nearest(self):
        self.study(objectives={"x": {"summary": "integrall"}})
        self.assertIn("'integral'", self.refused())
        self.study(objectives={"x": {"outcome": "fra"}})
        self.assertIn("far", self.refused())
        self.study(objectives={"x": {"expression": "integral + dep.out"}})
        self.assertIn("'deep.out'", self.refused())
        self.study(design={"kind": "grid", "factors": {"a.gian": [1]}})
        self.assertIn("gain", self.refused())
        self.study(design={"kind": "grid", "factors": {"/stop/time": [1]}})
        self.assertIn("'/stop/time'", self.refused())

    def test_an_error_names_the_study_and_the_part_that_causes_it(self):
        study = str(self.folder / "study.json")
        self.study(design={"kind": "grid", "factors": {"a.gain": [1, -100], "a.gian": [1]}})
        self.assertIn(f"{study}: factor 'a.gian' = 1: instance 'a'", self.refused())
        self.study(design={"kind": "grid", "factors": {"a.gain": [1, -100]}})
        self.assertIn(f"{study}: factor 'a.gain' = -100: -100 is below", self.refused())
        self.study(design={"kind": "grid", "factors": {"strength": {"options": {"weak": {"a.gain": 1}, "none": {"a.gain": -100}}}}})
        self.assertIn(f"{study}: factor 'strength' = \"none\": -100 is below", self.refused())
        self.study(draws={"replicates": 2, "variables": {"a.real_on": {"uniform": [0, 3]}}})
        self.assertIn(f"{study}: draw 'a.real_on'", self.refused())
        for source in ({"series": "a.real_oot", "of": "max"}, {"final": "a.real_oot"}):
            self.study(objectives={"top": source})
            self.assertIn(f"{study}: the objective 'top': ", self.refused())
        self.study(objectives={"x": {"outcome": "fra"}})
        self.assertIn(f"{study}: the objective 'x': ", self.refused())

    def test_a_refused_key_of_the_config_names_the_factor_and_its_value(self):
        study = str(self.folder / "study.json")
        self.study(design={"kind": "grid", "factors": {"a.gain": [1, 2], "/step": [0, 0.1, 1e-12]}})
        text = self.refused()
        for value in ("0", "1e-12"):
            self.assertIn(f"{study}: factor '/step' = {value}: ", text)

    def test_a_list_that_is_not_utf_8_is_named(self):
        (self.folder / "designs.csv").write_bytes("a.gain,a.string_in\n1,groß\n".encode("latin-1"))
        self.study(design={"kind": "list", "file": "designs.csv"})
        self.assertIn("designs.csv: this is not a CSV file in UTF-8", self.refused())

    def test_refuses_questions_that_cannot_be_decided(self):
        self.study(constraints={"success": {"above": 95}})
        self.assertIn("/constraints/success/above: 95 must be >= 0 and <= 1", self.refused())
        self.study(rounds={"size": 5, "stop": {"objective": "success", "above": 1.5}})
        self.assertIn("/rounds/stop/above", self.refused())
        self.study(rounds={"size": 5, "racing": True})
        self.assertIn("/rounds/racing", self.refused())

    def test_a_folder_that_cannot_be_made_or_another_file_in_place_of_the_journal_is_refused(self):
        self.study()
        (self.folder / "out").write_text("a file")
        self.assertIn("out: File exists", self.refused())
        (self.folder / "out").unlink()
        self.sweep()
        (self.folder / "out" / "missions.csv").unlink()
        journal = self.folder / "out" / "journal.jsonl"
        journal.write_text("garbage\n{}\n")
        self.assertIn("journal.jsonl: this is not a journal of `mebots sweep`", self.refused())
        self.assertEqual(journal.read_text(), "garbage\n{}\n")

    def test_an_objective_whose_arithmetic_has_no_value_in_any_mission_is_reported_once(self):
        self.study(objectives={
            "integral": {"summary": "integral"}, "none": {"expression": "integral / 0"},
            "root": {"expression": "sqrt(-1)"}, "huge": {"expression": "1e308 * 10"}})
        told = self.sweep(code=2)
        for label, text, why in (("none", "integral / 0", "float division by zero"), ("root", "sqrt(-1)", "math domain error"),
                                 ("huge", "1e308 * 10", "its result is inf")):
            line = f"the objective '{label}' has no value in any of 20 missions: '{text}': {why}"
            self.assertEqual(told.count(line), 1, told)
        self.assertNotIn("objective 'integral'", told)
        self.assertEqual(len(self.rows("missions.csv")), 20)

    def test_an_objective_that_some_missions_lack_is_no_mistake(self):
        self.study(objectives={"success": {"outcome": "far"}, "x": {"expression": "1 / 0", "where": "success"},
                               "y": {"summary": "integral", "where": "success"}, "z": {"expression": "2 * y"}},
                   draws={"replicates": 2, "seed": 1, "variables": {"a.real_in": {"uniform": [0, 1]}}})  # never far
        self.assertNotIn("the objective", self.sweep())

    def test_an_expression_allows_only_arithmetic(self):
        self.study(objectives={"x": {"expression": "__import__('os').system('true')"}})
        self.refused()
        self.study(objectives={"x": {"expression": "integral +"}})
        self.assertIn("not an expression", self.refused())
        for text in ("integral" + "+integral" * 20000, "1" + "+1" * 150, "-" * 150 + "integral"):
            self.study(objectives={"x": {"expression": text}})
            self.assertIn(f"the objective 'x': '{text[:40]}...' is too long", self.refused())
        self.study(objectives={"x": {"expression": "(" * 1500 + "integral" + ")" * 1500}})
        self.assertIn("is not an expression", self.refused())
        self.study(objectives={"integral": {"summary": "integral"}, "x": {"expression": "integral" + "+integral" * 90}})
        self.sweep()

    def test_a_folder_belongs_to_one_sweep_at_a_time(self):
        import fcntl
        self.study()
        self.sweep()
        with open(self.folder / "out" / "journal.jsonl", "r+b") as journal:
            fcntl.flock(journal, fcntl.LOCK_EX)
            self.assertIn("another", self.sweep(code=2))


class Reuse(StudyCase):
    def test_the_tables_of_another_study_are_not_replaced_in_silence(self):
        self.study()
        self.assertNotIn("another study", self.sweep())
        self.assertNotIn("another study", self.sweep())
        self.study(design={"kind": "grid", "factors": {"a.gain": [1, 5]}})
        text = self.sweep()
        self.assertIn("another study", text)
        self.assertIn("10 of them known before", text)

    def test_missions_of_another_build_are_not_flown_again_in_silence(self):
        self.study()
        self.sweep()
        self.assertNotIn("other builds", self.sweep())
        journal = self.folder / "out" / "journal.jsonl"
        records = [json.loads(line) for line in journal.read_text().splitlines()]
        del records[0]["flown_by"]  # as in records of earlier versions
        for number, record in enumerate(records):
            record["mission"] = f"{number:064x}"
            if number > 0:
                record["flown_by"] = "0" * 64
        journal.write_text("".join(json.dumps(record) + "\n" for record in records))
        text = self.sweep()
        self.assertIn(f"{len(records)} records of other builds not used", text)
        self.assertNotIn("known before", text)
        self.assertNotIn("other builds", self.sweep())  # this build has run all missions of the study

    def test_status_finds_the_missions_of_a_study_that_names_files(self):
        (self.folder / "data.txt").write_text("one")
        self.study(design={"kind": "grid", "factors": {"a.string_in": ["data.txt"]}})
        self.sweep()
        status = subprocess.run([MEBOTS, "sweep", "--status", str(self.folder / "out")], capture_output=True, text=True, cwd="/", check=True)
        self.assertIn("10 of at most 10 missions are flown", status.stdout)

    def test_the_same_question_of_another_mission(self):
        self.study(design={"kind": "grid", "factors": {"a.integer_in": [1]}})
        self.sweep()
        (self.folder / "mission.json").rename(self.folder / "other.json")
        self.mission(gain=4)
        self.sweep(out="twice")
        other = self.folder / "other.json"
        self.assertIn("another study", self.sweep("--mission", str(other), out="twice"))
        self.assertEqual(self.bytes_of("missions.csv", "twice"), self.bytes_of("missions.csv"))
        self.assertEqual(json.loads(self.bytes_of("study.json", "twice"))["mission"], str(other))
        mebots.sweep(self.folder / "study.json", self.folder / "python", mission=other)
        self.assertEqual(self.bytes_of("missions.csv", "python"), self.bytes_of("missions.csv"))
        self.assertIn("no.json", self.sweep("--mission", str(self.folder / "no.json"), code=2))

    def test_another_study_takes_the_missions_that_it_shares(self):
        self.study()
        self.sweep()
        self.study(design={"kind": "grid", "factors": {"a.gain": [1, 5]}}, objectives={"top": {"summary": "deep.out"}})
        self.sweep("--reuse", str(self.folder / "out"), out="other")
        old = {json.loads(line)["mission"] for line in self.bytes_of("journal.jsonl").splitlines()}
        new = [json.loads(line)["mission"] for line in self.bytes_of("journal.jsonl", "other").splitlines()]
        self.assertEqual(sum(one in old for one in new), 10)
        self.assertEqual(len(new), 20)

    def test_a_changed_file_is_another_mission(self):
        data = self.folder / "data.txt"
        data.write_text("one")
        self.study(design={
            "kind": "grid", "factors": {"a.string_in": ["data.txt"]}}, draws=None)
        self.sweep()
        data.write_text("two")
        self.sweep()
        self.assertEqual(len(self.bytes_of("journal.jsonl").splitlines()), 2)
        self.assertEqual(self.rows("missions.csv")[0]["a.string_in"], "data.txt")

    def test_a_dry_run_writes_no_missions(self):
        self.study()
        text = self.sweep("--dry-run")
        self.assertIn("2 designs, at most 20 missions", text)
        self.assertFalse((self.folder / "out").exists())


class Python(StudyCase):
    def test_values_that_a_mission_cannot_hold_are_reported(self):
        with mebots.Mission(self.folder / "mission.json") as mission:
            for value, text in ((2**70, "whole number of 64 bits"), ("\ud800", "text in Unicode")):
                with self.assertRaises(mebots.InputError) as caught:
                    mission.set("a.gain", value)
                self.assertIn(text, str(caught.exception))
        with self.assertRaises(TypeError) as told:
            mebots.Mission(self.folder / "mission.json", set="a.gain=2")
        self.assertIn("a.gain=2", str(told.exception))

    def test_a_mission_may_be_a_dict_whose_paths_are_relative_to_the_working_folder(self):
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)
        config = json.loads((self.folder / "mission.json").read_text())
        shutil.copy(PROBE, self.folder / "here.fmu")
        config["instances"]["a"]["fmu"] = "here.fmu"
        config["instances"]["a"]["parameters"]["string_in"] = "far"  # names no file
        with mebots.Mission(config, set={"a.gain": 3}) as mission:
            mission.run()
            self.assertEqual((mission.outcome, mission.value("a.real_out")), ("far", 9.0))
        config["instances"]["a"]["fum"] = "here.fmu"
        with self.assertRaisesRegex(mebots.InputError, "fum"):
            mebots.Mission(config)

    def test_dir_lists_all_that_the_package_offers(self):
        names = {name for name in dir(mebots) if not name.startswith("__")}
        self.assertEqual(names | {"__version__"}, {*mebots.__all__, "gym", "testing"})
        for name in names:
            self.assertIsNotNone(getattr(mebots, name), name)

    def test_a_package_without_gymnasium_has_help_and_says_how_to_install_it(self):
        shown = "'class Mission' in pydoc.render_doc(mebots, renderer=pydoc.plaintext)"
        code = f"import sys; sys.modules['gymnasium'] = None; import mebots, pydoc; print(hasattr(mebots, 'gym'), {shown}); mebots.gym"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
        self.assertEqual(done.stdout, "False True\n", done.stderr)
        self.assertIn("AttributeError: mebots.gym needs gymnasium: pip install 'mebots[gym]'", done.stderr)

    def test_sweep_gives_the_same_bytes_as_the_program(self):
        self.sweep_file = self.study()
        self.sweep()
        result = mebots.sweep(self.sweep_file, self.folder / "python", jobs=1)
        self.assertEqual((result.missions, result.failed), (20, 0))
        self.assertEqual(self.bytes_of("missions.csv"), self.bytes_of("missions.csv", "python"))
        self.assertEqual(result.designs(), self.rows("designs.csv"))

    def test_an_empty_environment_gives_the_same_bytes(self):
        """Tests an environment without PATH, which Python needs to find its own program."""
        self.study()
        self.sweep()
        packages = os.pathsep.join(path for path in sys.path if path.endswith(("site-packages", "dist-packages")))
        command = [MEBOTS, "sweep", str(self.folder / "study.json"), "--out", str(self.folder / "empty")]
        done = subprocess.run(command, capture_output=True, text=True, timeout=170, env={"PYTHONPATH": packages})
        if "cannot load the package" in done.stderr:
            self.skipTest("python3 of /usr/bin is of another version than this one")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.bytes_of("missions.csv"), self.bytes_of("missions.csv", "empty"))

    def test_any_executor_flies_them(self):
        import concurrent.futures
        import multiprocessing

        file = self.study()
        self.sweep()
        with concurrent.futures.ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as executor:
            mebots.sweep(file, self.folder / "pool", executor=executor)
        self.assertEqual(self.bytes_of("missions.csv"), self.bytes_of("missions.csv", "pool"))


class Kept(StudyCase):
    """Tests the folders and files that a study keeps in addition to its tables."""

    def test_results_of_each_mission_are_those_of_a_single_run(self):
        self.study(results=True)
        self.sweep("--jobs", "2")
        rows = self.rows("missions.csv")
        for row in (rows[2], rows[15]):
            folder = self.flight(row)
            single = self.folder / "single"
            command = [MEBOTS, "run", str(self.folder / "mission.json"), "--out", str(single), "--quiet"]
            for name in ("a.gain", "a.real_in"):
                command += ["--set", f"{name}={row[name]}"]
            subprocess.run(command, check=True)
            self.assertEqual((folder / "results.csv").read_bytes(), (single / "results.csv").read_bytes())
            self.assertEqual(json.loads((folder / "summary.json").read_text())["integral"], float(row["integral"]))
        self.assertEqual(len(list((self.folder / "out" / "flights").glob("??/*"))), 20)

    def test_no_temporary_files_stay(self):
        temporary = self.folder / "temporary"
        temporary.mkdir()
        self.FMU = STEADY
        self.mission()
        self.study(fork={"at": 0.5, "variables": ["a.real_in"]})
        environment = dict(os.environ, TMPDIR=str(temporary))
        command = [MEBOTS, "sweep", str(self.folder / "study.json"), "--out", str(self.folder / "out"), "--jobs", "2"]
        subprocess.run(command, env=environment, capture_output=True, check=True)
        self.assertEqual([path.name for path in temporary.iterdir()], [])

    def test_no_temporary_files_stay_after_an_interrupt_at_any_time(self):
        temporary = self.folder / "temporary"
        temporary.mkdir()
        self.mission(fault="slow", fault_time=0)
        self.study()
        environment = dict(os.environ, TMPDIR=str(temporary))
        command = [MEBOTS, "sweep", str(self.folder / "study.json"), "--out", str(self.folder / "out"), "--jobs", "2"]
        for wait_s in [0] * 10 + [0.1, 0.2, 0.4, 0.8]:
            process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            while not any(temporary.iterdir()):
                self.assertIsNone(process.poll())  # without a pause, to reach the time directly after the threads' start
            time.sleep(wait_s)
            process.send_signal(signal.SIGINT)
            self.assertEqual(process.wait(timeout=20), 1)
            self.assertEqual([path.name for path in temporary.iterdir()], [], f"after {wait_s} s")

    def test_results_that_were_lost_are_flown_again_and_others_are_not(self):
        self.study(results=True)
        self.sweep()
        before = self.bytes_of("missions.csv")
        lost = self.flight(self.rows("missions.csv")[4]) / "summary.json"
        lost.unlink()
        lines = len(self.bytes_of("journal.jsonl").splitlines())
        self.sweep()
        self.assertTrue(lost.exists())
        self.assertEqual(self.bytes_of("missions.csv"), before)
        self.assertEqual(len(self.bytes_of("journal.jsonl").splitlines()), lines + 1)

    def test_a_dry_run_counts_them_among_the_disk(self):
        config = json.loads((self.folder / "mission.json").read_text())
        config["step"] = 0.0001  # 10,000 rows
        (self.folder / "mission.json").write_text(json.dumps(config))
        study = self.study(results=True)
        told = subprocess.run([MEBOTS, "sweep", str(study), "--dry-run"], capture_output=True, text=True, check=True).stdout
        megabytes = float(re.search(r"about ([\d.]+) MB of disk", told)[1])
        self.assertGreater(megabytes, 10)

    def test_hdf5_holds_the_tables_with_units(self):
        import h5py

        self.study(objectives={"success": {"outcome": "far"}, "integral": {"summary": "integral", "unit": "m"}})
        self.sweep()
        with h5py.File(self.folder / "out" / "tables.h5") as file:
            rows = self.rows("missions.csv")
            self.assertEqual(list(file["missions/integral"]), [float(row["integral [m]"]) for row in rows])
            self.assertEqual(file["missions/integral"].attrs["unit"], "m")
            self.assertEqual(file["missions/success"].dtype.kind, "i")
            self.assertEqual([text.decode() for text in file["missions/outcome"]], [row["outcome"] for row in rows])
            self.assertEqual(len(file["designs/design"]), 2)

    @unittest.skipUnless(importlib.util.find_spec("pyarrow"), "pyarrow is not installed: pip install pyarrow")
    def test_parquet_holds_the_tables(self):
        import pyarrow.parquet

        self.study(objectives={"success": {"outcome": "far"}, "integral": {"summary": "integral", "unit": "m"}})
        self.sweep()
        for name in ("missions", "designs"):
            table = pyarrow.parquet.read_table(self.folder / "out" / f"{name}.parquet").to_pydict()
            rows = self.rows(f"{name}.csv")
            self.assertEqual(list(table), list(rows[0]))
            for title, column in table.items():
                self.assertEqual(len(column), len(rows))
                for value, row in zip(column, rows, strict=True):
                    self.assertEqual(value if isinstance(value, str) else float(value), row[title] if isinstance(value, str) else float(row[title] or "nan"))
        self.assertIsInstance(pyarrow.parquet.read_table(self.folder / "out" / "missions.parquet")["success"][0].as_py(), int)

    def test_progress_and_status_say_what_is_known_so_far(self):
        told = []
        mebots.sweep(self.study(), self.folder / "out", jobs=1, progress=told.append)
        outcomes = [row["outcome"] for row in self.rows("missions.csv")]
        self.assertIn(f"near {outcomes.count('near')}", told[-1].answer)
        status = subprocess.run([MEBOTS, "sweep", "--status", str(self.folder / "out")], capture_output=True, text=True, check=True)
        self.assertIn(f"far {outcomes.count('far')}", status.stdout)
        self.assertIn("20 of at most 20", status.stdout)


class Summary(StudyCase):
    def test_is_whole_for_any_number_of_labels(self):
        """Adds one label at a time, so that the JSON text of the record has many lengths."""
        config = json.loads((self.folder / "mission.json").read_text())
        for count in range(40):
            config["summary"] = {f"label{number}": "a.integral" for number in range(count)}
            (self.folder / "mission.json").write_text(json.dumps(config))
            with mebots.Mission(self.folder / "mission.json") as mission:
                mission.start()
                summary = mission.summary
            self.assertEqual(summary["versions"]["mebots"], mebots.__version__)
            self.assertEqual(list(summary["versions"]["instances"]), ["a"])
            self.assertEqual(list(summary["inputs"]["fmus"]), ["a"])
            self.assertEqual(summary["parameters"]["a"]["gain"], 2)


class Arrays(StudyCase):
    """Tests missions with arrays whose sizes depend on a structural parameter."""

    def mission(self, **parameters):
        (self.folder / "mission.json").write_text(json.dumps({
            "step": 0.5, "stop_time": 1, "connections": [],
            "instances": {"a": {"fmu": BANK, "parameters": {"line.initial[1]": 0} | parameters}},
            "outcomes": [{"outcome": "far", "when": [{"variable": "a.line.y[1]", "above": 2}]}, {"outcome": "near"}],
            "record": {"variables": ["*", "a.labels", "a.line.echo[1]"]},
            "summary": {"y": "a.line.y[1]"},
        }))

    def test_an_element_may_be_a_factor_before_its_size(self):
        self.study(design={"kind": "grid", "factors": {"a.line.initial[4]": [5, 7], "a.lines": [4]}},
                   draws={"replicates": 2, "seed": 1, "variables": {"a.line.u[4]": {"uniform": [0, 3]}}},
                   objectives={"fourth": {"final": "a.line.y[4]"}})
        self.sweep("--jobs", "1")
        for row in self.rows("missions.csv"):
            expected = float(row["a.line.initial[4]"]) + float(row["a.line.u[4]"])
            self.assertAlmostEqual(float(row["fourth"]), expected, 12)

    def test_a_pattern_may_be_a_factor_and_a_draw(self):
        self.study(design={"kind": "grid", "factors": {"a.line.initial[*]": [5, 7], "a.lines": [4]}},
                   draws={"replicates": 2, "seed": 1, "variables": {"a.*.u[4]": {"uniform": [0, 3]}}},
                   objectives={"first": {"final": "a.line.y[1]"}, "fourth": {"final": "a.line.y[4]"}})
        self.sweep("--jobs", "1")
        for row in self.rows("missions.csv"):
            initial = float(row["a.line.initial[*]"])
            self.assertAlmostEqual(float(row["fourth"]), initial + float(row["a.*.u[4]"]), 12)
        self.study(design={"kind": "grid", "factors": {"a.line.initail[*]": [5, 7]}}, draws=None,
                   objectives={"first": {"final": "a.line.y[1]"}})
        self.assertIn("no variable fits 'a.line.initail[*]'. Did you mean 'a.line.initial[*]'", self.sweep("--jobs", "1", code=2))

    def test_python_sets_all_variables_that_fit_a_pattern(self):
        with mebots.Mission(self.folder / "mission.json", set={"a.line.u[*]": 7, "a.lines": 4}) as mission:
            mission.run()
            self.assertEqual([mission.value(f"a.line.u[{line}]") for line in range(1, 5)], [7] * 4)
        with mebots.Mission(self.folder / "mission.json") as mission:
            for name, value in {"a.line.u[*]": 7, "a.line.u[4]": 9, "a.lines": 4}.items():
                mission.set(name, value)
            mission.run()
            self.assertEqual([mission.value(f"a.line.u[{line}]") for line in range(1, 5)], [7, 7, 7, 9])
        with mebots.Mission(self.folder / "mission.json", set={"a.lines": 4, "a.*.u[4]": 9}) as mission:
            with self.assertRaisesRegex(mebots.InputError, r"no variable fits 'a\.\*\.u\[4\]'.* Set the sizes of arrays before"):
                mission.set("a.lines", 2)
            mission.run()
            self.assertEqual(mission.value("a.line.u[4]"), 9)  # the failed call has no effect
        with self.assertRaisesRegex(mebots.InputError, r"no variable fits 'a\.line\.v\*'\. Did you mean .*'a\.line\.u\[\*\]'"):
            mebots.Mission(self.folder / "mission.json", set={"a.line.v*": 7})

    def test_a_size_may_be_a_factor(self):
        self.study(design={"kind": "grid", "factors": {"a.lines": [2, 3]}},
                   draws={"replicates": 2, "seed": 1, "variables": {"a.line.u[2]": {"uniform": [0, 3]}}},
                   objectives={"second": {"final": "a.line.y[2]"}})
        self.sweep("--jobs", "1")
        self.assertEqual(len(self.rows("missions.csv")), 4)

    def test_python_sets_elements_and_sizes_in_any_order(self):
        values = {"a.line.u[4]": 7, "a.lines": 4}
        for order in (values, dict(reversed(values.items()))):
            with mebots.Mission(self.folder / "mission.json", set=order) as mission:
                mission.run()
                self.assertEqual(mission.value("a.line.y[4]"), 37)
            with mebots.Mission(self.folder / "mission.json") as mission:
                for name, value in order.items():
                    mission.set(name, value)
                mission.run()
                self.assertEqual(mission.value("a.line.y[4]"), 37)
                mission.reset()
                mission.set("a.line.u[1]", 1)
                mission.run()
                self.assertNotIn("a.line.y[4]", mission.variables)

    def test_python_refuses_elements_beyond_the_size(self):
        with mebots.Mission(self.folder / "mission.json", set={"a.lines": 3, "a.line.u[4]": 7}) as mission:
            with self.assertRaisesRegex(mebots.InputError, r'set\("a.line.u\[4\]"\): .*no variable \'line.u\[4\]\''):
                mission.start()
        with mebots.Mission(self.folder / "mission.json") as mission:
            for wrong in ("a.line.u", "a.line.u[0]", "a.line.u[1,1]", "a.line.u[]", "a.line.u[2,]", "a.nothing[2]"):
                with self.assertRaisesRegex(mebots.InputError, "no variable", msg=wrong):
                    mission.set(wrong, 1)
            with self.assertRaises(mebots.InputError):
                mission.set("a.line.u[4]", "text")
            with self.assertRaisesRegex(mebots.InputError, "cannot be set"):
                mission.set("a.line.y[4]", 1)

    def test_a_factor_beyond_the_size_is_named(self):
        self.study(design={"kind": "grid", "factors": {"a.line.u[4]": [5, 7]}}, draws=None,
                   objectives={"first": {"final": "a.line.y[1]"}})
        error = self.sweep("--jobs", "1", code=2)
        self.assertIn("factor 'a.line.u[4]'", error)
        self.assertIn("no variable 'line.u[4]'", error)
        self.assertNotIn("set(", error)

    def test_texts_that_look_like_numbers_stay_texts(self):
        out = self.folder / "out"
        with mebots.Mission(self.folder / "mission.json", out=out,
                            set={"a.line.message[1]": "0102", "a.line.label[1]": "007", "a.line.label[2]": ""}) as mission:
            mission.run()
        results = mebots.read(out)
        self.assertEqual(results["a.line.echo[1]"][-1], "0102")
        self.assertIsInstance(results["a.labels"][0], str)
        self.assertEqual(results["a.line.y[1]"].dtype, "float64")


class Reset(StudyCase):
    """Tests that a mission after reset() gives the same bits as a new mission."""

    VARIABLES = ["battery.*", "motors.*", "world.*", "soc.*"]

    def flight(self, mission, settings):
        for name, value in settings.items():
            mission.set(name, value)
        mission.record(self.VARIABLES)
        mission.set_stop_time(2)
        mission.run()
        kept = {key: value for key, value in mission.summary.items() if key not in ("wall_clock", "real_time_factor")}
        return kept, {name: mission._series(name)[1] for name in mission.variables}

    def test_of_the_gate_mission(self):
        config = SOURCE / "configs" / "gate_easy.json"
        first = {"world.sensors.seed": 7, "battery.cell.name": "lipol_350", "soc.core.clock": 150e6, "world.scene.name": "gate_hard"}
        second = {"world.sensors.seed": 8}
        used = mebots.Mission(config)
        changed = self.flight(used, first)
        used.reset()
        self.assertEqual(used.state, "open")
        again = self.flight(used, second)
        del used  # an FMU with its own library cannot be loaded twice in a process
        fresh = self.flight(mebots.Mission(config), second)
        self.assertEqual(again, fresh)
        self.assertNotEqual(changed, fresh)

    def test_of_one_that_failed_that_was_closed_and_that_is_in_a_step(self):
        mission = mebots.Mission(self.folder / "mission.json", set={"a.fault": "fatal", "a.fault_time": 0.5})
        with self.assertRaises(mebots.Error):
            mission.run()
        mission.reset()
        mission.run_until(0.3)
        mission.reset()
        mission.on_point(lambda time: self.assertRaises(mebots.InputError, mission.reset))
        mission.run()
        self.assertEqual((mission.outcome, mission.value("a.integral")), ("far", 3.0))

    def test_not_of_one_that_was_resumed(self):
        out = self.folder / "run"
        mission = mebots.Mission(self.folder / "mission.json", out=out, checkpoint_every=0.2)
        mission.run_until(0.5)
        mission.close()
        with self.assertRaises(mebots.InputError):
            mebots.Mission.resume(out).reset()


if __name__ == "__main__":
    unittest.main(argv=sys.argv)
