#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Acts as the host at GAP8's JTAG for programs of gap_sdk's utils/openocd_tools. These programs run unmodified on board gap8.

    gap8_jtag.py flash MEBOTS_SOC FLASHER [--bytes N]    N pseudo-random bytes from the second sector on, at most 262144;
                                                         tests/conformance/gap8/read_flash.S, which is loaded into the
                                                         same chip, reads them back
    gap8_jtag.py dump MEBOTS_SOC DUMPER IMAGE            the flash contains IMAGE: its first two sectors are dumped
    gap8_jtag.py fuse MEBOTS_SOC FUSER                   bits of two fuses are programmed, and all 1024 read

Uses mebots-soc's gdb server to read and write memory. gap_flasher.c, gap_dumper.c and tcl/fuser.tcl of gap_sdk define the words
of the bridges. `flash` needs riscv64-unknown-elf-gcc.
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
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
BOARD = ROOT / "configs/boards/gap8.json"
READER = ROOT / "tests/conformance/gap8/read_flash.S"
READER_BUFFER = 0x1C020000
BRIDGE_POINTER = 0x1C000090  # address at which flasher and dumper store the address of their bridge
FUSER_POINTER = 0x1C000190
FUSES = 128  # number of bytes
HOST_READY, GAP_READY, BUFFER, RUN, ADDRESS, SIZE = 0, 4, 8, 16, 20, 24
SECTOR = 256 << 10
LONGEST = 1024  # maximum number of bytes in a packet
SLICES_S = (0.02, 1.0)  # duration of the first slice of a run, and of the longest slice
LONGEST_WAIT_S = 120


class Chip:
    """A program in mebots-soc. The program is stopped except during run()."""

    def __init__(self, soc, program, *options):
        self.said = tempfile.TemporaryFile("a+")  # a file, because a full pipe without a reader would stop the program
        self.process = subprocess.Popen(
            [soc, "run", program, "--board", BOARD, "--gdb", "0", *options], text=True, stdout=subprocess.DEVNULL,
            stderr=self.said)
        self.socket = socket.create_connection(("127.0.0.1", self.port()))
        self.buffer = b""

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        self.said.close()

    def port(self):
        while True:
            ended = self.process.poll() is not None
            self.said.seek(0)
            said = self.said.read()
            if port := re.search(r"127\.0\.0\.1:(\d+)\n", said):
                return int(port[1])
            if ended:
                raise SystemExit(f"mebots-soc named no port: {said}")
            time.sleep(0.05)

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

    def run(self, seconds):
        self.send("c")
        self.socket.settimeout(seconds)
        try:
            stopped = self.receive()
            raise SystemExit(f"the program stopped by itself: {stopped}")
        except TimeoutError:
            pass
        self.socket.settimeout(None)
        self.socket.sendall(b"\x03")
        self.receive()

    def run_until(self, what, good):
        end = time.monotonic() + LONGEST_WAIT_S
        slice_s = SLICES_S[0]
        while not good():
            if time.monotonic() > end:
                raise SystemExit(f"{what}: this has not come in {LONGEST_WAIT_S} s")
            self.run(slice_s)
            slice_s = min(2 * slice_s, SLICES_S[1])

    def load(self, program):
        """Loads a program as a host does: writes the segments and sets the pc to the entry."""
        data = program.read_bytes()
        entry, headers = struct.unpack_from("<II", data, 24)
        size, count = struct.unpack_from("<HH", data, 42)
        for i in range(count):
            kind, offset, address, _, in_file, in_memory = struct.unpack_from("<IIIIII", data, headers + i * size)
            if kind == 1:
                self.write(address, data[offset:offset + in_file] + bytes(in_memory - in_file))
        self.ask(f"P20={struct.pack('<I', entry).hex()}")

    def end(self):
        """Ends the run as gdb's kill does."""
        self.send("k")
        self.socket.close()
        self.process.wait(LONGEST_WAIT_S)


def bridge_at(chip, pointer, ready):
    """Waits until the program has created its bridge and set the word at `ready` to 1. Returns the bridge's address. A
    bridge is a struct in the chip's memory through which a program and its host communicate."""
    chip.run_until("the bridge", lambda: chip.word(pointer) not in (0, 0xDEADBEEF)
                   and chip.word(chip.word(pointer) + ready) == 1)
    return chip.word(pointer)


def sector_bridge(chip):
    """Returns the addresses of flasher's or dumper's bridge and of its buffer. Clears the bridge's ready flag and sets its run
    flag."""
    bridge = bridge_at(chip, BRIDGE_POINTER, GAP_READY)
    chip.put(bridge + GAP_READY, 0)
    chip.put(bridge + RUN, 1)
    return bridge, chip.word(bridge + BUFFER)


def flash(chip, place, data):
    bridge, buffer = sector_bridge(chip)
    chip.put(bridge + HOST_READY, 1)
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


def dump(chip, place, count):
    bridge, buffer = sector_bridge(chip)
    pieces = []
    for at in range(0, count, SECTOR):
        size = min(SECTOR, count - at)
        chip.put(bridge + ADDRESS, place + at)
        chip.put(bridge + SIZE, size)
        chip.put(bridge + HOST_READY, 1)
        chip.run_until("the dumper is ready", lambda: chip.word(bridge + GAP_READY) == 1)
        chip.put(bridge + HOST_READY, 0)
        pieces.append(chip.read(buffer, size))
        if at + SECTOR >= count:
            chip.put(bridge + RUN, 0)
        chip.put(bridge + GAP_READY, 0)
    chip.run_until("the dumper is done", lambda: chip.word(bridge + RUN) == 1)
    return b"".join(pieces)


class Fuser:
    """Reads and programs fuses through the program gap_fuser. Requests go through its bridge in the chip's memory."""

    TO_CHIP, TO_HOST, COMMAND, BIT, COUNT, STATUS, BITS = 8, 12, 16, 20, 24, 28, 36
    READ, PROGRAM = 0, 1
    READY, DONE = 1, 2

    def __init__(self, chip):
        self.chip = chip
        self.bridge = bridge_at(chip, FUSER_POINTER, self.TO_HOST)

    def ask(self, command, bit, count):
        """Sends a command. Returns the program's status, which is 0 for success."""
        for offset, value in ((self.BIT, bit), (self.COUNT, count), (self.COMMAND, command), (self.TO_HOST, 0),
                              (self.TO_CHIP, 1)):
            self.chip.put(self.bridge + offset, value)
        self.chip.run_until("the fuser is done", lambda: self.chip.word(self.bridge + self.TO_HOST) == self.DONE)
        return self.chip.word(self.bridge + self.STATUS)

    def program(self, bit, bits):
        self.chip.write(self.bridge + self.BITS, bits)
        return self.ask(self.PROGRAM, bit, 8 * len(bits))

    def read(self):
        if status := self.ask(self.READ, 0, 8 * FUSES):
            raise SystemExit(f"reading the fuses: status {status}")
        return self.chip.read(self.bridge + self.BITS, FUSES)


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


def compare(read, data):
    if read != data:
        wrong = next(i for i, (a, b) in enumerate(zip(read, data)) if a != b)
        raise SystemExit(f"byte {wrong} of {len(data)} read back is 0x{read[wrong]:02x}, not 0x{data[wrong]:02x}")


def run_flash(arguments):
    data = random.Random(8).randbytes(arguments.bytes)
    with Chip(arguments.soc, arguments.program) as chip:
        flash(chip, SECTOR, data)
        read = read_back(chip, len(data))
        chip.end()
    compare(read, data)
    return f"{len(data)} bytes programmed by the flasher and read back"


def run_dump(arguments):
    data = arguments.image.read_bytes()[:2 * SECTOR]
    with Chip(arguments.soc, arguments.program, "--flash", arguments.image) as chip:
        read = dump(chip, 0, len(data))
        chip.end()
    compare(read, data)
    return f"{len(data)} bytes of the flash dumped, those of the image"


def run_fuse(arguments):
    """Programs the fuses that make a GAPuino boot from its HyperFlash, as fuser.tcl does: 0x10 in the first fuse, and 1 in the
    fuse at bit 296."""
    with Chip(arguments.soc, arguments.program) as chip:
        fuser = Fuser(chip)
        wanted = bytearray(FUSES)
        compare(fuser.read(), wanted)
        for bit, value in ((0, 0x10), (296, 0x01)):
            wanted[bit // 8] = value
            if status := fuser.program(bit, bytes([value])):
                raise SystemExit(f"programming {value:#x} at bit {bit}: status {status}")
        compare(fuser.read(), wanted)
        if fuser.program(0, b"\x00") == 0:
            raise SystemExit("the fuser let a bit be programmed back to 0")
        compare(fuser.read(), wanted)
        chip.end()
    return f"2 fuses programmed, {FUSES} read back, one back to 0 refused by the program"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for name, function in (("flash", run_flash), ("dump", run_dump), ("fuse", run_fuse)):
        command = commands.add_parser(name)
        command.set_defaults(function=function)
        command.add_argument("soc", type=pathlib.Path)
        command.add_argument("program", type=pathlib.Path)
        if name == "flash":
            command.add_argument("--bytes", type=int, default=SECTOR)
        if name == "dump":
            command.add_argument("image", type=pathlib.Path)
    arguments = parser.parse_args()
    if not 0 < getattr(arguments, "bytes", 1) <= SECTOR:
        sys.exit(f"--bytes {arguments.bytes}: 1 to {SECTOR}")
    print(arguments.function(arguments))


if __name__ == "__main__":
    main()
