# SPDX-License-Identifier: Apache-2.0
"""Compares the same flights with two chips. Creates tables and texts of the report from both chips' data."""

import re

import collect
import targets
from collect import HARD_NAMES
from experiments import EASY_SPEEDS
from missions import BATTERIES, MOTORS
from replay import READINGS
from results import LAST_STRETCH_M, PASSED

# Kinds of endurance flights: two kinds that land at 10 % charge, and flights that hover until the protection opens.
IN_THE_AIR = ("hover", "cruise", "empty")


def off_the_middle(lateral_m):
    return "-" if lateral_m is None else f"{100 * lateral_m:+.1f}"


def plain(outcome):
    return outcome.replace("_", " ")


def of_targets(first, second):
    """Returns two lists. The first list, with the bench's motors, contains (target, quantity, the paper's value, value with the
    first chip, value with the second chip). The second list contains (target, quantity, label of the entry of READINGS, value
    with the first chip, value with the second chip)."""
    pairs = list(zip(targets.rows(first), targets.rows(second), strict=True))
    bench = [(a.target, a.what, a.paper, a.texts()[0], b.texts()[0]) for a, b in pairs]
    read = [(a.target, a.what, READINGS[name][0], of_first, of_second) for a, b in pairs
            for name, of_first, of_second in zip(targets.COLUMNS, a.texts(), b.texts())
            if name in READINGS and of_first != targets.NOTHING]
    return bench, read


def targets_apart(first, second):
    """Returns {unit: (difference, quantity)} for the units s and %: the largest difference between the two chips over all rows of
    the table of targets, and the quantity of this row."""
    apart = dict.fromkeys(("s", "%"), (-1.0, ""))
    for a, b in zip(targets.rows(first), targets.rows(second), strict=True):
        units = [after.strip(" ,") for after in re.findall(r"{[^}]*}( [^ ,]*)?", a.form)]
        for column in zip(a.values, b.values, strict=True):
            for unit, one, other in zip(units, *column, strict=True):
                if unit in apart:
                    apart[unit] = max(apart[unit], (abs(one - other), a.what))
    return apart


def lives_of_both(first, second):
    """Returns for each endurance flight its motors, battery and kind, and the values with the first and with the second chip."""
    return [(motors, battery, kind, first["lives"][motors][battery][kind], second["lives"][motors][battery][kind])
            for motors in MOTORS for battery in BATTERIES for kind in IN_THE_AIR]


def ends_apart(first, second):
    """Returns the number of flights in both experiments, and the flights that end differently with the second chip."""
    ends = [(f"{kind} on {BATTERIES[battery][0]}'s cell, {MOTORS[motors]}", a["crashed"], b["crashed"])
            for motors, battery, kind, a, b in lives_of_both(first, second)]
    ends += [(f"hard, {name}", *(data["speeds"][name]["outcome"] for data in (first, second))) for name in HARD_NAMES]
    easy = [data["batteries"]["outcomes"] for data in (first, second)]
    return len(ends) + sum(easy[0].values()), [what for what, a, b in [*ends, ("easy flights", *easy)] if a != b]


def furthest(first, second, value, kinds=IN_THE_AIR):
    """Returns the largest difference of a value between the two chips, over the endurance flights that have this value with both
    chips. If there is no such flight, returns None."""
    return max((abs(a[value] - b[value]) for _, _, kind, a, b in lives_of_both(first, second)
                if kind in kinds and None not in (a[value], b[value])), default=None)


def opens_apart(first, second, kinds, digits):
    apart = furthest(first, second, "opens", kinds)
    return "in no flight of both" if apart is None else f"at most {apart:.{digits}f} % of charge apart"


def describe_experiments(both):
    first, second = both.values()
    flights, otherwise = ends_apart(first, second)
    apart = " and by ".join(f"{most:.1f} {unit} ({what})" for unit, (most, what) in targets_apart(first, second).items())
    yield ((f"Of the {flights} flights of both experiments, the outcome differs between the two chips in: {'; '.join(otherwise)}. "
            if otherwise else
            f"All {flights} flights of both experiments have the same outcome with both chips. ")
           + f"The targets in the tables below differ by at most {apart}.")
    alone = [f"{kind} on {BATTERIES[battery][0]}'s cell with the {MOTORS[motors]} ({chip})"
             for motors, battery, kind, a, b in lives_of_both(first, second)
             for chip, one, other in zip(both, (a, b), (b, a)) if other["to_ten_s"] is None is not one["to_ten_s"]]
    yield ("In endurance flights that reach 10 % with both chips, the times until then differ by at most "
           f"{furthest(first, second, 'to_ten_s'):.1f} s. Flights that reach 10 % with one chip only: {', '.join(alone) or 'none'}. The "
           f"times in the air differ by at most {furthest(first, second, 'air_s'):.1f} s. The protection opens in hover "
           f"{opens_apart(first, second, ('hover', 'empty'), 3)}, in cruise {opens_apart(first, second, ('cruise',), 2)}.")


def describe_decisions(both):
    ones = {chip: data["decisions"]["b-adaptive"] for chip, data in both.items()}
    yield "A decision of the hard adaptive flight takes " + ", ".join(
        f"{1e3 * one['latency_s']:.1f} ms with {chip} (rows {1e3 * one['read_out_s']:.1f}, inference "
        f"{1e3 * one['inference_s']:.1f}, other parts "
        f"{1e3 * (one['latency_s'] - one['read_out_s'] - one['inference_s']):.1f})" for chip, one in ones.items()) + "."


def describe_joules(both):
    for chip, data in both.items():
        one, parts, seconds = data["decisions"]["b-adaptive"], data["adaptive"]["chip"], data["speeds"]["adaptive"]["simulated_s"]
        low, high = bounds(data)
        milliwatts = 1e3 * one["chip_j"] / seconds
        yield (f"In all {seconds:.0f} s of the hard adaptive flight the chip of {chip} takes {milliwatts:.1f} mW; checks allow "
               f"{low * milliwatts:.1f} to {high * milliwatts:.1f}. Of this, leakage takes {1e3 * parts['leakage'] / seconds:.2f} mW, and the "
               f"cluster's background {1e3 * parts['cluster_background'] / seconds:.2f} mW. For a picture, the chip takes "
               f"{1e3 * one['chip_j'] / one['pictures']:.2f} mJ, and the camera {1e3 * one['camera_j'] / one['pictures']:.2f} mJ. Both together "
               f"are {100 * (one['chip_j'] + one['camera_j']) / one['cell_j']:.2f} % of the cell's joules.")


def joules(one):
    """Returns texts for the decisions of a flight: the chip's energy [J], the camera's energy [J], and the chip's share of the
    cell's energy [%]."""
    return f"{one['chip_j']:.3f}", f"{one['camera_j']:.3f}", f"{100 * one['chip_j'] / one['cell_j']:.3f}"


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
    """Returns the largest difference between the chips in the charge used by the easy flights [% of the capacity]."""
    ours, theirs = first["batteries"]["used"], second["batteries"]["used"]
    return max(abs(ours[battery][speed][kind] - theirs[battery][speed][kind])
               for battery in ours for speed in ours[battery] for kind in ours[battery][speed])


def ended(entry):
    return f"fell at {entry['opens']:.1f} %" if entry["crashed"] else f"landed with {entry['charge']:.1f} %"


def of_lives(first, second):
    def seconds(entry):
        return "-" if entry["to_ten_s"] is None else f"{entry['to_ten_s']:.1f}"
    for motors, battery, kind, a, b in lives_of_both(first, second):
        if kind != "empty":
            yield MOTORS[motors], BATTERIES[battery][0], kind, seconds(a), seconds(b), ended(a), ended(b)


def scenarios_of_both(first, second):
    return [name for name in second["robustness"] if name in first["robustness"]]


def of_starts(both):
    """Yields a row for each scenario and chip: the numbers of outcomes over the starts that both chips ran."""
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
    """Returns the numbers of common starts from which the drone passed: [with both chips, with the first only, with the second
    only, with none]."""
    ends = [{way["name"]: way["outcome"] in PASSED for way in data["robustness"][name]["ways"]} for data in (first, second)]
    pairs = [(ends[0][start], passed) for start, passed in ends[1].items() if start in ends[0]]
    return [pairs.count(pair) for pair in ((True, True), (True, False), (False, True), (False, False))]


def describe_starts(both, name):
    first, second = both
    with_both, alone_first, alone_second, none = same_starts(both[first], both[second], name)
    told = (f"{name}: from {with_both} starts, both chips passed. From {alone_first} starts, only {first} passed; from {alone_second}, only "
            f"{second}; from {none}, neither of them.")
    came = [way for way in both[second]["robustness"][name]["ways"] if way["last_stretch_s"] is not None]
    passed, others = ([way["last_stretch_s"] for way in came if (way["outcome"] in PASSED) == wanted] for wanted in (True, False))
    if passed and others:
        begin, end = LAST_STRETCH_M
        told += (f" From {begin} m to {end} m before the gate's plane, the flights that passed with {second} took {min(passed):.1f} to "
                 f"{max(passed):.1f} s, and the other flights {min(others):.1f} to {max(others):.1f} s.")
    return told


def bounds(data):
    """Returns the tolerance of the chip's energy, relative to the computed energy. Checks against silicon determine it."""
    parts = [(one["least_j"] / one["chip_j"], one["most_j"] / one["chip_j"]) for one in data["decisions"].values()]
    return min(low for low, _ in parts), max(high for _, high in parts)


def of_clocks(both):
    for rows in zip(*(data["clocks"] for data in both.values()), strict=True):
        for chip, row in zip(both, rows):
            yield (row["cores"], row["clock_mhz"], f"{row['voltage_v']:.2f}", chip, f"{row['crossed']} of {row['flights']}",
                   f"{row['pictures_per_s']:.1f}", f"{row['gate_s']:.1f}", f"{row['chip_mw']:.2f}", f"{row['chip_j']:.3f}")


def least(rows, cores):
    """Returns the clock that needs the least energy [MHz]."""
    return min((row for row in rows if row["cores"] == cores and row["crossed"]), key=lambda row: row["chip_j"])["clock_mhz"]


def of_parts(both):
    """Returns (part, mJ and % with each chip) for the hard adaptive flight."""
    parts = [data["adaptive"]["chip"] for data in both.values()]
    for part in sorted(parts[1], key=lambda name: -parts[1][name]):
        cells = [(f"{1e3 * chip[part]:.1f}", f"{100 * chip[part] / sum(chip.values()):.1f}") for chip in parts]
        yield part.replace("_", " "), *cells[0], *cells[1]
