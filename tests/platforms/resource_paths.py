# SPDX-License-Identifier: Apache-2.0
"""Starts an FMU for Windows under wine. Passes the path of its resources in each possible notation.

    resource_paths.py WINE RUN_FMU_EXE FMU...

The folder's name contains blanks, a percent sign and letters outside of ASCII. The folder is on drive Z:, wine's name for /, and
on drive C:. If an FMU does not find its resources, its initialisation fails. The values of all starts must be equal. The exit
code is 1 if a start fails, or if a value differs.
"""

import os
import subprocess
import sys
import tempfile
import urllib.parse
from pathlib import Path

from compare import Fmu, bits

NAME = "mebots f\u00fcr 100% \u03a9 \u30e1\u30dc"


def forms(is_fmi3, path):
    """Yields the notations of `path`, such as Z:/tmp/x, each with a description."""
    quoted = urllib.parse.quote(path, safe="/:")
    if is_fmi3:
        yield "slashes", path
        yield "backslashes", path.replace("/", "\\")
        yield "a backslash at the end", path.replace("/", "\\") + "\\"
        return
    yield "URI", "file:///" + quoted
    yield "URI with a slash at the end", "file:///" + quoted + "/"
    yield "URI with a small drive letter", "file:///" + quoted[0].lower() + quoted[1:]
    yield "URI of the host", "file://localhost/" + quoted
    yield "URI of one slash", "file:/" + quoted
    yield "URI with letters outside of ASCII", "file:///" + path.replace("%", "%25")


def start(command, fmu, drive_path, resources):
    library = f"{drive_path}/{fmu.library('win64').relative_to(fmu.folder)}"
    reads = [f"read {kind} {reference} {count}" for _, kind, causality, reference, count in fmu.variables
             if causality == "output" and kind == "real"]
    orders = [f"library {library}", f"guid {fmu.guid}", f"resources {resources}", f"instantiate {3 if fmu.is_fmi3 else 2}", "initialise",
              f"step {bits(0)} {bits(0.02)}", *reads]
    done = subprocess.run(command, input="\n".join(orders).encode(), capture_output=True, timeout=300, check=False)
    return done.stdout.decode() if done.returncode == 0 else None, done.stderr.decode(errors="replace")


def main():
    wine, loader, *archives = sys.argv[1:]
    on_c = Path(os.environ["WINEPREFIX"]) / "drive_c"
    good = True
    for archive in archives:
        expected = None
        for parent, drive in ((None, "Z:"), (on_c, "C:")):
            with tempfile.TemporaryDirectory(dir=parent) as folder:
                fmu = Fmu(Path(archive), Path(folder) / NAME)
                place = drive + str(fmu.folder if parent is None else "/" / fmu.folder.relative_to(on_c))
                for text, resources in forms(fmu.is_fmi3, place + "/resources"):
                    values, problem = start([wine, loader], fmu, place, resources)
                    expected = expected or values
                    equal = values is not None and values == expected
                    good = good and equal
                    print(f"{Path(archive).name}, {drive} {text}: " + ("equal" if equal else f"different or failed: {problem[-300:]}"))
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
