#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tries the attacks of the FMU in tests/fmus/attacker.c in each kind of process, and prints a Markdown table.

Usage: attacks.py MEBOTS ATTACKER.fmu [--compare FILE] [--kinds KIND,...]

All targets of the attacks are set up for the run: files, sockets, memory, a process. Root becomes an ordinary user first.
With --compare, exits with 1 if the table in FILE differs, and with 77 if this system refuses a part of the sandbox or an
ordinary user cannot read the programs.
"""
import argparse
import csv
import ctypes
import json
import os
import pathlib
import socket
import subprocess
import sys
import tempfile

KINDS = ("shared", "own", "sandboxed")
SKIPPED = 77
NOBODY = 65534
KEY = 0x6D65626F
csv.field_size_limit(1 << 20)


class Targets:
    """Creates the files, memory, processes and sockets that the FMU attacks."""

    def __init__(self, folder: pathlib.Path):
        self.home = folder / "home"
        self.home.mkdir()
        for name in ("private", "public", "truncated", "deleted", "renamable"):
            (self.home / f"{name}.txt").write_text("of the user\n")
        (self.home / "private.txt").chmod(0o600)
        self.shared_memory = pathlib.Path(f"/dev/shm/mebots-attacks-{os.getpid()}")
        self.shared_memory.write_text("of the user\n")
        self.shared_memory.chmod(0o600)
        self.temporary_file = folder / "temporary.txt"
        self.temporary_file.write_text("of the user\n")
        self.left = folder / "left.txt"
        self.process = subprocess.Popen(["/bin/sh", "-c", "trap '' USR2; echo; exec sleep 1000"], stdout=subprocess.PIPE, text=True)
        self.process.stdout.readline()
        self.address = pathlib.Path(f"/proc/{self.process.pid}/maps").read_text().split("-")[0]
        libc = ctypes.CDLL(None, use_errno=True)
        self.libc, self.segment = libc, libc.shmget(KEY, 4096, 0o1600)
        self.semaphore, self.messages = libc.semget(KEY, 1, 0o1600), libc.msgget(KEY, 0o1600)
        self.abstract = f"mebots-attacks-{os.getpid()}"
        self.path = folder / "socket"
        self.sockets = [self.listen(socket.AF_UNIX, str(self.path)), self.listen(socket.AF_UNIX, "\0" + self.abstract),
                        self.listen(socket.AF_INET, ("127.0.0.1", 0)), self.listen(socket.AF_INET6, ("::1", 0))]

    @staticmethod
    def listen(family, address):
        try:
            line = socket.socket(family)
            line.bind(address)
            line.listen()
            return line
        except OSError:
            return None

    def text(self, kind: str) -> str:
        ports = [line.getsockname()[1] if line else 1 for line in self.sockets[2:]]
        # In the sandbox, the FMU has its own /tmp and network, and cannot distinguish them from those of the system.
        # Therefore effects on these are checked from outside.
        values = {"home": self.home, "shared_memory": self.shared_memory, "temporary_file": self.temporary_file, "temporary": self.left,
                  "process": self.process.pid, "address": self.address, "key": KEY, "socket": self.path, "abstract": self.abstract,
                  "port": ports[0], "port6": ports[1], "port_udp": ports[0], "free_port": 0, "master": os.getpid(),
                  "looks": "inside" if kind != "sandboxed" else "private"}
        return ";".join(f"{name}={value}" for name, value in values.items())

    def close(self):
        self.process.kill()
        self.process.wait()
        self.shared_memory.unlink(missing_ok=True)
        self.libc.shmctl(self.segment, 0, None), self.libc.semctl(self.semaphore, 0, 0), self.libc.msgctl(self.messages, 0, None)
        for line in self.sockets:
            if line:
                line.close()


def attack(mebots: str, fmu: str, kind: str, folder: pathlib.Path) -> dict[str, tuple[str, str]]:
    """Runs all attacks in a process of this kind. Returns their descriptions and results by name."""
    folder.mkdir()
    targets = Targets(folder)
    try:
        config = {"step": 1, "stop_time": 1, "connections": [], "record": ["a.report"],
                  "instances": {"a": {"fmu": fmu, "process": kind, "parameters": {"targets": targets.text(kind)}}}}
        if kind != "shared":
            config["instances"]["a"]["deadline"] = 60
        (folder / "config.json").write_text(json.dumps(config))
        environment = os.environ | {"MEBOTS_TEST_SECRET": "of the user", "TMPDIR": str(folder)}
        done = subprocess.run([mebots, "run", str(folder / "config.json"), "--out", str(folder / "out"), "--quiet"],
                              env=environment, capture_output=True, text=True, timeout=300)
        if "refuses a part of its sandbox" in done.stderr:
            print(done.stderr, file=sys.stderr)
            sys.exit(SKIPPED)
        if done.returncode != 0:
            sys.exit(f"{kind}: exit code {done.returncode}: {done.stderr}")
        with open(folder / "out" / "results.csv", newline="") as file:
            report = list(csv.reader(file))[-1][-1]
        results = {name: (text, result) for name, result, text in (line.split("\t") for line in report.splitlines())}
        if targets.left.exists():  # the FMU cannot determine whether this file is the system's
            results["write_temporary"] = (results["write_temporary"][0], "reached")
        return results
    finally:
        targets.close()


def table_in(page: pathlib.Path) -> dict[tuple[str, str], str]:
    """Returns the results in a page's table by attack and kind of process."""
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in page.read_text().splitlines() if line.startswith("| ")]
    start = next(i for i, row in enumerate(rows) if row[0] == "an FMU tries to")
    return {(row[0], kind): cell for row in rows[start + 1:] for kind, cell in zip(rows[start][1:], row[1:])}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("mebots")
    parser.add_argument("fmu")
    parser.add_argument("--compare")
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--as-root", action="store_true", help="stay root; for kinds that hold every attack")
    options = parser.parse_args()
    if os.getuid() == 0 and not options.as_root:
        os.setgroups([])
        os.setresgid(NOBODY, NOBODY, NOBODY)
        os.setresuid(NOBODY, NOBODY, NOBODY)
    if not (os.access(options.mebots, os.X_OK) and os.access(options.fmu, os.R_OK)):
        print(f"{options.mebots} or {options.fmu} cannot be read by an ordinary user", file=sys.stderr)
        return SKIPPED
    kinds = options.kinds.split(",")
    with tempfile.TemporaryDirectory(prefix="mebots-attacks-", ignore_cleanup_errors=True) as name:
        os.chmod(name, 0o755)
        results = {kind: attack(os.path.abspath(options.mebots), os.path.abspath(options.fmu), kind, pathlib.Path(name) / kind)
                   for kind in kinds}
    rows = [f"| {text} | {' | '.join(results[kind][attack][1] for kind in kinds)} |"
            for attack, (text, _) in results[kinds[0]].items()]
    print(f"| an FMU tries to | {' | '.join(kinds)} |")
    print("|---|" + "---|" * len(kinds))
    print("\n".join(rows))
    for kind in kinds:
        reached = [attack for attack, (_, result) in results[kind].items() if result == "reached"]
        print(f"{kind}: {len(reached)} of {len(rows)} reached", *reached, file=sys.stderr)
    if not options.compare:
        return 0
    written = table_in(pathlib.Path(options.compare))
    differences = [f"{options.compare}: {kind}: {text}: {result} now, not {written.get((text, kind))}"
                   for kind in kinds for text, result in results[kind].values() if written.get((text, kind)) != result]
    print(*differences, sep="\n", file=sys.stderr)
    return 1 if differences else 0


if __name__ == "__main__":
    sys.exit(main())
