# SPDX-License-Identifier: Apache-2.0
"""Compares a run on two kinds of processor: other_processor.py FOLDER FOLDER.

Results and pictures must have the same bits. If they differ, prints a table of the columns with the time of the first difference
and the largest difference. The earliest difference is closest to the cause.
"""
import csv
import hashlib
import pathlib
import sys


def rows(folder):
    with open(folder / "results.csv", newline="") as file:
        return list(csv.reader(file))


def differences(one, other):
    """Returns the time of the first difference and the largest difference of each column that differs. The columns are in the
    order of these times."""
    if len(one) != len(other) or one[0] != other[0]:
        sys.exit(f"results.csv: {len(one)} rows with {len(one[0])} columns beside {len(other)} rows with {len(other[0])}")
    found = {}
    for left, right in zip(one[1:], other[1:]):
        for name, a, b in zip(one[0], left, right):
            if a != b:
                first, largest = found.get(name, (left[0], 0.0))
                found[name] = first, max(largest, size(a, b))
    return found


def size(a, b):
    try:
        return abs(float(a) - float(b))
    except ValueError:  # a column of texts
        return float("inf")


def pictures_of(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.glob("pictures/*/*.png")}


def main(one, other):
    columns = rows(one)
    found = differences(columns, rows(other))
    seen, also = pictures_of(one), pictures_of(other)
    pictures = sorted(name for name in seen.keys() | also.keys() if seen.get(name) != also.get(name))
    hashes = [hashlib.sha256((folder / "results.csv").read_bytes()).hexdigest()[:16] for folder in (one, other)]
    print(f"results.csv: {hashes[0]} and {hashes[1]}")
    print(f"{len(columns) - 1} rows: {len(columns[0]) - len(found)} of {len(columns[0])} columns are the same to the bit")
    print(f"{len(seen) - len(pictures)} of {len(seen)} pictures are the same to the bit")
    for name, (first, largest) in found.items():
        print(f"differs: {name}, from {first} s on, by {largest:.2g} at most")
    for name in pictures:
        print(f"differs: {name}")
    return 1 if hashes[0] != hashes[1] or pictures else 0


if __name__ == "__main__":
    sys.exit(main(*map(pathlib.Path, sys.argv[1:3])))
