# SPDX-License-Identifier: Apache-2.0
"""Makes a film of a run's page: Chromium draws the page frame by frame, and ffmpeg encodes the film.

The connection to Chromium is a pipe (--remote-debugging-pipe). No further program is necessary, and no other program can connect to
Chromium.
"""

from __future__ import annotations

import base64
import contextlib
import fcntl
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator
from typing import Any

from mebots.errors import Error, InputError

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
WIDTH, HEIGHT = 1280, 720
PATIENCE_S = 120  # maximum time for drawing the page
ABOVE = 10  # lowest file descriptor in use, because Chromium requires 3 and 4

# Waits for two animation frames; the page then shows the new time.
SHOW = """new Promise((done) => {
  globalThis.mebots.clock.set(%r);
  requestAnimationFrame(() => requestAnimationFrame(() => done()));
})"""
# Returns the end time of the run after everything is drawn, null before, or the page's error message.
READY = """(() => {
  const state = document.documentElement?.dataset.state ?? "loading";
  return state === "loading" ? null : state === "ready" ? globalThis.mebots.clock.end : document.body.innerText;
})()"""


def write_film(page: pathlib.Path, out: pathlib.Path, frames_per_second: int, speed: float) -> int:
    """Writes a film of the whole run. Returns the number of frames. Raises InputError or Error if this fails.

    :param speed: simulated seconds per second of the film.
    """
    browser = _program("Chromium", os.environ.get("CHROMIUM"), BROWSERS, "CHROMIUM")
    encoder = _program("ffmpeg", None, ("ffmpeg",), "PATH")
    frames = 0
    with _chromium(browser) as tab:
        end = tab.open(page)
        command = [encoder, "-y", "-loglevel", "error", "-f", "image2pipe", "-framerate", str(frames_per_second), "-i", "-",
                   "-pix_fmt", "yuv420p", "-crf", "26", str(out)]
        film = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE)
        assert film.stdin is not None
        try:
            while frames * speed / frames_per_second <= end + 1e-9:
                tab.evaluate(SHOW % (frames * speed / frames_per_second))
                film.stdin.write(tab.screenshot())
                frames += 1
        except BrokenPipeError:
            pass  # reported below
        said = film.communicate()[1].decode(errors="replace").strip()
        if film.returncode != 0:
            raise Error(f"{out}: ffmpeg could not write it: {said or film.returncode}", "system_failure")
    return frames


def _program(what: str, named: str | None, names: tuple[str, ...], place: str) -> str:
    found = next((path for name in ([named] if named else names) if (path := shutil.which(name))), None)
    if found is None:
        looked = named or ", ".join(names)
        raise InputError(
            f"a video needs {what}, which was not found ({looked}). Install it"
            + (f", or set {place} to its path" if place != "PATH" else ""), "not_offered")
    return found


class _Tab:
    """Controls a page in Chromium by the DevTools protocol. Messages are JSON texts that end with a zero byte."""

    def __init__(self, to: Any, answers: Any) -> None:
        self._to, self._answers = to, answers
        self._number = 0
        self._rest = b""
        self._session: str | None = None
        target = self._call("Target.createTarget", url="about:blank")["targetId"]
        self._session = self._call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self._call("Emulation.setDeviceMetricsOverride", width=WIDTH, height=HEIGHT, deviceScaleFactor=1, mobile=False)

    def open(self, page: pathlib.Path) -> float:
        """Opens the page and waits until it is drawn. Returns the end time of the run [s]."""
        self._call("Page.navigate", url=page.resolve().as_uri() + "#t=0")
        deadline = time.monotonic() + PATIENCE_S
        while (end := self.evaluate(READY)) is None:
            if time.monotonic() > deadline:
                raise Error(f"{page}: the page was not drawn within {PATIENCE_S} s", "system_failure")
            time.sleep(0.05)
        if not isinstance(end, (int, float)):
            raise Error(f"{page}: this page cannot be drawn: {end}", "system_failure")
        return float(end)

    def evaluate(self, expression: str) -> Any:
        answer = self._call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in answer:
            raise Error(f"the page says: {answer['exceptionDetails'].get('text')}", "system_failure")
        return answer["result"].get("value")

    def screenshot(self) -> bytes:
        return base64.b64decode(self._call("Page.captureScreenshot", format="jpeg", quality=92)["data"])

    def _call(self, method: str, **parameters: Any) -> dict[str, Any]:
        self._number += 1
        request = {"id": self._number, "method": method, "params": parameters}
        if self._session:
            request["sessionId"] = self._session
        self._to.write(json.dumps(request).encode() + b"\0")
        self._to.flush()
        while True:
            answer = self._next()
            if answer.get("id") != self._number:
                continue  # an event, not the reply
            if "error" in answer:
                raise Error(f"Chromium rejects {method}: {answer['error'].get('message')}", "system_failure")
            return answer["result"]

    def _next(self) -> dict[str, Any]:
        while b"\0" not in self._rest:
            piece = self._answers.read1(1 << 20)
            if not piece:
                raise Error("Chromium ended before the video was complete", "system_failure")
            self._rest += piece
        text, _, self._rest = self._rest.partition(b"\0")
        return json.loads(text)


@contextlib.contextmanager
def _chromium(program: str) -> Iterator[_Tab]:
    options = ["--headless=new", "--remote-debugging-pipe", "--hide-scrollbars", "--no-first-run", "--disable-background-networking",
               "--disable-component-update", "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    if os.geteuid() == 0:
        options.append("--no-sandbox")  # Chromium's sandbox does not run as root
    ours, theirs = os.pipe(), os.pipe()  # occupies the low numbers until Chromium has its own pipes
    reads, writes = fcntl.fcntl(ours[0], fcntl.F_DUPFD, ABOVE), fcntl.fcntl(theirs[1], fcntl.F_DUPFD, ABOVE)

    def give() -> None:
        os.dup2(reads, 3)
        os.dup2(writes, 4)

    with tempfile.TemporaryDirectory(prefix="mebots-film-", ignore_cleanup_errors=True) as profile:
        process = subprocess.Popen([program, *options, f"--user-data-dir={profile}", "about:blank"], preexec_fn=give,
                                   close_fds=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for descriptor in (ours[0], theirs[1], reads, writes):
            os.close(descriptor)
        with os.fdopen(ours[1], "wb") as to, os.fdopen(theirs[0], "rb") as answers:
            try:
                yield _Tab(to, answers)
            finally:
                process.kill()
                process.wait()
