#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests `mebots link` without cflib: random datagrams, recordings, and user errors."""

import json
import os
import random
import signal
import socket
import struct
import subprocess
import time
import unittest
import unittest.mock

from mebots import mission
from mebots.errors import InputError
from mebots.link.recording import Recorder
from mebots.link.server import Server
from mebots.link.session import Session, Settings
from support import CONFIG, MEBOTS, LinkCase, free_port

LOCAL = "127.0.0.1"
SUPERVISOR = 9


class Client:
    """A client of a drone's port."""

    def __init__(self, port):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.settimeout(5)
        self.socket.connect((LOCAL, port))

    def close(self):
        self.socket.close()

    def send(self, data):
        self.socket.send(data)

    def answer(self, data, begins=None):
        """Sends a packet. Returns the first answer that starts with `begins`, by default with the first byte of ``data``."""
        self.send(data)
        while True:
            answer = self.socket.recv(64)
            if answer.startswith(data[:1] if begins is None else begins):
                return answer


class Datagrams(LinkCase):
    def client(self, *options, **more):
        client = Client(self.start(*options, **more))
        self.addCleanup(client.close)
        return client

    def test_random_datagrams_neither_stop_nor_slow_the_server(self):
        client = self.client()
        chance = random.Random(1)
        begin = time.monotonic()
        sent = 0
        while time.monotonic() - begin < 8:
            for _ in range(50):
                header = chance.randrange(256)
                if header >> 4 == SUPERVISOR and chance.random() < 0.98:  # after an emergency stop, no more tests are possible
                    continue
                size = chance.choice((0, 1, 2, 3, 5, 9, 17, 18, 24, 29, 30, 30, 31, 200, 1500))
                body = bytes(chance.randrange(14 if chance.random() < 0.3 else 256) for _ in range(size))
                client.send(bytes([header]) + body)
                sent += 1
            client.send(b"")
            time.sleep(0.02)
        self.assertGreater(sent, 5000)
        self.assertTrue(client.answer(b"\xf1\0", b"\xf1").startswith(b"\xf1Bitcraze Crazyflie"))
        printed = self.stop()
        simulated_s = float(printed.split("simulated ")[1].split(" s")[0])
        self.assertGreater(simulated_s, 4)
        self.assertIn(self.recording()[-1]["bits"], self.replay())
        inputs = json.loads((self.out / "summary.json").read_text())["inputs"]
        self.assertLessEqual(len(inputs["writes"]), 1000)  # sessions of hours must not fill the memory

    def test_numbers_that_are_not_finite_are_ignored(self):
        client = self.client()
        for number in (float("nan"), float("inf"), 3e38):
            for kind in range(12):
                client.send(b"\x70" + struct.pack("<Bffff", kind, number, number, number, number))
            for command in range(14):
                client.send(b"\x80" + (bytes([command, 0]) + struct.pack("<ffffff", *[number] * 6))[:30])
            for parameter in range(60):
                client.send(b"\x22" + struct.pack("<Hf", parameter, number))
            time.sleep(0.5)
        self.assertTrue(client.answer(b"\xf1\0", b"\xf1").startswith(b"\xf1Bitcraze Crazyflie"))
        self.stop()

    def test_a_flood_is_cut_as_a_radio_cuts_it(self):
        client = self.client()
        for _ in range(200):
            for _ in range(50):
                client.send(b"\xff")
            time.sleep(0.002)
        self.stop()
        times = [line["ms"] for line in self.recording()[1:-1]]
        self.assertEqual(max(times.count(one) for one in set(times)), 64)
        self.assertIn(self.recording()[-1]["bits"], self.replay())

    def test_a_packet_from_an_own_port_is_ignored(self):
        session = Session(CONFIG, Settings(drones=2), None)
        self.addCleanup(session.close)
        port = free_port(2)
        server = Server(session, LOCAL, port, None)
        self.addCleanup(server.close)
        self.assertTrue(server._is_own((LOCAL, port + 1)))
        self.assertFalse(server._is_own((LOCAL, port + 2)))
        self.assertFalse(server._is_own(("192.0.2.1", port + 1)))  # address for documentation, RFC 5737
        server._sockets[1].sendto(b"\xff", (LOCAL, port))
        server._receive(time.monotonic() + 0.05)
        self.assertEqual(server._clients, [None, None])

    def test_a_world_has_as_many_linked_drones_as_its_count(self):
        for settings, count in ((Settings(), 4), (Settings(set={"world.drone.count": 3}), 3), (Settings(drones=2), 8)):
            session = Session(CONFIG.with_name("link_4.json"), settings, None)
            self.addCleanup(session.close)
            self.assertEqual(len(session.drones), count)

    def test_a_config_whose_connected_drones_do_not_exist_is_refused(self):
        content = json.loads(CONFIG.with_name("link_4.json").read_text())
        content["$schema"] = str(CONFIG.with_name("schemas") / "mebots-config.schema.json")
        content["groups"]["drones"] = {"i": [3, 4]}
        content["instances"]["world"]["parameters"][0]["drone.count"] = 2
        config = self.folder / "link_3_4.json"
        config.write_text(json.dumps(content))
        with self.assertRaisesRegex(InputError, "link_3_4.json: no drone .* exists in: world; set drone.count to at least 3"):
            Session(config, Settings(), None)

    def test_a_full_recording_ends_the_run(self):
        session = Session(CONFIG, Settings(), None)
        self.addCleanup(session.close)
        recorder = Recorder(self.folder / "link.jsonl", Settings(), most_bytes=2000)
        self.addCleanup(recorder.close, 0, "")
        port = free_port()
        server = Server(session, LOCAL, port, recorder)
        self.addCleanup(server.close)
        client = Client(port)
        self.addCleanup(client.close)
        for _ in range(60):
            client.send(b"\xff")
        server.serve(20, lambda: False)
        self.assertTrue(recorder.is_full)
        self.assertLess(session.time_ms, 1000)

    def test_a_drone_waits_for_its_first_packet(self):
        client = self.client("--idle", "0.5")
        time.sleep(1)
        self.assertIsNone(self.server.poll())
        self.assertEqual(client.answer(b"\xff", b"")[0] >> 4, 15)
        self.end()
        self.assertEqual(self.recording()[1], {"ms": 0, "drone": 1, "packet": "f3"})


    def test_a_config_with_repeated_worlds_has_a_drone_for_each(self):
        content = json.loads(CONFIG.read_text())
        del content["$schema"], content["view"], content["summary"], content["outcomes"]
        one = {"i": [1, 2]}
        content["instances"] = {f"{name}[{{i}}]": {"repeat": one, **instance} for name, instance in content["instances"].items()}
        content["connections"] = [
            {"repeat": one, **{side: name.replace(".", "[{i}].", 1) for side, name in end.items()}} for end in content["connections"]
        ]
        file = self.folder / "two.json"
        file.write_text(json.dumps(content))
        port = self.start("--idle", "0.5", config=file)
        self.assertIn(f"drone 2: udp://{LOCAL}:{port + 1}", self.server.stdout.readline())
        for number in range(2):
            client = Client(port + number)
            self.addCleanup(client.close)
            self.assertEqual(client.answer(b"\xff", b"")[0] >> 4, 15)
        self.end()
        self.assertEqual([line["drone"] for line in self.recording()[1:3]], [1, 2])


class Interrupts(LinkCase):
    def test_a_signal_shortens_no_period(self):
        requests = []
        before = signal.signal(signal.SIGINT, lambda *_: requests.append(True))
        self.addCleanup(signal.signal, signal.SIGINT, before)
        interrupt_s = 0.102  # in a period, at the first of its five communication points

        class Interrupted(mission.Mission):
            def start(self):
                self.on_point(lambda time_s: os.kill(os.getpid(), signal.SIGINT) if abs(time_s - interrupt_s) < 1e-6 else None)
                super().start()

        with unittest.mock.patch("mebots.link.session.Mission", Interrupted):
            session = Session(CONFIG, Settings(), None)
        self.addCleanup(session.close)
        while not requests:
            session.advance()
        self.assertEqual(session.time_ms, 110)
        self.assertFalse(session.ended, session.end_text)
        again = Session(CONFIG, Settings(), None)
        self.addCleanup(again.close)
        while again.time_ms < session.time_ms:
            again.advance()
        self.assertEqual(again.fingerprint, session.fingerprint)


class Recordings(LinkCase):
    HEAD = {"mebots": "0", "drones": 1, "spacing": 1.0, "decks": [], "set": {}, "stop_time": None}

    def write(self, *lines):
        self.out.mkdir(exist_ok=True)
        (self.out / "link.jsonl").write_text("".join(json.dumps(line) + "\n" for line in (self.HEAD, *lines)))

    def test_wrong_lines_are_named(self):
        for lines, said in (
            ([{"ms": 10, "drone": 1, "packet": "zz"}], ":2:"),
            ([{"ms": 10, "drone": 0, "packet": "ff"}], "drone 0"),
            ([{"ms": 15, "drone": 1, "packet": "ff"}], "multiple of 10"),
            ([{"ms": 20, "drone": 1, "packet": "ff"}, {"ms": 10, "drone": 1, "packet": "ff"}], ":3:"),
            ([{"ms": 20, "drone": 1}], "'packet'"),
            ([{"end_ms": 0, "bits": ""}, {"end_ms": 0, "bits": ""}], "after the end"),
            ([[]], ":2:"),
        ):
            self.write(*lines)
            self.assertIn(said, self.replay(code=2))
        self.write({"ms": 10, "drone": 2, "packet": "ff"})
        self.assertIn("drone 2", self.replay(code=2))
        (self.out / "link.jsonl").write_text("")
        self.assertIn("empty", self.replay(code=2))

    def test_a_recording_without_an_end_is_repeated_as_far_as_it_goes(self):
        self.write({"ms": 500, "drone": 1, "packet": "ff"})
        with open(self.out / "link.jsonl", "a") as file:
            file.write('{"ms": 600, "dro')
        self.assertIn("simulated 0.5 s", self.replay())

    def test_settings_are_those_of_the_recording(self):
        self.write()
        self.assertIn("leave out", self.replay("--drones", "2", code=2))

    def test_other_bits_are_an_error(self):
        self.write({"end_ms": 100, "bits": "0123456789abcdef"})
        self.assertIn("had the bits 0123456789abcdef", self.replay(code=1))


class Mistakes(LinkCase):
    def refused(self, *options, config=CONFIG):
        done = subprocess.run([MEBOTS, "link", str(config), "--out", str(self.folder / "refused"), *options], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        return done.stderr

    def changed(self, change):
        content = json.loads(CONFIG.read_text())
        del content["$schema"]
        change(content)
        file = self.folder / "changed.json"
        file.write_text(json.dumps(content))
        return file

    def test_rotor_commands_may_have_several_targets(self):
        def watched(content):
            content["instances"]["spare"] = content["instances"]["motors"]
            content["connections"].append({"from": "world.rotor[1].command", "to": "spare.rotor[1].command"})

        self.start(config=self.changed(watched))
        self.stop()

    def test_a_config_may_begin_at_another_time(self):
        self.start("--idle", "0.1", config=self.changed(lambda content: content.update(start_time=5, stop_time=6)))
        self.assertIn("simulated 0 s", self.stop())
        file = self.changed(lambda content: content.update(start_time=5, stop_time=6))
        session = Session(file, Settings(), None)
        self.addCleanup(session.close)
        session.advance()
        self.assertAlmostEqual(session._missions[0].time, 5.01, places=9)

    def test_configs_that_cannot_be_linked_say_why(self):
        self.assertIn("divides 10 ms", self.refused(config=self.changed(lambda content: content.update(step=0.004))))
        self.assertIn("fmu_world", self.refused(config=CONFIG.with_name("battery_motors.json")))

        def unfed(content):
            content["connections"] = [end for end in content["connections"] if end["to"] != "motors.bus.voltage"]

        self.assertIn("no battery feeds", self.refused(config=self.changed(unfed)))

    def test_options_are_checked(self):
        self.assertIn("bcFlow2", self.refused("--decks", "bcFlow3"))
        self.assertIn("nothing.at.all", self.refused("--set", "nothing.at.all=1"))
        port = self.start()
        self.assertIn("cannot be opened", self.refused("--port", str(port)))


if __name__ == "__main__":
    unittest.main()
