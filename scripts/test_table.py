#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests by area, from what ctest wrote. Usage: scripts/test_table.py BUILD_FOLDER JUNIT_FILE

An area is a folder below tests/. `skipped` are tests that said themselves that they cannot run; each is named below the table.
"""

import collections
import json
import pathlib
import subprocess
import sys
import xml.etree.ElementTree


def areas(build):
    """Area by name of test, as the folders of the build tell."""
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
    skipped, failed = [], []
    for case in xml.etree.ElementTree.parse(junit).getroot().iter("testcase"):
        name, status = case.get("name"), case.get("status")
        kind = {"run": "passed", "fail": "failed"}.get(status, "skipped")
        counts[area_of.get(name, "others")][kind] += 1
        counts["all"][kind] += 1
        if kind == "skipped":
            skipped.append(name)
        elif kind == "failed":
            failed.append(name)
    print("\n| area | passed | failed | skipped |\n|---|---|---|---|")
    for area in sorted(counts, key=lambda name: (name == "all", name)):
        print(f"| {area} | " + " | ".join(str(counts[area][kind]) for kind in ("passed", "failed", "skipped")) + " |")
    for title, names in (("failed", failed), ("skipped", skipped)):
        if names:
            print(f"\n{title}: " + ", ".join(sorted(names)))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__.splitlines()[0])
    main(*sys.argv[1:])
