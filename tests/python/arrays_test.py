# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Arrays go into the library and come out without a copy where they can, and wrong ones are refused in words."""
import gc
import itertools
import os
import tempfile
import unittest

import array_address
import numpy as np

import palpate
from shared import grid

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.7]])


def address(array):
    return array.__array_interface__["data"][0]


class Out(unittest.TestCase):
    def test_vertices_are_the_memory_of_the_mesh(self):
        mesh = palpate.TriangleMesh(SQUARE, [[0, 1, 2], [0, 2, 3]])
        self.assertIs(type(mesh.vertices), np.ndarray)
        self.assertEqual((mesh.vertices.dtype, mesh.vertices.shape), (np.float64, (4, 3)))
        self.assertTrue(mesh.vertices.flags.c_contiguous)
        view = mesh.vertices
        self.assertEqual(address(mesh.vertices), address(view))
        mesh.vertices[2] = [5, 6, 7]
        np.testing.assert_array_equal(view[2], [5, 6, 7])

    def test_what_was_written_to_vertices_is_what_functions_see(self):
        mesh = grid(2, 2)
        mesh.vertices[:, 2] = 4.25
        self.assertEqual(palpate.SurfaceQuery(mesh).closest_points([[0.5, 0.25, 0]]).distances[0], 4.25)

    def test_a_view_outlives_its_owner(self):
        mesh = grid(200, 200)
        view, copy = mesh.vertices, mesh.vertices.copy()
        closest = palpate.SurfaceQuery(mesh).closest_points(copy + [0, 0, 1])
        positions, distances = closest.positions, closest.distances
        del mesh, closest
        gc.collect()
        others = [np.full((40000, 3), 1e9) for _ in range(8)]  # take the memory, if it were free
        np.testing.assert_array_equal(view, copy)
        np.testing.assert_allclose(positions, copy, atol=1e-12)
        np.testing.assert_array_equal(distances, 1)
        del others

    def test_triangles_cannot_be_written_to(self):
        mesh = grid(2, 2)
        self.assertIs(type(mesh.triangles), np.ndarray)
        with self.assertRaises(ValueError):
            mesh.triangles[0, 0] = 99

    def test_depths_are_the_memory_of_the_range_map(self):
        camera = palpate.Camera(width=3, height=2, fx=10, fy=10, cx=1, cy=0.5)
        map = palpate.RangeMap(np.full((2, 3), 7.5), camera)
        map.z[1, 2] = np.nan
        self.assertEqual(map.z.dtype, np.float32)
        self.assertEqual(np.isnan(map.points()).any(axis=1).tolist(), [False] * 5 + [True])


class In(unittest.TestCase):
    def test_contiguous_float64_is_read_in_place(self):
        points = np.zeros((5, 3))
        self.assertEqual(array_address.seen_at(points), address(points))
        self.assertEqual(array_address.seen_at(points[1:4]), address(points[1:4]))
        mesh = grid(3, 3)
        self.assertEqual(array_address.seen_at(mesh.vertices), address(mesh.vertices))

    def test_other_layouts_are_converted(self):
        points = np.arange(12.0).reshape(4, 3)
        swapped = points.astype(points.dtype.newbyteorder())
        bytes_before = np.zeros(12 * 8 + 1, np.uint8)
        bytes_before[1:] = np.frombuffer(points.tobytes(), np.uint8)
        unaligned = bytes_before[1:].view(np.float64).reshape(4, 3)
        for given in (np.asfortranarray(points), points.astype(np.float32), points.astype(np.int16), swapped, unaligned,
                      np.repeat(points, 2, axis=0)[::2], points[::-1].copy()[::-1], points.tolist()):
            np.testing.assert_array_equal(palpate.TriangleMesh(given, [[0, 1, 2]]).vertices, points)
        self.assertEqual(array_address.seen_at(unaligned) % 8, 0)

    def test_indices_of_any_whole_type_are_taken(self):
        for kind in (np.int8, np.uint16, np.int64, np.uint64, np.float32, ">i4"):
            mesh = palpate.TriangleMesh(SQUARE, np.array([[0, 1, 2], [0, 2, 3]], kind, order="F"))
            self.assertEqual(mesh.triangles.dtype, np.int32)
            np.testing.assert_array_equal(mesh.triangles, [[0, 1, 2], [0, 2, 3]])

    def test_empty_arrays_are_taken(self):
        mesh = palpate.TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), int))
        self.assertEqual((mesh.vertices.shape, mesh.triangles.shape), ((0, 3), (0, 3)))


class Wrong(unittest.TestCase):
    def refuses(self, words, function, *arguments, **named):
        with self.assertRaisesRegex(palpate.InvalidInput, words) as caught:
            function(*arguments, **named)
        self.assertIsInstance(caught.exception, ValueError)
        self.assertIsInstance(caught.exception, palpate.Error)

    def test_shapes(self):
        self.refuses(r"vertices: its shape is \(4, 2\); it must be \(N, 3\)", palpate.TriangleMesh, SQUARE[:, :2], [[0, 1, 2]])
        self.refuses(r"vertices: .*transpose", palpate.TriangleMesh, SQUARE.T, [[0, 1, 2]])
        self.refuses(r"points: .*one point is a list of one", palpate.SurfaceQuery(grid(2, 2)).closest_points, [1, 2, 3])
        self.refuses(r"triangles: its shape is \(2, 4\)", palpate.TriangleMesh, SQUARE, np.zeros((2, 4), int))
        self.refuses(r"triangles: its shape is \(3,\)", palpate.TriangleMesh, SQUARE, [0, 1, 2])

    def test_types(self):
        self.refuses(r"vertices: its type is complex128; it must be real", palpate.TriangleMesh, SQUARE * 1j, [[0, 1, 2]])
        self.refuses(r"vertices: its type is <U1", palpate.TriangleMesh, [["a", "b", "c"]], [[0, 1, 2]])
        self.refuses(r"vertices: its type is object", palpate.TriangleMesh, [[None, 0, 0]], [[0, 1, 2]])
        self.refuses(r"vertices: is a masked array", palpate.TriangleMesh, np.ma.masked_less(SQUARE, 0), [[0, 1, 2]])
        self.refuses(r"triangles: its type is bool", palpate.TriangleMesh, SQUARE, [[True, False, True]])
        self.refuses(r"vertices: ", palpate.TriangleMesh, [[0, 0, 0], [1, 2]], [[0, 1, 2]])

    def test_indices_out_of_range_name_their_place(self):
        for wrong, words in ((-1, "-1"), (2**31, "2147483648"), (2**63 - 1, "9223372036854775807"), (0.5, "0.5"),
                             (np.nan, "nan"), (np.inf, "inf"), (1e300, r"1e\+300")):
            triangles = np.array([[0, 1, 2], [0, 2, 3]], type(wrong) if isinstance(wrong, float) else np.int64)
            triangles[1, 2] = wrong
            self.refuses(rf"triangles: \[1, 2\] is {words}; it must be a whole number from 0 to 2147483647",
                         palpate.TriangleMesh, SQUARE, triangles)
        self.refuses(r"\[0, 0\] is 18446744073709551615", palpate.TriangleMesh, SQUARE, np.array([[2**64 - 1, 0, 1]], np.uint64))

    def test_indices_without_a_vertex_are_refused_by_what_uses_them(self):
        mesh = palpate.TriangleMesh(SQUARE, [[0, 1, 2], [0, 2, 7]])
        self.refuses("triangle 1", palpate.SurfaceQuery, mesh)
        self.refuses("triangle 1", palpate.geodesic_distance, mesh, [0])

    def test_vertices_that_are_not_finite_are_named(self):
        mesh = grid(3, 3)
        mesh.vertices[4, 1] = np.nan
        for function in (palpate.SurfaceQuery, lambda m: palpate.decimate(m, tolerance=1), lambda m: palpate.compare(m, m)):
            self.refuses("vertex 4", function, mesh)

    def test_sources_of_distances(self):
        mesh = grid(3, 3)
        self.refuses(r"sources\[1\] is 9; the mesh has 9 vertices", palpate.geodesic_distance, mesh, [0, 9])
        self.refuses(r"sources: \[0\] is -1", palpate.geodesic_distance, mesh, [-1])
        self.refuses("method: is 'quick'; it must be one of 'fast_marching', 'exact'",
                     palpate.geodesic_distance, mesh, [0], method="quick")

    def test_an_argument_of_another_class_is_a_type_error(self):
        with self.assertRaises(TypeError):
            palpate.decimate(SQUARE, tolerance=1)
        with self.assertRaises(TypeError):
            palpate.decimate(None, tolerance=1)


class Junk(unittest.TestCase):
    def test_arguments_of_any_kind_are_refused_in_words(self):
        junk = [None, -1, 2**70, float("nan"), "x", b"x", [], {}, object(), np.zeros((2, 3)), np.array("a"), grid(2, 2)]
        calls = [getattr(palpate, name) for name in palpate.__all__ if callable(getattr(palpate, name))]
        calls = [call for call in calls if not (isinstance(call, type) and issubclass(call, Exception))]
        before = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)  # some name files to write
            try:
                for call in calls:
                    for arguments in itertools.chain([()], itertools.product(junk), itertools.product(junk, junk)):
                        try:
                            call(*arguments)
                        except (TypeError, palpate.Error) as error:
                            self.assertGreater(len(str(error)), 10, (call, arguments))
            finally:
                os.chdir(before)


if __name__ == "__main__":
    unittest.main()
