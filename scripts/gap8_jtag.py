#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The host at GAP8's JTAG, for the flasher of gap_sdk's utils/openocd_tools: a sector is programmed and read back.

    gap8_flash.py MEBOTS_SOC FLASHER [--bytes N]    N pseudo-random bytes from the second sector on, at most 262144

The unmodified flasher runs on board gap8; behind it tests/conformance/gap8/read_flash.S, which is loaded into the same
chip, reads what the flash holds. Memory is read and written by mebots-soc's gdb server; what the words of the bridge mean
is told in gap_flasher.c and flash_image.tcl of gap_sdk. Needs riscv64-unknown-elf-gcc.
"""
import argparse
import pathlib
import random
import re
import socket
import struct
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
BOARD = ROOT / "configs/boards/gap8.json"
READER = ROOT / "tests/conformance/gap8/read_flash.S"
READER_BUFFER = 0x1C020000
BRIDGE_POINTER = 0x1C000090  # where the flasher keeps the address of its bridge
HOST_READY, GAP_READY, BUFFER, RUN, ADDRESS, SIZE = 0, 4, 8, 16, 20, 24
SECTOR = 256 << 10
LONGEST = 1024  # bytes of a packet
SLICE_S = 0.2
MOST_SLICES = 300


class Chip:
    """A program in mebots-soc, stopped but for run()."""

    def __init__(self, soc, program):
        self.process = subprocess.Popen(
            [soc, "run", program, "--board", BOARD, "--gdb", "0"], text=True, stdout=subprocess.PIPE,
            stderr=subprocess.PIPE)
        for line in self.process.stderr:
            if port := re.search(r"127\.0\.0\.1:(\d+)", line):
                break
        else:
            raise SystemExit("mebots-soc named no port")
        self.socket = socket.create_connection(("127.0.0.1", int(port[1])))
        self.buffer = b""

    def receive(self):
        while not (found := re.search(rb"\$([^#]*)#..", self.buffer)):
            got = self.socket.recv(65536)
            if not got:
                raise SystemExit("mebots-soc has ended")
            self.buffer += got
        self.buffer = self.buffer[found.end():]
        self.socket.sendall(b"+")
        return found[1].decode()

    def send(self, text):
        self.socket.sendall(f"${text}#{sum(text.encode()) & 0xFF:02x}".encode())

    def ask(self, text):
        self.send(text)
        answer = self.receive()
        if answer.startswith("E"):
            raise SystemExit(f"{text[:40]}: {answer}")
        return answer

    def read(self, address, count):
        pieces = [self.ask(f"m{address + at:x},{min(LONGEST, count - at):x}") for at in range(0, count, LONGEST)]
        return bytes.fromhex("".join(pieces))

    def write(self, address, data):
        for at in range(0, len(data), LONGEST):
            piece = data[at:at + LONGEST]
            self.ask(f"M{address + at:x},{len(piece):x}:{piece.hex()}")

    def word(self, address):
        return struct.unpack("<I", self.read(address, 4))[0]

    def put(self, address, value):
        self.write(address, struct.pack("<I", value))

    def run(self):
        """For a while."""
        self.send("c")
        self.socket.settimeout(SLICE_S)
        try:
            stopped = self.receive()
            raise SystemExit(f"the program stopped by itself: {stopped}")
        except TimeoutError:
            pass
        self.socket.settimeout(None)
        self.socket.sendall(b"\x03")
        self.receive()

    def run_until(self, what, good):
        for _ in range(MOST_SLICES):
            if good():
                return
            self.run()
        raise SystemExit(f"{what}: this has not come")

    def load(self, program):
        """As a host does it: bytes of the segments, and the pc at the entry."""
        data = program.read_bytes()
        entry, headers = struct.unpack_from("<II", data, 24)
        size, count = struct.unpack_from("<HH", data, 42)
        for i in range(count):
            kind, offset, address, _, in_file, in_memory = struct.unpack_from("<IIIIII", data, headers + i * size)
            if kind == 1:
                self.write(address, data[offset:offset + in_file] + bytes(in_memory - in_file))
        self.ask(f"P20={struct.pack('<I', entry).hex()}")

    def end(self):
        self.send("k")
        self.socket.close()
        self.process.communicate()


def bridge_of(chip):
    chip.run_until("the bridge", lambda: chip.word(BRIDGE_POINTER) not in (0, 0xDEADBEEF)
                   and chip.word(chip.word(BRIDGE_POINTER) + GAP_READY) == 1)
    bridge = chip.word(BRIDGE_POINTER)
    chip.put(bridge + GAP_READY, 0)
    return bridge


def flash(chip, place, data):
    bridge = bridge_of(chip)
    chip.put(bridge + RUN, 1)
    chip.put(bridge + HOST_READY, 1)
    buffer = chip.word(bridge + BUFFER)
    for at in range(0, len(data), SECTOR):
        chip.run_until("the flasher is ready", lambda: chip.word(bridge + GAP_READY) == 1)
        chip.put(bridge + HOST_READY, 0)
        piece = data[at:at + SECTOR]
        if at + SECTOR >= len(data):
            chip.put(bridge + RUN, 0)
        chip.put(bridge + ADDRESS, place + at)
        chip.put(bridge + SIZE, len(piece))
        chip.write(buffer, piece)
        chip.put(bridge + GAP_READY, 0)
        chip.put(bridge + HOST_READY, 1)
    chip.run_until("the flasher is done", lambda: chip.word(bridge + RUN) == 1)


def read_back(chip, count):
    with tempfile.TemporaryDirectory() as folder:
        program = pathlib.Path(folder) / "read_flash.elf"
        subprocess.run(["riscv64-unknown-elf-gcc", "-march=rv32imc_zicsr", "-mabi=ilp32", "-nostdlib", "-nostartfiles",
                        "-Wl,-N", "-Wl,--no-warn-rwx-segments", "-Wl,-Ttext=0x1C000000", READER, "-o", program], check=True)
        chip.load(program)
        symbols = subprocess.run(["riscv64-unknown-elf-nm", program], text=True, capture_output=True, check=True).stdout
    done = int(re.search(r"([0-9a-f]+) \w read_flash_done", symbols)[1], 16)
    chip.run_until("the reader is done", lambda: chip.word(done) != 0)
    return chip.read(READER_BUFFER, count)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("soc", "flasher"):
        parser.add_argument(name, type=pathlib.Path)
    parser.add_argument("--bytes", type=int, default=SECTOR)
    arguments = parser.parse_args()
    if not 0 < arguments.bytes <= SECTOR:
        sys.exit(f"--bytes {arguments.bytes}: 1 to {SECTOR}")
    data = random.Random(8).randbytes(arguments.bytes)
    chip = Chip(arguments.soc, arguments.flasher)
    flash(chip, SECTOR, data)
    read = read_back(chip, len(data))
    chip.end()
    if read != data:
        wrong = next(i for i, (a, b) in enumerate(zip(read, data)) if a != b)
        sys.exit(f"byte {wrong} of {len(data)} read back is 0x{read[wrong]:02x}, not 0x{data[wrong]:02x}")
    print(f"{len(data)} bytes programmed by the flasher and read back")


if __name__ == "__main__":
    main()
