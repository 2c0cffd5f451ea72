#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures how time and memory of a run grow with the size of each part of a config.

Usage: sizes.py MEBOTS [OTHER_MEBOTS...] [--sizes N,N,...] [--only NAME,...] [--limit SECONDS]

Each run takes two steps. The programs alternate at each size. Prints processor seconds and the peak of resident memory. The last
column is the growth of the time from size to size; for 4 times the size, 5 times the time is permitted. If a program fails or
exceeds the limit, skips the larger sizes of this part.
"""
from __future__ import annotations

import argparse
import functools
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import zipfile
from typing import Any

HERE = pathlib.Path(__file__).resolve().parent
SIZES = [2500, 10_000, 40_000]


def wide_fmu(folder: pathlib.Path, count: int, direct: bool = False) -> pathlib.Path:
    """Builds the FMU of wide.c with ``count`` inputs, outputs and parameters."""
    archive = folder / f"wide{count}{'direct' if direct else ''}.fmu"
    if archive.exists():
        return archive
    library = folder / "wide.so"
    subprocess.run(["gcc", "-O2", "-shared", "-fPIC", f"-DCOUNT={count}", *(["-DDIRECT"] if direct else []), f"-I{HERE.parents[1] / 'tests/fmus'}",
                    str(HERE / "wide.c"), "-o", str(library)], check=True)
    kinds = [("u", 'causality="input"', ""), ("y", 'causality="output" initial="exact"', ""),
             ("p", 'causality="parameter" variability="tunable"', "")]
    variables = "".join(f'<ScalarVariable name="{name}[{i}]" valueReference="{k * count + i}" {kind}><Real start="0"/></ScalarVariable>\n'
                        for k, (name, kind, _) in enumerate(kinds) for i in range(count))
    outputs = "".join(f'<Unknown index="{count + i + 1}" dependencies="{i + 1 if direct else ""}"/>' for i in range(count))
    description = f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="wide" guid="{{wide{count}}}">
<CoSimulation modelIdentifier="wide" canHandleVariableCommunicationStepSize="true"/>
<ModelVariables>{variables}</ModelVariables><ModelStructure><Outputs>{outputs}</Outputs><InitialUnknowns>{outputs}</InitialUnknowns></ModelStructure>
</fmiModelDescription>"""
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as fmu:
        fmu.writestr("modelDescription.xml", description)
        fmu.write(library, "binaries/linux64/wide.so")
    return archive


def base(fmu: pathlib.Path, instances: int = 2) -> dict[str, Any]:
    return {"step": 1, "stop_time": 2, "record": ["i0.y[0]"], "connections": [],
            "instances": {f"i{k}": {"fmu": str(fmu)} for k in range(instances)}}


def ends(count: int) -> list[dict[str, str]]:
    return [{"from": f"i0.y[{i}]", "to": f"i1.u[{i}]"} for i in range(count)]


def names(count: int, kind: str = "y") -> list[str]:
    return [f"i0.{kind}[{i}]" for i in range(count)]


# Each function takes the size and a function that builds an FMU of a given width. It returns a config.
SCENES = {
    "instances in a ring": lambda n, wide: base(wide(1), n) | {
        "connections": [{"from": f"i{k}.y[0]", "to": f"i{(k + 1) % n}.u[0]"} for k in range(n)]},
    "variables of an FMU": lambda n, wide: base(wide(n)),
    "connections": lambda n, wide: base(wide(n)) | {"connections": ends(n)},
    "parameters": lambda n, wide: base(wide(n), 1) | {
        "instances": {"i0": {"fmu": str(wide(n)), "parameters": {f"p[{i}]": i for i in range(n)}}}},
    "parameters and connections": lambda n, wide: base(wide(n)) | {"connections": ends(n), "instances": {
        "i0": {"fmu": str(wide(n))}, "i1": {"fmu": str(wide(n)), "parameters": {f"p[{i}]": i for i in range(n)}}}},
    "recorded names": lambda n, wide: base(wide(n), 1) | {"record": names(n)},
    "recorded patterns": lambda n, wide: base(wide(n), 1) | {"record": [f"i0.y[{i}*]" for i in range(n)]},
    "recorded by one pattern": lambda n, wide: base(wide(n), 1) | {"record": ["*"]},
    "excluded names": lambda n, wide: base(wide(n), 1) | {
        "record": {"variables": ["*"], "exclude": names(n)[1:]}},
    "recorded parameters": lambda n, wide: base(wide(n), 1) | {
        "record": {"variables": ["i0.y[0]"], "parameters": names(n, "p")}},
    "scenario entries": lambda n, wide: base(wide(n), 1) | {
        "scenario": [{"variable": f"i0.u[{i}]", "set": 1} for i in range(n)]},
    "scenario entries of one variable": lambda n, wide: base(wide(1), 1) | {
        "scenario": [{"variable": "i0.u[0]", "set": i, "from": i / n} for i in range(n)]},
    "outcomes": lambda n, wide: base(wide(n), 1) | {
        "outcomes": [{"outcome": f"o{i}", "when": [{"variable": f"i0.y[{i}]", "above": 1}]} for i in range(n)]},
    "stop conditions": lambda n, wide: base(wide(n), 1) | {
        "stop_when": [{"variable": f"i0.y[{i}]", "above": 1} for i in range(n)]},
    "summary values": lambda n, wide: base(wide(n), 1) | {"summary": {f"v{i}": f"i0.y[{i}]" for i in range(n)}},
    "log sections": lambda n, wide: base(wide(1), n) | {"log": {f"i{k}": ["*"] for k in range(n)}},
    "gauss-seidel order": lambda n, wide: base(wide(1), n) | {
        "algorithm": {"type": "gauss-seidel", "order": [f"i{k}" for k in range(n)]}},
    "long chain": lambda n, wide: base(wide(1), n) | {
        "connections": [{"from": f"i{k}.y[0]", "to": f"i{k + 1}.u[0]"} for k in range(n - 1)]},
    "chain of direct dependencies": lambda n, wide: base(wide(1, direct=True), n) | {
        "instances": {f"i{k}": {"fmu": str(wide(1, direct=True)), "parameters": {} if k else {"u[0]": 1}} for k in range(n)},
        "connections": [{"from": f"i{k}.y[0]", "to": f"i{k + 1}.u[0]"} for k in range(n - 1)]},
    "star: one output to all": lambda n, wide: base(wide(1), n) | {
        "connections": [{"from": "i0.y[0]", "to": f"i{k}.u[0]"} for k in range(1, n)]},
}


def measured(program: str, config: pathlib.Path, limit: float) -> tuple[float, float, int]:
    """Runs a config. Returns processor seconds, peak memory [MB] and exit code."""
    out = config.parent / "out"
    command = ["/usr/bin/env", "timeout", str(limit), program, "run", str(config), "--out", str(out), "--quiet"]
    with open(config.parent / "log", "w") as log:
        child = subprocess.Popen(command, stdout=log, stderr=log)
        _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    subprocess.run(["rm", "-rf", str(out)], check=True)
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, child.returncode


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("programs", nargs="+")
    parser.add_argument("--sizes", default=",".join(map(str, SIZES)))
    parser.add_argument("--only", default="")
    parser.add_argument("--limit", type=float, default=60)
    options = parser.parse_args()
    sizes = [int(text) for text in options.sizes.split(",")]
    wanted = [text for text in options.only.split(",") if text]
    failures = 0
    print(f"| thing | program | {' | '.join(f'{n:,}: s, MB' for n in sizes)} | growth of the time |")
    print("|---|---|" + "---|" * len(sizes) + "---|")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for scene, make in SCENES.items():
            if wanted and not any(text in scene for text in wanted):
                continue
            rows: dict[str, list[tuple[float, float, int]]] = {program: [] for program in options.programs}
            for n in sizes:
                config = folder / "config.json"
                config.write_text(json.dumps(make(n, functools.partial(wide_fmu, folder))))
                for program, row in rows.items():
                    if not row or row[-1][2] == 0:
                        row.append(measured(program, config, options.limit))
                        if row[-1][2] not in (0, 124):
                            failures += 1
                            print((folder / "log").read_text()[-400:], file=sys.stderr)
            for program, row in rows.items():
                cells = [f"{s:.2f}, {mb:.0f}" if code == 0 else f"over {options.limit:g} s" if code == 124 else f"exit {code}" for s, mb, code in row]
                cells += ["-"] * (len(sizes) - len(cells))
                growth = [f"{b[0] / a[0]:.1f}" for a, b in zip(row, row[1:]) if b[2] == 0]
                print(f"| {scene} | {program} | {' | '.join(cells)} | {', '.join(growth)} |", flush=True)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
