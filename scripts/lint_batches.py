#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Puts the project's sources together, some of one folder at a time, for clang-tidy.

Most of clang-tidy's time goes into library headers; sources that share them are looked at in one
go. Files of a batch have the same compiler options. Usage: lint_batches.py BUILD_DIR OUT_DIR
"""

import collections
import json
import pathlib
import re
import sys

FOLDERS = re.compile(r"(modeldesc|fmu_[a-z]+|master)/.*\.cpp$")
BATCH = 12


def options(entry):
    """The compiler's call without its launcher, input and output."""
    return re.sub(r"^\S*ccache ", "", re.sub(r" -o \S+ -c .*", "", entry["command"]))


def main(build, out):
    root = pathlib.Path(__file__).resolve().parent.parent
    groups = collections.defaultdict(set)
    seen = set()
    for entry in json.loads((build / "compile_commands.json").read_text()):
        source = pathlib.Path(entry["file"])
        if source in seen or not source.is_relative_to(root):
            continue
        if FOLDERS.match(str(source.relative_to(root))):
            seen.add(source)
            groups[source.parent, options(entry)].add(source)

    out.mkdir(parents=True, exist_ok=True)
    for old in out.glob("*.cpp"):
        old.unlink()
    commands = []
    for (_, call), sources in sorted(groups.items()):
        ordered = sorted(sources)
        for first in range(0, len(ordered), BATCH):
            batch = out.resolve() / f"batch{len(commands)}.cpp"
            batch.write_text("".join(f'#include "{s}"\n' for s in ordered[first:first + BATCH]))
            commands.append({"directory": str(build.resolve()), "file": str(batch),
                             "command": f'{call} -c "{batch}"'})
    (out / "compile_commands.json").write_text(json.dumps(commands, indent=1))
    print(f"clang-tidy: {len(seen)} sources in {len(commands)} batches")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
