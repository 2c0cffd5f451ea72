# SPDX-License-Identifier: Apache-2.0
"""Options of a deployment, and its result in memory."""

from __future__ import annotations

import dataclasses

from mebots.deploy import layers as integers
from mebots.deploy.arithmetic import Scale
from mebots.deploy.calibrate import FloatModel
from mebots.deploy.chip import Board
from mebots.deploy.emit import Sources
from mebots.deploy.graph import Graph
from mebots.deploy.model_file import Model
from mebots.deploy.pictures import Crop, Pictures
from mebots.deploy.plan import Plan

Size = tuple[int, int]
"""Rows and columns of an input."""


@dataclasses.dataclass(frozen=True)
class Options:
    """``equalise`` is cross-layer equalisation. With ``percentile`` None, the least and greatest values are used. ``vectors`` is the number of test vectors to
    keep. The accuracy is judged on the pictures of ``validate`` (None: those of the calibration), with the file ``labels``.
    ``sizes`` are further sizes of the input; None means three quarters and half of the rows and columns."""

    board: str = "ai_deck"
    percentile: float | None = None
    equalise: bool = False
    input_scale: float = 1 / 255
    input_offset: float = 0.0
    crop: Crop | None = None
    vectors: int = 4
    pictures: int = 256
    measure: bool = True
    validate: str | None = None
    labels: str | None = None
    sizes: tuple[Size, ...] | None = None


@dataclasses.dataclass(frozen=True)
class Deployed:
    """A network in three forms: in float, in integers, and as C."""

    model: Model
    graph: Graph
    network: integers.Network
    plan: Plan
    sources: Sources
    pictures: Pictures
    scale: Scale
    float_model: FloatModel | None  # None: the model is an integer network
    board: Board
