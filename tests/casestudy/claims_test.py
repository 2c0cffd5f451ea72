# SPDX-License-Identifier: Apache-2.0
"""Tests claims of the paper's study on a few of its flights. Uses the study's own functions."""

import copy
import dataclasses
import json
import math
import os
import pathlib
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "examples/paper/study"))
sys.path.insert(0, str(ROOT / "examples/paper/training"))

import chips  # noqa: E402
import collect  # noqa: E402
import experiments  # noqa: E402
import integer_network  # noqa: E402
import landing  # noqa: E402
import missions  # noqa: E402
from missions import KM_H, Flight, config  # noqa: E402
from results import CRUISE, Trace, energy_by_phase  # noqa: E402
from run import Place, fly  # noqa: E402
import study  # noqa: E402

BUILD = pathlib.Path(os.environ["MEBOTS_BUILD"])
# A separate folder for each claim, because a study locks its folder while it runs.
PLACE = Place(BUILD, BUILD / "tests/casestudy/flights" / "-".join(sys.argv[1:2]), 1)
MACS_PER_INFERENCE = 1_679_904


def flown(flight, place=PLACE):
    summary = fly(flight, place)
    return summary, Trace(summary["folder"])


class Batteries(unittest.TestCase):
    """Tests how the charge used in the first ten seconds of the endurance flights depends on a cell's mass and capacity."""

    HOVER_S = 10.0

    def charge_used(self, battery, equal_mass):
        base = next(f for f in experiments.endurance() if f.name == f"endurance-{battery}-hover")
        flight = dataclasses.replace(base, name=f"{base.name}-{equal_mass}-short", equal_mass=equal_mass,
                                     stop_time=self.HOVER_S)
        return 1 - flown(flight)[0]["state_of_charge"]

    def test_a_lighter_cell_of_the_same_capacity_uses_less(self):
        saved = 1 - self.charge_used("ufx_250", False) / self.charge_used("bitcraze_250", False)
        # The masses differ by 1.3 g of 40 g. Most of the power is proportional to the mass to the power of 1 to 1.5.
        self.assertGreater(saved, 0.025)
        self.assertLess(saved, 0.05)

    def test_at_equal_mass_the_charge_used_goes_with_one_over_the_capacity(self):
        ratio = self.charge_used("cyclone_300", True) / self.charge_used("lipol_350", True)
        # The tolerance covers the loss in the cells' resistance, a few per cent of the energy.
        self.assertAlmostEqual(ratio, 350 / 300, delta=0.03)

    def test_a_lighter_cell_uses_less_with_its_own_mass_than_with_the_heaviests(self):
        self.assertLess(self.charge_used("bitcraze_250", False), self.charge_used("bitcraze_250", True))


class EasyFlight(unittest.TestCase):
    def test_the_network_flies_through_the_easy_gate_at_the_highest_speed(self):
        base = next(f for f in experiments.batteries() if f.name == "a-bitcraze_250-1.5-real")
        summary, trace = flown(dataclasses.replace(base, record=("world.*", "battery.*", "soc.*", "motors.*")))
        self.assertEqual(summary["outcome"], "passed")
        self.assertLess(abs(summary["lateral_error"]), 0.10)
        cruise = trace["world.drone.phase"] == CRUISE
        self.assertGreater(summary["pictures"], 29 * trace.time[cruise].size * 0.1)
        # A dot product computes four products of bytes.
        self.assertGreater(trace["soc.cluster.instructions"][-1], summary["pictures"] * MACS_PER_INFERENCE / 4)
        phases = energy_by_phase(trace)
        for consumer in ("motors", "chip", "camera", "converters", "cell"):
            self.assertGreater(phases["cruise"][consumer], 0)
        everything = sum(sum(consumers.values()) for consumers in phases.values())
        # `phases` omits self-discharge and the time before the first sample.
        self.assertAlmostEqual(everything / summary["energy"]["open_circuit"], 1, delta=1e-3)


class HardFlightAdaptive(unittest.TestCase):
    def test_the_adaptive_policy_slows_down_to_turn_and_crosses_the_hard_gates_opening(self):
        base = next(f for f in experiments.speeds() if f.name == "b-adaptive")
        summary, trace = flown(base)
        # The motion after the contact is chaotic, so the test does not check whether the drone passes the frame.
        self.assertTrue(summary["gate"]["crossed"])
        asked = trace["soc.setpoint.velocity.x"][trace["world.drone.phase"] == CRUISE]
        self.assertEqual(asked[: len(asked) // 3].min(), 0.0, "the gate at the edge of the picture stops the drone")
        self.assertAlmostEqual(asked.max(), 1.0 * KM_H, delta=1e-4)
        # At 0.3 km/h, the fastest constant speed that passes, the drone reaches the gate 5.8 m / 0.083 m/s after the start of its
        # cruise.
        self.assertLess(trace.time_at_gate(), 5.8 / (0.3 * KM_H))


class HardMission(unittest.TestCase):
    """Tests configs/gate_hard.json, the mission that users run."""

    SHIPPED = ROOT / "configs/gate_hard.json"

    def test_it_is_the_studys_adaptive_flight_with_the_sight_firmware(self):
        shipped = json.loads(self.SHIPPED.read_text())
        base = next(f for f in experiments.speeds() if f.name == "b-adaptive")
        study = config(base, "ai_deck")
        chip = shipped["instances"]["soc"]["parameters"]
        self.assertEqual(chip.pop("firmware"), "sight")
        studied = study["instances"]["soc"]["parameters"]
        chip["mission.yaw_rate_scale"] = studied["mission.yaw_rate_scale"]
        chip["mission.navigator"] = studied["mission.navigator"]  # never read by the sight firmware
        for key in ("step", "stop_time", "instances", "connections", "stop_when", "outcomes", "summary", "pictures"):
            self.assertEqual(shipped[key], study[key], key)

    def test_it_turns_to_the_gate_slows_down_and_flies_through_without_a_touch(self):
        out = BUILD / "tests/casestudy/gate_hard"
        subprocess.run([str(BUILD / "bin/mebots"), "run", str(self.SHIPPED), "--out", str(out), "--quiet"], check=True)
        summary, trace = json.loads((out / "summary.json").read_text()), Trace(out)
        self.assertEqual(summary["outcome"], "passed")
        self.assertFalse(summary["gate"]["touched"])
        self.assertLess(abs(summary["lateral_error"]), 0.1)
        flying = trace["world.drone.phase"] == CRUISE
        # The firmware takes a picture in each frame period of 33 ms, because an inference takes less time than the period.
        self.assertGreater(summary["pictures"], 0.95 * flying.sum() * 0.1 / 0.033)
        asked = trace["soc.setpoint.velocity.x"][flying]
        self.assertAlmostEqual(asked.max(), 1.0 * KM_H, delta=1e-4)
        self.assertLess(asked[:20].min(), 0.3 * KM_H, "the gate at the edge of the picture slows it down")


class SecondChip(unittest.TestCase):
    """Tests the study on board gap8_drone."""

    PLACE = dataclasses.replace(PLACE, results=PLACE.results / "gap8_drone", chip="gap8_drone")
    # The read-out time is the number of sensor rows up to the last row that the camera interface passes, times the clocks per
    # row, divided by the clock.
    READ_OUT_S = 322 * 376 / 6e6

    def test_a_flight_is_that_of_the_other_chip_with_what_the_shipped_mission_changes(self):
        changes = json.loads((ROOT / "configs/gate_easy_gap8.json").read_text())["changes"]
        for flight in (experiments.speeds()[0], experiments.batteries()[0], experiments.starts("shipped", 1, 1)[0]):
            wanted = missions.merged(config(flight, "ai_deck"), changes)
            found = config(flight, "gap8_drone")
            lenses = [mission["instances"]["world"]["parameters"].pop("camera.field_of_view") for mission in (wanted, found)]
            if not flight.pictures:
                del wanted["pictures"]
            self.assertEqual(found, wanted, flight.name)
            if flight.scenario == "shipped":
                self.assertEqual(*lenses)

    def test_the_middle_of_the_sensor_sees_what_the_other_camera_sees(self):
        own = missions.scenario("hard")[missions.LENS]
        self.assertEqual(missions.lens(own, "ai_deck"), own)
        wider = math.tan(missions.lens(own, "gap8_drone") / 2) / math.tan(own / 2)
        self.assertAlmostEqual(wider, 324 / 320, delta=1e-5)

    def test_a_lens_that_no_shipped_mission_has_is_refused(self):
        with self.assertRaises(KeyError):
            missions.lens(0.5, "gap8_drone")

    def test_the_fastest_easy_flight_is_as_published(self):
        published = json.loads(study.PUBLISHED["gap8_drone"].read_text())
        base = next(f for f in experiments.batteries() if f.name == "a-bitcraze_250-1.5-real")
        summary, _ = flown(base, self.PLACE)
        before = published["decisions"][base.name]
        self.assertEqual(summary["outcome"], before["outcome"])
        self.assertEqual(summary["pictures"], before["pictures"])
        self.assertAlmostEqual(summary["decision"]["mean"]["read_out"], self.READ_OUT_S, delta=1e-6)
        self.assertAlmostEqual(summary["chip_energy"]["total"] / before["chip_j"], 1, delta=1e-4)
        self.assertLess(summary["chip_energy"]["least"], summary["chip_energy"]["total"])

    def test_a_study_of_its_clocks_changes_what_an_inference_takes(self):
        """The firmware sets the clocks requested by the mission."""
        took = {}
        for clock in (25, 175):
            flight = experiments.clocks(1)[8, clock][0]
            summary, _ = flown(dataclasses.replace(flight, stop_time=6.0), self.PLACE)
            took[clock] = summary["decision"]["mean"]["inference"]
        self.assertGreater(took[25] / took[175], 4)


class HardFlightTooFast(unittest.TestCase):
    def test_the_hard_gate_is_missed_at_half_a_kilometre_an_hour(self):
        base = next(f for f in experiments.speeds() if f.name == "b-0.5")
        summary, _ = flown(base)
        self.assertEqual(summary["outcome"], "missed")
        self.assertLess(summary["lateral_error"], -0.2, "the turn is too slow: it passes to the right of the opening")


class WorldMissions(unittest.TestCase):
    def test_warehouse_and_forest_are_one_mission_in_two_scenes(self):
        missions = {name: json.loads((ROOT / f"configs/{name}.json").read_text()) for name in ("warehouse", "forest")}
        for name, mission in missions.items():
            self.assertEqual(mission["instances"]["world"]["parameters"].pop("scene.name"), name)
            self.assertIn(name, mission.pop("text"))
        self.assertEqual(missions["warehouse"], missions["forest"])


class Arithmetic(unittest.TestCase):
    def test_wilsons_interval_is_that_of_the_textbook(self):
        low, high = collect.wilson(81, 263)
        # Newcombe, Two-sided confidence intervals for the single proportion, Statistics in Medicine 17 (1998), table I.
        self.assertAlmostEqual(low, 0.2553, delta=1e-4)
        self.assertAlmostEqual(high, 0.3662, delta=1e-4)

    def test_a_weights_file_is_read_as_the_layers_that_were_written(self):
        packed = (ROOT / "fmu_soc/firmware/nn/sight.weights").read_bytes()
        channels = [(8, 5, 1), (8, 3, 8), (8, 3, 8), (16, 3, 8), (16, 3, 16), (32, 3, 16), (32, 3, 32), (4, 6, 32)]
        shapes = [(out, kernel, kernel, into) for out, kernel, into in channels]
        self.assertEqual(integer_network.to_bytes(integer_network.from_bytes(packed, shapes)), packed)
        with self.assertRaisesRegex(ValueError, "bytes of weights"):
            integer_network.from_bytes(packed + bytes(4), shapes)

    def test_the_least_charge_for_landing_is_between_one_that_landed_and_one_that_fell(self):
        def found(**flights):
            return {"opens": 9.0, "flights": [{"charge": float(c[1:]) / 10, "landed": ok} for c, ok in flights.items()]}

        self.assertEqual(landing.least(found(c105=False, c110=True, c115=True)), 11.0)
        self.assertIsNone(landing.least(found(c100=False, c110=True)), "10.5 % was not flown")
        self.assertIsNone(landing.least(found(c110=True)))

    def test_flights_that_passed_in_the_published_data_crossed_the_opening(self):
        for chip, file in study.PUBLISHED.items():
            for name, part in json.loads(file.read_text())["robustness"].items():
                self.assertLessEqual(part["passed"], part["crossed"], (chip, name))
                self.assertLessEqual(part["crossed"], part["flights"], (chip, name))
                for way, lateral_m in zip(part["ways"], part["lateral_m"], strict=True):
                    if way["outcome"] in collect.PASSED:
                        self.assertIsNotNone(lateral_m, f"{chip}: {way['name']} passed: it came to the plane")

    def test_two_chips_are_compared_over_the_starts_that_both_flew(self):
        def part(*ends):
            ways = [{"name": f"easy-1-{i:03}", "outcome": end, "crossed": True} for i, end in enumerate(ends)]
            return {"robustness": {"easy": collect.counted(ways, [0.0] * len(ways))}}

        first = part("passed", "passed", "stuck", "touched_passed", "missed")
        second = part("passed", "stuck", "passed", "passed")
        self.assertEqual(chips.same_starts(first, second, "easy"), [2, 1, 1, 0])
        rows = list(chips.of_starts({"a": first, "b": second}))
        self.assertEqual([row[1:4] for row in rows], [("a", "4", "3"), ("b", "4", "3")], "the fifth start was flown by one alone")

    def test_the_clock_of_least_energy_is_among_those_that_reached_the_gate(self):
        rows = [{"cores": 8, "clock_mhz": clock, "crossed": crossed, "chip_j": energy}
                for clock, crossed, energy in ((25, 0, None), (50, 3, 0.2), (87, 4, 0.1))]
        self.assertEqual(chips.least(rows, 8), 87)

    def test_the_listed_differences_of_two_chips_are_those_of_their_data(self):
        first = json.loads(study.PUBLISHED["ai_deck"].read_text())
        second = copy.deepcopy(first)
        self.assertEqual(chips.ends_apart(first, second), (54, []))
        self.assertEqual([most for most, _ in chips.targets_apart(first, second).values()], [0.0, 0.0])
        second["speeds"]["adaptive"]["gate_s"] += 2.0
        second["speeds"]["adaptive"]["path_m"] *= 1.05
        fell = second["lives"]["bench"]["lipol_350"]["cruise"]
        fell.update(crashed=True, to_ten_s=None, air_s=fell["air_s"] - 7.0)
        self.assertEqual(chips.ends_apart(first, second), (54, ["cruise on Lipol's cell, bench motors"]))
        apart = chips.targets_apart(first, second)
        self.assertAlmostEqual(apart["s"][0], 2.0)
        self.assertEqual(apart["s"][1], "adaptive, time to the gate")
        self.assertGreater(apart["%"][0], 5.0)
        self.assertIn("path to the plane", apart["%"][1])
        self.assertAlmostEqual(chips.furthest(first, second, "air_s"), 7.0)
        self.assertEqual(chips.furthest(first, second, "to_ten_s"), 0.0)

    def test_a_straight_flight_meets_the_opening_only_when_it_points_there(self):
        def start(y, yaw):
            return Flight("s", "easy", 1.0, extra=(("world.start.offset.x", 0.0), ("world.start.offset.y", y),
                                                   ("world.start.yaw_offset", yaw)))

        self.assertEqual(collect.straight("easy", [start(0.2, 0.0)]), 1.0)
        self.assertEqual(collect.straight("easy", [start(0.2, 0.1)]), 0.0)


if __name__ == "__main__":
    unittest.main(verbosity=2)
