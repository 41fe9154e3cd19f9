# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""A surface is followed from range map to range map."""
import unittest

import numpy as np

import palpate

CAMERA = palpate.Camera(width=120, height=90, fx=200, fy=200, cx=59.5, cy=44.5)


def relief(shift):
    """A range map of a rippled surface 700 mm away, moved by (dx, dy, dz) mm."""
    v, u = np.mgrid[: CAMERA.height, : CAMERA.width]
    x, y = (u - CAMERA.cx) / CAMERA.fx, (v - CAMERA.cy) / CAMERA.fy
    z = np.full(x.shape, 700.0)
    for _ in range(30):  # the ray meets the surface where z agrees with its height there
        z = 700 + shift[2] + 8 * np.sin((x * z - shift[0]) / 12) * np.cos((y * z - shift[1]) / 15)
    return palpate.RangeMap(z, CAMERA)


class Tracking(unittest.TestCase):
    def test_vertices_follow_their_points_on_relief(self):
        reference = palpate.mesh_from(relief((0, 0, 0)))
        tracker = palpate.SurfaceTracker(reference, nodes=60)
        np.testing.assert_array_equal(tracker.triangles, reference.triangles)
        for shift in ((0, 0, 0), (2, -1, 3), (4, -2, 6)):
            found = tracker.track(relief(shift))
            self.assertEqual(found.lost, "")
            self.assertEqual(found.vertices.shape, reference.vertices.shape)
            inside = (np.abs(reference.vertices[:, :2]) < [150, 100]).all(axis=1)
            errors = np.linalg.norm(found.vertices - reference.vertices - shift, axis=1)[inside]
            self.assertLess(np.median(errors), 0.5)  # mm; pixels are 3.5 mm wide
            self.assertLess(found.rms, 0.2)
            self.assertGreater(found.measured, 0.9)
            across, along = np.median([found.sigma_across[inside], found.sigma_along[inside]], axis=1)
            self.assertLess(across, along)
            self.assertLess(along, 3.5)

    def test_texture_shows_the_motion_of_a_plane_in_itself(self):
        v, u = np.mgrid[: CAMERA.height, : CAMERA.width]
        x, y = 700 * (u - CAMERA.cx) / CAMERA.fx, 700 * (v - CAMERA.cy) / CAMERA.fy
        plane = palpate.RangeMap(np.full(x.shape, 700.0), CAMERA)
        reference = palpate.mesh_from(plane)
        inside = (np.abs(reference.vertices[:, :2]) < [150, 100]).all(axis=1)
        tracker = palpate.SurfaceTracker(reference, nodes=60)
        for shift in (0, 3, 6):  # mm; pixels are 3.5 mm wide
            texture = np.sin((x - shift) / 14 + 0.3 * np.cos(y / 30)) + np.sin(y / 12 - (x - shift) / 40)
            found = tracker.track(plane, image=100 + 40 * texture)
            errors = np.linalg.norm(found.vertices - reference.vertices - (shift, 0, 0), axis=1)[inside]
            self.assertLess(np.median(errors), 0.5)
        with self.assertRaisesRegex(palpate.InvalidInput, "must be of one size"):
            tracker.track(plane, image=np.ones((3, 4)))

    def test_a_surface_that_is_hidden_is_lost_and_found_again(self):
        tracker = palpate.SurfaceTracker(palpate.mesh_from(relief((0, 0, 0))), nodes=60)
        tracker.track(relief((0, 0, 0)))
        hidden = palpate.RangeMap(np.full((CAMERA.height, CAMERA.width), 400.0), CAMERA)
        self.assertIn("min_visible", tracker.track(hidden).lost)
        self.assertEqual(tracker.track(relief((1, 0, 1))).lost, "")

    def test_wrong_options_are_refused_by_name(self):
        reference = palpate.mesh_from(relief((0, 0, 0)))
        with self.assertRaisesRegex(palpate.InvalidInput, "nodes is 0; it must be"):
            palpate.SurfaceTracker(reference, nodes=0)
        with self.assertRaisesRegex(TypeError, "'knots' is not a keyword argument"):
            palpate.SurfaceTracker(reference, knots=3)
        with self.assertRaisesRegex(palpate.InvalidInput, "no triangles"):
            palpate.SurfaceTracker(palpate.TriangleMesh(np.eye(3), np.zeros((0, 3), int)))


if __name__ == "__main__":
    unittest.main()
