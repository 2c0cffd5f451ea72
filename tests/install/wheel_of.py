#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Creates a wheel from an existing build without compiling, with the layout of pyproject.toml, and installs it in a new
environment. scripts/wheel.sh builds the published wheel.

Usage: wheel_of.py SOURCES BUILD WORK. Writes the wheel to WORK/wheels and the environment to WORK/drone. The packages that it
needs are those of the environment that runs this script.
"""

import base64
import hashlib
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tomllib
import venv
import zipfile


def installed_tree(build, work):
    """Returns a folder with the package `mebots` in the layout of a wheel: the package's folder contains the Python files
    and the folders bin, lib, include and share."""
    prefix = work / "installed"
    subprocess.run(["cmake", "--install", build, "--prefix", prefix], check=True, stdout=subprocess.DEVNULL)
    tree = work / "tree"
    package = next(prefix.glob("lib/python3.*/site-packages/mebots"))
    shutil.move(package, tree / "mebots")
    shutil.rmtree(package.parents[1])
    for part in prefix.iterdir():
        shutil.move(part, tree / "mebots" / part.name)
    return tree


def write_metadata(sources, tree):
    """Adds the wheel's folder of metadata, without the file RECORD, and returns the folder."""
    project = tomllib.loads((sources / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    version = re.search(r"(?i)project\(mebots VERSION ([0-9.]+)", (sources / "CMakeLists.txt").read_text(encoding="utf-8"))[1]
    info = tree / f"mebots-{version}.dist-info"
    info.mkdir()
    needs = "".join(f"Requires-Dist: {need}\n" for need in project["dependencies"])
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: mebots\nVersion: {version}\nSummary: {project['description']}\n{needs}", encoding="utf-8")
    tag = f"cp{sys.version_info.major}{sys.version_info.minor}-cp{sys.version_info.major}{sys.version_info.minor}-linux_{sysconfig.get_platform().rsplit('-', 1)[-1]}"
    (info / "WHEEL").write_text(f"Wheel-Version: 1.0\nGenerator: wheel_of.py\nRoot-Is-Purelib: false\nTag: {tag}\n", encoding="utf-8")
    scripts = "".join(f"{name} = {place}\n" for name, place in project["scripts"].items())
    (info / "entry_points.txt").write_text(f"[console_scripts]\n{scripts}", encoding="utf-8")
    return info, f"mebots-{version}-{tag}.whl"


def pack(tree, info, wheel):
    """Packs without compression, because the file exists for only one test."""
    record = []
    with zipfile.ZipFile(wheel, "w") as archive:
        for file in sorted(path for path in tree.rglob("*") if path.is_file()):
            name = str(file.relative_to(tree))
            content = file.read_bytes()
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            entry.external_attr = (0o100000 | file.stat().st_mode & 0o777) << 16
            archive.writestr(entry, content)
            digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
            record.append(f"{name},sha256={digest},{len(content)}\n")
        name = f"{info.name}/RECORD"
        archive.writestr(name, "".join([*record, f"{name},,\n"]))


def main():
    sources, build, work = (pathlib.Path(argument).resolve() for argument in sys.argv[1:])
    shutil.rmtree(work, ignore_errors=True)
    (work / "tree").mkdir(parents=True)
    (work / "wheels").mkdir()
    tree = installed_tree(build, work)
    info, name = write_metadata(sources, tree)
    pack(tree, info, work / "wheels" / name)
    venv.create(work / "drone", symlinks=True)
    site = next((work / "drone").glob("lib/python3.*/site-packages"))
    (site / "needed.pth").write_text(sysconfig.get_paths()["purelib"] + "\n", encoding="utf-8")
    subprocess.run([sys.executable, "-m", "pip", "--python", work / "drone/bin/python", "install", "--quiet", "--no-deps", "--no-index", "--no-compile",
                    "--disable-pip-version-check", work / "wheels" / name], check=True)
    shutil.rmtree(work / "installed")
    shutil.rmtree(tree)
    subprocess.run([work / "drone/bin/mebots", "--version"], check=True)


if __name__ == "__main__":
    main()
