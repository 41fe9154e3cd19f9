# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Notebooks get a line of words, and the page of `palpate export --html`."""
import html
import re
import sys
import types
import unittest

import numpy as np

import palpate
from shared import DEMO, PAGE, grid


class Words(unittest.TestCase):
    def test_meshes_are_told_of_by_counts_and_size(self):
        self.assertEqual(html.unescape(grid(3, 5)._repr_html_()), "<p>15 vertices, 16 triangles, 2 × 4 × 0 mm</p>")
        for mesh in (palpate.TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), int)),
                     palpate.TriangleMesh([[np.nan, 0, 0]], np.zeros((0, 3), int))):
            self.assertIn("no vertices", mesh._repr_html_())

    def test_range_maps_are_told_of_by_their_known_depths(self):
        camera = palpate.Camera(width=40, height=20, fx=9, fy=9, cx=9, cy=9)
        z = np.add.outer(np.zeros(20), np.linspace(500, 600, 40))
        z[:, 10:20] = np.nan
        map = palpate.RangeMap(z, camera)
        self.assertIn("40 × 20 pixels, 600 with a depth, 500 to 600 mm", html.unescape(map._repr_html_()))
        map.z[:] = np.nan
        self.assertIn("none with a depth", map._repr_html_())

    def test_models_are_told_of_by_their_contacts(self):
        self.assertIn("46 contacts", palpate.read_model(PAGE / "model")._repr_html_())


class Pages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.model = palpate.read_model(PAGE / "model")

    def tearDown(self):
        sys.modules.pop("IPython", None)

    def test_the_page_is_that_of_the_command(self):
        self.assertEqual(self.model.page(title="A <sheet> & its feel"), (PAGE / "model.html").read_text())

    def test_show_puts_the_page_into_a_notebook(self):
        shown = []
        notebook = types.ModuleType("IPython")
        notebook.get_ipython = lambda: "a shell"
        notebook.display = types.SimpleNamespace(HTML=lambda text: text, display=shown.append)
        sys.modules["IPython"] = notebook
        self.model.show(title="Sheet", height=321)
        (frame,) = shown
        self.assertIn("height:321px", frame)
        inside = re.fullmatch(r'<iframe srcdoc="([^"]*)" [^<>]*></iframe>', frame).group(1)
        self.assertEqual(html.unescape(inside), self.model.page(title="Sheet"))

    def test_show_says_what_is_missing_outside_of_a_notebook(self):
        with self.assertRaisesRegex(palpate.Error, "IPython.*write_page"):
            self.model.show()

    def test_a_friction_that_is_wrong_is_refused(self):
        with self.assertRaisesRegex(palpate.InvalidInput, "unknown_friction"):
            self.model.page(unknown_friction=float("nan"))


if __name__ == "__main__":
    unittest.main()
