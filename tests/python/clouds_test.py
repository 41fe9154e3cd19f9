# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Functions on point clouds give what NumPy computes from all pairs, and what geometry says."""
import pathlib
import tempfile
import unittest

import numpy as np

import palpate
from shared import grid


def random_points(count, seed=1):
    return np.random.default_rng(seed).uniform(-10, 10, (count, 3))


def directions(count, seed=1):
    points = np.random.default_rng(seed).normal(size=(count, 3))
    return points / np.linalg.norm(points, axis=1, keepdims=True)


def distances(points, others):
    return np.linalg.norm(points[:, None] - others[None], axis=2)


class Files(unittest.TestCase):
    def test_points_and_normals_are_read_back(self):
        points, normals = random_points(50), directions(50)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "cloud.ply"
            palpate.write_points(path, points, normals=normals)
            np.testing.assert_array_equal(palpate.read_points(path), points)
            np.testing.assert_array_equal(palpate.read_points(path, unit=10), 10 * points)

    def test_what_cannot_be_written_or_read_is_named(self):
        with self.assertRaisesRegex(palpate.FileError, "/nowhere/a.pcd"):
            palpate.read_points("/nowhere/a.pcd")
        with self.assertRaisesRegex(palpate.InvalidInput, "points: its shape"):
            palpate.write_points("a.pcd", [1, 2, 3, 4])
        with self.assertRaises(palpate.InvalidInput):
            palpate.write_points("a.ply", random_points(3), normals=directions(2))


class Selections(unittest.TestCase):
    def test_isolated_points_have_too_few_others_near(self):
        points = random_points(300)
        others = (distances(points, points) <= 2).sum(axis=1) - 1
        np.testing.assert_array_equal(palpate.without_isolated(points, 2, 3), np.flatnonzero(others >= 3))

    def test_outliers_are_farther_from_their_neighbours_than_usual(self):
        points = np.vstack([random_points(500), [[100, 0, 0], [np.nan, 0, 0]]])
        np.testing.assert_array_equal(palpate.without_outliers(points, neighbours=8), np.arange(500))

    def test_voxels_have_the_means_of_their_points(self):
        points = np.vstack([random_points(400), [[np.inf, 0, 0]]])
        means, voxel = palpate.voxel_sample(points, 5)
        self.assertEqual(voxel[-1], -1)
        for index, mean in enumerate(means):
            inside = points[voxel == index]
            self.assertEqual(len(np.unique(np.floor(inside / 5), axis=0)), 1)
            np.testing.assert_allclose(mean, inside.mean(axis=0), atol=1e-12)

    def test_a_poisson_sample_is_sparse_and_leaves_no_gap(self):
        points = random_points(500)
        chosen = palpate.poisson_sample(points, 3)
        apart = distances(points[chosen], points[chosen])
        self.assertGreaterEqual(apart[~np.eye(len(chosen), dtype=bool)].min(), 3)
        self.assertLess(distances(points, points[chosen]).min(axis=1).max(), 3)

    def test_clusters_are_apart_and_the_largest_is_the_first(self):
        points = np.vstack([random_points(200), random_points(600, 2) + [100, 0, 0], [[0, 0, 500]]])
        np.testing.assert_array_equal(palpate.cloud_clusters(points, max_gap=15, min_points=2), [1] * 200 + [0] * 600 + [-1])

    def test_progress_is_told_and_what_it_raises_ends_the_work(self):
        told = []
        palpate.without_isolated(random_points(1000), 2, 3, progress=lambda done, total: told.append((done, total)))
        self.assertEqual(told[-1][0], told[-1][1])

        def stop(done, total):
            raise KeyboardInterrupt

        for work in (
            lambda: palpate.poisson_sample(random_points(10), 1, progress=stop),
            lambda: palpate.cloud_normals(random_points(10), progress=stop),
            lambda: palpate.find_plane(random_points(10), tolerance=1, progress=stop),
        ):
            with self.assertRaises(KeyboardInterrupt):
                work()


class Measures(unittest.TestCase):
    def test_distances_are_those_of_all_pairs(self):
        points, cloud = np.vstack([random_points(100), [[np.nan, 0, 0]]]), random_points(200, 2)
        np.testing.assert_allclose(
            palpate.distances_to_cloud(points, cloud), np.append(distances(points[:-1], cloud).min(axis=1), np.nan)
        )

    def test_distances_from_a_plane_have_its_sides(self):
        points = np.random.default_rng(1).uniform([0, 0, -3], [8, 6, 3], (100, 3))
        np.testing.assert_allclose(palpate.distances_to_surface(points, grid(9, 7)), points[:, 2], atol=1e-12)

    def test_normals_of_a_sphere_point_outwards_or_to_the_viewpoint(self):
        sphere = directions(3000)
        np.testing.assert_array_less(0.95, (palpate.cloud_normals(10 * sphere) * sphere).sum(axis=1))
        inwards = palpate.cloud_normals(10 * sphere, neighbours=10, viewpoint=[0, 0, 0])
        np.testing.assert_array_less((inwards * sphere).sum(axis=1), -0.95)


class Shapes(unittest.TestCase):
    def test_a_plane_is_found_among_other_points(self):
        points = random_points(900)
        points[:500, 2] = 0.5 * points[:500, 0] + 1
        plane = palpate.find_plane(points, tolerance=1e-6)
        np.testing.assert_array_equal(plane.inliers, np.arange(500))
        np.testing.assert_allclose(plane.normal, np.array([-0.5, 0, 1]) / np.sqrt(1.25), atol=1e-9)
        np.testing.assert_allclose(plane.point, points[:500].mean(axis=0), atol=1e-9)
        self.assertLess(plane.rms, 1e-9)
        self.assertIsNone(palpate.find_plane(random_points(300), tolerance=1e-6))

    def test_a_sphere_is_found_among_other_points(self):
        points = np.vstack([random_points(300), 4 * directions(400) + [1, 2, 3]])
        sphere = palpate.find_sphere(points, tolerance=1e-6)
        np.testing.assert_array_equal(sphere.inliers, np.arange(300, 700))
        np.testing.assert_allclose(sphere.centre, [1, 2, 3], atol=1e-9)
        self.assertAlmostEqual(sphere.radius, 4)
        self.assertIsNone(palpate.find_sphere(points, tolerance=1e-6, max_radius=3))

    def test_a_cylinder_is_found_by_its_normals(self):
        angle, along = np.random.default_rng(1).uniform([0, -5], [2 * np.pi, 5], (500, 2)).T
        normals = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(500)])
        cylinder = palpate.find_cylinder(3 * normals + along[:, None] * [0, 0, 1], normals, tolerance=1e-6)
        self.assertEqual(len(cylinder.inliers), 500)
        np.testing.assert_allclose(cylinder.axis, [0, 0, 1], atol=1e-9)
        self.assertAlmostEqual(cylinder.radius, 3)
        self.assertAlmostEqual(cylinder.length, np.ptp(along))


if __name__ == "__main__":
    unittest.main()
