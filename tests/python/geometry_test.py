# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Functions on meshes give what geometry says."""
import copy
import os
import pathlib
import pickle
import subprocess
import tempfile
import unittest

import numpy as np

import palpate
from shared import DEMO, PAGE, REPOSITORY, grid


def export(name, *options):
    """Runs `palpate export` on a file of the demo, or of another folder."""
    subprocess.run([os.environ["PALPATE_COMMAND"], "export", DEMO / name, *options], check=True, stdout=subprocess.DEVNULL)


def rotation(axis, angle):
    axis = np.asarray(axis) / np.linalg.norm(axis)
    cross = np.cross(np.eye(3), axis)
    return np.eye(3) - np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


class Files(unittest.TestCase):
    def test_a_mesh_is_read_back_exactly(self):
        mesh = grid(4, 3, 1 / 3)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "grid.ply"
            palpate.write_mesh(path, mesh)
            read = palpate.read_mesh(str(path))
        np.testing.assert_array_equal(read.vertices, mesh.vertices)
        np.testing.assert_array_equal(read.triangles, mesh.triangles)

    def test_vtk_reads_what_is_written_for_it(self):
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkIOLegacy import vtkPolyDataReader

        mesh = grid(4, 3, 1 / 3)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "grid.vtk"
            palpate.write_mesh(path, mesh)
            reader = vtkPolyDataReader()
            reader.SetFileName(str(path))
            reader.Update()
        data = reader.GetOutput()
        np.testing.assert_array_equal(vtk_to_numpy(data.GetPoints().GetData()), mesh.vertices)
        np.testing.assert_array_equal(vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3), mesh.triangles)

    def test_numpy_and_open3d_read_exported_depths(self):
        import open3d

        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            export("truth/duck.tiff", "--rig", DEMO / "rig.yaml", "--png", "--npy", "-o", folder / "duck")
            exact = np.load(folder / "duck.npy")
            image = open3d.io.read_image(str(folder / "duck.png"))
            camera = open3d.io.read_pinhole_camera_intrinsic(str(folder / "camera_intrinsic.json"))
        range_map = palpate.read_range_map(DEMO / "truth/duck.tiff", DEMO / "rig.yaml")
        np.testing.assert_array_equal(exact, range_map.z)
        units = np.asarray(image)
        self.assertEqual(units.dtype, np.uint16)
        np.testing.assert_array_equal(units == 0, np.isnan(exact))
        self.assertLess(np.nanmax(abs(0.1 * units - exact)), 0.0501)
        cloud = open3d.geometry.PointCloud.create_from_depth_image(image, camera, depth_scale=10000, depth_trunc=10)
        v, u = np.nonzero(units)
        c = camera.intrinsic_matrix
        rays = np.stack([(u - c[0, 2]) / c[0, 0], (v - c[1, 2]) / c[1, 1], np.ones(len(u))], axis=1)
        self.assertLess(abs(1000 * np.asarray(cloud.points) - rays * exact[v, u][:, None]).max(), 0.0501)

    def test_vtk_reads_the_forces_of_an_exported_model(self):
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkIOLegacy import vtkPolyDataReader

        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "model.vtk"
            export(PAGE / "model", "--vtk", "--press-depth", "2", "-o", path)
            reader = vtkPolyDataReader()
            reader.SetFileName(str(path))
            reader.Update()
        values = reader.GetOutput().GetPointData()
        model = palpate.read_model(PAGE / "model")
        force = vtk_to_numpy(values.GetArray("force"))
        stiffness = vtk_to_numpy(values.GetArray("stiffness"))
        self.assertEqual(len(force), len(model.surface.vertices))
        self.assertGreater(np.isfinite(force).sum(), 0)
        np.testing.assert_array_equal(np.isfinite(force), np.isfinite(stiffness))

    def test_a_mesh_can_be_copied_and_sent_to_another_process(self):
        mesh = grid(4, 3, 1 / 3)
        for other in (copy.copy(mesh), copy.deepcopy(mesh), pickle.loads(pickle.dumps(mesh))):
            np.testing.assert_array_equal(other.triangles, mesh.triangles)
            other.vertices[0] = 7
            self.assertEqual(mesh.vertices[0].tolist(), [0, 0, 0])

    def test_the_unit_of_a_file_may_be_stated(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "one.obj"
            path.write_text("v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n")
            np.testing.assert_array_equal(palpate.read_mesh(path, unit=10).vertices[2], [0, 20, 0])

    def test_files_that_are_missing_or_wrong_are_named(self):
        with self.assertRaisesRegex(palpate.FileError, "/nowhere/a.ply") as caught:
            palpate.read_mesh("/nowhere/a.ply")
        self.assertIsInstance(caught.exception, OSError)
        with self.assertRaisesRegex(palpate.FileError, "rig.yaml"):
            palpate.read_mesh(DEMO / "rig.yaml")
        with self.assertRaises(palpate.OutputError):
            palpate.write_mesh("/proc/grid.ply", grid(2, 2))
        with self.assertRaises(palpate.InvalidInput):
            palpate.write_mesh("grid.unknown", grid(2, 2))

    def test_a_mistyped_folder_is_not_made(self):
        with tempfile.TemporaryDirectory() as folder:
            place = pathlib.Path(folder) / "resluts"
            mesh = grid(2, 2)
            map = palpate.read_range_map(DEMO / "truth/duck.tiff", DEMO / "rig.yaml")
            rig = palpate.read_rig(DEMO / "rig.yaml")
            for write in (lambda: palpate.write_mesh(place / "a.ply", mesh), lambda: palpate.write_points(place / "a.pcd", mesh.vertices),
                          lambda: palpate.write_range_map(place / "a.tiff", map), lambda: rig.write(place / "rig.yaml")):
                with self.assertRaisesRegex(palpate.OutputError, "there is no folder .*resluts; check the path"):
                    write()
                self.assertFalse(place.exists())
            place.mkdir()
            palpate.write_mesh(place / "a.ply", mesh)
            self.assertTrue((place / "a.ply").exists())

    # tests/install/check_install.cmake tests that a missing package raises it.
    def test_what_a_build_does_not_have_has_an_error_of_its_own(self):
        self.assertTrue(issubclass(palpate.Unavailable, palpate.Error))
        self.assertFalse(issubclass(palpate.Unavailable, palpate.InvalidInput))


class Surfaces(unittest.TestCase):
    def test_closest_points_of_a_plane_are_below_them(self):
        points = np.random.default_rng(1).uniform([0, 0, -3], [8, 6, 3], (1000, 3))
        closest = palpate.SurfaceQuery(grid(9, 7)).closest_points(points)
        np.testing.assert_allclose(closest.distances, np.abs(points[:, 2]), atol=1e-12)
        np.testing.assert_allclose(closest.positions, points * [1, 1, 0], atol=1e-12)
        corners = grid(9, 7).vertices[grid(9, 7).triangles[closest.triangles]]
        np.testing.assert_allclose(np.einsum("nc,ncd->nd", closest.barycentric, corners), closest.positions, atol=1e-12)

    def test_a_point_that_is_not_finite_has_no_closest_point(self):
        closest = palpate.SurfaceQuery(grid(2, 2)).closest_points([[0, 0, 1], [np.nan, 0, 0]])
        self.assertEqual(closest.triangles.tolist()[1], -1)
        self.assertTrue(np.isnan(closest.distances[1]) and closest.distances[0] == 1)

    def test_segments_cross_a_plane_where_they_pass_through_it(self):
        starts = np.random.default_rng(2).uniform([1, 1, 1], [7, 5, 3], (200, 3))
        ends = np.random.default_rng(3).uniform([1, 1, -3], [7, 5, -1], (200, 3))
        ends[0] = starts[0] + [0, 0, 1]  # stays above
        hits = palpate.SurfaceQuery(grid(9, 7)).first_hits(starts, ends)
        along = starts[:, 2] / (starts[:, 2] - ends[:, 2])
        np.testing.assert_allclose(hits.along[1:], along[1:], atol=1e-12)
        np.testing.assert_allclose(hits.positions[1:], (starts + along[:, None] * (ends - starts))[1:], atol=1e-12)
        self.assertTrue(hits.triangles[0] == -1 and np.isnan(hits.along[0]))
        with self.assertRaisesRegex(palpate.InvalidInput, "ends"):
            palpate.SurfaceQuery(grid(9, 7)).first_hits(starts, ends[1:])

    def test_all_crossings_of_two_planes_are_in_their_order(self):
        lower = grid(9, 7)
        both = palpate.TriangleMesh(
            np.vstack([lower.vertices, lower.vertices + [0, 0, 1]]),
            np.vstack([lower.triangles, lower.triangles + len(lower.vertices)]),
        )
        starts = np.random.default_rng(2).uniform([1, 1, 2], [7, 5, 3], (50, 3))
        ends = np.random.default_rng(3).uniform([1, 1, -3], [7, 5, -1], (50, 3))
        ends[10] = starts[10] + [0, 0, 1]  # stays above
        hits = palpate.SurfaceQuery(both).all_hits(starts, ends)
        np.testing.assert_array_equal(hits.segments, np.repeat(np.delete(np.arange(50), 10), 2))
        np.testing.assert_allclose(hits.positions[:, 2], np.tile([1, 0], 49), atol=1e-12)
        from_start = (starts[hits.segments, 2] - hits.positions[:, 2]) / (starts - ends)[hits.segments, 2]
        np.testing.assert_allclose(hits.along, from_start, atol=1e-12)
        corners = both.vertices[both.triangles[hits.triangles]]
        np.testing.assert_allclose(np.einsum("nc,ncd->nd", hits.barycentric, corners), hits.positions, atol=1e-12)
        with self.assertRaisesRegex(palpate.InvalidInput, "all_hits"):
            palpate.SurfaceQuery(both).all_hits(starts, ends[1:])

    def test_the_winding_number_passes_one_half_at_a_sheet_that_seems_endless(self):
        sheet = grid(201, 201, 10)  # the back of a triangle is inside
        above, below = [1000, 1000, 1], [1000, 1000, -1]
        winding = palpate.WindingNumber(sheet)
        np.testing.assert_allclose(winding.at([below, above], tolerance=0), [0.5, -0.5], atol=1e-3)
        np.testing.assert_allclose(winding.at([below, above]), winding.at([below, above], tolerance=0), atol=0.01)
        self.assertTrue(np.isnan(winding.at([[np.nan, 0, 0]])[0]))
        cube = palpate.TriangleMesh(
            [[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)],
            [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]]
            + [[2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]],
        )
        points = np.random.default_rng(4).uniform(-1, 2, (300, 3))
        inside = ((points > 0) & (points < 1)).all(axis=1)
        np.testing.assert_array_equal(palpate.WindingNumber(cube).contains(points), inside)
        with self.assertRaisesRegex(palpate.InvalidInput, "tolerance"):
            winding.at(points, tolerance=-1)

    def test_distances_along_a_plane_are_euclidean(self):
        mesh = grid(31, 21, 0.5)
        source = 31 * 10 + 7
        straight = np.linalg.norm(mesh.vertices - mesh.vertices[source], axis=1)
        exact = palpate.geodesic_distance(mesh, [source], method="exact")
        np.testing.assert_allclose(exact.distance, straight, atol=1e-9)
        near = palpate.geodesic_distance(mesh, [source], stop_radius=3)
        np.testing.assert_array_equal(np.isfinite(near.distance), near.label == 0)
        self.assertLess(near.distance[np.isfinite(near.distance)].max(), 3.5)

    def test_a_prepared_mesh_gives_what_the_mesh_gives(self):
        mesh = grid(31, 21, 0.5)
        surface = palpate.GeodesicSurface(mesh)
        for method in ("fast_marching", "exact"):
            for source in (0, 200):
                np.testing.assert_array_equal(
                    palpate.geodesic_distance(surface, [source], method=method).distance,
                    palpate.geodesic_distance(mesh, [source], method=method).distance,
                )
        (path,) = palpate.shortest_paths(surface, [0], [300])
        self.assertEqual(path.length, palpate.shortest_paths(mesh, [0], [300])[0].length)
        self.assertAlmostEqual(palpate.straighten_path(surface, path).length, path.length)
        with self.assertRaises(TypeError):
            palpate.geodesic_distance(None, [0])

    def test_places_on_another_mesh_are_refused(self):
        mesh, other = grid(5, 5), grid(21, 21)
        places = palpate.SurfaceQuery(mesh).closest_points([[1, 1, 0]])
        (path,) = palpate.shortest_paths(mesh, places, [3])
        words = "another mesh, with 25 vertices and 32 triangles; this one has 441 vertices and 800 triangles"
        for call in (lambda: palpate.geodesic_distance(other, places), lambda: palpate.geodesic_distances(other, places),
                     lambda: palpate.shortest_paths(other, [0], places), lambda: palpate.straighten_path(other, path)):
            with self.assertRaisesRegex(palpate.InvalidInput, words):
                call()
        moved = palpate.TriangleMesh(mesh.vertices + [0, 0, 5], mesh.triangles)  # the same places later
        self.assertEqual(palpate.shortest_paths(moved, places, [3])[0].length, path.length)

    def test_coordinates_are_not_taken_for_vertices(self):
        for sources in ([[0.5, 1, 0]], [0.5, 1, 0], [25]):
            with self.assertRaisesRegex(palpate.InvalidInput, r"^sources.*given by their indices, \(N,\), and coordinates as ClosestPoints"):
                palpate.geodesic_distance(grid(5, 5), sources)

    def test_sources_may_lie_anywhere_on_the_surface(self):
        mesh = grid(11, 11)
        places = palpate.SurfaceQuery(mesh).closest_points([[2.3, 4.1, 0], [8.6, 5.2, 0]])
        found = palpate.geodesic_distance(mesh, places, method="exact")
        straight = np.linalg.norm(mesh.vertices[:, None] - places.positions, axis=2)
        np.testing.assert_allclose(found.distance, straight.min(axis=1), atol=1e-9)
        np.testing.assert_array_equal(found.label, straight.argmin(axis=1))
        each = palpate.geodesic_distances(mesh, places, method="exact")
        np.testing.assert_allclose(each, straight.T, atol=1e-9)

    def test_a_shortest_path_on_a_plane_is_the_straight_line(self):
        mesh = grid(31, 21, 0.5)
        places = palpate.SurfaceQuery(mesh).closest_points([[2.3, 4.1, 0], [8.6, 5.2, 0]])
        targets = [0, 31 * 20 + 30, 31 * 7 + 3]
        for place, path in zip(targets, palpate.shortest_paths(mesh, places, targets)):
            straight = np.linalg.norm(mesh.vertices[place] - places.positions, axis=1)
            self.assertAlmostEqual(path.length, straight.min(), 9)
            self.assertEqual(path.source, straight.argmin())
            steps = np.linalg.norm(np.diff(path.positions, axis=0), axis=1)
            self.assertAlmostEqual(steps.sum(), path.length, 9)
            corners = mesh.vertices[mesh.triangles[path.triangles]]
            np.testing.assert_allclose(np.einsum("nk,nkd->nd", path.barycentric, corners), path.positions, atol=1e-12)

    def test_a_path_along_edges_is_pulled_tight(self):
        mesh = grid(31, 21, 0.5)
        edges = [31 * 2 + x for x in range(4, 20)] + [31 * y + 19 for y in range(3, 12)]
        straight = np.linalg.norm(mesh.vertices[edges[0]] - mesh.vertices[edges[-1]])
        tight = palpate.straighten_path(mesh, edges)
        self.assertAlmostEqual(tight.length, straight, 9)
        there, on = palpate.shortest_paths(mesh, [edges[0]], [0])[0], palpate.shortest_paths(mesh, [0], [edges[-1]])[0]
        self.assertAlmostEqual(palpate.straighten_path(mesh, [there, on]).length, straight, 9)
        with self.assertRaisesRegex(palpate.InvalidInput, "point 1 "):
            palpate.straighten_path(mesh, [0, 5])

    def test_there_is_no_path_between_pieces(self):
        one = grid(3, 3)
        two = palpate.TriangleMesh(np.concatenate([one.vertices, one.vertices + [10, 0, 0]]),
                                   np.concatenate([one.triangles, one.triangles + 9]))
        self.assertEqual(palpate.shortest_paths(two, [0], [12]), [None])

    def test_a_plane_is_remeshed_to_an_edge_length(self):
        mesh = grid(31, 21, 0.5)
        seen = []
        result = palpate.remesh(mesh, edge_length=1.2, progress=lambda done, total: seen.append((done, total)))
        corners = result.mesh.vertices[result.mesh.triangles]
        edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
        self.assertAlmostEqual(edges.mean(), 1.2, delta=0.2)
        self.assertEqual(seen[-1][0], seen[-1][1])
        # Values of the vertices, here x, follow by the weights.
        values = mesh.vertices[:, 0][mesh.triangles[result.triangles]]
        np.testing.assert_allclose((values * result.barycentric).sum(axis=1), result.mesh.vertices[:, 0], atol=1e-9)
        with self.assertRaisesRegex(palpate.InvalidInput, "edge_length"):
            palpate.remesh(mesh, edge_length=0)
        with self.assertRaisesRegex(palpate.InvalidInput, "edge_length must be given"):
            palpate.remesh(mesh)
        with self.assertRaisesRegex(palpate.InvalidInput, "edge_length is .* more than the 100 of max_triangles"):
            palpate.remesh(mesh, edge_length=0.5, max_triangles=100)

    def test_a_plane_needs_two_triangles(self):
        seen = []
        result = palpate.decimate(grid(21, 21), tolerance=0.01, progress=lambda done, total: seen.append((done, total)))
        self.assertLess(len(result.mesh.triangles), 10)
        self.assertLessEqual(result.distance, 0.01)
        np.testing.assert_array_equal(result.mesh.vertices, grid(21, 21).vertices[result.source])
        self.assertEqual(seen[-1][0], seen[-1][1])

    def test_what_progress_raises_ends_the_work(self):
        def stop(done, total):
            raise KeyError("enough")

        with self.assertRaisesRegex(KeyError, "enough"):
            palpate.decimate(grid(21, 21), tolerance=0.01, progress=stop)
        with self.assertRaisesRegex(KeyError, "enough"):
            palpate.repair(grid(3, 3), progress=stop)
        with self.assertRaisesRegex(KeyError, "enough"):
            palpate.register_points(grid(3, 3).vertices, grid(21, 21), progress=stop)

    def test_a_repeated_triangle_is_removed(self):
        mesh = grid(3, 3)
        broken = palpate.TriangleMesh(mesh.vertices, np.concatenate([mesh.triangles, mesh.triangles[:1]]))
        repaired = palpate.repair(broken)
        self.assertEqual((repaired.removed_triangles, len(repaired.mesh.triangles)), (1, len(mesh.triangles)))
        np.testing.assert_array_equal(repaired.mesh.vertices, mesh.vertices[repaired.source])

    def test_planes_are_compared_with_their_distance(self):
        mesh, shifted = grid(5, 5), grid(5, 5)
        shifted.vertices[:, 2] += 0.75
        result = palpate.compare(shifted, mesh)
        for figure in (result.mean, result.rms, result.median, result.p90, *result.distance):
            self.assertAlmostEqual(figure, 0.75, 12)
        self.assertAlmostEqual(palpate.compare(mesh, shifted).mean, -0.75, 12)
        self.assertAlmostEqual(result.area, 16, 12)
        self.assertEqual(len(result.cells.triangles), len(result.distance))
        lower, upper = result.hausdorff
        self.assertTrue(lower <= 0.75 + 1e-12 and 0.75 - 1e-12 <= upper <= 0.75 * 1.02)

    def test_a_moved_surface_is_registered(self):
        mesh = palpate.read_mesh(REPOSITORY / "demo/sheet_block/surface.ply")
        centre = mesh.vertices.mean(axis=0)
        bumpy = palpate.TriangleMesh(mesh.vertices, mesh.triangles)
        x, y = (mesh.vertices - centre)[:, :2].T
        bumpy.vertices[:, 2] += 3 * np.sin(x / 9) * np.cos(y / 14) + 2 * np.exp(-((x - 20) ** 2 + (y + 11) ** 2) / 60)
        turn, shift = rotation([1, 2, 3], 0.2), np.array([4, -3, 5])
        points = ((bumpy.vertices - centre) @ turn.T + centre + shift)[::7]
        found = palpate.register_points(points, bumpy)
        self.assertTrue(found.accepted, found.reason)
        moved = points @ found.T_target_source[:3, :3].T + found.T_target_source[:3, 3]
        np.testing.assert_allclose(moved, bumpy.vertices[::7], atol=1e-6)
        # What is known beforehand is taken, and nothing is searched.
        start = np.eye(4)
        start[:3, :3], start[:3, 3] = turn.T, centre - turn.T @ (centre + shift)
        known = palpate.register_points(points, bumpy, start=start, search_rotation=0, search_translation=0)
        np.testing.assert_allclose(known.T_target_source, start, atol=1e-6)

    def test_a_plane_is_refused_because_points_slide(self):
        found = palpate.register_points(grid(9, 9).vertices + [0.5, 0.5, 0.1], grid(12, 12))
        self.assertEqual((found.accepted, found.verdict), (False, "slides"))

    def test_a_start_that_is_no_pose_is_refused(self):
        for start in (np.eye(3), 2 * np.eye(4), np.full((4, 4), np.nan), np.diag([1, 1, -1, 1])):
            with self.assertRaisesRegex(palpate.InvalidInput, "start: must be"):
                palpate.register_points(grid(3, 3).vertices, grid(3, 3), start=start)


class RangeMaps(unittest.TestCase):
    def test_the_mesh_of_a_plane_lies_in_it(self):
        camera = palpate.Camera(width=40, height=30, fx=50, fy=50, cx=20, cy=15)
        z = np.full((30, 40), 100.0)
        z[5, 5] = np.nan
        map = palpate.RangeMap(z, camera)
        self.assertEqual(repr(map), "<palpate.RangeMap: 40 x 30 pixels, 1199 with a depth>")
        mesh = palpate.mesh_from(map)
        self.assertEqual(len(mesh.vertices), 1199)
        np.testing.assert_array_equal(mesh.vertices[:, 2], 100)
        v, u = np.mgrid[:30, :40]
        expected = np.stack([(u - 20) / 50 * z, (v - 15) / 50 * z, z], axis=-1).reshape(-1, 3)
        np.testing.assert_allclose(map.points(), expected, atol=1e-12)

    def test_depths_and_cameras_that_do_not_fit_are_refused(self):
        camera = palpate.Camera(width=4, height=3, fx=1, fy=1, cx=0, cy=0)
        for z, words in ((np.zeros((4, 3)), "3 x 4 pixels, but the camera has 4 x 3"), (np.zeros(12), r"\(rows, columns\)"),
                         (np.zeros((3, 4), complex), "real numbers")):
            with self.assertRaisesRegex(palpate.InvalidInput, words):
                palpate.RangeMap(z, camera)
        with self.assertRaisesRegex(palpate.InvalidInput, "fx"):
            palpate.Camera(width=4, height=3, fx=np.nan, fy=1, cx=0, cy=0)
        with self.assertRaisesRegex(palpate.InvalidInput, "at most 8"):
            palpate.Camera(width=4, height=3, fx=1, fy=1, cx=0, cy=0, distortion=range(9))

    def test_files_are_read_back_with_their_camera(self):
        map = palpate.read_range_map(DEMO / "truth/duck.tiff", DEMO / "rig.yaml")
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "map.tiff"
            palpate.write_range_map(path, map)
            np.testing.assert_array_equal(palpate.read_range_map(path, DEMO / "rig.yaml").z, map.z)
            with self.assertRaisesRegex(palpate.FileError, "map.tiff: needs its camera: .* as rig=, or .* rig.yaml"):
                palpate.read_range_map(path)
            with self.assertRaisesRegex(palpate.FileError, "nowhere.tiff: no such file"):
                palpate.read_range_map(path.parent / "nowhere.tiff")

    def test_depth_images_are_read_with_their_unit(self):
        image, camera = DEMO / "depth_sequence/depth/000000.png", DEMO / "depth_sequence/camera.json"
        with self.assertRaisesRegex(palpate.FileError, "000000.png: a depth image needs scale=, .*: 1 for most"):
            palpate.read_range_map(image, camera)
        with self.assertRaisesRegex(palpate.FileError, "000000.png: needs its camera: .* as rig="):
            palpate.read_range_map(image, scale=1)
        depths = palpate.read_range_map(image, camera, scale=1).z
        self.assertEqual(depths.shape, (150, 200))
        np.testing.assert_array_equal(palpate.read_range_map(image, camera, scale=0.5).z, depths / 2)
        with self.assertRaisesRegex(palpate.InvalidInput, "with 1 mm, half of the depths"):
            palpate.read_range_map(image, camera, scale=0.001)

    def test_background_is_left_out(self):
        map = palpate.read_range_map(DEMO / "depth_sequence/depth/000000.png", DEMO / "depth_sequence/camera.json", scale=1)
        expected = np.where((map.z >= 400) & (map.z <= 430), map.z, np.nan)
        np.testing.assert_array_equal(palpate.select_depths(map, near=400, far=430).z, expected)
        mask = np.zeros(map.z.shape, bool)
        mask[50:60] = True
        np.testing.assert_array_equal(palpate.select_depths(map, mask=mask).z, np.where(mask, map.z, np.nan))
        object = np.isfinite(palpate.select_depths(map, far=700, remove_plane=3).z)
        self.assertTrue(2000 < object.sum() < 5000)
        boxed = palpate.select_depths(map, crop=[[-100, -100, 300, 0, 100, 600]])
        self.assertLessEqual(np.nanmax(boxed.points()[:, 0]), 0)
        with self.assertRaisesRegex(palpate.InvalidInput, "far is -1"):
            palpate.select_depths(map, far=-1)
        with self.assertRaisesRegex(palpate.InvalidInput, "mask: has no pixel"):
            palpate.select_depths(map, mask=np.zeros((0, 0), bool))

    def test_noise_of_depths_is_reduced_within_their_deviations(self):
        random, sigma = np.random.default_rng(1), np.full((40, 60), 0.5)
        camera = palpate.Camera(width=60, height=40, fx=100, fy=100, cx=29.5, cy=19.5)
        noisy = palpate.RangeMap(500 + sigma * random.standard_normal(sigma.shape), camera)
        sigma[0] = np.nan
        smooth = palpate.smooth_depths(noisy, sigma)
        np.testing.assert_array_equal(smooth.z[0], noisy.z[0])
        self.assertLessEqual(np.abs(smooth.z - noisy.z).max(), 0.5001)
        self.assertLess(np.std(smooth.z[5:]), 0.7 * np.std(noisy.z[5:]))
        still = palpate.smooth_depths(noisy, sigma, max_move=1e-9)
        np.testing.assert_array_equal(still.z, noisy.z)
        with self.assertRaisesRegex(palpate.InvalidInput, r"radius_px is 0 px; it must be in \[1, 15\]"):
            palpate.smooth_depths(noisy, sigma, radius_px=0)


if __name__ == "__main__":
    unittest.main()
