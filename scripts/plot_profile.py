#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws a profile of `mebots-soc run --profile FILE.json` (or of the parameter observe.profile) as flame graphs.

Usage: plot_profile.py PROFILE.json [--out PICTURE.png] [--profiles time energy]

The file has speedscope's format, so speedscope.app can also open it. Each box is a function, on top of the box of its caller. The
width of a box is the share of the function and its callees.
"""

import argparse
import collections
import json
import pathlib
import zlib

from matplotlib.colors import to_rgb
from matplotlib.patches import Rectangle

from figure_style import PALETTE, plt, save

SCALES = {"nanoseconds": (1e-9, "s")}
ROW_INCHES = 0.3
LEAST_SHARE = 0.004  # boxes below this share do not add a row


def read_stacks(profile, names, left_out):
    """Returns [(stack of frames, own cost)] of an evented profile. Omits stacks with a name in `left_out`."""
    stacks, stack, last = [], [], 0
    for event in profile["events"]:
        if stack and event["at"] > last and not any(names[frame] in left_out for frame in stack):
            stacks.append((tuple(stack), event["at"] - last))
        last = event["at"]
        if event["type"] == "O":
            stack.append(event["frame"])
        else:
            stack.pop()
    return stacks


def boxes(stacks):
    """Returns (depth, start, width, frame) of every box. Merges equal beginnings of successive stacks."""
    found, open_boxes, at = [], [], 0
    for stack, cost in stacks + [((), 0)]:
        same = 0
        while same < min(len(open_boxes), len(stack)) and open_boxes[same][0] == stack[same]:
            same += 1
        while len(open_boxes) > same:
            frame, start = open_boxes.pop()
            found.append((len(open_boxes), start, at - start, frame))
        open_boxes += [(frame, at) for frame in stack[same:]]
        at += cost
    return found


def colour(name):
    """Returns a light colour of the palette for black text. A function has the same colour in every picture. Sleep and
    interrupts, which are not functions, are grey."""
    if name.startswith("["):
        return "#d9dce0"
    tone = to_rgb(PALETTE[zlib.crc32(name.encode()) % (len(PALETTE) - 1)])
    return tuple(0.45 * part + 0.55 for part in tone)


def rows_of(stacks):
    """Returns the number of rows that the boxes of all stacks need. Omits boxes that are narrower than LEAST_SHARE."""
    total = sum(cost for _, cost in stacks) or 1
    return max((depth + 1 for depth, _, width, _ in boxes(stacks) if width / total >= LEAST_SHARE), default=1)


def draw(axes, profile, stacks, names):
    total = sum(cost for _, cost in stacks) or 1
    axes.set(xlim=(0, 1), ylim=(0, rows_of(stacks)), yticks=[])
    axes.set_xticks([0, 0.25, 0.5, 0.75, 1], ["0", "25 %", "50 %", "75 %", "100 %"])
    axes.spines["left"].set_visible(False)
    for depth, start, width, frame in boxes(stacks):
        share = width / total
        if share < 0.0005:
            continue
        axes.add_patch(Rectangle((start / total, depth), share, 1, facecolor=colour(names[frame]), edgecolor="white", linewidth=0.5))
        room = int(share * 125)
        if room >= 4:
            text = f"{names[frame]} {100 * share:.1f} %" if room > len(names[frame]) + 7 else names[frame][:room]
            axes.text(start / total + share / 2, depth + 0.5, text, ha="center", va="center", fontsize=8, clip_on=True)
    factor, unit = SCALES.get(profile["unit"], (1e-9, "J") if "nJ" in profile["name"] else (1, ""))
    axes.set_title(f"{profile['name'].replace(' [nJ]', '')}: {total * factor:.4g} {unit}", loc="left", fontsize=10)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("profile", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, help="default: beside the profile")
    parser.add_argument("--leave-out", nargs="*", default=[], help="frames that are not drawn, such as '[asleep]'")
    parser.add_argument("--profiles", nargs="+", default=["time", "energy"], help="names, as they begin, such as 'energy [nJ], cluster core 0'")
    arguments = parser.parse_args()

    data = json.loads(arguments.profile.read_text())
    names = [frame["name"] for frame in data["shared"]["frames"]]
    chosen = []
    for wanted in arguments.profiles:
        named = [p for p in data["profiles"] if p["name"].startswith(wanted)]
        if not named:
            parser.error(f"{arguments.profile} has no profile \"{wanted}\"; it has {'; '.join(p['name'] for p in data['profiles'])}")
        chosen.append(named[0])  # profiles of the fabric controller precede those of the cluster's cores
    drawn = [read_stacks(profile, names, arguments.leave_out) for profile in chosen]
    heights = [rows_of(stacks) for stacks in drawn]
    figure, axes = plt.subplots(len(chosen), 1, figsize=(10, ROW_INCHES * sum(heights) + 0.6 * len(chosen) + 0.3),
                                height_ratios=heights, constrained_layout=True, squeeze=False)
    for cell, profile, stacks in zip(axes.flat, chosen, drawn):
        draw(cell, profile, stacks, names)
        costs = collections.Counter()
        for stack, cost in stacks:
            costs[stack[-1]] += cost
        print(profile["name"])
        for frame, cost in costs.most_common(8):
            print(f"  {100 * cost / sum(costs.values()):6.2f} %  {names[frame]}")
    without = f" without {', '.join(arguments.leave_out)}" if arguments.leave_out else ""
    figure.suptitle(pathlib.Path(data["name"]).name + without)
    out = arguments.out or arguments.profile.with_suffix(".png")
    save(figure, out)
    print(f"wrote {out}")


if __name__ == "__main__":
    main()
