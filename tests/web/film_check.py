#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks a film of a flight: it has the expected number of frames, and no two seconds are equal. Without the necessary
programs, an error names the missing one.

Usage: film_check.py MEBOTS RUN_DIR OUT.mp4
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

from PIL import Image, ImageChops

mebots, run, out = sys.argv[1:]


def report(*words, **environment):
    return subprocess.run([mebots, "report", run, "--out", out + ".html", *words], capture_output=True, text=True,
                          env=os.environ | {"MEBOTS_PYTHON": sys.executable} | environment)


refused = report("--video", out, CHROMIUM="/nowhere/chromium")
assert refused.returncode == 2, refused
assert "/nowhere/chromium" in refused.stderr and "CHROMIUM" in refused.stderr, refused.stderr

if not shutil.which("ffmpeg") or not any(map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))):
    print("skipped: a film needs Chromium and ffmpeg")
    sys.exit(77)

made = report("--video", out, "--fps", "2", "--speed", "1")
assert made.returncode == 0, made
assert "(9 frames)" in made.stdout, made.stdout  # 4 s, both ends
with tempfile.TemporaryDirectory() as folder:
    subprocess.run(["ffmpeg", "-loglevel", "error", "-i", out, f"{folder}/%02d.png"], check=True)
    frames = [Image.open(file).convert("L") for file in sorted(pathlib.Path(folder).iterdir())]
    assert len(frames) == 9 and frames[0].size == (1280, 720), (len(frames), frames[0].size)
    for a, b in zip(frames[::2], frames[2::2]):
        assert ImageChops.difference(a, b).getextrema()[1] > 60, "the film stands still"
print("9 frames, each second another")
