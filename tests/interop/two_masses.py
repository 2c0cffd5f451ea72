# SPDX-License-Identifier: Apache-2.0
"""Simulates two masses with a spring between them, with mebots' algorithms and with libcosim. Each mass is in one FMU
(tests/fmus/coupling.c: m = 1, k = 10, coupling 10), which integrates it exactly. Prints a Markdown table (docs/interop.md) with
the largest error of both positions over 5 s, and the ratio of the energies at the end and at the start.

Usage: two_masses.py BUILD_FOLDER
"""

import math
import pathlib
import sys
import tempfile
import zipfile

import tools

SECONDS = 5


def held(fmu, target):
    """Returns a copy of the FMU without declared time derivatives, so that its inputs are constant during a step."""
    with zipfile.ZipFile(fmu) as source, zipfile.ZipFile(target, "w") as copy:
        for name in source.namelist():
            content = source.read(name)
            if name == "modelDescription.xml":
                content = content.replace(b'canInterpolateInputs="true" maxOutputDerivativeOrder="2"', b"")
            copy.writestr(name, content)
    return target


def system(fmu, step, algorithm):
    return {"step": step, "steps": round(SECONDS / step), "algorithm": algorithm,
            "instances": {"a": {"fmu": str(fmu), "parameters": {"mass_x": 1.0}}, "b": {"fmu": str(fmu)}},
            "connections": [{"from": "a.mass_x", "to": "b.mass_u"}, {"from": "b.mass_x", "to": "a.mass_u"}]}


def energy(a, v, b, w):
    return (v * v + w * w + 10 * a * a + 10 * b * b + 10 * (a - b) ** 2) / 2


def judge(tool, what, folder):
    columns, _ = tool.run(what, folder)
    a, b = columns["a.mass_x"], columns["b.mass_x"]
    largest = 0.0
    for k in range(1, len(a)):  # libcosim has no values at t = 0
        t = k * what["step"]
        total, apart = math.cos(math.sqrt(10) * t), math.cos(math.sqrt(30) * t)
        largest = max(largest, abs(a[k] - (total + apart) / 2), abs(b[k] - (total - apart) / 2))
    ratio = energy(a[-1], columns["a.mass_v"][-1], b[-1], columns["b.mass_v"][-1]) / energy(1, 0, 0, 0)
    return f"{largest:.2g} ({ratio:.4g})"


def main():
    build = pathlib.Path(sys.argv[1]).resolve()
    fmu = build / "test_fmus" / "coupling.fmu"
    mebots = tools.Mebots(build / "bin" / "mebots")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        plain = held(fmu, folder / "held.fmu")
        ways = [("libcosim", tools.Libcosim(), plain, "jacobi"), ("Jacobi", mebots, plain, "jacobi"),
                ("Gauss-Seidel", mebots, plain, "gauss-seidel"), ("Jacobi + derivatives", mebots, fmu, "jacobi"),
                ("Gauss-Seidel + derivatives", mebots, fmu, "gauss-seidel")]
        print("| h [s] | " + " | ".join(title for title, *_ in ways) + " |\n|---|" + "---|" * len(ways))
        for step in (0.1, 0.05, 0.01, 0.001):
            cells = [judge(tool, system(used, step, algorithm), folder) for _, tool, used, algorithm in ways]
            print(f"| {step} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
