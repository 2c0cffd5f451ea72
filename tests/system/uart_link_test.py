# SPDX-License-Identifier: Apache-2.0
"""Runs configs/gate_easy_uart.json. The AI-deck sends its set-points by UART to the flight controller's chip.

Usage: uart_link_test.py MEBOTS

Checks the times of the bytes: a byte has ten bits, so it ends 10 / 115200 s after the previous byte. Checks the frame's checksum
with another implementation, binascii.
"""
import binascii
import csv
import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
CONFIGS = ROOT / "configs"
BYTE_PS = round(10e12 / 115200)
STEP_PS = 10**9
FRAME = struct.Struct("<BBBiiiH")
SETPOINTS = {"mode": 1, "velocity.x": 1e6, "yaw_rate": 1e6, "altitude": 1e6}
MODES = {"off": 0, "take_off": 1, "fly": 2, "land": 3}


CUT_S = 6


def config_file(folder, name, scenario=None):
    """Writes a config of the mission that records the bytes on the UART and the set-points at every communication point."""
    config = json.loads((CONFIGS / "gate_easy_uart.json").read_text(encoding="utf-8"))
    config["changes"]["record"] = {"variables": ["*.uart.*", "*.setpoint.*", "fc.companion.*", "*.cycles", "world.drone.phase"],
                                   "texts": True, "interval": 0.001, "exclude": None}
    if scenario:
        config["changes"]["scenario"] = scenario
    (folder / "gate_easy.json").write_bytes((CONFIGS / "gate_easy.json").read_bytes())
    (folder / f"{name}.json").write_text(json.dumps(config), encoding="utf-8")
    return folder / f"{name}.json"


class Mission:
    """The results of a run."""

    def __init__(self, out):
        with (out / "results.csv").open(encoding="utf-8") as file:
            self.rows = [{key.split(" [")[0]: value for key, value in row.items()} for row in csv.DictReader(file)]
        self.summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))

    def line(self, sender):
        """Returns (end of the stop bit [ps], value) of each byte that `sender` has sent on the UART. Checks that the recorded
        byte numbers are consecutive."""
        found = []
        for index, row in enumerate(self.rows):
            words = row[f"{sender}.uart.sent"].split()
            if not words:
                continue
            assert int(words[0]) == len(found), f"byte {words[0]} after {len(found)} bytes"
            for word in words[1:]:
                if not word.startswith("="):
                    value, end = word.split("@")
                    found.append(((index - 1) * STEP_PS + int(end), int(value, 16)))
        return found

    def setpoint(self, instance, row):
        values = [self.rows[row][f"{instance}.setpoint.{name}"] for name in SETPOINTS]
        return tuple(round(MODES[value] if value in MODES else float(value) * scale) for value, scale in zip(values, SETPOINTS.values()))


def fly(mebots, folder, name, *options, scenario=None):
    out = folder / name
    subprocess.run([mebots, "run", str(config_file(folder, name, scenario)), "--out", str(out), "--quiet", *options], check=True)
    return Mission(out)


def fly_with_a_kill(mebots, folder):
    """Kills a run after its second checkpoint, and resumes the run."""
    out = folder / "killed"
    run = subprocess.Popen([mebots, "run", str(config_file(folder, "killed")), "--out", str(out), "--quiet", "--stop-time", "6",
                            "--checkpoint-every", "2"])
    checkpoint = out / "checkpoint.bin"
    seen = set()
    while len(seen) < 2:
        assert run.poll() is None, "the run has ended before its second checkpoint"
        if checkpoint.exists():
            seen.add(checkpoint.stat().st_ino)
        time.sleep(0.005)
    run.kill()
    assert run.wait() < 0, "the run has ended before it was killed"
    subprocess.run([mebots, "resume", str(out), "--quiet"], check=True)
    return Mission(out)


def frames_of(line):
    """Returns (end of the last byte [ps], set-point) of each frame on a line without errors."""
    frames = []
    for first in range(0, len(line) - len(line) % FRAME.size, FRAME.size):
        ends, values = zip(*line[first:first + FRAME.size])
        mark, number, mode, velocity, yaw_rate, altitude, checksum = FRAME.unpack(bytes(values))
        assert mark == 0xA5 and number == len(frames) % 256, f"frame {len(frames)} has mark {mark:#x} and number {number}"
        assert checksum == binascii.crc_hqx(bytes(values[:-2]), 0xFFFF), f"frame {number} has a wrong checksum"
        for before, after in zip(ends, ends[1:]):
            assert after - before == BYTE_PS, f"{after - before} ps from byte to byte instead of {BYTE_PS}"
        frames.append((ends[-1], (mode, velocity, yaw_rate, altitude)))
    return frames


def check_delays(mission, frames):
    """Checks the step in which each set-point takes effect. A frame arrives one step after the end of its last byte. The
    controller's loop, which reads the line, starts 0.1 ms after a sample of the IMU and takes less than 0.1 ms. Therefore the
    controller uses the set-point at the end of the step that contains the first loop after the frame's arrival.
    """
    for end, setpoint in frames:
        arrival = end + STEP_PS
        loop = (arrival - STEP_PS // 10 + STEP_PS - 1) // STEP_PS * STEP_PS + STEP_PS // 10
        row = loop // STEP_PS + 1
        if row < len(mission.rows):
            assert mission.setpoint("fc", row) == setpoint, f"{mission.setpoint('fc', row)} at row {row} instead of {setpoint}"


def check_line(mission):
    summary = mission.summary
    line = mission.line("soc")
    frames = frames_of(line)
    check_delays(mission, frames)
    sent = [setpoint for _, setpoint in frames]
    assert {mode for mode, *_ in sent} == {1, 2, 3}, "all modes are on the line"
    assert summary["link"]["frames_lost"] == 0 and summary["link"]["bytes_lost"] == 0 and not summary["link"]["silent"], summary["link"]
    assert len(frames) - 1 <= summary["link"]["frames"] <= len(frames), f"{len(frames)} frames, {summary['link']['frames']} valid"
    end = float(mission.rows[-1]["time"])
    for name, chip in (("AI-deck", "soc"), ("flight controller", "fc")):
        load = float(mission.rows[-1][f"{chip}.cycles"]) / (100e6 * end)
        print(f"load of the {name}: {100 * load:.2f} % of 100 MHz; {len(frames)} frames in {end:.1f} s")
        assert 1e-5 < load < 0.1, f"load {load}"


def check_cut(mission):
    """From CUT_S on, no complete byte arrives. The controller keeps its set-points for a second, and then lands."""
    def changes(name):
        return [row for row in range(1, len(mission.rows)) if mission.rows[row][name] != mission.rows[row - 1][name]]

    last = changes("fc.companion.frames")[-1]
    landing = changes("fc.companion.silent")[-1]
    assert last <= 1000 * CUT_S + 5, f"a frame at {last} ms"
    assert mission.setpoint("fc", landing - 1) == mission.setpoint("fc", last), "the set-points hold"
    assert mission.setpoint("fc", landing)[0] == MODES["land"], mission.setpoint("fc", landing)
    assert 1000 <= landing - last <= 1002, f"landing {landing - last} ms after the last frame"
    assert mission.summary["landed"] and not mission.summary["crashed"] and mission.summary["link"]["silent"], mission.summary


def main():
    mebots = sys.argv[1]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        clean = fly(mebots, folder, "clean", "--expect", "passed")
        check_line(clean)
        for again in (fly_with_a_kill(mebots, folder), fly(mebots, folder, "isolated", "--isolate", "--stop-time", "3")):
            assert len(again.rows) > 2000, f"{len(again.rows)} rows"
            assert again.rows == clean.rows[:len(again.rows)], "another run has other bits"
        noisy = fly(mebots, folder, "noisy", "--expect", "passed", "--set", "fc.uart.error_rate=0.002")
        assert noisy.summary["link"]["frames_lost"] > 0, "no frame was lost"
        print(f"with 0.2 % wrong bytes: {noisy.summary['link']}")
        cut = fly(mebots, folder, "cut", scenario=[{"text": "line cut", "variable": "fc.uart.error_rate", "set": 1, "from": CUT_S}])
        check_cut(cut)


if __name__ == "__main__":
    main()
