# SPDX-License-Identifier: Apache-2.0
"""Defines the style of all figures: one palette, thin axes, units in square brackets.

The palette is Okabe and Ito's, as on the page of a run (web/src/theme.ts): people with any kind of colour vision can distinguish
its colours. Success is blue, failure is vermilion.
"""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

PALETTE = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#b58900", "#56b4e9", "#5c4d9e", "#7f7f7f")
BLUE, VERMILION, GREEN, PINK, OCHRE, SKY, VIOLET, GREY = PALETTE
GOOD, MIDDLING, BAD = BLUE, SKY, VERMILION
FAINT = "#999999"
INK = "#22272e"
SEQUENCE = "cividis"  # for ordered numbers: its lightness rises uniformly

plt.rcParams.update({
    "font.size": 10, "axes.titlesize": 10, "axes.spines.top": False, "axes.spines.right": False, "axes.linewidth": 0.8,
    "axes.edgecolor": "#666666", "axes.labelcolor": INK, "text.color": INK, "xtick.color": "#444444", "ytick.color": "#444444",
    "axes.prop_cycle": plt.cycler(color=PALETTE), "axes.grid": False, "grid.color": "#e4e7eb", "grid.linewidth": 0.8,
    "legend.frameon": False, "lines.linewidth": 1.4, "image.cmap": SEQUENCE, "savefig.dpi": 110, "svg.hashsalt": "mebots",
})


def label_line(axes, text, colour, at=-1, line=None, offset=(5, 0), **more):
    """Writes the name of a curve next to the curve, in place of a legend. `at` is the index of the point."""
    line = line or axes.lines[-1]
    x, y = line.get_xdata()[at], line.get_ydata()[at]
    axes.annotate(text, (x, y), xytext=offset, textcoords="offset points", color=colour, va="center", fontsize=9,
                  annotation_clip=False, **more)


def save(figure, file):
    """Saves a figure. Equal figures give equal bytes."""
    figure.savefig(file, metadata={"Software": None} if str(file).endswith(".png") else {"Date": None})
    plt.close(figure)
