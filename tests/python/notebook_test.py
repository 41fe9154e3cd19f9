# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Notebooks get small pictures, and the page of `palpate export --html`."""
import base64
import html
import re
import struct
import sys
import types
import unittest
import zlib

import numpy as np

import palpate
from palpate import _pictures
from shared import DEMO, PAGE, grid


def pixels_of(text):
    """The picture of a representation: (rows, columns, 3)."""
    data = base64.b64decode(re.search(r'src="data:image/png;base64,([^"]+)"', text).group(1))
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    parts, at = {}, 8
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        kind, body = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        assert struct.unpack(">I", data[at + 8 + length : at + 12 + length])[0] == zlib.crc32(kind + body)
        parts[kind] = body
        at += 12 + length
    columns, rows = struct.unpack(">II", parts[b"IHDR"][:8])
    lines = np.frombuffer(zlib.decompress(parts[b"IDAT"]), np.uint8).reshape(rows, 1 + 3 * columns)
    return lines[:, 1:].reshape(rows, columns, 3)


def share_drawn(pixels):
    return (pixels != 255).any(axis=2).mean()


class Pictures(unittest.TestCase):
    def test_a_square_fills_the_height_and_leaves_its_sides(self):
        for cells in (1, 40):  # few large triangles, and many small ones
            pixels = pixels_of(grid(cells + 1, cells + 1)._repr_html_())
            expected = (0.94 * _pictures.HEIGHT) ** 2 / (_pictures.WIDTH * _pictures.HEIGHT)
            self.assertAlmostEqual(share_drawn(pixels), expected, delta=0.02)

    def test_what_is_nearer_hides_what_is_behind(self):
        # Two squares that face the viewer, the nearer one tilted, so that it is darker.
        far, near = grid(2, 2), grid(2, 2)
        far.vertices[:] = (far.vertices - [0.5, 0.5, 0]) * 10 + [0, 0, -8]
        near.vertices[:] = (near.vertices - [0.5, 0.5, 0]) * 2 @ [[0.6, 0, 0.8], [0, 1, 0], [-0.8, 0, 0.6]]
        both = palpate.TriangleMesh(np.concatenate([near.vertices, far.vertices]), np.concatenate([near.triangles, far.triangles + 4]))
        for mesh in (both, palpate.TriangleMesh(both.vertices, both.triangles[::-1])):
            pixels = pixels_of(mesh._repr_html_()).astype(int)
            middle = pixels[_pictures.HEIGHT // 2, _pictures.WIDTH // 2]
            beside = pixels[_pictures.HEIGHT // 5, _pictures.WIDTH // 2]
            self.assertLess(middle.sum(), beside.sum() - 30)

    def test_meshes_that_cannot_be_drawn_are_told_of_all_the_same(self):
        for mesh in (palpate.TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), int)),
                     palpate.TriangleMesh([[0, 0, np.nan], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]),
                     palpate.TriangleMesh([[0, 0, 0], [1, 0, 0]], [[0, 1, 5]])):
            self.assertEqual(share_drawn(pixels_of(mesh._repr_html_())), 0)
        flat = palpate.TriangleMesh([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]])
        self.assertIn("3 vertices", flat._repr_html_())

    def test_unknown_depths_are_white(self):
        camera = palpate.Camera(width=40, height=20, fx=9, fy=9, cx=9, cy=9)
        z = np.add.outer(np.zeros(20), np.linspace(500, 600, 40))
        z[:, 10:20] = np.nan
        map = palpate.RangeMap(z, camera)
        pixels = pixels_of(map._repr_html_())
        np.testing.assert_array_equal((pixels == 255).all(axis=2), np.isnan(z))
        self.assertIn("40 × 20 pixels, 600 with a depth, 500 to 600 mm", html.unescape(map._repr_html_()))
        map.z[:] = np.nan
        self.assertIn("none with a depth", map._repr_html_())

    def test_a_model_shows_its_contacts(self):
        text = palpate.read_model(PAGE / "model")._repr_html_()
        red = (pixels_of(text) == _pictures.DOT).all(axis=2).sum()
        self.assertTrue(46 * 5 < red <= 46 * 9, red)
        self.assertIn("46 contacts", text)
        self.assertLess(len(text), 60_000)


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
