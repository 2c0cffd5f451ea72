#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests that the stub of the C++ module declares exactly the module's classes, methods, properties and functions.
"""

import ast
import inspect
import pathlib
import sys
import unittest

import mebots
from mebots import _mebots

STUB = pathlib.Path(mebots.__file__).with_name("_mebots.pyi")


def names_of(parts):
    """Returns the public names in `parts`, sorted. These are names of the stub or of the module."""
    return sorted(name for name in parts if not name.startswith("_"))


class Stub(unittest.TestCase):
    def setUp(self):
        self.stub = ast.parse(STUB.read_text(encoding="utf-8"))
        self.classes = {node.name: node for node in self.stub.body if isinstance(node, ast.ClassDef)}

    def test_it_has_the_names_of_the_module(self):
        functions = [node.name for node in self.stub.body if isinstance(node, ast.FunctionDef)]
        self.assertEqual(names_of([*functions, *self.classes]), names_of(vars(_mebots)))

    def test_classes_have_their_members(self):
        for name, node in self.classes.items():
            members = [one.name for one in node.body if isinstance(one, ast.FunctionDef)]
            self.assertEqual(names_of(members), names_of(vars(getattr(_mebots, name))), name)

    def test_properties_and_methods_are_what_they_are_in_the_module(self):
        for name, node in self.classes.items():
            for one in node.body:
                if isinstance(one, ast.FunctionDef) and not one.name.startswith("_"):
                    is_property = any(isinstance(mark, ast.Name) and mark.id == "property" for mark in one.decorator_list)
                    self.assertEqual(is_property, isinstance(inspect.getattr_static(getattr(_mebots, name), one.name), property), one.name)

    def test_each_public_name_of_the_package_is_there_for_type_checkers(self):
        tree = ast.parse(pathlib.Path(mebots.__file__).read_text(encoding="utf-8"))
        imported = {alias.name for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) for alias in node.names}
        annotated = {node.target.id for node in ast.walk(tree) if isinstance(node, ast.AnnAssign)}
        offered = {name for name in dir(mebots) if not name.startswith("__")}
        self.assertEqual({*mebots.__all__, *offered} - imported - annotated, set())


if __name__ == "__main__":
    unittest.main(argv=sys.argv)
