# SPDX-License-Identifier: Apache-2.0
"""Tests firmware with pytest: a program runs on a simulated board, and the test controls it step by step.

    def test_greets(chip):
        board = chip("hello.elf", board="virt")
        board.wait_for("ready\\n", within=0.1)
        board.send("name\\n")
        board.wait_for("hello, name", within=0.1)
        assert board.read("greetings") == 1
        board.expect(joules=(0, 1e-3), cycles=(1, 200_000))

Time is simulated time in seconds, so a test gives the same result on every machine. The fixture ``chip`` is part of
the package's pytest plug-in; without pytest, use `Board` in a with statement.
"""

from __future__ import annotations

import json
import os
import pathlib
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from typing import Any

from mebots.errors import Error, InputError

Bounds = tuple[float, float]

_BAD_INPUT = 102  # mebots-soc's exit code for invalid input


def _program() -> str:
    """Returns the path of mebots-soc: $MEBOTS_SOC, otherwise in the package, otherwise in PATH."""
    own = pathlib.Path(__file__).with_name("bin") / "mebots-soc"
    found = os.environ.get("MEBOTS_SOC") or (str(own) if own.exists() else shutil.which("mebots-soc"))
    if not found:
        raise InputError("mebots-soc was not found: install MEbots, or set MEBOTS_SOC to its path")
    return found


class Board:
    """A program on a board. Simulated time stops between calls.

    Args:
        program: the ELF file.
        board: a board file, or the name of a board of MEbots; None: RAM around the program.
        options: further options of ``mebots-soc run``, such as ``["--report", "report.json"]``.
    """

    def __init__(self, program: str | os.PathLike[str], *, board: str | os.PathLike[str] | None = None, options: Sequence[str] = ()) -> None:
        command = [_program(), "run", os.fspath(program), "--control", *options]
        if board is not None:
            command += ["--board", os.fspath(board)]
        self._errors = tempfile.TemporaryFile("w+")
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._errors, text=True, encoding="utf-8")
        self.output = ""
        """The text that the program has printed so far, up to the last call."""
        self.time = 0.0
        """Simulated time [s]."""
        self.running = True
        """False after the program has ended."""
        self.exit_code: int | None = None
        """The program's exit code; None while it runs, or if the program did not end itself."""
        self._ask({"run": 0})

    def __enter__(self) -> Board:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Ends the run and completes its files, such as that of ``--report``. Raises InputError if this fails."""
        if self._errors.closed:
            return
        told = self._process.poll() is not None  # an earlier call has already reported the end
        if not told:
            self._process.communicate()
        program_ended_so = self.exit_code is not None and self.exit_code & 0xFF == _BAD_INPUT
        failed = not told and self._process.returncode == _BAD_INPUT and not program_ended_so
        refusal = self._refusal() if failed else None
        self._errors.close()
        if refusal is not None:
            raise refusal

    def run(self, seconds: float) -> str:
        """Runs the board for a time. Returns the text that the program printed in this time."""
        return self._ask({"run": seconds})["console"]

    def wait_for(self, text: str, *, within: float) -> str:
        """Runs until the program prints a text. Returns the output up to and including the text.

        Raises AssertionError with the output if this takes longer than `within` seconds, or if the program ends before.
        """
        reply = self._ask({"run": within, "until": text})
        if not reply["found"]:
            how = "within" if self.running else "before the program ended, within"
            raise AssertionError(f"the program did not print {text!r} {how} {within:g} s, but {reply['console']!r}{self._fault(reply)}")
        return reply["console"]

    def wait_for_end(self, *, within: float) -> int:
        """Runs until the program ends. Returns its exit code. Raises AssertionError if it does not end within `within` seconds."""
        reply = self._ask({"run": within})
        if self.exit_code is None:
            raise AssertionError(f"the program did not end itself within {within:g} s{self._fault(reply)}")
        return self.exit_code

    def send(self, text: str) -> None:
        """Sends a text to the program's serial port."""
        self._ask({"send": text})

    def get(self, variable: str) -> float:
        """Returns the value of a device's variable, such as ``led.level``. An input must have been set before."""
        return self._ask({"get": variable})["value"]

    def set(self, variable: str, value: float) -> None:
        """Sets an input of a device, such as ``button.pressed``."""
        self._ask({"set": variable, "value": float(value)})

    def press(self, variable: str, seconds: float = 0.01) -> None:
        """Presses a button: sets an input to 1, runs the board for a time, and sets the input to 0."""
        self.set(variable, 1)
        self.run(seconds)
        self.set(variable, 0)

    def read(self, symbol: str | int, *, signed: bool = False, offset: int = 0, size: int | None = None) -> int:
        """Returns a variable of the program by its symbol, or the word at an address.

        `size` is in bytes, at most 8, and by default that of the symbol. `offset` is in bytes from the symbol's start.
        Raises InputError if there is no byte at the offset.
        """
        if offset < 0:
            raise InputError(f"{symbol}: offset {offset} is before its start")
        bytes_ = self.read_bytes(symbol)[offset:] if size is None else self.read_bytes(symbol, offset + size)[offset:]
        if not bytes_:
            raise InputError(f"{symbol} has no bytes to read from offset {offset}: give an offset before its end, and a size above 0")
        if len(bytes_) > 8:
            raise InputError(f"{symbol} has {len(bytes_)} bytes from offset {offset}: give the size of one of its numbers, or use read_bytes()")
        return int.from_bytes(bytes_, "little", signed=signed)

    def read_bytes(self, symbol: str | int, size: int | None = None) -> bytes:
        """Returns the bytes of memory at a symbol or address. Without ``size``, returns all bytes of the symbol."""
        command: dict[str, Any] = {"read": symbol}
        if size is not None:
            command["size"] = size
        return bytes.fromhex(self._ask(command)["bytes"])

    @property
    def report(self) -> dict[str, Any]:
        """Returns the counts, times and energies of the run so far, in the format of ``--json``."""
        return self._ask({"report": True})["report"]

    @property
    def joules(self) -> float:
        """Returns the energy that the chip has used so far [J]."""
        return self.report["chip_j"]

    @property
    def cycles(self) -> int:
        """Returns the active cycles of the core, or of the fabric controller, so far."""
        return self.report["controller"]["cycles"]

    def expect(self, *, joules: Bounds | None = None, cycles: Bounds | None = None, seconds: Bounds | None = None, **variables: Bounds) -> None:
        """Checks energy, cycles, time and variables of the program against bounds (least, most), which are permitted values.

        Raises AssertionError that names each value outside its bounds.
        """
        report = self.report
        found: dict[str, tuple[float, Bounds | None]] = {
            "joules": (report["chip_j"], joules),
            "cycles": (report["controller"]["cycles"], cycles),
            "seconds": (report["time_s"], seconds),
        }
        found |= {name: (self.read(name), bounds) for name, bounds in variables.items()}
        wrong = [
            f"{name} = {value:g}, not in [{bounds[0]:g}, {bounds[1]:g}]"
            for name, (value, bounds) in found.items()
            if bounds is not None and not bounds[0] <= value <= bounds[1]
        ]
        if wrong:
            raise AssertionError("; ".join(wrong))

    def _ask(self, command: dict[str, Any]) -> dict[str, Any]:
        assert self._process.stdin is not None and self._process.stdout is not None
        try:
            self._process.stdin.write(json.dumps(command) + "\n")
            self._process.stdin.flush()
            line = self._process.stdout.readline()
        except (BrokenPipeError, ValueError):
            line = ""
        if not line:
            raise self._refusal()
        reply: dict[str, Any] = json.loads(line)
        if "error" in reply:
            raise InputError(reply["error"])
        self.output += reply.get("console", "")
        self.time = reply.get("time_s", self.time)
        self.running = reply.get("running", self.running)
        self.exit_code = reply.get("exit_code", self.exit_code)
        return reply

    def _refusal(self) -> Error:
        if self._errors.closed:
            return InputError("the board is closed")
        self._process.wait()
        self._errors.seek(0)
        return InputError(self._errors.read().strip() or f"mebots-soc ended with {self._process.returncode}")

    @staticmethod
    def _fault(reply: dict[str, Any]) -> str:
        return f"; {reply['fault']}" if "fault" in reply else ""
