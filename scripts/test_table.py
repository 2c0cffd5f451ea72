#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints tests by area, from ctest's results. Usage: scripts/test_table.py BUILD_FOLDER JUNIT_FILE

An area is a folder in tests/. A test is `skipped` if it reported that it cannot run. It is `not run` if ctest could not start it,
or if it is disabled. The tests of both kinds and the failed tests are listed below the table.
"""

import collections
import json
import pathlib
import subprocess
import sys
import xml.etree.ElementTree


# Kinds of results in ctest's words. For a skipped test, ctest writes "notrun" with a message.
KINDS = ("passed", "failed", "skipped", "not run")


def kind_of(case):
    """Returns the result of a test: one of KINDS."""
    status = case.get("status")
    if status == "notrun":
        skip = case.find("skipped")
        return "skipped" if skip is not None and (skip.get("message") or "").startswith("SKIP_") else "not run"
    return {"run": "passed", "fail": "failed"}.get(status, "not run")


def areas(build):
    """Maps the name of each test to its area. Uses the folders of the build."""
    shown = subprocess.run(["ctest", "--test-dir", build, "--show-only=json-v1"], check=True, capture_output=True, text=True)
    found = {}
    for test in json.loads(shown.stdout)["tests"]:
        folder = next((p["value"] for p in test.get("properties", []) if p["name"] == "WORKING_DIRECTORY"), "")
        parts = pathlib.PurePath(folder).parts
        found[test["name"]] = parts[parts.index("tests") + 1] if "tests" in parts[:-1] else "others"
    return found


def main(build, junit):
    area_of = areas(build)
    counts = collections.defaultdict(collections.Counter)
    named = {kind: [] for kind in KINDS if kind != "passed"}
    for case in xml.etree.ElementTree.parse(junit).getroot().iter("testcase"):
        name, kind = case.get("name"), kind_of(case)
        counts[area_of.get(name, "others")][kind] += 1
        counts["all"][kind] += 1
        if kind in named:
            named[kind].append(name)
    print("\n| area | " + " | ".join(KINDS) + " |\n|" + "---|" * (1 + len(KINDS)))
    for area in sorted(counts, key=lambda name: (name == "all", name)):
        print(f"| {area} | " + " | ".join(str(counts[area][kind]) for kind in KINDS) + " |")
    for title, names in named.items():
        if names:
            print(f"\n{title}: " + ", ".join(sorted(names)))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__.splitlines()[0])
    main(*sys.argv[1:])
