# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Exact pixels of a board give the exact rig."""
import pathlib
import tempfile
import unittest

import numpy as np

import palpate
from shared import DEMO

SIZES = (640, 480), (512, 384)
FOCAL = 801.0, 903.0
CENTRES = np.array([325.3, 236.7]), np.array([251.9, 215.3])
TURN = np.array([[0.96, 0.0, 0.28], [0.0, 1.0, 0.0], [-0.28, 0.0, 0.96]])  # of the projector
MOVE = np.array([90.7, 121.3, -11.9])


def rotation(axis, angle):
    """Rodrigues' formula."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def view(number, tilt=0.5):
    """A board of 9 x 6 corners, seen by lenses without distortion."""
    board = np.array([[15.5 * column, 15.5 * row] for row in range(6) for column in range(9)])
    turn = rotation((np.cos(2.4 * number), np.sin(2.4 * number), 0), tilt)
    flat = np.column_stack([board - [62, 38.75], np.zeros(len(board))])
    seen = flat @ turn.T + [18 * np.cos(5 * number), 14 * np.sin(3 * number), 430 + 25 * (number % 4)]
    lit = seen @ TURN.T + MOVE
    camera, projector = (f * points[:, :2] / points[:, 2:] + c for points, f, c in zip((seen, lit), FOCAL, CENTRES))
    return palpate.RigView(f"view {number}", board=board, camera=camera, lit_camera=camera, projector=projector)


class CalibrateRig(unittest.TestCase):
    def test_exact_pixels_give_the_exact_rig(self):
        found = palpate.calibrate_rig([view(i) for i in range(8)], *SIZES, distortion_terms=0)
        self.assertAlmostEqual(found.rig.camera.fx, FOCAL[0], 4)
        self.assertAlmostEqual(found.rig.projector.fy, FOCAL[1], 4)
        np.testing.assert_allclose(found.rig.T_projector_camera[:3, :3], TURN, atol=1e-7)
        np.testing.assert_allclose(found.rig.T_projector_camera[:3, 3], MOVE, atol=1e-4)
        self.assertEqual([name for name, *_ in found.views], [f"view {i}" for i in range(8)])
        self.assertEqual(found.rejected, [])
        self.assertLess(max(found.camera_rms, found.projector_rms, found.stereo_rms), 1e-5)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "rig.yaml"
            found.rig.write(path)
            np.testing.assert_array_equal(palpate.read_rig(path).T_projector_camera, found.rig.T_projector_camera)

    def test_views_that_determine_nothing_are_refused(self):
        level = [view(i, tilt=0.01) for i in range(8)]
        with self.assertRaisesRegex(palpate.SolverError, "do not determine the rig"):
            palpate.calibrate_rig(level, *SIZES, distortion_terms=0)
        for options, words in (({"distortion_terms": 3}, "distortion_terms is 3; it must be 0, 2, 4 or 5"),
                               ({"min_tilt": 0}, "min_tilt is 0 rad; it must be in")):
            with self.assertRaisesRegex(palpate.InvalidInput, words):
                palpate.calibrate_rig(level, *SIZES, **options)
        with self.assertRaisesRegex(palpate.InvalidInput, r"board: must have the shape \(N, 2\)"):
            palpate.RigView("a", board=[1, 2], camera=[[1, 2]], lit_camera=[[1, 2]], projector=[[1, 2]])

    def test_folders_without_images_are_no_views(self):
        with self.assertRaisesRegex(palpate.FileError, "there is no image in it"):
            palpate.read_rig_views([DEMO / "sheet"], SIZES[1], columns=9, rows=6, square=15.5)


if __name__ == "__main__":
    unittest.main()
