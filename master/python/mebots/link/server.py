# SPDX-License-Identifier: Apache-2.0
"""Serves a UDP port for each drone. Simulated time follows the wall clock."""

from __future__ import annotations

import functools
import selectors
import socket
import sys
import time
from collections.abc import Callable

from mebots.errors import InputError
from mebots.link.control import PERIOD_MS
from mebots.link.crtp import Packet
from mebots.link.recording import Event, Recorder
from mebots.link.session import Session

_PERIOD_S = PERIOD_MS / 1000.0
_MOST_BEHIND_S = 0.4  # less than the 0.5 s after which a drone without set-points levels out
_REPORT_S = 5.0
_FLUSH_MS = 1000
_WAIT_S = 0.2
_MOST_IN_PERIOD = 64  # per drone; a radio transfers about 10
_DATAGRAM_BYTES = 2048


class Pace:
    """Determines the wall-clock time at which each period starts. After a delay of up to 0.4 s, the simulation catches up. A longer delay
    also delays all later periods."""

    def __init__(self, clock: Callable[[], float], report: Callable[[str], None]) -> None:
        self._clock = clock
        self._report = report
        self._deadline_s = clock()
        self._window_s = self._deadline_s
        self._periods = 0
        self._slipped = False

    def next_deadline_s(self) -> float:
        self._deadline_s += _PERIOD_S
        return self._deadline_s

    def note_period(self) -> None:
        now_s = self._clock()
        self._periods += 1
        if now_s - self._deadline_s > _MOST_BEHIND_S:
            self._deadline_s = now_s
            self._slipped = True
        passed_s = now_s - self._window_s
        if passed_s < _REPORT_S:
            return
        if self._slipped:
            self._report(f"the simulation is slower than the wall clock: {self._periods * _PERIOD_S / passed_s:.2f} x real time")
        self._window_s, self._periods, self._slipped = now_s, 0, False


class Server:
    """Answers on the ports from ``port``, one per drone. A drone without power closes its port, so that a client notices the failure.

    :param recorder: records every packet; None = no recording.
    """

    def __init__(self, session: Session, host: str, port: int, recorder: Recorder | None) -> None:
        self._session = session
        self._recorder = recorder
        self._selector = selectors.DefaultSelector()
        self._sockets: list[socket.socket | None] = []
        self._clients: list[tuple | None] = [None] * len(session.drones)
        self._left = [_MOST_IN_PERIOD] * len(session.drones)  # number of packets that each drone may still receive in this period
        self._own_ports = range(port, port + len(session.drones))
        self._heard_s = time.monotonic()
        for index in range(len(session.drones)):
            self._open(index, host, port + index)

    def serve(self, idle_s: float | None, is_stopped: Callable[[], bool]) -> None:
        """Waits for the first datagram. Then runs until the missions end, ``is_stopped`` returns True, no datagram arrives for ``idle_s``,
        or the recording is full."""
        while not is_stopped() and not self._selector.select(_WAIT_S):
            pass
        self._heard_s = time.monotonic()
        pace = Pace(time.monotonic, _notice)
        while not is_stopped() and not self._session.ended:
            if idle_s is not None and time.monotonic() - self._heard_s > idle_s:
                return
            if self._recorder is not None and self._recorder.is_full:
                _notice(f"the recording has reached its largest size at {self._session.time_ms / 1000.0:g} s; the run ends")
                return
            self._begin_period()
            self._receive(pace.next_deadline_s())
            for index, packet in self._session.advance():
                self._send(index, packet)
            self._close_unpowered()
            if self._recorder is not None and self._session.time_ms % _FLUSH_MS == 0:
                self._recorder.flush()
            pace.note_period()

    def close(self) -> None:
        for index in range(len(self._sockets)):
            self._close(index)
        self._selector.close()

    def _open(self, index: int, host: str, port: int) -> None:
        try:
            opened = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            self._sockets.append(opened)
            opened.bind((host, port))
        except (OSError, OverflowError) as error:
            self.close()
            raise InputError(f"--host {host} --port {port}: the port cannot be opened: {error}; name another one", "invalid_argument") from None
        opened.setblocking(False)
        self._selector.register(opened, selectors.EVENT_READ, index)

    def _begin_period(self) -> None:
        for index, opened in enumerate(self._sockets):
            if opened is not None and self._left[index] == 0:
                self._selector.register(opened, selectors.EVENT_READ, index)
            self._left[index] = _MOST_IN_PERIOD

    def _receive(self, deadline_s: float) -> None:
        """Answers datagrams until the deadline, so that a flood of datagrams does not stop simulated time."""
        while True:
            ready = self._selector.select(max(deadline_s - time.monotonic(), 0.0))
            for key, _ in ready:
                self._read(key.data)
            if not ready or time.monotonic() >= deadline_s:
                return

    def _read(self, index: int) -> None:
        opened = self._sockets[index]
        assert opened is not None
        while self._left[index] > 0:
            try:
                datagram, client = opened.recvfrom(_DATAGRAM_BYTES)
            except OSError:  # no more datagrams
                return
            self._left[index] -= 1
            if self._left[index] == 0:  # later packets stay in the socket until the next period
                self._selector.unregister(opened)
            packet = Packet.parse(datagram)
            if packet is None or self._is_own(client):
                continue
            self._heard_s = time.monotonic()
            self._clients[index] = client
            if self._recorder is not None:
                self._recorder.write(Event(self._session.time_ms, index, packet))
            for answer in self._session.handle(index, packet):
                self._send(index, answer)

    def _is_own(self, client: tuple) -> bool:
        """True if the sender's address is an address of this server, which must be forged. If the server answered, two drones would answer
        each other without end."""
        return client[1] in self._own_ports and _is_local(client[0])

    def _send(self, index: int, packet: Packet) -> None:
        opened, client = self._sockets[index], self._clients[index]
        if opened is None or client is None:
            return
        try:
            opened.sendto(packet.encode(), client)
        except OSError:
            pass  # the buffer is full; the packet is lost, as with a radio

    def _close_unpowered(self) -> None:
        for index, drone in enumerate(self._session.drones):
            if self._sockets[index] is not None and not drone.is_powered:
                _notice(f"drone {index + 1} has lost its supply at {self._session.time_ms / 1000.0:g} s")
                self._close(index)

    def _close(self, index: int) -> None:
        opened = self._sockets[index]
        if opened is None:
            return
        if opened in self._selector.get_map():
            self._selector.unregister(opened)
        opened.close()
        self._sockets[index] = None


@functools.lru_cache(maxsize=64)
def _is_local(address: str) -> bool:
    """True if the address belongs to this computer. Only such an address can be bound to a socket."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind((address, 0))
        except OSError:
            return False
    return True


def _notice(text: str) -> None:
    print(f"mebots link: {text}", file=sys.stderr, flush=True)
