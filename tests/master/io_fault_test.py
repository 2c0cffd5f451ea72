#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests runs and reports on a disk that fails. Each call that writes a results file fails in turn, as in the tests of
SQLite. Each time, exit code and message must report the failure, no file may be incomplete under its final name, and
the next run must give the same bytes. EINTR and short writes must have no effect.

Usage: io_fault_test.py MEBOTS PROBE_FMU [--all]   the table of all calls; without --all a few of each kind, for ctest
"""

import collections
import json
import os
import pathlib
import shutil
import sys
import tempfile

import h5py

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "support"))
import io_faults

OF_TIME = ("wall_clock", "real_time_factor", "resumed_at")
"""Lists the keys of summary.json that differ between two runs, or between a run and a resumed run."""
GROWS = ("results.csv", "log.txt")
"""Lists the files that have their final names from the start."""


def system(probe, stop_s, format, record=("a.*", "b.*")):
    """Returns a config of two instances in steps of 0.1 s."""
    instance = {"fmu": probe, "parameters": {"gain": -0.9, "offset": 0.3, "string_in": "text"}}
    return {"step": 0.1, "stop_time": stop_s, "instances": {"a": instance, "b": instance},
            "connections": [{"from": "a.real_out", "to": "b.real_in"}, {"from": "b.real_out", "to": "a.real_in"}],
            "record": {"variables": list(record), "texts": True, "format": format, "parameters": ["*"]},
            "summary": {"end": "a.real_out"}}


class Run:
    """Performs a run, with optional checkpoints. After a fault, resumes or repeats the run."""

    def __init__(self, mebots, config, *more):
        self.command = [mebots, "run", str(config), "--quiet", *more]
        self.resume = [mebots, "resume"]
        self.tears = True

    def first(self, out):
        return [*self.command, "--out", str(out)]

    def again(self, out):
        return [*self.resume, str(out), "--quiet"] if (out / "checkpoint.bin").exists() else self.first(out)


class Report(Run):
    """Writes the report page of an existing run."""

    def __init__(self, mebots, results):
        self.mebots, self.results = mebots, results

    def first(self, out):
        out.mkdir(exist_ok=True)
        return [self.mebots, "report", str(self.results), "--out", str(out / "flight.html")]

    again = first


def without_times(text):
    """Returns the summary without the values that depend on the clock."""
    def cut(value):
        if isinstance(value, dict):
            return {key: cut(one) for key, one in value.items() if key not in OF_TIME}
        return [cut(one) for one in value] if isinstance(value, list) else value
    return cut(json.loads(text))


def rows_of(file):
    """Returns the datasets of an HDF5 file. The files themselves may differ: a resumed run copies the rows from results.csv
    to other places in the file."""
    found = {}

    def take(name, item):
        if isinstance(item, h5py.Dataset):
            found[name] = repr(item[()].tolist() if item.shape else item[()]), str(item.dtype), dict(item.attrs)

    with h5py.File(file) as opened:
        opened.visititems(take)
    return found


def content(out):
    """Returns the files that must be equal with and without faults, by name."""
    files = {path.name: path.read_bytes() for path in out.iterdir() if path.is_file()}
    if "summary.json" in files:
        files["summary.json"] = without_times(files["summary.json"])
    if "results.h5" in files:
        files["results.h5"] = rows_of(out / "results.h5")
    files.pop("log.txt", None)  # a resumed run has an additional notice
    return files


def torn(out, whole):
    """Returns incomplete and temporary files."""
    found = []
    for path in out.iterdir() if out.exists() else ():
        name, bytes_ = path.name, path.read_bytes() if path.is_file() else b""
        if name == ".mebots.lock" or path.is_dir():
            continue
        if name.endswith((".new", ".part")):
            found.append(name)
        elif name == "results.csv":
            if not whole[name].startswith(bytes_) or not (bytes_ == b"" or bytes_.endswith(b"\n")):
                found.append(name)
        elif name == "results.h5":
            try:
                with h5py.File(path) as file:
                    file["time"][:]
            except (OSError, KeyError):
                found.append(name)
        elif name == "summary.json":
            try:
                json.loads(bytes_)
            except ValueError:
                found.append(name)
        elif name in whole and name not in GROWS and bytes_ != whole[name]:
            found.append(name)
    return found


def problem_of(case, out, fault, done, whole, preload):
    """Checks a run after a fault. Returns a description of the problem, or an empty text."""
    told = done.stdout + done.stderr
    if fault.removesuffix(io_faults.STICKY) in io_faults.HARMLESS:
        if done.returncode != 0:
            return f"exit code {done.returncode}: {told.strip()}"
        return "" if content(out) == whole else "other bytes"
    if done.returncode <= 0:
        return "exit code 0, nothing reported" if done.returncode == 0 else f"signal {-done.returncode}"
    reason = os.strerror(io_faults.FAULTS[fault.removesuffix(io_faults.STICKY)])
    if reason not in told or str(out) not in told:
        return f"the message lacks file or reason: {told.strip()}"
    if "results.h5.new" in told and (out / "summary.json").exists():
        return "the message names a file that was renamed"
    if found := torn(out, whole):
        return f"torn: {', '.join(found)}"
    again, _ = io_faults.run(preload, case.again(out), out)
    if again.returncode != 0:
        return f"the next run fails: {again.stderr.strip()}"
    try:
        after = content(out)
    except OSError as error:
        return f"the next run leaves an unreadable file: {error}"
    other = sorted(name for name in whole.keys() | after.keys() if whole.get(name) != after.get(name))
    return f"the next run gives others: {', '.join(other)}" if other else ""


def sweep(name, case, folder, preload, most):
    """Runs a case many times. In each run, another call has a fault, or the same call has another fault. Prints a row
    per kind of call and fault. Returns the number of problems."""
    out = folder / "out"
    done, counts = io_faults.run(preload, case.first(out), out)
    assert done.returncode == 0, done.stderr
    whole = content(out)
    problems = 0
    for kind in io_faults.KINDS:
        for fault in io_faults.faults_of(kind) if counts[kind] else ():
            found = collections.Counter()
            for nth in io_faults.numbers(counts[kind], most):
                shutil.rmtree(out)
                done, _ = io_faults.run(preload, case.first(out), out, kind, fault, nth)
                found[problem_of(case, out, fault, done, whole, preload)] += 1
            problems += found.total() - found[""]
            print(io_faults.table_row(name, kind, fault, counts[kind], found), flush=True)
    shutil.rmtree(out)
    return problems


def main():
    mebots, probe, *more = (os.path.abspath(one) if os.path.exists(one) else one for one in sys.argv[1:])
    most = sys.maxsize if more == ["--all"] else 3
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        preload = io_faults.library(folder)
        if preload is None:
            sys.exit(77)

        def config(name, *arguments):
            file = folder / f"{name}.json"
            file.write_text(json.dumps(system(probe, *arguments)))
            return file

        cases = {"CSV, HDF5 and checkpoints, 100 rows": Run(mebots, config("usual", 10, "both"), "--checkpoint-every", "4")}
        if most == sys.maxsize:
            cases["CSV alone, 100 rows"] = Run(mebots, config("csv", 10, "csv"))
            cases["CSV alone, 20,000 rows"] = Run(mebots, config("long", 2000, "csv", ["a.real_out", "b.integral"]))
            cases["HDF5 alone, 2 rows"] = Run(mebots, config("tiny", 0.1, "hdf5"))
            cases["HDF5 alone, 20,000 rows"] = Run(mebots, config("large", 2000, "hdf5", ["a.real_out", "b.integral"]))
        results = folder / "results"
        io_faults.run(preload, Run(mebots, config("page", 10, "csv")).first(results), folder / "none")
        cases["page of a run"] = Report(mebots, results)
        print(io_faults.TABLE_HEAD)
        problems = sum(sweep(name, case, folder, preload, most) for name, case in cases.items())
    sys.exit(f"{problems} faults did not end as required" if problems else 0)


if __name__ == "__main__":
    main()
