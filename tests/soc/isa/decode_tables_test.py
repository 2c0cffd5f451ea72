# SPDX-License-Identifier: Apache-2.0
"""Tests that the generator of the tables of instructions refuses contradictory rows, and names their place."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

ISA = pathlib.Path(__file__).resolve().parents[3] / "fmu_soc/src/isa"
ADD = "add   0000000 ..... ..... 000 ..... 0110011  @r\n"


def generate(rows):
    """Runs the generator with a table that has these rows. Returns its exit code and message."""
    with tempfile.TemporaryDirectory() as folder:
        table = pathlib.Path(folder) / "trial.decode"
        table.write_text(rows, encoding="utf-8")
        done = subprocess.run([sys.executable, ISA / "decode_tables.py", folder, ISA / "formats.decode", table],
                              capture_output=True, text=True, check=False)
        return done.returncode, done.stderr


class DecodeTables(unittest.TestCase):
    def expect_refused(self, rows, message):
        code, text = generate(rows)
        self.assertEqual(1, code)
        self.assertIn(message, text)

    def test_accept_a_row(self):
        self.assertEqual((0, ""), generate(ADD))

    def test_refuse_two_rows_for_one_word(self):
        self.expect_refused(ADD + "sum   0000000 ..... ..... ... ..... 0110011  @r\n",
                            "trial.decode:2: 'sum' overlaps 'add' (trial.decode:1)")

    def test_refuse_a_wrong_number_of_bits(self):
        self.expect_refused(ADD.replace("0000000", "000000"), "trial.decode:1: an encoding of @r has 31 bits")

    def test_refuse_an_unknown_format_class_or_attribute(self):
        self.expect_refused(ADD.replace("@r", "@q"), "no format @q")
        self.expect_refused(ADD.replace("@r", "@r  &slow"), "no class &slow")
        self.expect_refused(ADD.replace("@r", "@r  colour=red"), "unknown: colour")

    def test_refuse_another_encoding_of_no_operation(self):
        self.expect_refused(ADD.replace("@r", "@r  = plus"), "no operation plus above this row")

    def test_refuse_a_row_of_more_than_120_columns(self):
        self.expect_refused(ADD.strip() + " " * 80 + "\n", "the most is 120")


if __name__ == "__main__":
    unittest.main()
