# SPDX-License-Identifier: Apache-2.0
"""The same flights with two chips, side by side: tables and texts of the report from the data of both."""

import collect
import targets
from collect import HARD_NAMES
from experiments import EASY_SPEEDS
from missions import BATTERIES, MOTORS
from replay import READINGS
from results import PASSED


def off_the_middle(lateral_m):
    return "-" if lateral_m is None else f"{100 * lateral_m:+.1f}"


def plain(outcome):
    return outcome.replace("_", " ")


def of_targets(first, second):
    """(target, what, paper's, first's, second's) with the bench's motors, and (target, what, reading, first's, second's) of the
    rows that have other readings."""
    pairs = list(zip(targets.rows(first), targets.rows(second), strict=True))
    bench = [(*a[:4], b[3]) for a, b in pairs]
    places = {name: 3 + targets.COLUMNS.index(name) for name in READINGS}
    read = [(a[0], a[1], READINGS[name][0], a[place], b[place]) for a, b in pairs for name, place in places.items()
            if a[place] != targets.NOTHING]
    return bench, read


def joules(one):
    """Of a flight's decisions: the chip's joules, what the checks say of them, the camera's, the chip's part of the cell's."""
    return (f"{one['chip_j']:.3f}", f"{one['least_j']:.3f} to {one['most_j']:.3f}", f"{one['camera_j']:.3f}",
            f"{100 * one['chip_j'] / one['cell_j']:.3f}")


def of_speeds(both):
    for name in HARD_NAMES:
        for chip, data in both.items():
            flight, one = data["speeds"][name], data["decisions"][f"b-{name}"]
            gate = "-" if flight["gate_s"] is None else f"{flight['gate_s']:.1f}"
            yield (name, chip, plain(flight["outcome"]), gate, off_the_middle(flight["lateral_m"]), f"{flight['charge']:.2f}",
                   f"{one['pictures']:.0f}", f"{1e3 * one['latency_s']:.1f}", *joules(one))


def of_easy(both):
    for speed in EASY_SPEEDS:
        for chip, data in both.items():
            one = data["decisions"][f"a-bitcraze_250-{speed}-real"]
            used = data["batteries"]["used"]["bitcraze_250"][str(speed)]["real"]
            yield (speed, chip, plain(one["outcome"]), f"{used:.3f}", f"{one['pictures']:.0f}", f"{1e3 * one['latency_s']:.1f}",
                   f"{1e3 * one['read_out_s']:.1f}", f"{1e3 * one['inference_s']:.2f}", *joules(one))


def charge_apart(first, second):
    """How far the charges used in the easy flights are apart at most [% of the capacity]."""
    ours, theirs = first["batteries"]["used"], second["batteries"]["used"]
    return max(abs(ours[battery][speed][kind] - theirs[battery][speed][kind])
               for battery in ours for speed in ours[battery] for kind in ours[battery][speed])


def ended(entry):
    return f"fell at {entry['opens']:.1f} %" if entry["crashed"] else f"landed with {entry['charge']:.1f} %"


def of_lives(first, second):
    def seconds(entry):
        return "-" if entry["to_ten_s"] is None else f"{entry['to_ten_s']:.1f}"
    for motors in MOTORS:
        for battery, (label, _, _) in BATTERIES.items():
            for kind in ("hover", "cruise"):
                a, b = first["lives"][motors][battery][kind], second["lives"][motors][battery][kind]
                yield MOTORS[motors], label, kind, seconds(a), seconds(b), ended(a), ended(b)


def scenarios_of_both(first, second):
    return [name for name in second["robustness"] if name in first["robustness"]]


def of_starts(both):
    """The starts that both flew."""
    first, second = both
    for name in scenarios_of_both(both[first], both[second]):
        flights = min(data["robustness"][name]["flights"] for data in both.values())
        for chip in (first, second):
            rows = collect.start_rows(name, both[chip]["robustness"][name])[:flights]
            same = collect.counted([way for way, _ in rows], [offset for _, offset in rows])
            yield (name, chip, f"{flights}", f"{same['passed']}", " to ".join(f"{100 * x:.0f}" for x in same["interval"]) + " %",
                   f"{same['clean']}", f"{same['crossed']}",
                   ", ".join(f"{count} {plain(o)}" for o, count in same["outcomes"].items() if o not in PASSED) or "none")


def same_starts(first, second, name):
    """Of the starts that both flew: [with both, with the first alone, with the second alone, with none] passed."""
    ends = [{way["name"]: way["outcome"] in PASSED for way in data["robustness"][name]["ways"]} for data in (first, second)]
    pairs = [(ends[0][start], passed) for start, passed in ends[1].items() if start in ends[0]]
    return [pairs.count(pair) for pair in ((True, True), (True, False), (False, True), (False, False))]


def bounds(data):
    """What the checks beside silicon say of the chip's joules, as parts of them: the same in every flight."""
    one = data["decisions"]["b-adaptive"]
    return one["least_j"] / one["chip_j"], one["most_j"] / one["chip_j"]


def of_clocks(both):
    for rows in zip(*(data["clocks"] for data in both.values()), strict=True):
        for (chip, data), row in zip(both.items(), rows):
            low, high = bounds(data)
            yield (row["cores"], row["clock_mhz"], f"{row['voltage_v']:.2f}", chip, f"{row['crossed']} of {row['flights']}",
                   f"{row['pictures_per_s']:.1f}", f"{row['gate_s']:.1f}", f"{row['chip_mw']:.2f}", f"{row['chip_j']:.3f}",
                   f"{low * row['chip_j']:.3f} to {high * row['chip_j']:.3f}")


def least(rows, cores):
    """The clock with the least energy [MHz]."""
    return min((row for row in rows if row["cores"] == cores and row["crossed"]), key=lambda row: row["chip_j"])["clock_mhz"]


def of_parts(both):
    """(part, mJ and % with each chip) of the hard adaptive flight."""
    parts = [data["adaptive"]["chip"] for data in both.values()]
    for part in sorted(parts[1], key=lambda name: -parts[1][name]):
        cells = [(f"{1e3 * chip[part]:.1f}", f"{100 * chip[part] / sum(chip.values()):.1f}") for chip in parts]
        yield part.replace("_", " "), *cells[0], *cells[1]
