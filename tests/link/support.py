# SPDX-License-Identifier: Apache-2.0
"""Starts `mebots link` for a test, and ends it."""

import json
import os
import pathlib
import signal
import socket
import subprocess
import tempfile
import unittest

BUILD = pathlib.Path(os.environ["MEBOTS_BUILD"])
SOURCE = pathlib.Path(os.environ["MEBOTS_SOURCE"])
MEBOTS = str(BUILD / "bin" / "mebots")
CONFIG = SOURCE / "configs" / "link.json"


def free_port(count=1):
    """Returns the first of `count` consecutive unused UDP ports."""
    for first in range(20000 + os.getpid() % 20000, 65000, 16):
        try:
            opened = []
            for port in range(first, first + count):
                opened.append(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
                opened[-1].bind(("127.0.0.1", port))
            return first
        except OSError:
            continue
        finally:
            for one in opened:
                one.close()
    raise OSError("no free ports")


class LinkCase(unittest.TestCase):
    """Creates a folder for each test, and ends its servers afterwards."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.out = self.folder / "out"
        self.server = None

    def start(self, *options, drones=1, config=CONFIG, port=None):
        """Starts a server for `drones` drones of the config. Returns its first port."""
        port = port or free_port(drones)
        command = [MEBOTS, "link", str(config), "--out", str(self.out), "--port", str(port), *options]
        self.notices = self.folder / "notices"
        with open(self.notices, "w") as notices:
            self.server = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=notices, text=True)
        self.addCleanup(self.kill)
        for _ in range(drones):
            line = self.server.stdout.readline()
            self.assertIn("udp://", line, line or self.notices.read_text())
        return port

    def was_slow(self):
        """True if simulated time fell behind the wall clock."""
        return "slower than the wall clock" in self.notices.read_text()

    def kill(self):
        if self.server.poll() is None:
            self.server.kill()
        self.server.wait()
        self.server.stdout.close()

    def stop(self, code=0):
        """Interrupts the server as Ctrl-C does. Returns its output."""
        self.server.send_signal(signal.SIGINT)
        return self.end(code)

    def end(self, code=0):
        printed = self.server.communicate(timeout=60)[0] + self.notices.read_text()
        self.assertEqual(self.server.returncode, code, printed)
        return printed

    def replay(self, *options, code=0, config=CONFIG):
        """Repeats the recorded run. Returns the program's output."""
        command = [MEBOTS, "link", str(config), "--replay", str(self.out / "link.jsonl"), *options]
        done = subprocess.run(command, capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def recording(self):
        return [json.loads(line) for line in (self.out / "link.jsonl").read_text().splitlines()]
