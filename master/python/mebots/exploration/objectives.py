# SPDX-License-Identifier: Apache-2.0
"""Converts records of missions to the numbers that a study requests."""

from __future__ import annotations

import ast
import math
import operator
import os
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from mebots.errors import InputError
from mebots.exploration.journal import Record
from mebots.exploration.replies import Reply, number_of
from mebots.exploration.study import Objective, Study

Measures = tuple[float | None, ...]
"""One number per objective; None if the mission has no value of it."""


class Measurer:
    """Computes the measures of missions. ``labels`` are the labels in the summary of a mission. Raises InputError if an objective names a
    label or a variable that does not exist."""

    def __init__(self, study: Study, labels: Iterable[str]) -> None:
        self._objectives = study.objectives
        self._place = study.place
        self._formulas: dict[str, Callable[[Mapping[str, Any]], float]] = {}
        self._sound = 0  # number of missions without an error
        self._valued: set[str] = set()  # objectives that have had a value
        self._mistakes: dict[str, tuple[int, str]] = {}  # first arithmetic error of each expression: number of the mission, text
        labels = list(labels)
        known: set[str] = set(labels)
        for one in self._objectives:
            place = f"{study.place}: the objective '{one.label}'"
            if one.source == "summary" and one.what not in known.intersection(labels):
                raise InputError(f"{place}: the mission's summary has no '{one.what}'. {_nearest(one.what, labels)}", "unknown_name")
            if one.source == "expression":
                self._formulas[one.label] = formula(one.what, known, place)
            known.add(one.label)

    def __call__(self, record: Record, number: int = 0) -> Measures:
        """Returns the measures of a mission. ``number`` is its index in the study."""
        values: dict[str, Any] = record.get("values", {})
        if self._formulas:  # expressions may use other objectives
            values = dict(values)
        sound = not record["error"]
        self._sound += sound
        measured: dict[str, float | None] = {}
        for one in self._objectives:
            if one.where is not None and measured.get(one.where, 1.0) != 1.0:
                found = None
            elif one.is_share:
                found = float(_ending(record, one) in one.what)
            else:
                found = self._one(one, record, values, number) if sound else None
            if found is not None:
                self._valued.add(one.label)
            measured[one.label] = found
            if self._formulas:
                values[one.label] = found
        return tuple(measured[one.label] for one in self._objectives)

    def columns(self, reply: Reply) -> np.ndarray:
        """Returns the measures of missions, one row each. NaN marks a missing value."""
        if self._formulas:
            rows = [self(record, index) for record, index in zip(reply.records(), reply.indices, strict=True)]
            return np.array([[math.nan if one is None else one for one in row] for row in rows], float).reshape(len(rows), -1)
        sound = ~reply.failed
        self._sound += int(sound.sum())
        measured = np.full((len(self._objectives), len(reply)), math.nan)
        known: dict[str, np.ndarray] = {}
        for one, column in zip(self._objectives, measured, strict=True):
            if one.is_share:
                column[:] = _share_of(one, reply)
            else:
                column[sound] = self._column(one, reply)[sound]
            if one.where in known:
                column[known[one.where] != 1.0] = math.nan
            known[one.label] = column
            if not np.isnan(column).all():
                self._valued.add(one.label)
        return measured.T

    @staticmethod
    def _column(one: Objective, reply: Reply) -> np.ndarray:
        keys = {"summary": ("values", one.what), "final": ("finals", one.what), "series": ("series", f"{one.what} {one.reduction}")}
        none = np.full(len(reply), math.nan)
        return reply.numbers.get(keys[one.source], none)

    def without_value(self) -> list[str]:
        """Returns a message for each objective whose expression had no value in any mission because of an arithmetic error. Skips
        objectives with ``where``, and expressions of values that a mission may lack."""
        return [
            f"{self._place}: the objective '{label}' has no value in any of {self._sound} missions: '{what}': {why}"
            for label, what, why in (
                (one.label, one.what, self._mistakes.get(one.label, (0, None))[1]) for one in self._objectives if one.label not in self._valued
            )
            if why is not None
        ]

    def _one(self, one: Objective, record: Record, values: Mapping[str, Any], number: int) -> float | None:
        if one.source == "summary":
            return _number(values.get(one.what))
        if one.source == "final":
            return _number(record["finals"][one.what])
        if one.source == "series":
            return _number(record["series"][f"{one.what} {one.reduction}"])
        if one.source == "expression":
            try:
                result = self._formulas[one.label](values)
            except TypeError:  # this mission lacks a value
                return None
            except (ArithmeticError, ValueError) as error:
                self._note(one.label, number, str(error))
                return None
            if not math.isfinite(result):
                self._note(one.label, number, f"its result is {result}")
            return _number(result)
        return None

    def _note(self, label: str, number: int, why: str) -> None:
        if label not in self._mistakes or number < self._mistakes[label][0]:
            self._mistakes[label] = number, why


def _share_of(one: Objective, reply: Reply) -> np.ndarray:
    """Returns 1 for each mission that ended with one of the objective's outcomes or end reasons, and 0 for others."""
    if one.source == "outcome":
        return np.array([name in one.what for name in reply.outcome_names], float)[reply.outcomes]
    return np.array([_ending(record, one) in one.what for record in reply.records()], float)


def _ending(record: Record, one: Objective) -> str:
    """Returns the outcome or end reason of a mission. A crashed mission has no end reason."""
    return record["outcome"] if one.source == "outcome" else record.get("end_reason", "failed")


def has_all(record: Record, order: Mapping[str, Any]) -> bool:
    """True if a stored mission need not run again for ``order``. Its record must contain all final values and series of the order. If the
    order has a results folder, summary.json must exist there. A failed mission needs no values."""
    if record["error"]:
        return True
    if "out" in order and not os.path.exists(os.path.join(order["out"], "summary.json")):
        return False
    return all(name in record.get("finals", {}) for name in order["finals"]) and all(
        f"{name} {how}" in record.get("series", {}) for name, how in order["series"]
    )


def _number(value: Any) -> float | None:
    found = number_of(value)
    return None if math.isnan(found) else found


_OPERATORS: dict[type, Callable[..., float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
}
_MOST_CHARACTERS = 4000
_MOST_LEVELS = 100
"""The maximum depth of an expression, far below Python's recursion limit at any depth of calls."""

_FUNCTIONS: dict[str, Callable[..., float]] = {"abs": abs, "min": min, "max": max, "sqrt": math.sqrt}


def formula(text: str, known: Iterable[str], place: str) -> Callable[[Mapping[str, Any]], float]:
    """Returns a function that evaluates an expression with values by name. Expressions contain +, -, *, /, abs, min, max, sqrt, numbers,
    and names with dots. Raises InputError if the expression is invalid."""
    known = set(known)

    def compiled(node: ast.AST) -> Callable[[Mapping[str, Any]], float]:
        if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)) and not isinstance(node.value, bool):
            number = float(node.value)
            return lambda values: number
        name = _dotted(node)
        if name is not None:
            if name not in known:
                raise InputError(f"{place}: '{name}' is unknown. {_nearest(name, known)}", "unknown_name")
            return lambda values: values[name]
        if isinstance(node, ast.UnaryOp) and type(node.op) in _OPERATORS:
            work, inner = _OPERATORS[type(node.op)], compiled(node.operand)
            return lambda values: work(inner(values))
        if isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
            work, left, right = _OPERATORS[type(node.op)], compiled(node.left), compiled(node.right)
            return lambda values: work(left(values), right(values))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in _FUNCTIONS and not node.keywords:
            function, parts = _FUNCTIONS[node.func.id], [compiled(part) for part in node.args]
            return lambda values: function(*(part(values) for part in parts))
        raise InputError(f"{place}: '{ast.unparse(node)}' is neither a number, a name, + - * / nor one of {', '.join(_FUNCTIONS)}", "syntax_error")

    too_long = InputError(f"{place}: '{text[:40]}...' is too long; split the expression into several objectives", "syntax_error")
    if len(text) > _MOST_CHARACTERS:
        raise too_long
    try:
        tree = ast.parse(text, mode="eval").body
    except (SyntaxError, ValueError, MemoryError):  # also raised for too deep nesting
        raise InputError(f"{place}: '{text}' is not an expression", "syntax_error") from None
    if _depth(tree) > _MOST_LEVELS:
        raise too_long
    return compiled(tree)


def _depth(tree: ast.AST) -> int:
    """Returns the depth of a tree without recursion."""
    depth, level = 0, [tree]
    while level:
        depth, level = depth + 1, [child for node in level for child in ast.iter_child_nodes(node)]
    return depth


def _dotted(node: ast.AST) -> str | None:
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute):
        before = _dotted(node.value)
        return None if before is None else f"{before}.{node.attr}"
    return None


def _nearest(name: str, known: Iterable[str]) -> str:
    import difflib

    known = sorted(known)
    near = difflib.get_close_matches(name, known, n=3, cutoff=0.4)
    return f"Did you mean {', '.join(repr(one) for one in near)}?" if near else f"There are: {', '.join(known)}"
