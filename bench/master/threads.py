#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks whether runs with several threads are slower than runs with one thread. Alternates runs with `threads` 1 and "auto".

Usage: threads.py MEBOTS PASSTHROUGH.fmu [CONFIG...] [--repeats N]

Systems: rings of four and of sixteen instances of the cheapest FMU, a ring of four instances whose steps take about 60 us, and
every given CONFIG (for example configs/gate_easy.json). Prints wall seconds of stepping from summary.json. results.csv must have
the same bytes.
"""

import argparse
import hashlib
import json
import pathlib
import statistics
import subprocess
import tempfile


def ring(fmu, count, work, steps):
    return {"step": 0.1, "stop_time": round(0.1 * steps, 6),
            "instances": {f"i{i}": {"fmu": str(fmu), "parameters": {"sum": 0.1 + i, "work": work}} for i in range(count)},
            "connections": [{"from": f"i{i}.sum", "to": f"i{(i + 1) % count}.u"} for i in range(count)],
            "record": {"variables": ["*.sum"], "interval": round(0.1 * steps / 10, 6)}}


def run(mebots, config, threads, folder):
    """Runs a config. Returns the seconds of stepping and the hash of the results."""
    file = folder / "config.json"
    file.write_text(json.dumps(config | {"threads": threads}))
    out = folder / "out"
    subprocess.run([mebots, "run", file, "--quiet", "--out", out], check=True)
    summary = json.loads((out / "summary.json").read_text())
    return summary["wall_clock"]["stepping"], hashlib.sha256((out / "results.csv").read_bytes()).hexdigest()


def absolute(config, file):
    """Returns the config with absolute paths of its FMUs."""
    for instance in config["instances"].values():
        path = (file.parent / instance["fmu"]).resolve()
        if path.is_file():  # otherwise it is a name
            instance["fmu"] = str(path)
    return config


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mebots", type=pathlib.Path)
    parser.add_argument("fmu", type=pathlib.Path)
    parser.add_argument("configs", type=pathlib.Path, nargs="*")
    parser.add_argument("--repeats", type=int, default=3)
    arguments = parser.parse_args()
    fmu = arguments.fmu.resolve()
    systems = {"ring of 4, cheap": ring(fmu, 4, 0, 1_000_000), "ring of 16, cheap": ring(fmu, 16, 0, 250_000),
               "ring of 4, 60 us each": ring(fmu, 4, 15_000, 4_000)}
    systems |= {file.stem: absolute(json.loads(file.read_text()), file.resolve()) for file in arguments.configs}
    print(f"wall seconds of stepping, {arguments.repeats} interleaved repeats: min / median / max")
    for name, config in systems.items():
        times = {1: [], "auto": []}
        hashes = set()
        with tempfile.TemporaryDirectory() as folder:
            for _ in range(arguments.repeats):
                for threads, values in times.items():
                    seconds, digest = run(arguments.mebots.resolve(), config, threads, pathlib.Path(folder))
                    values.append(seconds)
                    hashes.add(digest)
        if len(hashes) != 1:
            raise SystemExit(f"{name}: the results differ with and without threads")
        shown = {t: f"{min(v):.3f} / {statistics.median(v):.3f} / {max(v):.3f}" for t, v in times.items()}
        ratio = min(times["auto"]) / min(times[1])
        print(f"  {name:<24} 1 thread {shown[1]}   auto {shown['auto']}   best auto / best one {ratio:.2f}")


if __name__ == "__main__":
    main()
