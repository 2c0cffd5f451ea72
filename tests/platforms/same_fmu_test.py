# SPDX-License-Identifier: Apache-2.0
"""Checks that an installation accepts an FMU for several platforms only if it is built from the same code
(cmake/MebotsSameFmu.cmake).

    same_fmu_test.py CMAKE
"""

import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

CMAKE = sys.argv[1]
MODULE = Path(__file__).parents[2] / "cmake/MebotsSameFmu.cmake"
OWN = {"modelDescription.xml": "<x/>", "binaries/linux64/it.so": "code", "resources/firmware.elf": "loop", "documentation/index.html": "here"}
MERGED = OWN | {"binaries/win64/it.dll": "code for Windows", "documentation/index.html": "there"}


class SameFmu(unittest.TestCase):
    def install(self, merged):
        with tempfile.TemporaryDirectory(prefix="mebots fmus ") as folder:
            paths = [Path(folder) / name for name in ("merged.fmu", "own.fmu")]
            for path, content in zip(paths, (merged, OWN)):
                with zipfile.ZipFile(path, "w") as archive:
                    for name, text in content.items():
                        archive.writestr(name, text)
            script = Path(folder) / "install.cmake"
            script.write_text(f'include("{MODULE}")\nmebots_require_same_fmu("{paths[0]}" "{paths[1]}")\n', encoding="utf-8")
            done = subprocess.run([CMAKE, "-P", script], capture_output=True, text=True, check=False)
            self.assertEqual({path.name for path in Path(folder).iterdir()}, {"merged.fmu", "own.fmu", "install.cmake"}, "a file is left")
            return done.returncode, " ".join(done.stderr.split())

    def test_more_platforms_and_other_documentation_are_accepted(self):
        self.assertEqual(self.install(MERGED), (0, ""))

    def test_a_difference_is_refused_by_name(self):
        for name in ("modelDescription.xml", "binaries/linux64/it.so", "resources/firmware.elf"):
            with self.subTest(name):
                code, text = self.install(MERGED | {name: "other"})
                self.assertEqual(code, 1)
                self.assertIn(f"they differ in {name}. Run scripts/platforms.sh again", text)

    def test_an_archive_without_this_platform_is_refused(self):
        code, text = self.install({name: text for name, text in MERGED.items() if "linux64" not in name})
        self.assertEqual(code, 1)
        self.assertIn("they differ in binaries/linux64/it.so", text)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
