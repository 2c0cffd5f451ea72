#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests `mebots.sweep` in programs and notebooks: data frames, a temporary folder, a progress bar and pages."""

import gc
import importlib.util
import json
import sys
import types
import unittest
import unittest.mock

import mebots
from mebots import notebook
from support import StudyCase


def needs(package):
    return unittest.skipUnless(importlib.util.find_spec(package), f"{package} is not installed: pip install {package}")


class Frames(StudyCase):
    def swept(self, *out):
        return mebots.sweep(json.loads(self.study().read_text()) | {"mission": str(self.folder / "mission.json")}, *out, jobs=2)

    def test_a_dict_without_a_folder_gives_data_frames_that_go_with_it(self):
        result = self.swept()
        designs, missions = result.to_pandas(), result.to_pandas("missions")
        self.assertEqual(designs["a.gain"].tolist(), [0.2, 1])
        self.assertEqual(len(missions), 20)
        self.assertAlmostEqual(missions.groupby("design")["integral"].mean()[1], designs["integral: mean"][1], 12)
        folder = result.folder
        self.assertTrue((folder / "report.html").is_file())
        del result
        gc.collect()
        self.assertFalse(folder.exists())

    @needs("xarray")
    def test_missions_are_a_dataset_over_design_and_replicate(self):
        result = self.swept(self.folder / "out")
        found = result.to_xarray()
        self.assertEqual(dict(found.sizes), {"design": 2, "replicate": 10})
        row = self.rows("missions.csv")[13]
        self.assertEqual((row["design"], row["replicate"]), ("1", "3"))
        self.assertEqual(float(found["integral"][1, 3]), float(row["integral"]))
        self.assertEqual(float(found["a.real_in"][3]), float(row["a.real_in"]))
        self.assertEqual(found["a.gain"].values.tolist(), [0.2, 1])
        self.assertEqual(found["simulated_time"].attrs["units"], "s")

    @needs("polars")
    def test_tables_are_frames_of_polars(self):
        result = self.swept(self.folder / "out")
        self.assertEqual(result.to_polars()["a.gain"].to_list(), [0.2, 1])
        self.assertEqual(result.to_polars("missions").height, 20)

    @needs("xarray")
    def test_a_run_is_a_dataset_over_time(self):
        with mebots.Mission(self.folder / "mission.json", record=["a.integral"], out=self.folder / "run") as mission:
            mission.run()
            found = mission.to_xarray()
        self.assertEqual(found["a.integral"].values.tolist(), mission["a.integral"].tolist())
        self.assertEqual(found["time"].attrs["units"], "s")
        self.assertEqual(mebots.read(self.folder / "run").to_xarray()["a.integral"].values.tolist(), mission["a.integral"].tolist())

    def test_a_table_that_does_not_exist_is_named(self):
        with self.assertRaisesRegex(mebots.InputError, "'flights'.*'designs' and 'missions'"):
            self.swept(self.folder / "out").to_pandas("flights")

    def test_a_package_that_is_missing_is_named(self):
        result = self.swept(self.folder / "out")
        with unittest.mock.patch.dict(sys.modules, {"polars": None}), self.assertRaisesRegex(mebots.InputError, "pip install polars"):
            result.to_polars()

    def test_a_failed_sweep_leaves_no_temporary_folder(self):
        place = self.folder / "temporary"
        place.mkdir()
        study = {"mission": str(self.folder / "mission.json"), "design": {"kind": "grid", "factors": {"a.nothing": [1]}}, "objectives": {"x": {"summary": "integral"}}}
        with unittest.mock.patch("tempfile.tempdir", str(place)), self.assertRaises(mebots.InputError):
            mebots.sweep(study)
        self.assertEqual([file for file in place.iterdir() if file.name.startswith("mebots-sweep-")], [])


class Notebooks(StudyCase):
    """Tests with a replacement of IPython that stores displayed objects."""

    def setUp(self):
        super().setUp()
        self.shown = []
        shell = type("ZMQInteractiveShell", (), {})()
        handle = types.SimpleNamespace(update=lambda html: self.shown.append(html.data))
        display = types.ModuleType("IPython.display")
        display.HTML = lambda data: types.SimpleNamespace(data=data)
        display.display = lambda html, display_id: handle
        ipython = types.ModuleType("IPython")
        ipython.get_ipython = lambda: shell
        for name, module in (("IPython", ipython), ("IPython.display", display)):
            sys.modules[name] = module
            self.addCleanup(sys.modules.pop, name)

    def test_a_study_has_a_bar_and_its_report_is_shown_in_a_frame(self):
        result = mebots.sweep(self.study(), self.folder / "out", jobs=1)
        self.assertRegex(self.shown[-1], r'<progress value="20" max="20"')
        self.assertRegex(result.show().data, r'^<div><iframe srcdoc="&lt;!doctype html&gt;')
        self.assertIn("<pre>", result._repr_html_())

    def test_false_switches_the_bar_off(self):
        mebots.sweep(self.study(), self.folder / "out", jobs=1, progress=False)
        self.assertEqual(self.shown, [])

    def test_the_page_of_a_run_is_written_and_shown(self):
        with mebots.Mission(self.folder / "mission.json", out=self.folder / "run") as mission:
            mission.run()
        self.assertIn("iframe", mebots.show(self.folder / "run").data)
        self.assertTrue((self.folder / "run" / "flight.html").is_file())
        with self.assertRaisesRegex(mebots.InputError, "neither a page nor the results"):
            mebots.show(self.folder)


if __name__ == "__main__":
    unittest.main()
