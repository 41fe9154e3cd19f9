# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""The notebooks of docs/notebooks run, and print what is stored in them."""
import os
import sys
import unittest
from pathlib import Path

import nbformat

REPOSITORY = Path(os.environ["PALPATE_REPOSITORY"])
sys.path.insert(0, str(REPOSITORY / "studies"))
import notebooks  # noqa: E402


def outputs(notebook):
    """The text of each output, or its kind for a picture, cell by cell."""
    return [(cell.source, [output.get("text") or output.data.get("image/png") and "picture" or output.data["text/plain"]
                           for output in cell.outputs])
            for cell in notebook.cells if cell.cell_type == "code"]


class Notebooks(unittest.TestCase):
    def test_the_stored_outputs_are_those_of_today(self):
        paths = sorted((REPOSITORY / "docs/notebooks").glob("*.ipynb"))
        self.assertEqual(len(paths), 5)
        for path in paths:
            with self.subTest(path.name):
                self.assertEqual(outputs(notebooks.run(path)), outputs(nbformat.read(path, as_version=4)))


if __name__ == "__main__":
    unittest.main()
