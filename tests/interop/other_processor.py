# SPDX-License-Identifier: Apache-2.0
"""Compares one flight on two kinds of processor: other_processor.py FOLDER FOLDER.

What the firmware did must be the same to the bit: the chip's columns and the camera's pictures. Debian's builds of ODE, ARKODE and musl
for 64-bit ARM fuse a product and a sum into one operation with one rounding, as its compiler does unless told otherwise; those for x86-64
cannot. So what they compute may differ by rounding: `TOLERANCE` is allowed, in the unit of each column.
"""
import csv
import pathlib
import sys

TOLERANCE = 1e-9


def rows(folder):
    with open(folder / "results.csv", newline="") as file:
        return list(csv.reader(file))


def largest_differences(one, other):
    """Of each column that differs: the largest difference."""
    if len(one) != len(other) or one[0] != other[0]:
        sys.exit(f"results.csv: {len(one)} rows with {len(one[0])} columns beside {len(other)} rows with {len(other[0])}")
    found = {}
    for left, right in zip(one[1:], other[1:]):
        for name, a, b in zip(one[0], left, right):
            if a != b:
                found[name] = max(found.get(name, 0.0), abs(float(a) - float(b)))
    return found


def pictures_of(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.glob("pictures/*/*.png")}


def main(one, other):
    columns = rows(one)
    found = largest_differences(columns, rows(other))
    seen, also = pictures_of(one), pictures_of(other)
    pictures = sorted(name for name in seen.keys() | also.keys() if seen.get(name) != also.get(name))
    wrong = [name for name in found if name.startswith("soc.") or not found[name] <= TOLERANCE]
    worst = max(found, key=found.get, default=None)
    print(f"{len(columns) - 1} rows: {len(columns[0]) - len(found)} of {len(columns[0])} columns are the same to the bit"
          + (f"; largest difference {found[worst]:.2g} in {worst}" if worst else ""))
    print(f"{len(seen) - len(pictures)} of {len(seen)} pictures are the same to the bit")
    for name in wrong:
        print(f"differs: {name}, by {found[name]:.2g}")
    for name in pictures:
        print(f"differs: {name}")
    return 1 if wrong or pictures else 0


if __name__ == "__main__":
    sys.exit(main(*map(pathlib.Path, sys.argv[1:3])))
