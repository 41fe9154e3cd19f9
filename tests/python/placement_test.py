# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""An arm is placed by touches, and by a ball that it holds."""
import unittest

import numpy as np

import palpate
from shared import grid

# Where the arm stands: the x axis of its base is the camera's z axis.
POSE = np.array([[0.0, 1, 0, 30], [0, 0, 1, -190], [1, 0, 0, 400], [0, 0, 0, 1]])


def for_arm(points):
    return (np.asarray(points) - POSE[:3, 3]) @ POSE[:3, :3]


def hills():
    """A surface before a camera, with normals towards it."""
    flat = grid(50, 40, 2.0)
    x, y, _ = np.asarray(flat.vertices).T
    z = 700 - 8 * np.sin(x / 15) * np.cos(y / 12) - 4 * np.sin(x / 8 + y / 9) - 0.002 * (x - 50) * (y - 40)
    return palpate.TriangleMesh(np.column_stack([x, y, z]), np.asarray(flat.triangles)[:, ::-1])


class ByTouches(unittest.TestCase):
    def test_touched_points_give_the_pose(self):
        surface = hills()
        inside = np.random.default_rng(1).choice(len(surface.vertices), 300, replace=False)
        touched = np.asarray(surface.vertices)[inside]
        touched = touched[(touched[:, 0] > 5) & (touched[:, 0] < 90) & (touched[:, 1] > 5) & (touched[:, 1] < 70)][:60]
        start = POSE.copy()
        start[:3, 3] += [5, -4, 8]
        found = palpate.place_arm_by_touches(for_arm(touched), surface, start=start)
        self.assertTrue(found.determined, found.reason)
        np.testing.assert_allclose(found.T_camera_base, POSE, atol=1e-5)
        self.assertTrue(found.used.all())
        self.assertEqual(found.distances.shape, (60,))
        self.assertEqual(found.covariance.shape, (6, 6))
        with self.assertRaisesRegex(palpate.InvalidInput, "tip_radius is -1"):
            palpate.place_arm_by_touches(for_arm(touched), surface, tip_radius=-1)

    def test_a_plane_leaves_motions_free(self):
        flat = grid(30, 30, 3.0)
        points = np.asarray(flat.vertices)[31:600:13]
        found = palpate.place_arm_by_touches(for_arm(points), flat)
        self.assertFalse(found.determined)
        self.assertIn("does not fix", found.reason)


class ByABall(unittest.TestCase):
    def test_balls_that_are_seen_give_the_pose_and_the_offset(self):
        random = np.random.default_rng(2)
        normals = random.normal(size=(4000, 3))
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        normals = normals[normals[:, 2] < -0.2]
        tips, balls, turns = [], [], []
        offset = np.array([3.0, -2, 40])
        for _ in range(12):
            turn = random.normal(size=4)
            turn /= np.linalg.norm(turn)
            x, y, z, w = turn
            matrix = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                               [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                               [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
            centre = random.uniform([-60, -50, 640], [60, 50, 760])
            ball = palpate.find_ball(centre + 15 * normals, normals, 15)
            np.testing.assert_allclose(ball.centre, centre, atol=1e-6)
            tips.append(for_arm(centre) - matrix @ offset)
            balls.append(ball)
            turns.append(turn)
        balls[4] = None
        found = palpate.place_arm_by_ball(tips, balls, 15, orientations=turns)
        self.assertTrue(found.determined, found.reason)
        np.testing.assert_allclose(found.T_camera_base, POSE, atol=1e-5)
        np.testing.assert_allclose(found.offset, offset, atol=1e-5)
        self.assertEqual(list(np.flatnonzero(~found.used)), [4])
        self.assertTrue(np.isnan(found.distances[4]))

    def test_too_few_or_wrong_arguments_are_named(self):
        self.assertIn("at 0 poses", palpate.place_arm_by_ball(np.zeros((2, 3)), [None, None], 15).reason)
        with self.assertRaisesRegex(palpate.InvalidInput, "balls: there are 1"):
            palpate.place_arm_by_ball(np.zeros((2, 3)), [None], 15)
        with self.assertRaisesRegex(palpate.InvalidInput, "orientations"):
            palpate.place_arm_by_ball(np.zeros((2, 3)), [None, None], 15, orientations=np.zeros((2, 3)))
        self.assertIsNone(palpate.find_ball(np.zeros((0, 3)), np.zeros((0, 3)), 15))


if __name__ == "__main__":
    unittest.main()
