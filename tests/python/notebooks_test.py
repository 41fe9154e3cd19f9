# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""The notebooks of docs/notebooks run, and print what is stored in them."""
import os
import re
import sys
import unittest
from pathlib import Path

import nbformat

REPOSITORY = Path(os.environ["PALPATE_REPOSITORY"])
sys.path.insert(0, str(REPOSITORY / "studies"))
import notebooks  # noqa: E402

NUMBER = r"\d+(?:\.\d+)?"
# Libraries choose instructions by the processor, which may change the last digits: part of a number, besides its last digit.
TOLERANCE = 0.01


def outputs(notebook):
    """The text of each output, or its kind for a picture, cell by cell."""
    return [[output.get("text") or output.data.get("image/png") and "picture" or output.data["text/plain"] for output in cell.outputs]
            for cell in notebook.cells if cell.cell_type == "code"]


class Notebooks(unittest.TestCase):
    def assert_alike(self, today, stored):
        def words(text):
            return re.sub(NUMBER, "#", text).split()
        self.assertEqual(words(today), words(stored))
        for found, expected in zip(re.findall(NUMBER, today), re.findall(NUMBER, stored)):
            last_digit = 10.0 ** -len(expected.partition(".")[2])
            self.assertAlmostEqual(float(found), float(expected), delta=TOLERANCE * float(expected) + last_digit, msg=today)

    def test_the_stored_outputs_are_those_of_today(self):
        paths = sorted((REPOSITORY / "docs/notebooks").glob("*.ipynb"))
        self.assertEqual(len(paths), 5)
        for path in paths:
            today, stored = outputs(notebooks.run(path)), outputs(nbformat.read(path, as_version=4))
            self.assertEqual([len(cell) for cell in today], [len(cell) for cell in stored], path.name)
            for cell, before in zip(today, stored):
                for text, text_before in zip(cell, before):
                    with self.subTest(path.name):
                        self.assert_alike(text, text_before)


if __name__ == "__main__":
    unittest.main()
