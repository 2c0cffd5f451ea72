#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""An FMU of pythonfmu takes the Python interpreter of its process: without one, mebots says how to get it.

Usage: pythonfmu_check.py MEBOTS

What such FMUs compute is compared in compare.py.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import pythonfmu


def main():
    mebots = sys.argv[1]
    script = pathlib.Path(__file__).parent / "python_slave.py"
    with tempfile.TemporaryDirectory(prefix="foreign fmus ") as folder:
        folder = pathlib.Path(folder)
        fmu = pythonfmu.FmuBuilder.build_FMU(str(script), dest=str(folder))
        config = {"step": 0.125, "stop_time": 1, "instances": {"a": {"fmu": str(fmu)}}, "connections": []}
        (folder / "config.json").write_text(json.dumps(config))
        alone = subprocess.run([mebots, "run", folder / "config.json", "--out", folder / "out"], capture_output=True, text=True)
        if alone.returncode != 2 or "LD_PRELOAD" not in alone.stderr:
            sys.exit(f"FAILED: without a Python interpreter the message must say how to get one: {alone.stderr}")
        print(f"ok: {alone.stderr.strip()[-160:]}")


if __name__ == "__main__":
    main()
