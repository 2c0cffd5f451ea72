#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the journal: damaged lines, journals of earlier versions, file systems without locks."""

import errno
import json
import os
import pathlib
import sys
import tempfile
import time
import unittest
import unittest.mock

from mebots import InputError
from mebots.exploration import files, flying
from mebots.exploration.journal import Journal, line_of
from support import StudyCase

BUILD = "b" * 64


def record(number, **more):
    return {"mission": f"{number:064x}", "flown_by": BUILD, "outcome": "far", "error": "", "code": "", "values": {"integral": number}} | more


class JournalCase(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.file = self.folder / "journal.jsonl"

    def opened(self):
        journal = Journal(self.folder)
        self.addCleanup(journal.close)
        return journal


class Lines(JournalCase):
    def test_records_are_found_after_opening_again(self):
        journal = self.opened()
        for number in range(0, 3000, 100):
            journal.append([record(number + one) for one in range(100)])
        journal.close()
        journal = self.opened()
        self.assertEqual(len(journal), 3000)
        self.assertEqual(journal.find(f"{1234:064x}"), record(1234))
        self.assertIsNone(journal.find(f"{3000:064x}"))
        self.assertEqual(journal.may_have([number.to_bytes(32, "big") for number in (0, 2999)]).tolist(), [True, True])
        self.assertEqual((journal.of_other_builds(BUILD), journal.of_other_builds("other")), (0, 3000))

    def test_missions_whose_hashes_begin_alike_are_distinguished(self):
        journal = self.opened()
        journal.append([record(0, mission=("0" * 60) + f"{number:04x}", values={"n": number}) for number in range(50)])
        for _ in range(2):
            self.assertEqual(journal.find(("0" * 60) + f"{7:04x}")["values"], {"n": 7})
            journal.close()
            journal = self.opened()

    def test_the_last_record_of_a_mission_counts(self):
        journal = self.opened()
        journal.append([record(1), record(1, outcome="near")])
        self.assertEqual(journal.find(f"{1:064x}")["outcome"], "near")
        journal.close()
        self.assertEqual(self.opened().find(f"{1:064x}")["outcome"], "near")

    def test_each_changed_byte_is_detected_and_named(self):
        line = line_of(record(1))
        sound = line_of(record(0)) + line + line_of(record(2))
        begin = len(line_of(record(0)))
        for at in range(begin, begin + len(line) - 1):
            changed = bytearray(sound)
            changed[at] = ord("7") if changed[at] != ord("7") else ord("3")
            self.file.write_bytes(changed)
            journal = Journal(self.folder)
            self.assertEqual(len(journal), 2, bytes(changed[begin:]))
            self.assertEqual(len(journal.notices), 1)
            self.assertIn("journal.jsonl:2: this line is damaged", journal.notices[0])
            self.assertEqual(journal.find(f"{2:064x}"), record(2))
            journal.close()

    def test_a_line_nested_too_deep_for_the_parser_is_damaged(self):
        self.file.write_bytes(line_of(record(1)) + b'{"mission":' + b"[" * 200_000 + b"\n")
        journal = self.opened()
        self.assertIn("journal.jsonl:2: this line is damaged", journal.notices[0])
        self.assertEqual(len(journal), 1)

    def test_many_damaged_lines_are_counted(self):
        self.file.write_bytes(line_of(record(1)) + b"garbage\n" * 5000)
        notices = self.opened().notices
        self.assertEqual(len(notices), 11)
        self.assertIn("5000 lines are damaged", notices[-1])

    def test_an_incomplete_last_line_is_cut_off(self):
        self.file.write_bytes(line_of(record(1)) + line_of(record(2))[:-9])
        self.assertEqual(len(self.opened()), 1)
        self.assertEqual(self.file.read_bytes(), line_of(record(1)))

    def test_lines_of_earlier_versions_without_a_checksum_count(self):
        old = b"".join(json.dumps(record(number)).encode() + b"\n" for number in range(3))
        oldest = json.dumps({key: value for key, value in record(3).items() if key != "flown_by"}).encode() + b"\n"
        self.file.write_bytes(oldest + old)
        journal = self.opened()
        journal.append([record(4)])
        journal.close()
        journal = self.opened()
        self.assertEqual((len(journal), journal.notices), (5, []))
        self.assertEqual(journal.find(f"{1:064x}"), record(1))
        self.assertEqual(journal.of_other_builds(BUILD), 1)

    def test_another_file_is_refused_and_stays_as_it_is(self):
        self.file.write_text("not a journal\n")
        with self.assertRaises(InputError) as caught:
            Journal(self.folder)
        self.assertIn("this is not a journal", str(caught.exception))
        self.assertEqual(self.file.read_text(), "not a journal\n")


class Locks(JournalCase):
    def test_a_second_sweep_is_refused(self):
        self.opened()
        with self.assertRaises(InputError) as caught:
            Journal(self.folder)
        self.assertIn("another `mebots sweep`", str(caught.exception))

    def test_a_file_system_without_locks_is_reported_as_one(self):
        with unittest.mock.patch("fcntl.flock", side_effect=OSError(errno.ENOSYS, os.strerror(errno.ENOSYS))):
            journal = self.opened()
        self.assertIn("this file system cannot lock files (Function not implemented)", journal.notices[0])
        journal.append([record(1)])
        self.assertEqual(len(journal), 1)


class Studies(StudyCase):
    def test_a_damaged_line_is_named_and_its_mission_runs_again(self):
        self.study()
        self.sweep()
        whole = {name: self.bytes_of(name) for name in ("missions.csv", "designs.csv")}
        journal = self.folder / "out" / "journal.jsonl"
        lines = journal.read_bytes().splitlines(keepends=True)
        place = lines[4].index(b'"integral":') + len(b'"integral":') + 3
        lines[4] = lines[4][:place] + (b"1" if lines[4][place : place + 1] != b"1" else b"2") + lines[4][place + 1 :]
        journal.write_bytes(b"".join(lines))
        told = self.sweep()
        self.assertIn("journal.jsonl:5: this line is damaged (its checksum is wrong); its mission runs again", told)
        self.assertIn("20 missions, 19 of them known before", told)
        for name, content in whole.items():
            self.assertEqual(self.bytes_of(name), content)

    def test_a_table_does_not_follow_a_symbolic_link(self):
        self.study()
        (self.folder / "out").mkdir()
        precious = self.folder / "precious"
        precious.write_text("precious")
        for name in ("missions.csv.part", "designs.csv.part", "report.html.part", "study.json.part", "tables.h5.part"):
            (self.folder / "out" / name).symlink_to(precious)
        self.sweep()
        self.assertEqual(precious.read_text(), "precious")

    def test_an_empty_environment_is_enough(self):
        self.study()
        code = "import sys; from mebots.exploration.command import main; sys.exit(main(sys.argv[1:]))"
        words = [sys.executable, "-c", f"import sys; sys.path[:0] = {sys.path!r}; {code}", str(self.folder / "study.json"), "--out", str(self.folder / "out")]
        process = os.posix_spawn(sys.executable, words, {})
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]), 0)


class TemporaryFolders(unittest.TestCase):
    def test_the_next_run_removes_empty_folders_of_killed_runs(self):
        with tempfile.TemporaryDirectory() as name, unittest.mock.patch("tempfile.gettempdir", return_value=name):
            old, young, used = (pathlib.Path(name) / f"mebots-sweep-{one}" for one in ("old", "young", "used"))
            for folder in (old, young, used):
                folder.mkdir()
            (used / "file").touch()
            for folder in (old, used):
                os.utime(folder, (time.time() - 3600,) * 2)
            flying._remove_empty_folders()
            self.assertEqual((old.exists(), young.exists(), used.exists()), (False, True, True))


class TemporaryFiles(JournalCase):
    def test_a_file_is_replaced_completely_or_not_at_all(self):
        file = self.folder / "table"
        file.write_text("old")

        def blocks():
            yield b"new"
            raise ValueError

        with self.assertRaises(ValueError):
            files.write_whole(file, blocks())
        self.assertEqual(file.read_text(), "old")
        self.assertEqual([one.name for one in self.folder.iterdir()], ["table"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv)
