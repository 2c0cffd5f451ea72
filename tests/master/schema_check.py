#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The shipped JSON schema and the reader of the master accept and refuse the same configs.

Usage: schema_check.py MEBOTS PROBE.fmu CONFIG.json...

Each case is a good config with one change. What only the reader can know (that names exist, that times are multiples
of steps) is left out. `mebots info` reads a config without opening its FMUs.
"""

import copy
import json
import pathlib
import subprocess
import sys
import tempfile

import jsonschema

ABSENT = object()

# path in the config, new value, whether it is still a good config
CASES = [
    ([], [], False),
    (["step"], ABSENT, False),
    (["stop_time"], ABSENT, False),
    (["instances"], ABSENT, False),
    (["connections"], ABSENT, False),
    (["stpe"], 0.1, False),
    (["$schema"], "mebots-config.schema.json", True),
    (["$schema"], 1, False),
    (["text"], "a text", True),
    (["text"], 1, False),
    (["step"], 0, False),
    (["step"], -0.1, False),
    (["step"], "0.1", False),
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
    (["instances", "a", "step"], 0.2, True),
    (["instances", "a", "step"], 0, False),
    (["instances", "a", "step"], "0.2", False),
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
    (["log"], {"a": ["*"]}, True),
    (["log"], {"a": "*"}, False),
    (["log"], {"a": [""]}, False),
    (["log"], [], False),
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


def main():
    mebots, probe = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    schema = json.loads(subprocess.run([mebots, "schema"], check=True, capture_output=True, text=True).stdout)
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    good = {
        "step": 0.1,
        "stop_time": 2,
        "instances": {"a": {"fmu": str(probe)}, "b": {"fmu": str(probe)}},
        "connections": [{"from": "a.real_out", "to": "b.real_in"}],
    }
    failures = []
    for path in sys.argv[3:]:
        problems = [error.message for error in validator.iter_errors(json.loads(pathlib.Path(path).read_text()))]
        if problems:
            failures.append(f"{path}: the schema refuses it: {problems[0]}")
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "case.json"
        for path, value, expected in [([], good, True)] + CASES:
            config = changed(good, path, value)
            file.write_text(json.dumps(config))
            by_schema = validator.is_valid(config)
            result = subprocess.run([mebots, "info", file], capture_output=True, text=True)
            by_reader = result.returncode == 0
            if result.returncode not in (0, 2) or by_schema != expected or by_reader != expected:
                failures.append(f"{path} = {value!r}: expected {expected}, schema {by_schema}, reader {by_reader} {result.stderr}")
    for failure in failures:
        print(f"FAILED: {failure}")
    print(f"{len(CASES) + 1} configs: schema and reader agree" if not failures else f"{len(failures)} disagreements")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
