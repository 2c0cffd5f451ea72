#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests the readers of flight logs: their values, and their errors for other files."""

import json
import pathlib
import struct
import tempfile
import unittest
import zlib

import numpy as np
from logs import ulog, usd_header, usd_log, usd_record

import mebots
from mebots.flight.reading import read_log

STATE = (0xFFFF, "fixedFrequency", ["rpm.m1(H)", "pwm.m1_pwm(H)", "pm.vbatMV(H)", "acc.z(f)", "own.value(i)"])
POSE = (8, "estPose", ["locSrv.x(f)"])


class LogCase(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def file(self, content, name="log"):
        path = self.folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def mapping(self, content):
        path = self.folder / "mapping.json"
        path.write_text(json.dumps(content))
        return path

    def refusal(self, content, mapping=None):
        with self.assertRaises(mebots.InputError) as caught:
            read_log(self.file(content), mapping)
        text = str(caught.exception)
        self.assertIn("log", text)
        return text


class UsdLogs(LogCase):
    def test_signals_have_si_units_and_their_own_times(self):
        records = [
            (0xFFFF, 5_000_000, (6000, 65535, 4000, 1.0, -7)),
            (8, 5_001_000, (2.5,)),
            (0xFFFF, 5_002_000, (12000, 0, 3900, 0.0, 8)),
        ]
        log = read_log(self.file(usd_log([STATE, POSE], records)))
        np.testing.assert_allclose(log["rotor[1].speed"].values, [200 * np.pi, 400 * np.pi])
        np.testing.assert_allclose(log["motor[1].command"].values, [1, 0])
        np.testing.assert_allclose(log["battery.voltage"].values, [4.0, 3.9])
        np.testing.assert_allclose(log["acceleration.z"].values, [9.80665, 0])
        np.testing.assert_allclose(log["battery.voltage"].times, [0, 0.002])
        np.testing.assert_allclose(log["locSrv.x"].times, [0.001])
        np.testing.assert_allclose(log["own.value"].values, [-7, 8])
        self.assertEqual(log["battery.voltage"].unit, "V")
        self.assertEqual(log["battery.voltage"].column, "pm.vbatMV")
        self.assertEqual(log.notes, ())

    def test_a_mapping_replaces_the_meanings_of_known_columns(self):
        content = usd_log([STATE], [(0xFFFF, 0, (6000, 65535, 4000, 1.0, -7))])
        mapping = {"columns": {"pm.vbatMV": {"signal": "battery.voltage", "unit": "mV", "scale": 2.0},
                               "acc.z": {"signal": "acceleration.z", "unit": "m/s2"}}}  # fmt: skip
        log = read_log(self.file(content), self.mapping(mapping))
        np.testing.assert_allclose(log["battery.voltage"].values, [8.0])
        np.testing.assert_allclose(log["acceleration.z"].values, [1.0])
        np.testing.assert_allclose(log["rotor[1].speed"].values, [200 * np.pi])

    def test_version_1_counts_milliseconds(self):
        log = read_log(self.file(usd_log([POSE], [(8, 10, (1.0,)), (8, 30, (2.0,))], 1)))
        np.testing.assert_allclose(log["locSrv.x"].times, [0, 0.02])

    def test_a_cut_log_is_read_as_far_as_it_goes(self):
        whole = usd_log([POSE], [(8, 1000 * i, (float(i),)) for i in range(5)])
        log = read_log(self.file(whole[:-9]))
        self.assertEqual(len(log["locSrv.x"]), 4)
        self.assertIn("9 bytes from byte", log.notes[0])

    def test_a_changed_log_is_read_up_to_the_change(self):
        header = usd_header([POSE])
        data = header + usd_record(8, 0, "f", (1.0,)) + usd_record(8, 5, "f", (1.5,)) + usd_record(99, 9, "f", (2.0,))
        log = read_log(self.file(data + b"\0\0\0\0"))
        self.assertEqual(len(log["locSrv.x"]), 2)
        self.assertIn(f"byte {len(header) + 28}", log.notes[0])

    def test_mistakes_of_the_writer_name_the_byte(self):
        def closed(data):
            return data + struct.pack("<I", zlib.crc32(data))

        header = usd_header([POSE])
        self.assertIn(f"byte {len(header)}: a record has the id 99", self.refusal(closed(header + usd_record(99, 0, "f", (1.0,)))))
        self.assertIn("is incomplete", self.refusal(closed(header + usd_record(8, 0, "f", (1.0,))[:-2])))
        self.assertIn("byte 1: version 7", self.refusal(usd_header([POSE], 7)))
        self.assertIn("must end in its type", self.refusal(usd_header([(8, "estPose", ["locSrv.x(z)"])])))
        self.assertIn("must end in its type", self.refusal(usd_header([(8, "estPose", ["x"])])))
        self.assertIn("has no end", self.refusal(header[:20]))
        self.assertIn("the header ends", self.refusal(header[:4]))
        self.assertIn("the id 8", self.refusal(usd_header([POSE, POSE])))
        self.assertIn("a variable twice", self.refusal(usd_header([(8, "a", ["b(f)", "b(f)"])])))
        self.assertIn("no samples", self.refusal(closed(header)))
        self.assertIn("empty", self.refusal(b""))

    def test_every_cut_gives_samples_or_an_error(self):
        whole = usd_log([STATE, POSE], [(8, 1, (1.0,)), (0xFFFF, 2, (1, 2, 3, 4.0, 5)), (8, 3, (2.0,))])
        for length in range(len(whole)):
            try:
                read_log(self.file(whole[:length]))
            except mebots.InputError:
                pass


class CsvTables(LogCase):
    MAPPING = {"time": {"column": "t", "unit": "ms"}, "columns": {"u": {"signal": "battery.voltage", "unit": "mV"}}}

    def test_bytes_that_are_not_utf_8_are_refused(self):
        self.assertIn("0xb0, which is not UTF-8", self.refusal(b"t,u\n1,\xb0\n", self.mapping(self.MAPPING)))

    def test_units_and_scale_are_applied(self):
        columns = {
            "u": {"signal": "battery.voltage", "unit": "mV"},
            "n": {"signal": "rotor[1].speed", "unit": "rpm"},
            "d": {"signal": "velocity.z", "unit": "m/s", "scale": -1},
        }
        mapping = self.mapping({"time": {"column": "t", "unit": "ms"}, "columns": columns})
        log = read_log(self.file("t,u,n,d,remark\n100,4000,60,2,start\n110,3900,120,-3,\n"), mapping)
        np.testing.assert_allclose(log["battery.voltage"].values, [4, 3.9])
        np.testing.assert_allclose(log["battery.voltage"].times, [0, 0.01])
        np.testing.assert_allclose(log["rotor[1].speed"].values, [2 * np.pi, 4 * np.pi])
        np.testing.assert_allclose(log["velocity.z"].values, [-2, 3])
        self.assertNotIn("remark", log)

    def test_rows_without_times_have_a_period(self):
        mapping = self.mapping({"time": {"period": 10, "unit": "ms"}, "columns": self.MAPPING["columns"]})
        log = read_log(self.file("u\n4000\n3900\n"), mapping)
        np.testing.assert_allclose(log["battery.voltage"].times, [0, 0.01])
        self.assertIn("0.01 s", log.notes[0])

    def test_the_drift_of_a_clock_is_taken_out(self):
        time = {"column": "t", "unit": "s", "reference": {"column": "host", "unit": "s"}}
        rows = "".join(f"{0.999 * i},{100 + i},4000\n" for i in range(11))
        log = read_log(self.file("t,host,u\n" + rows), self.mapping({"time": time, "columns": self.MAPPING["columns"]}))
        self.assertAlmostEqual(log["battery.voltage"].times[-1], 10, places=9)
        self.assertIn("-1001 ppm", log.notes[0])

    def test_two_clocks_of_different_units_are_refused(self):
        time = {"column": "t", "reference": {"column": "host"}}
        rows = "".join(f"{i},{1000 * i},4000\n" for i in range(3))
        mapping = self.mapping({"time": time, "columns": self.MAPPING["columns"]})
        self.assertIn("check the units", self.refusal("t,host,u\n" + rows, mapping))

    def test_errors_name_row_column_and_value(self):
        mapping = self.mapping(self.MAPPING)
        self.assertIn("row 2 after the header, column 2: 'high'", self.refusal("t,u\n0,4000\n1,high\n", mapping))
        self.assertIn("the column 'u'", self.refusal("t,v\n0,4000\n", mapping))
        self.assertIn("no rows", self.refusal("t,u\n", mapping))
        self.assertIn("--mapping", self.refusal("t,u\n0,4000\n"))
        self.assertIn("not a flight log", self.refusal(b"MZ\0\0\1"))
        self.assertIn("column of times", self.refusal("time,u\n0,4000\n", mapping))

    def test_an_empty_cell_is_no_number(self):
        log = read_log(self.file("t,u\n0,4000\n1,\n2,3900\n"), self.mapping(self.MAPPING))
        self.assertTrue(np.isnan(log["battery.voltage"].values[1]))


class Mappings(LogCase):
    def refused(self, content):
        with self.assertRaises(mebots.InputError) as caught:
            read_log(self.file("t,u\n0,1\n"), self.mapping(content))
        return str(caught.exception)

    def test_mistakes_are_named(self):
        time = {"column": "t"}
        self.assertIn("battery.volts", self.refused({"time": time, "columns": {"u": {"signal": "battery.volts", "unit": "V"}}}))
        self.assertIn("rad/s", self.refused({"time": time, "columns": {"u": {"signal": "rotor[1].speed", "unit": "V"}}}))
        self.assertIn("'column' or 'period'", self.refused({"time": {}, "columns": {"u": {"signal": "battery.voltage", "unit": "V"}}}))
        self.assertIn("no column", self.refused({"time": time, "columns": {}}))
        twice = {name: {"signal": "battery.voltage", "unit": "V"} for name in "ut"}
        self.assertIn("already has a column", self.refused({"time": time, "columns": twice}))

    def test_a_mapping_adds_to_a_usd_log(self):
        mapping = self.mapping({"columns": {"locSrv.x": {"signal": "position.x", "unit": "mm"}}})
        log = read_log(self.file(usd_log([POSE], [(8, 0, (1.0,)), (8, 9, (2.0,))])), mapping)
        np.testing.assert_allclose(log["position.x"].values, [0.001, 0.002])


class ULogs(LogCase):
    def test_frames_are_east_north_up_and_forward_left_up(self):
        half = np.sqrt(0.5)
        messages = {
            "battery_status": ("float voltage_v;float current_a;", "ff", [(2000, (12.5, 3.0)), (12000, (12.0, 4.0))]),
            "vehicle_local_position": ("float vx;float vy;float vz;", "fff", [(2000, (1.0, 2.0, 3.0)), (3000, (1.0, 2.0, 3.0))]),
            # The drone is level with its nose to the north, a quarter turn left of the east.
            "vehicle_attitude": ("float[4] q;", "ffff", [(2000, (1.0, 0.0, 0.0, 0.0)), (3000, (half, 0.0, 0.0, half))]),
        }
        log = read_log(self.file(ulog(messages)))
        np.testing.assert_allclose(log["battery.voltage"].values, [12.5, 12])
        np.testing.assert_allclose(log["battery.current"].times, [0, 0.01])
        self.assertEqual([log[f"velocity.{axis}"].values[0] for axis in "xyz"], [2, 1, -3])
        q = np.array([log[f"attitude.q{part}"].values for part in "wxyz"])
        forward = np.array([q[0] ** 2 + q[1] ** 2 - q[2] ** 2 - q[3] ** 2, 2 * (q[1] * q[2] + q[0] * q[3])])
        up = q[0] ** 2 - q[1] ** 2 - q[2] ** 2 + q[3] ** 2
        np.testing.assert_allclose(forward[:, 0], [0, 1], atol=1e-7)
        np.testing.assert_allclose(forward[:, 1], [1, 0], atol=1e-7)  # the east, a quarter turn to the right
        np.testing.assert_allclose(up, [1, 1], atol=1e-7)

    def test_broken_files_are_refused_or_read_in_part(self):
        whole = ulog({"battery_status": ("float voltage_v;", "f", [(1000 * i, (12.0,)) for i in range(1, 5)])})
        self.assertIn("ULog", self.refusal(whole[:7]))
        self.assertIn("byte 16", self.refusal(whole[:16] + b"\xff" * 5000))
        for length in range(8, len(whole)):
            try:
                read_log(self.file(whole[:length]))
            except mebots.InputError:
                pass


if __name__ == "__main__":
    unittest.main()
