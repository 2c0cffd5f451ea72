#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the includes between the folders of a part: docs/img/layers.png.

    plot_layers.py OUT.png [--part master] [ROOT...]

Draws a panel for each checkout ROOT, by default for this checkout. A row is a layer of tests/structure/layers.json, the lowest
layer at the bottom. Arrows between folders of a cycle are vermilion, all others are grey. Their width grows with the number of
includes.
"""
import argparse
import json
import sys
from collections import Counter, defaultdict
from pathlib import Path, PurePosixPath

REPOSITORY = Path(__file__).resolve().parents[1]
sys.path += [str(REPOSITORY / "tests/structure"), str(REPOSITORY / "scripts")]

import figure_style as style  # noqa: E402
import structure  # noqa: E402


def short(folder, part):
    """Returns a short name for readers, such as `engine` for master/src/engine/algorithm."""
    steps = folder.relative_to(part).parts
    return "/".join(steps[1:2] if steps[0] == "src" and len(steps) > 1 else steps[:1]) or "."


def graph_of(root, part):
    """Returns {(folder, other folder): number of includes}, and {folder: row in the picture}. A row is a layer of
    layers.json."""
    order = json.loads((REPOSITORY / "tests/structure/layers.json").read_text())
    tree = structure.Structure(root, order)
    edges, rows = Counter(), {}
    for folder in {file.parent for file in tree.parts[part].files}:
        layer = tree.parts[part].layer(folder)
        rows[short(folder, part)] = max(rows.get(short(folder, part), 0), layer[0] if layer else 0)
    for (folder, other), pairs in tree.dependencies(part).items():
        names = short(folder, part), short(other, part)
        if names[0] != names[1]:
            edges[names] += len(pairs)
    return edges, rows


def draw(axes, root, part):
    edges, rows = graph_of(root, part)
    in_row = defaultdict(list)
    for name, row in sorted(rows.items()):
        in_row[row].append(name)
    levels = {row: level for level, row in enumerate(sorted(in_row))}
    places = {name: ((place + 1) / (len(names) + 1) + 0.05 * (levels[row] % 3 - 1),
                     levels[row] + (0.4 * (place % 2) - 0.4 if len(names) > 6 else 0))
              for row, names in in_row.items() for place, name in enumerate(names)}
    graph = defaultdict(set)
    for name, other in edges:
        graph[name].add(other)
    cycles = structure.cycles(graph)
    for (name, other), count in sorted(edges.items()):
        in_cycle = any(name in cycle and other in cycle for cycle in cycles)
        axes.annotate("", places[other], places[name], zorder=2 if in_cycle else 1, arrowprops={
            "arrowstyle": "-|>", "color": style.BAD if in_cycle else "#b8bec6", "linewidth": min(0.4 + 0.08 * count, 2),
            "shrinkA": 12, "shrinkB": 12, "connectionstyle": "arc3,rad=0.08"})
    for name, place in places.items():
        axes.annotate(name, place, ha="center", va="center", fontsize=9, zorder=3,
                      bbox={"boxstyle": "round,pad=0.25", "facecolor": "white", "edgecolor": style.INK, "linewidth": 0.8})
    in_cycles = sum(len(cycle) for cycle in cycles)
    axes.set_title(f"{len(rows)} folders, {in_cycles} of them in a cycle" if cycles else f"{len(rows)} folders, no cycle")
    axes.set(xlim=(-0.02, 1.02), ylim=(-0.5, max(levels.values()) + 0.5))
    axes.axis("off")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("roots", type=Path, nargs="*", default=[REPOSITORY])
    parser.add_argument("--part", default="master")
    options = parser.parse_args()
    count = len(options.roots)
    figure, axes = style.plt.subplots(1, count, figsize=(6.5 * count, 8), squeeze=False)
    for panel, root in zip(axes[0], options.roots, strict=True):
        draw(panel, root.resolve(), options.part)
    figure.tight_layout()
    style.save(figure, options.out)


if __name__ == "__main__":
    main()
