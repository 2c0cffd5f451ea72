#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests that the includes and imports of the product follow the layers in tests/structure/layers.json, and that the checker
finds each kind of violation."""
import json
import tempfile
import unittest
from pathlib import Path

import structure

ORDER = {"parts": {"a": {"uses": [], "include_paths": ["include", "src"], "public": ["include"],
                         "layers": [{"folders": ["include"], "what": ""}, {"folders": ["src/low"], "what": ""},
                                    {"folders": ["src/left", "src/right"], "what": ""}]}},
         "modules": []}


class Product(unittest.TestCase):
    def setUp(self):
        self.structure = structure.Structure(structure.REPOSITORY, json.loads(structure.ORDER.read_text("utf-8")))

    def test_dependencies_follow_the_order(self):
        self.assertEqual("", "\n".join(self.structure.mistakes()))

    def test_architecture_shows_the_order(self):
        page = (structure.REPOSITORY / structure.PAGE).read_text(encoding="utf-8")
        self.assertEqual(page, structure.page_with_tables(self.structure, page),
                         "run tests/structure/structure.py --write")

    def test_every_part_has_includes_that_are_found(self):
        for name, part in self.structure.parts.items():
            self.assertTrue(any(target is not None for file, _, target in self.structure.includes
                                if self.structure.owners[file] is part), name)


class Checker(unittest.TestCase):
    def mistakes(self, files, order=None):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in files.items():
                file = Path(folder) / name
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(text, encoding="utf-8")
            return structure.Structure(Path(folder), order or ORDER).mistakes()

    def test_accepts_an_include_from_a_higher_to_a_lower_layer(self):
        self.assertEqual([], self.mistakes({"a/src/low/x.hpp": "", "a/src/left/y.cpp": '#include "low/x.hpp"\n'}))

    def test_refuses_an_include_from_a_lower_to_a_higher_layer(self):
        [mistake] = self.mistakes({"a/src/left/x.hpp": "", "a/src/low/y.cpp": '#include "left/x.hpp"\n'})
        self.assertEqual("a/src/low must not use a/src/left: a/src/low/y.cpp includes a/src/left/x.hpp", mistake)

    def test_refuses_an_include_between_folders_of_one_layer(self):
        [mistake] = self.mistakes({"a/src/left/x.hpp": "", "a/src/right/y.cpp": '#include "left/x.hpp"\n'})
        self.assertIn("a/src/right must not use a/src/left", mistake)

    def test_refuses_a_cycle_between_a_folder_and_its_sub_folder(self):
        [mistake] = self.mistakes({"a/src/low/x.hpp": '#include "low/sub/y.hpp"\n',
                                   "a/src/low/sub/y.hpp": '#include "../x.hpp"\n'})
        self.assertIn("form a cycle: a/src/low, a/src/low/sub", mistake)

    def test_accepts_a_known_cycle_until_it_is_gone(self):
        files = {"a/src/left/x.hpp": '#include "right/y.hpp"\n', "a/src/right/y.hpp": '#include "left/x.hpp"\n'}
        known = {"parts": {"a": {**ORDER["parts"]["a"], "known_cycles": [["src/left", "src/right"]]}}, "modules": []}
        self.assertEqual([], self.mistakes(files, known))
        [mistake] = self.mistakes({"a/src/left/x.hpp": "", "a/src/right/y.hpp": ""}, known)
        self.assertIn("remove the known cycle a/src/left, a/src/right", mistake)

    def test_refuses_a_private_header_in_a_public_one(self):
        mistakes = self.mistakes({"a/src/low/x.hpp": "", "a/include/y.hpp": "#include <low/x.hpp>\n"})
        self.assertIn("a/include/y.hpp is public and includes the private a/src/low/x.hpp", mistakes)

    def test_refuses_a_folder_without_a_layer(self):
        [mistake] = self.mistakes({"a/src/new/x.hpp": ""})
        self.assertIn("no layer of a names its folder", mistake)

    def test_refuses_a_part_that_must_not_be_used(self):
        order = {"parts": {**ORDER["parts"], "b": {"uses": [], "include_paths": ["."]}}, "modules": []}
        [mistake] = self.mistakes({"a/src/low/x.hpp": "", "b/y.cpp": '#include "low/x.hpp"\n'}, order)
        self.assertEqual("b/y.cpp includes a/src/low/x.hpp, but b must not use a", mistake)

    def test_refuses_cycles_of_python_and_typescript_modules(self):
        order = {"parts": {}, "modules": [{"root": "p", "language": "python"},
                                          {"root": "t", "language": "typescript"}]}
        mistakes = self.mistakes({"p/one.py": "from . import two\n", "p/two.py": "from p.one import name\n",
                                  "p/__init__.py": "", "t/one.ts": 'import { a } from "./sub/two";\n',
                                  "t/sub/two.ts": 'import { b } from "../one";\n'}, order)
        self.assertEqual(["modules of p form a cycle: one, two", "modules of t form a cycle: one, sub/two"], mistakes)


if __name__ == "__main__":
    unittest.main()
