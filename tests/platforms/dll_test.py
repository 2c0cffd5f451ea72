# SPDX-License-Identifier: Apache-2.0
"""Checks the tables of the FMUs' DLLs: they may import only DLLs of Windows, and export only the functions of FMI.

    dll_test.py FOLDER

Exit code 77 (skipped): FOLDER contains no DLL (scripts/platforms.sh builds them), or objdump for Windows is missing.
"""

import re
import shutil
import subprocess
import sys
from pathlib import Path

OBJDUMP = "x86_64-w64-mingw32-objdump"
OF_WINDOWS = {"kernel32.dll", "msvcrt.dll", "user32.dll"}


def complaints(library):
    tables = subprocess.run([OBJDUMP, "-p", library], capture_output=True, text=True, check=True).stdout
    needed = re.findall(r"^\s*DLL Name: (\S+)", tables, re.MULTILINE)
    if not needed:
        yield "has no table of imports"
    for name in needed:
        if name.lower() not in OF_WINDOWS:
            yield f"needs {name}"
    version = 3 if library.parent.name == "fmi3" else 2
    exports = re.findall(r"^\s*\[\s*\d+\] (\w+)$", tables.split("[Ordinal/Name Pointer] Table")[-1], re.MULTILINE)
    for name in exports:
        if not name.startswith(f"fmi{version}"):
            yield f"exports {name}"
    for name in ("GetVersion", "DoStep", "FreeInstance"):
        if f"fmi{version}{name}" not in exports:
            yield f"does not export fmi{version}{name}"


def main():
    libraries = sorted(Path(sys.argv[1]).rglob("*.dll"))
    if not libraries or not shutil.which(OBJDUMP):
        print(f"no DLL in {sys.argv[1]}, or no {OBJDUMP}")
        return 77
    found = [f"{library}: {text}" for library in libraries for text in complaints(library)]
    print("\n".join(found) or f"{len(libraries)} DLLs need DLLs of Windows alone, and export functions of FMI alone")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
