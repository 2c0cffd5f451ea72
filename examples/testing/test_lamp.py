# SPDX-License-Identifier: Apache-2.0
"""Tests lamp.c on the board of this folder. Run: pytest test_lamp.py."""

import pathlib
import subprocess

import pytest

from mebots.testing import Board

HERE = pathlib.Path(__file__).resolve().parent
COMPILER = "riscv64-unknown-elf-gcc"
OPTIONS = ["-march=rv32imc_zicsr", "-mabi=ilp32", "-mcmodel=medany", "-Os", "-g", "-ffreestanding", "-nostdlib", "-Wl,-n,-Ttext=0x80000000"]


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    built = tmp_path_factory.mktemp("lamp") / "lamp.elf"
    subprocess.run([COMPILER, *OPTIONS, HERE / "lamp.c", "-o", built], check=True)
    return built


@pytest.fixture
def lamp(chip, program):
    board = chip(program, board=HERE / "board.json")
    board.wait_for("ready\n", within=0.01)
    return board


def test_the_button_switches_the_lamp(lamp):
    assert lamp.get("lamp.on") == 0
    lamp.press("button.pressed", seconds=0.001)
    lamp.run(0.001)
    assert lamp.get("lamp.on") == 1
    lamp.press("button.pressed", seconds=0.001)
    assert lamp.get("lamp.on") == 0
    assert lamp.read("presses") == 2


def test_answers_a_line_with_its_length(lamp):
    lamp.send("hello, lamp\n")
    assert lamp.wait_for("\n", within=0.01) == "length 11\n"
    lamp.expect(lines=(1, 1), presses=(0, 0), joules=(0, 1e-3), cycles=(100, 2_000_000), seconds=(0, 0.02))


def test_off_ends_the_program(lamp):
    lamp.send("off\n")
    assert lamp.wait_for_end(within=0.01) == 0
    assert lamp.output == "ready\ngood night\n"
    assert not lamp.running


def test_says_what_was_printed_instead(lamp):
    lamp.send("x\n")
    with pytest.raises(AssertionError, match=r"did not print 'length 2' within 0.001 s, but 'length 01"):
        lamp.wait_for("length 2", within=0.001)
    with pytest.raises(AssertionError, match=r"lines = 1, not in \[2, 3\]"):
        lamp.expect(lines=(2, 3))


def test_refuses_offsets_outside_a_variable(lamp):
    with pytest.raises(RuntimeError, match="presses has no bytes to read from offset 4"):
        lamp.read("presses", offset=4)
    with pytest.raises(RuntimeError, match="presses: offset -4 is before its start"):
        lamp.read("presses", offset=-4)


def test_says_at_the_end_that_a_file_cannot_be_written(program):
    board = Board(program, board=HERE / "board.json", options=["--report", "/dev/full"])
    with pytest.raises(RuntimeError, match="/dev/full"):
        board.close()
    board.close()


def test_names_what_the_board_or_program_lacks(chip, lamp, program):
    with pytest.raises(RuntimeError, match="board lamp has no variable lamp.colour"):
        lamp.get("lamp.colour")
    with pytest.raises(RuntimeError, match="has no symbol colour"):
        lamp.read("colour")
    with pytest.raises(RuntimeError, match="no_such_board"):
        chip(program, board="no_such_board")
