# SPDX-License-Identifier: Apache-2.0
"""The options of a deployment, and its result in memory."""

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
    """Options of a deployment.

    percentile: share of values within the ranges; None: all values
    equalise: cross-layer equalisation
    vectors: number of test vectors in the folder
    pictures: number of pictures for the calibration
    validate: folder of pictures for the accuracy; None: the pictures of the calibration
    labels: file with the labels of these pictures
    sizes: further sizes of the input; None: three quarters and half of the rows and columns
    """

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
    """A network in float, in integers, and as C code."""

    model: Model
    graph: Graph
    network: integers.Network
    plan: Plan
    sources: Sources
    pictures: Pictures
    scale: Scale
    float_model: FloatModel | None  # None if the model is an integer network
    board: Board
