#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests that the shipped JSON schemas and the readers accept and reject the same files.

Usage: schema_check.py MEBOTS PROBE.fmu SOURCE_DIR

Every shipped file names its schema, and is valid for both. The test then checks configs with one manual change each,
for which both must give the expected verdict. It also checks shipped files of each kind with one systematic change
each. Readers check more than schemas, for example that names exist and that the values of a table rise. Therefore two
conditions apply to systematic changes. The reader must reject whatever the schema rejects. If the reader reports a
missing key, an unknown key or a wrong type, the schema must reject the file, too.
"""

import copy
import json
import pathlib
import random
import re
import subprocess
import sys
import tempfile

import jsonschema

ABSENT = object()

# Each entry is a path in the config, a new value, and True if the config is still valid.
CASES = [
    ([], [], False),
    (["step"], ABSENT, False),
    (["stop_time"], ABSENT, False),
    (["instances"], ABSENT, False),
    (["connections"], ABSENT, True),
    (["stpe"], 0.1, False),
    (["$schema"], "mebots-config.schema.json", True),
    (["$schema"], 1, False),
    (["text"], "a text", True),
    (["text"], 1, False),
    (["step"], 0, False),
    (["step"], -0.1, False),
    (["step"], "0.1", False),
    (["step"], "1/10", True),
    (["step"], "-1/10", False),
    (["step"], "0/10", False),
    (["step"], "1/0", False),
    (["step"], "1 / 10", False),
    (["solver"], {"method": "adams", "relative_tolerance": 1e-9, "max_step": 0.1, "max_steps": 5}, True),
    (["solver"], {"absolute_tolerance": 1e-9, "restart_at_points": True, "text": "a text"}, True),
    (["solver"], {"method": "euler"}, False),
    (["solver"], {"relative_tolerance": 0}, False),
    (["solver"], {"max_steps": 0}, False),
    (["solver"], {"max_steps": 1.5}, False),
    (["solver"], {"restart_at_points": 1}, False),
    (["solver"], {"step": 1}, False),
    (["solver"], [], False),
    (["instances", "a", "solver"], {"max_step": 0.5}, True),
    (["instances", "a", "solver"], {"max_step": -1}, False),
    (["instances", "a", "kind"], "co_simulation", True),
    (["instances", "a", "kind"], "me", False),
    (["start_time"], -1, True),
    (["start_time"], "-1/2", True),
    (["start_time"], "x", False),
    (["stop_time"], "2/1", True),
    (["stop_time"], -1e12, False),
    (["stop_time"], 0, False),
    (["stop_time"], 1e12, False),
    (["stop_time"], None, False),
    (["instances"], {}, False),
    (["instances"], [], False),
    (["instances", "a"], [], False),
    (["instances", "a", "fmu"], ABSENT, False),
    (["instances", "a", "fmu"], "", False),
    (["instances", "a", "fmu"], 3, False),
    (["instances", "a", "paramters"], {}, False),
    (["instances", "a", "parameters"], {"gain": 2, "string_in": "x", "boolean_in": True}, True),
    (["instances", "a", "parameters"], {"gain": None}, False),
    (["instances", "a", "parameters"], {"gain": [1]}, False),
    (["instances", "a", "parameters"], [], False),
    (["instances", "a", "repeat"], {"i": [1, 1]}, True),
    (["instances", "a", "repeat"], {"i": {"gain": [1]}, "j": [2, 2]}, True),
    (["instances", "a", "repeat"], {"i": "u.csv"}, True),
    (["instances", "a", "repeat"], {"i": [1]}, False),
    (["instances", "a", "repeat"], {"i": [1.5, 2]}, False),
    (["instances", "a", "repeat"], {"i": {}}, False),
    (["instances", "a", "repeat"], {"i": {"gain": []}}, False),
    (["instances", "a", "repeat"], {"i": {"gain": [None]}}, False),
    (["instances", "a", "repeat"], {"i": 3}, False),
    (["instances", "a", "repeat"], {}, False),
    (["instances", "a", "repeat"], {"1": [1, 1]}, False),
    (["stop_when"], [{"repeat": {"i": [1, 2]}, "variable": "a.real_out", "above": 1}], True),
    (["scenario"], [{"variable": "a.real_in", "set": 1, "when": {"repeat": {"i": [1, 2]}, "variable": "a.real_out", "above": 1}}], False),
    (["scenario"], [{"variable": "a.real_in", "set": 1, "when": {"variable": "a.real_out", "above": 1}}], True),
    (["outcomes"], [{"repeat": {"i": [1, 2]}, "outcome": "far {i}", "when": [{"variable": "a.real_out", "above": 1}]}], True),
    (["connections", 0, "repeat"], [], False),
    (["step_control"], {"max_step": 0.5}, True),
    (["step_control"], {"max_step": "1/2", "min_step": 0.1, "initial_step": 0.2, "rollback": "if_possible", "text": "a text"}, True),
    (["step_control"], {"max_step": 0.5, "relative_tolerance": 1e-4, "absolute_tolerance": 1, "tolerances": {"b.real_in": False}}, True),
    (["step_control"], {"max_step": 0.5, "tolerances": {"b.real_in": {"relative": 0.1, "absolute": 2}}}, True),
    (["step_control"], {"max_step": 0.5, "safety": 1, "min_factor": 0.5, "max_factor": 2, "proportional_gain": 0, "integral_gain": 1}, True),
    (["step_control"], {}, False),
    (["step_control"], True, False),
    (["step_control"], {"max_step": 0}, False),
    (["step_control"], {"max_step": 0.5, "min_step": -0.1}, False),
    (["step_control"], {"max_step": 0.5, "relative_tolerance": 0}, False),
    (["step_control"], {"max_step": 0.5, "tolerances": {"b.real_in": 1}}, False),
    (["step_control"], {"max_step": 0.5, "tolerances": {"b.real_in": {"relative": -1}}}, False),
    (["step_control"], {"max_step": 0.5, "tolerances": []}, False),
    (["step_control"], {"max_step": 0.5, "rollback": "always"}, False),
    (["step_control"], {"max_step": 0.5, "rollback": True}, False),
    (["step_control"], {"max_step": 0.5, "safety": 0}, False),
    (["step_control"], {"max_step": 0.5, "min_factor": 2}, False),
    (["step_control"], {"max_step": 0.5, "max_factor": 0.5}, False),
    (["step_control"], {"max_step": 0.5, "integral_gain": 2}, False),
    (["step_control"], {"max_step": 0.5, "kp": 2}, False),
    (["record"], {"step": True}, True),
    (["record"], {"step": 0.1}, False),
    (["coupling"], {}, True),
    (["coupling"], True, False),
    (["coupling"], {"input_limit": 0.05}, True),
    (["coupling"], {"input_limit": 0}, False),
    (["coupling"], {"bonds": []}, False),
    (["coupling"], {"bonds": {"it": {"effort": "a.real_in"}}}, False),
    (["coupling"], {"bonds": {"it": {"effort": "a.real_in", "flow": "a.real_in", "limit": -1}}}, False),
    (["instances", "a", "step"], 0.2, True),
    (["instances", "a", "step"], 0, False),
    (["instances", "a", "step"], "0.2", False),
    (["instances", "a", "step"], "1/5", True),
    (["instances", "a", "text"], "a", True),
    (["instances", "a", "text"], {}, False),
    (["instances", "a", "on_discard"], "divide", True),
    (["instances", "a", "on_discard"], "end", True),
    (["instances", "a", "on_discard"], "retry", False),
    (["connections"], {}, False),
    (["connections", 0], "a.real_out", False),
    (["connections", 0, "from"], ABSENT, False),
    (["connections", 0, "to"], ABSENT, False),
    (["connections", 0, "from"], "a", False),
    (["connections", 0, "from"], 1, False),
    (["connections", 0, "factor"], 2, True),
    (["connections", 0, "factor"], 0, False),
    (["connections", 0, "factor"], "2", False),
    (["connections", 0, "offset"], -1.5, True),
    (["connections", 0, "offset"], None, False),
    (["connections", 0, "convert_units"], False, True),
    (["connections", 0, "convert_units"], 1, False),
    (["connections", 0, "sum"], True, True),
    (["connections", 0, "sum"], "yes", False),
    (["connections", 0, "map"], {"1": 2, "low": "high"}, True),
    (["connections", 0, "map"], {"1": None}, False),
    (["connections", 0, "map"], [1], False),
    (["connections", 0, "text"], "why", True),
    (["connections", 0, "gain"], 2, False),
    (["algorithm"], "jacobi", True),
    (["algorithm"], "gauss-seidel", True),
    (["algorithm"], "newton", False),
    (["algorithm"], 1, False),
    (["algorithm"], {}, False),
    (["algorithm"], {"type": "jacobi"}, True),
    (["algorithm"], {"type": "jacobi", "order": ["a", "b"]}, False),
    (["algorithm"], {"type": "gauss-seidel", "order": ["b", "a"]}, True),
    (["algorithm"], {"type": "gauss-seidel", "order": ["a", "b", "a"]}, False),
    (["algorithm"], {"type": "gauss-seidel", "order": "a"}, False),
    (["algorithm"], {"type": "gauss-seidel", "sequence": []}, False),
    (["threads"], "auto", True),
    (["threads"], 2, True),
    (["threads"], 0, False),
    (["threads"], "two", False),
    (["stop_when"], [{"variable": "a.steps", "above": 3}], True),
    (["stop_when"], [{"variable": "a.steps", "above": 3, "for": 0.2}], True),
    (["stop_when"], [{"variable": "a.steps", "above": 3, "for": -1}], False),
    (["stop_when"], [{"variable": "a.steps", "above": 3, "for": "1/5"}], True),
    (["stop_when"], [{"variable": "a.steps", "above": 3, "for": "-1/5"}], False),
    (["scenario"], [{"variable": "a.real_in", "set": 1, "from": "1/5", "until": "2/5"}], True),
    (["scenario"], [{"variable": "a.real_in", "set": 1, "from": -1, "until": -0.5}], True),
    (["scenario"], [{"variable": "a.real_in", "set": 1, "duration": "1/5"}], True),
    (["scenario"], [{"variable": "a.real_in", "set": 1, "duration": 0}], False),
    (["stop_when"], [{"variable": "a.steps", "above": "3"}], False),
    (["stop_when"], [{"variable": "a.steps"}], False),
    (["stop_when"], [{"variable": "a.steps", "above": 1, "below": 3}], False),
    (["stop_when"], [{"above": 3}], False),
    (["stop_when"], [{"variable": "a.steps", "above": 3, "ever": True}], False),
    (["stop_when"], [{"variable": "a.steps", "equals": [3]}], False),
    (["stop_when"], {}, False),
    (["outcomes"], [{"outcome": "else"}], True),
    (["outcomes"], [{"outcome": "x", "when": [{"variable": "a.steps", "equals": 3, "ever": True}]}], True),
    (["outcomes"], [{"outcome": ""}], False),
    (["outcomes"], [{"when": []}], False),
    (["outcomes"], [{"outcome": "x", "when": [{"variable": "a.steps", "equals": 3, "for": 1}]}], False),
    (["outcomes"], [{"outcome": "x", "when": [{"variable": "a.steps", "equals": 3, "ever": 1}]}], False),
    (["summary"], {"x": "a.steps", "deep": {"y": "b.steps"}}, True),
    (["summary"], {"x": 1}, False),
    (["summary"], {"x": "steps"}, False),
    (["summary"], [], False),
    (["record"], ["a.*"], True),
    (["record"], [""], False),
    (["record"], {"variables": ["a.*"], "interval": 0.2, "exclude": ["a.real_*"], "texts": True}, True),
    (["record"], {"interval": 0}, False),
    (["record"], {"interval": "1"}, False),
    (["record"], {"parameters": True}, True),
    (["record"], {"parameters": ["a.gain"]}, True),
    (["record"], {"parameters": 1}, False),
    (["record"], {"columns": []}, False),
    (["record"], "a.*", False),
    (["pictures"], [{"frame": "a.buffer", "id": "a.steps", "width": 4}], True),
    (["pictures"], [{"frame": "a.buffer", "id": "a.steps", "width": 0}], False),
    (["pictures"], [{"frame": "a.buffer", "id": "a.steps", "width": 1.5}], False),
    (["pictures"], [{"frame": "a.buffer", "id": "a.steps"}], False),
    (["pictures"], [{"frame": "a.buffer", "id": "a.steps", "width": 4, "interval": -1}], False),
    (["view"], {"scene": "a.string_out", "marks": ["a"], "panels": []}, True),
    (["view"], {"panels": [{"title": "t", "kind": "lanes", "curves": [{"variable": "a.steps", "label": "l"}]}]}, True),
    (["view"], {"panels": [{"title": "t", "curves": [{"rate_of": "a.steps"}]}]}, True),
    (["view"], {"panels": [{"title": "t", "curves": [{"rate_of": "a.steps", "variable": "a.steps"}]}]}, False),
    (["view"], {"panels": [{"title": "t", "curves": [{}]}]}, False),
    (["view"], {"panels": [{"title": "t", "kind": "pie", "curves": []}]}, False),
    (["view"], {"panels": [{"curves": []}]}, False),
    (["view"], {"panels": {}}, False),
    (["view"], {"marks": "a"}, False),
    (["view"], {"scene": 1}, False),
    (["view"], {"page": 1}, False),
    (["record"], {"locals": True}, True),
    (["record"], {"locals": 1}, False),
    (["inputs"], {"file": "u.csv", "to": {"u": "a.integer_in"}}, True),
    (["inputs"], [{"file": "u.csv", "to": {"u": ["a.integer_in", {"variable": "b.integer_in"}]}, "after": "error"}], True),
    (["inputs"], {"file": "u.csv", "time": "time", "to": {}, "before": "hold", "text": "a text"}, True),
    (["inputs"], {"file": "u.csv", "to": {"u": {"variable": "a.integer_in", "units": "m"}}}, False),
    (["inputs"], {"file": "u.csv", "to": {"u": {"unit": "m"}}}, False),
    (["inputs"], {"file": "u.csv", "to": {"u": 1}}, False),
    (["inputs"], {"file": "u.csv", "to": ["a.integer_in"]}, False),
    (["inputs"], {"file": "u.csv", "after": "zero"}, False),
    (["inputs"], {"file": ""}, False),
    (["inputs"], {"to": {}}, False),
    (["inputs"], "u.csv", False),
    (["scenario"], [{"variable": "a.integer_in", "signal": "u", "file": "u.csv", "until": 0.5, "before": "error"}], True),
    (["scenario"], [{"variable": "a.integer_in", "signal": "u"}], False),
    (["scenario"], [{"variable": "a.integer_in", "signal": "", "file": "u.csv"}], False),
    (["scenario"], [{"variable": "a.integer_in", "set": 1, "file": "u.csv"}], False),
    (["scenario"], [{"variable": "a.integer_in", "set": 1, "after": "hold"}], False),
    (["log"], {"a": ["*"]}, True),
    (["log"], {"a": "*"}, False),
    (["log"], {"a": [""]}, False),
    (["log"], [], False),
    (["changes"], {}, False),
]

# A config that extends the valid one (written as config_0.json), and True if it is valid.
VARIANTS = [
    ({"extends": "config_0.json", "changes": {}}, True),
    ({"extends": "config_0.json", "changes": {"stop_time": 3}, "text": "a text", "$schema": "mebots-config.schema.json"}, True),
    ({"extends": "config_0.json"}, False),
    ({"extends": "config_0.json", "changes": []}, False),
    ({"extends": "config_0.json", "changes": {}, "step": 0.1}, False),
    ({"extends": "", "changes": {}}, False),
    ({"extends": "./config_0.json", "changes": {}}, False),
    ({"extends": 1, "changes": {}}, False),
    ({"changes": {}}, False),
]


def changed(config, path, value):
    if not path:
        return value
    config = copy.deepcopy(config)
    inner = config
    for step in path[:-1]:
        inner = inner[step]
    if value is ABSENT:
        del inner[path[-1]]
    else:
        inner[path[-1]] = value
    return config


# For each kind of file: patterns of the shipped files, and the files that the test changes.
SHIPPED = {
    "config": (["configs/*.json", "examples/*/mission.json"], None),
    "scenario": (["configs/scenarios/*.json"], "configs/scenarios/motor_loss.json"),
    "board": (["configs/boards/*.json", "examples/*/board.json"], "examples/time_of_flight/board.json"),
    "description": (["fmu_*/description.json", "examples/*/*/description.json"], "fmu_motors/description.json"),
    "cell": (["fmu_battery/params/cells/*.json"], "fmu_battery/params/cells/cyclone_300.json"),
    "converters": (["fmu_battery/params/converters.json"], "fmu_battery/params/converters.json"),
    "rotor": (["fmu_motors/params/rotors/*.json"], "fmu_motors/params/rotors/crazyflie_l250.json"),
    "drone": (["fmu_world/params/drones/*.json"], "fmu_world/params/drones/crazyflie.json"),
    "downwash": (["tests/world/dynamics/*.json"], "tests/world/dynamics/downwash.json"),
    "airframe": (["configs/airframes/*.json"], "configs/airframes/crazyflie_21.json"),
    "log-mapping": (["configs/logs/*.json"], "configs/logs/nanobench.json"),
    "scene": (["fmu_world/params/scenes/*.json"], ["fmu_world/params/scenes/gate_easy.json", "fmu_world/params/scenes/yard.json"]),
    "cases": (["fmu_*/reference/*.mebots-test.json"], None),
    "study": (
        ["examples/exploration/*.json", "examples/relay/study.json"],
        ["examples/exploration/study.json", "examples/exploration/gust.json", "examples/exploration/rare.json"],
    ),
}
STRUCTURE = {"unknown_key", "missing_key", "wrong_type"}
CHANGES_OF_A_KIND = 150


def changes(value, path=()):
    """Yields systematic changes of a file: the path of a key, and its new value or ABSENT."""
    if path and path[-1] != "$schema":
        yield path, ABSENT
        for other in (None, "x", "", 3, -1, 0, 1e9, [], {}, True):
            if other != value:
                yield path, other
    if isinstance(value, dict):
        yield (*path, "zzz"), 1
        for key, inner in value.items():
            yield from changes(inner, (*path, key))
    elif isinstance(value, list):
        for index, inner in enumerate(value[:3]):
            yield from changes(inner, (*path, index))


def codes_of(mebots, files):
    """Returns the error codes that `mebots validate` reports for each file."""
    result = subprocess.run([mebots, "validate", *files], capture_output=True, text=True)
    if result.returncode not in (0, 2):
        sys.exit(f"FAILED: mebots validate ended with {result.returncode}: {result.stderr}")
    codes = {str(file): set() for file in files}
    good = set(re.findall(r"^(.*): valid [\w-]+ file$", result.stdout, re.M))
    for line in result.stderr.splitlines():
        told = re.match(r"(.*?\.json)[: ].*\[(\w+)\]$", line)
        if told and told[1] in codes:
            codes[told[1]].add(told[2])
    for file, found in codes.items():
        if (file in good) == bool(found):
            sys.exit(f"FAILED: {file}: neither good nor with a mistake: {result.stderr}")
    return codes


class Check:
    def __init__(self, mebots, source, folder):
        self.mebots, self.source, self.folder = mebots, source, folder
        self.failures = []
        self.cases = 0

    def schema(self, kind):
        text = subprocess.run([self.mebots, "schema", kind], check=True, capture_output=True, text=True).stdout
        schema = json.loads(text)
        jsonschema.Draft202012Validator.check_schema(schema)
        if (self.source / f"configs/schemas/mebots-{kind}.schema.json").read_text() != text:
            self.failures.append(f"{kind}: `mebots schema` prints another one than is shipped")
        return jsonschema.Draft202012Validator(schema)

    def shipped(self, kind, validator, patterns):
        files = [file for pattern in patterns for file in sorted(self.source.glob(pattern))]
        for file in files:
            content = json.loads(file.read_text())
            named = file.parent / content.get("$schema", "nothing")
            if named.resolve() != (self.source / f"configs/schemas/mebots-{kind}.schema.json").resolve():
                self.failures.append(f"{file}: its $schema is not that of a {kind}")
            for error in validator.iter_errors(content):
                self.failures.append(f"{file}: the schema refuses it: {error.json_path}: {error.message}")
        readable = files if kind != "config" else []  # configs need their FMUs
        for file, codes in codes_of(self.mebots, readable).items() if readable else ():
            if codes:
                self.failures.append(f"{file}: the reader refuses it: {codes}")
        self.cases += len(files)

    def written(self, kind, cases):
        """Returns files with these contents."""
        files = []
        for number, content in enumerate(cases):
            file = self.folder / f"{kind}_{number}.json"
            file.write_text(json.dumps(content))
            files.append(file)
        return files

    def by_hand(self, validator, probe):
        good = {
            "$schema": "mebots-config.schema.json",
            "step": 0.1,
            "stop_time": 2,
            "instances": {"a": {"fmu": str(probe)}, "b": {"fmu": str(probe)}},
            "connections": [{"from": "a.real_out", "to": "b.real_in"}],
        }
        (self.folder / "u.csv").write_text("time,u\n0,1\n")  # for the configs that name it
        cases = [([], good, True)] + [case for case in CASES if case[0] and case[0] != ["$schema"]]
        contents = [changed(good, path, value) for path, value, _ in cases] + [content for content, _ in VARIANTS]
        cases += [(["extends"], content, expected) for content, expected in VARIANTS]
        codes = codes_of(self.mebots, self.written("config", contents))
        for (path, value, expected), content, found in zip(cases, contents, codes.values()):
            by_schema = validator.is_valid(content)
            if by_schema != expected or (not found) != expected:
                self.failures.append(f"config {path} = {value!r}: expected {expected}, schema {by_schema}, reader {found}")
        self.cases += len(cases)

    def by_rule(self, kind, validator, file):
        good = json.loads((self.source / file).read_text())
        if kind == "scene":
            good["drone"] = str((self.source / file).parent / good["drone"])
        if kind == "study":
            good["mission"] = str((self.source / file).parent / good["mission"])
        all_changes = list(changes(good))
        chosen = random.Random(kind).sample(all_changes, min(CHANGES_OF_A_KIND, len(all_changes)))
        contents = [changed(good, path, value) for path, value in chosen]
        codes = codes_of(self.mebots, self.written(kind, contents))
        for (path, value), content, found in zip(chosen, contents, codes.values()):
            by_schema = validator.is_valid(content)
            if (not by_schema and not found) or (by_schema and found & STRUCTURE):
                told = "removed" if value is ABSENT else f"= {value!r}"
                self.failures.append(f"{kind} {list(path)} {told}: schema {by_schema}, reader {found}")
        self.cases += len(chosen)


def main():
    mebots, probe, source = sys.argv[1], pathlib.Path(sys.argv[2]).resolve(), pathlib.Path(sys.argv[3])
    with tempfile.TemporaryDirectory() as folder:
        check = Check(mebots, source, pathlib.Path(folder))
        for kind, (patterns, file) in SHIPPED.items():
            validator = check.schema(kind)
            check.shipped(kind, validator, patterns)
            if kind == "config":
                check.by_hand(validator, probe)
            for changed_file in [file] if isinstance(file, str) else file or []:
                check.by_rule(kind, validator, changed_file)
    for failure in check.failures:
        print(f"FAILED: {failure}")
    print(f"{check.cases} files: schemas and readers agree" if not check.failures else f"{len(check.failures)} disagreements")
    sys.exit(1 if check.failures else 0)


if __name__ == "__main__":
    main()
