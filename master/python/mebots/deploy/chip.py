# SPDX-License-Identifier: Apache-2.0
"""Builds a deployed network for this machine and for the chip, and runs it on both."""

from __future__ import annotations

import dataclasses
import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys
from collections.abc import Sequence
from typing import Any

import numpy as np

import mebots
from mebots.errors import Error, InputError
from mebots.installation import data_folder

_MARK = b"mebots-request:\0"
CLOCK_HZ = 87_000_000
"""The cluster's highest clock at 1.0 V."""
SOC_CLOCK_HZ = 100_000_000
"""The clock of the SoC on board gap8 (START_CLOCK_HZ in fmu_soc/firmware/gap8/runtime/chip.h)."""
_TIME_LIMIT_S = 600
_GAP8_RUNTIME = ("chip.c", "soc_events.c", "uart.c", "vectors.S", "dma.c")
_RUNTIME = ("cluster.c", "cluster_start.S", "crt0.S", "console.c", "exit.c", "memory.c", "sleep.c", "trap.c")
_CHIP_OPTIONS = ("-march=rv32imc_zicsr", "-mabi=ilp32", "-mcmodel=medany", "-O2", "-g", "-ffreestanding", "-ffunction-sections", "-fdata-sections")


def program(name: str) -> str:
    """Returns the path of a program of MEbots."""
    here = pathlib.Path(mebots.__file__).resolve().parent
    for place in (here / "bin", here.parents[1] / "bin", here.parents[3] / "bin"):
        if (place / name).is_file():
            return str(place / name)
    found = shutil.which(name)
    if found is None:
        raise InputError(f"program {name} was not found. Build MEbots with the chip (-DMEBOTS_CHIP=ON)", "not_offered")
    return found


def compiler() -> str:
    found = shutil.which("riscv64-unknown-elf-gcc")
    if found is None:
        raise InputError("riscv64-unknown-elf-gcc was not found: install Debian's gcc-riscv64-unknown-elf, or deploy with --no-measure", "not_offered")
    return found


def run_program(words: Sequence[str | os.PathLike[str]], what: str) -> str:
    """Runs a program and returns its output. Raises Error if the program fails."""
    try:
        done = subprocess.run([os.fspath(one) for one in words], capture_output=True, text=True, timeout=_TIME_LIMIT_S, check=False)
    except subprocess.TimeoutExpired as error:
        raise Error(f"{what} did not end within {_TIME_LIMIT_S} s") from error
    if done.returncode != 0:
        text = (done.stderr or done.stdout).strip().splitlines()
        raise Error(f"{what} failed with exit code {done.returncode}: " + "\n".join(text[-12:]))
    return done.stdout


@dataclasses.dataclass(frozen=True)
class Board:
    """A board and the memories that a network may use on it."""

    path: pathlib.Path
    name: str
    l1: int
    l2: int
    cores: int
    is_gap8: bool  # has GAP8's own devices
    flies: bool  # has a flight link
    has_l3: bool  # has HyperRAM and HyperFlash at GAP8's uDMA


def board(name: str) -> Board:
    """Returns a board that MEbots contains, or reads one from a file."""
    path = pathlib.Path(name)
    if path.suffix != ".json":
        path = data_folder() / "configs/boards" / f"{name}.json"
    try:
        content = json.loads(path.read_text())
    except (OSError, ValueError) as error:
        known = ", ".join(sorted(one.stem for one in (data_folder() / "configs/boards").glob("*.json")))
        raise InputError(f"board {name} cannot be read: {error}. MEbots has: {known}", "unknown_name") from error
    sizes = {one["name"]: one["size"] for one in content.get("memories", [])}
    if "l1" not in sizes or "l2" not in sizes:
        raise InputError(f"board {path}: has no memories l1 and l2, which a network on the cluster needs", "invalid_board")
    devices = content.get("devices", [])
    return Board(
        path,
        content["name"],
        sizes["l1"],
        sizes["l2"],
        int(content.get("cluster_cores", 8)),
        any(one.get("kind") == "gap8_event_unit" for one in devices),
        any(one.get("name") == "flight" for one in devices),
        any(one.get("kind") == "gap8_udma" for one in devices),
    )


class Build:
    """Builds the programs that check a network, in a separate folder."""

    def __init__(self, library: pathlib.Path, scratch: pathlib.Path, on: Board, kernels: Sequence[str], objects: pathlib.Path | None = None) -> None:
        """``kernels``: sources of the kernels that the network needs."""
        self._library = library
        self._scratch = scratch
        self._objects = objects or scratch
        self._board = on
        self._kernels = kernels
        self._firmware = data_folder() / "fmu_soc/firmware"

    def _shared(self) -> list[pathlib.Path]:
        """Returns the sources of the kernels. They are the same for all networks whose weights are in the same memory, L2 or L3."""
        return [self._firmware / "kernels" / one for one in self._kernels]

    def _own(self) -> list[pathlib.Path]:
        return [self._firmware / "kernels/check.c", self._library / "network.c", self._library / "network_weights.S"]

    def host(self) -> pathlib.Path:
        gcc = shutil.which("cc") or shutil.which("gcc")
        if gcc is None:
            raise InputError("no C compiler (cc, gcc) was found: install gcc", "not_offered")
        out = self._scratch / "check_host"
        objects = [self._compiled([gcc, "-O2", "-w"], source, "host") for source in self._shared()]
        run_program([gcc, "-std=c11", "-O2", "-w", f"-I{self._firmware}", f"-I{self._library}", *self._own(), *objects, "-o", out], "compiling for this machine")
        return out

    def _compiled(self, words: list[str], source: pathlib.Path, kind: str) -> pathlib.Path:
        """Compiles a shared source unless its object file exists."""
        out = self._objects / f"{kind}_{source.name}.o"
        if not out.exists():
            standard = ["-std=c11"] if source.suffix == ".c" else []
            new = self._objects / f"{out.name}.{os.getpid()}"  # another process may compile it at the same time
            run_program([*words, *standard, *self._folders(), "-c", source, "-o", new], f"compiling {source.name}")
            os.replace(new, out)
        return out

    def chip(self) -> pathlib.Path:
        """Builds the program that checks and measures the network."""
        gcc = compiler()
        self._make_header()
        return self._link(gcc, self._own(), [*self._runtime(), *self._shared()], "check.elf")

    def pilot(self, name: str, sources: Sequence[str], order: Sequence[int]) -> pathlib.Path:
        """Builds a flight's program. ``order`` contains the index of the network's output for each value that the program needs."""
        gcc = compiler()
        self._make_header()
        (self._scratch / "output_order.h").write_text(f"#define OUTPUT_ORDER {', '.join(map(str, order))}\n")
        shared = [*self._runtime(), *self._shared(), *(self._overlaid(one) for one in sources)]
        return self._link(gcc, [self._firmware / "app/deployed.c", *self._own()[1:]], shared, f"{name}.elf")

    def _runtime(self) -> list[pathlib.Path]:
        more = _GAP8_RUNTIME if self._board.is_gap8 else ()
        return [self._overlaid(f"runtime/{one}") for one in (*_RUNTIME, *more)]

    def _overlaid(self, name: str) -> pathlib.Path:
        """Returns a source file. On a board with GAP8's own devices, prefers the file in gap8/."""
        instead = self._firmware / "gap8" / name
        return instead if self._board.is_gap8 and instead.exists() else self._firmware / name

    def _folders(self) -> list[str]:
        return [f"-I{self._firmware / 'gap8'}"] * self._board.is_gap8 + [f"-I{self._firmware}", f"-I{self._objects}"]

    def _make_header(self) -> None:
        header = self._objects / "board.h"
        if not header.exists():
            new = self._objects / f"board.h.{os.getpid()}"
            run_program([program("mebots-boardgen"), self._board.path, "--c", new], "mebots-boardgen")
            os.replace(new, header)

    def _link(self, gcc: str, own: Sequence[pathlib.Path], shared: Sequence[pathlib.Path], name: str) -> pathlib.Path:
        script = self._scratch / "link.ld"
        header = self._objects / "board.h"
        run_program([gcc, "-E", "-P", "-x", "assembler-with-cpp", "-include", header, self._firmware / "runtime/link.ld.in", "-o", script], "the linker script")
        maps = [f"-ffile-prefix-map={self._firmware}=.", f"-ffile-prefix-map={self._library}=.", f"-ffile-prefix-map={self._objects}=.", f"-ffile-prefix-map={self._scratch}=."]
        objects = [self._compiled([gcc, *_CHIP_OPTIONS, *maps], source, "chip") for source in shared]
        for source in own:
            out = self._scratch / f"{source.name}.o"
            standard = ["-std=c11"] if source.suffix == ".c" else []
            run_program([gcc, *_CHIP_OPTIONS, *maps, *standard, *self._folders(), f"-I{self._library}", f"-I{self._scratch}", "-c", source, "-o", out], f"compiling {source.name}")
            objects.append(out)
        library = run_program([gcc, "-march=rv32im", "-mabi=ilp32", "-print-libgcc-file-name"], "the compiler").strip()
        elf = self._scratch / name
        link: list[str | os.PathLike[str]] = [gcc, "-march=rv32imc", "-mabi=ilp32", "-nostdlib", "-Wl,--gc-sections", "-T", script, *objects, library, "-o", elf]
        try:
            run_program(link, "linking")
        except Error as error:
            raise _too_large(error, self._board) from error
        return elf


def _too_large(error: Error, on: Board) -> Error:
    text = str(error)
    if "overflowed by" not in text:
        return error
    more = text.split("overflowed by")[1].split()[0]
    return InputError(f"the program with this network exceeds L2 of board {on.name} ({on.l2} bytes) by {more} bytes. Use a smaller network or picture", "does_not_fit")


@dataclasses.dataclass(frozen=True)
class Request:
    cores: int
    layers: int  # -1: check of all layers
    bytes: Sequence[int]
    picture: np.ndarray
    clock_hz: int = CLOCK_HZ


@dataclasses.dataclass(frozen=True)
class Program:
    """A program that computes the layers of a network on the chip. ``picture`` is its input, ``bytes`` the size of each layer's output."""

    elf: pathlib.Path
    bytes: Sequence[int]
    picture: np.ndarray
    board: Board
    flash: pathlib.Path | None = None  # content of the flash

    def check(self, cores: int) -> str:
        """Runs all layers and returns the program's output."""
        return run_on_chip(self.elf, Request(cores, -1, self.bytes, self.picture), self.board, flash=self.flash)[0]

    def report(self, cores: int, layers: int, clock_hz: int = CLOCK_HZ, by_cause: bool = False) -> dict[str, Any]:
        """Runs the first ``layers`` layers and returns the chip's report."""
        return run_on_chip(self.elf, Request(cores, layers, self.bytes, self.picture, clock_hz), self.board, by_cause, self.flash)[1]


def with_request(built: pathlib.Path, request: Request, out: pathlib.Path) -> pathlib.Path:
    """Copies the program ``built`` to ``out``, and stores the request at the marked place in the copy."""
    content = bytearray(built.read_bytes())
    at = content.find(_MARK)
    if at < 0 or content.find(_MARK, at + 1) >= 0:
        raise Error(f"{built}: the marked place for the request was not found; build the program again")
    words = struct.pack(f"<{3 + len(request.bytes)}i", request.cores, request.clock_hz, request.layers, *request.bytes) + request.picture.astype(np.uint8).tobytes()
    at += len(_MARK)
    content[at : at + len(words)] = words
    out.write_bytes(bytes(content))
    out.chmod(0o755)
    return out


def run_on_host(built: pathlib.Path, request: Request) -> str:
    copy = with_request(built, request, built.with_name("request_host"))
    return run_program([copy], "the network on this machine")


def run_on_chip(built: pathlib.Path, request: Request, on: Board, by_cause: bool = False, flash: pathlib.Path | None = None) -> tuple[str, dict[str, Any]]:
    """Returns the program's output and the chip's report. If ``by_cause`` is true, the report divides the cycles of functions by cause,
    which takes longer."""
    copy = with_request(built, request, built.with_name("request.elf"))
    report = built.with_name("report.json")
    words: list[str | os.PathLike[str]] = [program("mebots-soc"), "run", copy, "--board", on.path, "--report" if by_cause else "--json", report]
    text = run_program([*words, *(() if flash is None else ("--flash", flash))], "the network on the chip")
    return text, json.loads(report.read_text())

