# SPDX-License-Identifier: Apache-2.0
"""Stores the orders of many missions as columns, so that a mission needs no separate object."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from mebots.exploration.study import Values

DIGEST_BYTES = 32

Order = dict[str, Any]
"""The members of an order: ``config``: JSON text, ``digest``: its hash, ``settings``: variable -> value, ``files``:
hash -> [path, name], ``finals`` and ``series``: values that are requested in addition to the summary,
``processor_time``: limit [s] or None, ``mission``: the hash, ``build``: of MEbots, as part of it, ``course``: a list of
{``place``, ``writes``, ``past``: hash of the state there}. Only if a mission runs up to a place: ``until``:
that place, ``keeps``: hash of the state there. Only if the study keeps results: ``out``: the mission's folder."""

Batch = dict[str, Any]
"""A task of an executor. It contains shared data once: ``configs``: hash -> JSON text, ``shared``: the other parts,
``files``. ``groups`` contains the rest. Each group has ``digests`` of its missions, and either ``own``: the parts
of each order, or ``common``: the parts that all have, and ``columns``: setting -> its value in each mission."""

_SHARED = ("build", "finals", "series", "processor_time")
_ELSEWHERE = (*_SHARED, "config", "files", "mission")


@dataclasses.dataclass
class Orders:
    """Orders of missions. If they differ only in numbers, ``common`` is an order without its hash, and ``columns`` contains the different
    settings. Otherwise, ``own`` contains one order per mission."""

    digests: list[bytes]
    common: Order = dataclasses.field(default_factory=dict)
    columns: Mapping[str, Sequence[Any]] = dataclasses.field(default_factory=dict)
    own: Sequence[Order] | None = None

    @classmethod
    def of(cls, orders: Sequence[Order]) -> Orders:
        return cls([bytes.fromhex(order["mission"]) for order in orders], own=orders)

    def __len__(self) -> int:
        return len(self.digests)

    def __getitem__(self, number: int) -> Order:
        if self.own is not None:
            return self.own[number]
        settings: Values = self.common["settings"] | {name: column[number] for name, column in self.columns.items()}
        return self.common | {"mission": self.digests[number].hex(), "settings": settings}

    def part(self, begin: int, end: int) -> Orders:
        if begin == 0 and end >= len(self):
            return self
        columns = {name: column[begin:end] for name, column in self.columns.items()}
        return Orders(self.digests[begin:end], self.common, columns, None if self.own is None else self.own[begin:end])

    def only(self, numbers: Sequence[int]) -> Orders:
        """Returns the orders with these indices."""
        columns = {name: [column[one] for one in numbers] for name, column in self.columns.items()}
        own = None if self.own is None else [self.own[one] for one in numbers]
        return Orders([self.digests[one] for one in numbers], self.common, columns, own)


def packed(groups: Sequence[Orders]) -> Batch:
    """Packs orders of a study into a batch."""
    whole = [order for orders in groups for order in ([orders.common] if orders.own is None else orders.own)]
    return {
        "configs": {order["digest"]: order["config"] for order in whole},
        "shared": {key: whole[0][key] for key in _SHARED},
        "files": {digest: place for order in whole for digest, place in order["files"].items()},
        "groups": [
            {"digests": b"".join(orders.digests), "common": _rest(orders.common), "columns": orders.columns}
            if orders.own is None
            else {"digests": b"".join(orders.digests), "own": [_rest(order) for order in orders.own]}
            for orders in groups
        ],
    }


def _rest(order: Order) -> Order:
    return {key: value for key, value in order.items() if key not in _ELSEWHERE}


def unpacked(batch: Batch) -> Iterator[Order]:
    """Yields the orders in a batch. Each contains the files of all orders."""
    for group in batch["groups"]:
        orders = Orders(pieces_of(group["digests"]), group.get("common", {}), group.get("columns", {}), group.get("own"))
        for number, digest in enumerate(orders.digests):
            order = orders[number]
            yield batch["shared"] | {"files": batch["files"], "config": batch["configs"][order["digest"]]} | order | {"mission": digest.hex()}


def pieces_of(digests: bytes) -> list[bytes]:
    """Splits concatenated digests."""
    return [digests[at : at + DIGEST_BYTES] for at in range(0, len(digests), DIGEST_BYTES)]
