#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests that orders and results of many missions at once equal those of single missions."""

import math
import pickle
import sys
import unittest

import numpy as np

from mebots.exploration.journal import record_of
from mebots.exploration.objectives import Measurer
from mebots.exploration.orders import Orders, packed, unpacked
from mebots.exploration.replies import reply_from, reply_of
from mebots.exploration.rounds import Flights
from mebots.exploration.space import Space
from mebots.exploration.study import read_study
from mebots.exploration.tables import number_text, number_texts
from support import StudyCase


class Batches(StudyCase):
    def space(self, **sections):
        return Space(read_study(self.study(**sections)))

    def check(self, space):
        """Checks that Space.orders(), which creates the orders of several missions together, gives the same orders as Space.order(). Also
        checks them after a transfer by pickle, as to a worker."""
        blocks = [orders for _, orders in space.orders(Flights(range(len(space.designs)), 0, 10), 4)]
        single = [space.order((design, replicate)) for design in range(len(space.designs)) for replicate in range(10)]
        self.assertEqual([orders[at] for orders in blocks for at in range(len(orders))], single)
        there = list(unpacked(pickle.loads(pickle.dumps(packed(blocks)))))
        self.assertEqual([one["mission"] for one in there], [one["mission"] for one in single])
        self.assertEqual([one["settings"] for one in there], [one["settings"] for one in single])
        self.assertEqual(there[3]["config"], single[3]["config"])
        part = blocks[0].part(1, 3)
        self.assertEqual([part[0], part[1]], single[1:3])
        self.assertEqual(blocks[0].only([3, 0])[0], single[3])

    def test_of_draws_that_are_numbers_are_columns(self):
        draws = {"replicates": 10, "seed": 1, "variables": {"a.real_in": {"uniform": [0, 3]}, "a.integer_in": {"integer": [1, 9]}}}
        space = self.space(draws=draws, design={"kind": "grid", "factors": {"a.gain": [0.2, 1e-9], "a.string_in": ["50 %b", "x"]}})
        self.assertIsNone(next(space.orders(Flights([0], 0, 3), 4))[1].own)
        self.check(space)

    def test_of_draws_that_are_texts_are_the_same_too(self):
        self.check(self.space(draws={"replicates": 10, "seed": 1, "variables": {"a.string_in": {"choice": ["p", "q"]}}}))

    def test_of_keys_of_the_config_are_the_same_too(self):
        self.check(self.space(design={"kind": "grid", "factors": {"/stop_time": [1, 2]}}))


class Replies(StudyCase):
    RECORDS = [
        {"mission": f"{at:064x}", "outcome": outcome, "error": error, "simulated_time": 1.5, "values": values}
        for at, (outcome, error, values) in enumerate([
            ("far", "", {"integral": 2, "deep.out": True}), ("near", "", {"integral": None, "deep.out": math.inf}),
            ("failed", "it broke", {}), ("far", "", {"integral": 2**1100, "deep.out": "text"})])]

    def test_hold_the_measures_of_each_record(self):
        objectives = {"success": {"outcome": "far"}, "integral": {"summary": "integral", "where": "success"}, "out": {"summary": "deep.out"}}
        study = read_study(self.study(objectives=objectives))
        reply = reply_from(pickle.loads(pickle.dumps(reply_of(self.RECORDS))))
        reply.indices = range(4)
        self.assertEqual(reply.records(), [record_of(line) for line in reply.lines.splitlines(keepends=True)])
        columns = Measurer(study, ["integral", "deep.out"]).columns(reply)
        rows = [Measurer(study, ["integral", "deep.out"])(record) for record in self.RECORDS]
        np.testing.assert_array_equal(columns, np.array([[math.nan if one is None else one for one in row] for row in rows]))

    def test_refuses_damaged_orders(self):
        parts = reply_of(self.RECORDS)
        with self.assertRaises(ValueError):
            reply_from(parts | {"lines": parts["lines"].replace(b"far", b"fat")})


class Numbers(unittest.TestCase):
    def test_of_a_column_have_the_texts_of_single_ones(self):
        import array

        values = array.array("d", [0.0, -0.0, 1.0, 10.0, 0.1, 1e15, 123456789012345.0, 1e16, 1e20, 1e22, -2.5e-300, math.nan, math.inf, -math.inf, 20.0])
        self.assertEqual(number_texts(values), [number_text(value) for value in values])


if __name__ == "__main__":
    unittest.main(argv=sys.argv)
