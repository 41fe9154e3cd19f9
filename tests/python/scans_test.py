# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Scans become one clean surface."""
import unittest

import numpy as np

import palpate
from shared import grid


class Merging(unittest.TestCase):
    def test_planes_at_different_heights_become_one_at_their_weighted_mean(self):
        scans = [grid(41, 31, 0.5), grid(41, 31, 0.5)]
        scans[1].vertices[:, 2] += 0.01  # far less than the spacing
        count = len(scans[0].vertices)
        merged = palpate.merge_scans(scans, sigmas=[np.full(count, 0.1), np.full(count, 0.2)], spacing=0.5)
        inside = (np.abs(merged.mesh.vertices - [10, 7.5, 0]) < [6, 4, 1]).all(axis=1)
        self.assertGreater(inside.sum(), 300)
        np.testing.assert_allclose(merged.mesh.vertices[inside, 2], 0.01 / 5, atol=1e-5)
        np.testing.assert_allclose(merged.sigma[inside], 0.1 * np.sqrt(4 / 5), rtol=1e-3)
        self.assertEqual(merged.spacing, 0.5)

    def test_scans_are_moved_by_their_poses(self):
        scans = [grid(31, 31, 0.5), grid(31, 31, 0.5)]
        turned = [[1, 0, 0, 0], [0, 0, -1, 5], [0, 1, 0, 5], [0, 0, 0, 1]]  # about x, and away
        merged = palpate.merge_scans(scans, poses=[None, turned])
        self.assertEqual(len(merged.sigma), 0)
        on_first = np.abs(merged.mesh.vertices[:, 2]) < 1e-9
        on_second = np.abs(merged.mesh.vertices[:, 1] - 5) < 1e-9
        self.assertGreater(on_first.sum(), 500)
        self.assertGreater(on_second.sum(), 500)

    def test_what_does_not_belong_to_the_scans_is_refused(self):
        with self.assertRaisesRegex(palpate.InvalidInput, "poses: there are 1"):
            palpate.merge_scans([grid(3, 3), grid(3, 3)], poses=[None])
        with self.assertRaisesRegex(palpate.InvalidInput, r"poses\[1\]: must be"):
            palpate.merge_scans([grid(3, 3), grid(3, 3)], poses=[None, 2 * np.eye(4)])
        with self.assertRaisesRegex(palpate.InvalidInput, "9 vertices and 1 standard deviations"):
            palpate.merge_scans([grid(3, 3)], sigmas=[[0.1]])

    def test_what_progress_raises_ends_the_work(self):
        def stop(done, total):
            raise KeyboardInterrupt

        with self.assertRaises(KeyboardInterrupt):
            palpate.merge_scans([grid(9, 9)], progress=stop)


class Cleaning(unittest.TestCase):
    def test_a_hole_in_a_plane_is_filled_and_its_outline_stays(self):
        whole = grid(11, 11)
        corners = whole.vertices[whole.triangles]
        kept = whole.triangles[(np.abs(corners - [5, 5, 0]) > 1.5).any(axis=(1, 2))]
        try:
            filled = palpate.fill_holes(palpate.TriangleMesh(whole.vertices, kept), max_diameter=6)
        except palpate.Error as error:
            self.assertIn("without CGAL", str(error))
            self.skipTest("the library was built without CGAL")
        self.assertEqual((filled.filled, filled.left), (1, 1))
        np.testing.assert_allclose(filled.mesh.vertices[:, 2], 0, atol=1e-12)
        a, b, c = filled.mesh.vertices[filled.mesh.triangles].transpose(1, 0, 2)
        self.assertAlmostEqual(np.cross(b - a, c - a)[:, 2].sum() / 2, 100)

    def test_smoothing_removes_noise_and_keeps_the_border(self):
        noisy = grid(31, 31)
        noisy.vertices[:, 2] += np.random.default_rng(1).normal(0, 0.1, len(noisy.vertices))
        smooth = palpate.smooth(noisy, iterations=30, keep_border=True)
        border = (np.abs(noisy.vertices[:, :2] - 15) == 15).any(axis=1)
        np.testing.assert_array_equal(smooth.vertices[border], noisy.vertices[border])
        self.assertLess(smooth.vertices[~border, 2].std(), 0.05)
        self.assertGreater(noisy.vertices[~border, 2].std(), 0.09)  # the given mesh stays


if __name__ == "__main__":
    unittest.main()
