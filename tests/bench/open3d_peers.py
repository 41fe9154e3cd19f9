#!/usr/bin/env python3
# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Palpate beside Open3D on the same data in one run: registration from a good start, closest points, rays, STL files, voxels,
decimation.

    PYTHONPATH=build/release/python tests/bench/open3d_peers.py

Processor time of all threads, the best of three runs in turns; ratios below 1: Palpate is faster. Answers are compared in the
last column.
"""
import os
import tempfile
import time

import numpy as np
import open3d as o3d
import palpate

NOISE = 0.05  # mm
o3d.utility.set_verbosity_level(o3d.utility.VerbosityLevel.Error)


def surface(side):
    """A height field of 2 side^2 triangles, 300 mm wide."""
    x, y = np.meshgrid(np.linspace(0, 300, side + 1), np.linspace(0, 300, side + 1))
    z = 12 * np.sin(x / 23) * np.cos(y / 31) + 5 * np.sin(x / 7 + y / 11) + 20 * np.exp(-((x - 90) ** 2 + (y - 200) ** 2) / 900)
    a = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    b, c, d = a + 1, a + side + 2, a + side + 1
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    return np.stack([x.ravel(), y.ravel(), z.ravel()], 1), triangles.astype(np.int32)


def times(ours, peer):
    """Processor times [s] of both, in turns, and their results."""
    best, results = [np.inf, np.inf], [None, None]
    for turn in range(3):
        for i in (0, 1) if turn % 2 == 0 else (1, 0):
            start = time.process_time()
            results[i] = (ours, peer)[i]()
            best[i] = min(best[i], time.process_time() - start)
    return best, results


def report(what, best, note):
    print(f"{what:46} {best[0] * 1e3:9.1f} ms {best[1] * 1e3:9.1f} ms {best[0] / best[1]:7.2f}   {note}", flush=True)


def open3d_mesh(vertices, triangles):
    return o3d.geometry.TriangleMesh(o3d.utility.Vector3dVector(vertices), o3d.utility.Vector3iVector(triangles))


def pose_of(angle, shift):
    axis = np.array([0.3, -0.5, 0.8]) / np.linalg.norm([0.3, -0.5, 0.8])
    pose = np.eye(4)
    pose[:3, :3] = o3d.geometry.get_rotation_matrix_from_axis_angle(axis * angle)
    pose[:3, 3] = shift
    return pose


def registration(side, count):
    vertices, triangles = surface(side)
    random = np.random.default_rng(1)
    mesh = palpate.TriangleMesh(vertices, triangles)
    cloud = open3d_mesh(vertices, triangles)
    cloud.compute_vertex_normals()
    target = o3d.geometry.PointCloud(cloud.vertices)
    target.normals = cloud.vertex_normals
    sampled = np.asarray(cloud.sample_points_uniformly(count).points) + random.normal(0, NOISE, (count, 3))
    start = pose_of(0.01, [1, -0.7, 0.4])  # half a degree and a millimetre off
    points = (sampled - start[:3, 3]) @ start[:3, :3]
    source = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
    criteria = o3d.pipelines.registration.ICPConvergenceCriteria(1e-9, 1e-9, 100)
    methods = {
        "to planes": o3d.pipelines.registration.TransformationEstimationPointToPlane(),
        "to points": o3d.pipelines.registration.TransformationEstimationPointToPoint(),
    }
    for name, method in methods.items():
        best, (ours, theirs) = times(
            lambda: palpate.register_points(points, mesh, search_rotation=0, search_translation=0).T_target_source,
            lambda: o3d.pipelines.registration.registration_icp(source, target, 5.0, np.eye(4), method, criteria).transformation)
        errors = [np.abs((points @ pose[:3, :3].T + pose[:3, 3]) - sampled).max() for pose in (ours, theirs)]
        report(f"registration, {count} points, Open3D {name}", best, f"largest error {errors[0]:.1e} and {errors[1]:.1e} mm")


def queries(side, count):
    vertices, triangles = surface(side)
    random = np.random.default_rng(2)
    query = palpate.SurfaceQuery(palpate.TriangleMesh(vertices, triangles))
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(o3d.core.Tensor(vertices.astype(np.float32)), o3d.core.Tensor(triangles.astype(np.uint32)))
    points = random.uniform([0, 0, -30], [300, 300, 60], (count, 3))
    floats = o3d.core.Tensor(points.astype(np.float32))
    best, (ours, theirs) = times(lambda: query.closest_points(points).distances, lambda: scene.compute_distance(floats).numpy())
    report(f"distances of {count} points", best, f"differ by at most {np.abs(ours - theirs).max():.1e} mm")


def files(side):
    vertices, triangles = surface(side)
    mesh = palpate.TriangleMesh(vertices, triangles)
    with tempfile.TemporaryDirectory() as folder:
        for ending in (".stl", ".obj", ".ply"):
            path = os.path.join(folder, "mesh" + ending)
            palpate.write_mesh(path, mesh)
            best, (ours, theirs) = times(lambda: palpate.read_mesh(path), lambda: o3d.io.read_triangle_mesh(path))
            report(f"reading {ending}, {len(triangles)} triangles", best,
                   f"{len(ours.vertices)} and {len(theirs.vertices)} vertices")


def decimation(side, share):
    vertices, triangles = surface(side)
    mesh, peer = palpate.TriangleMesh(vertices, triangles), open3d_mesh(vertices, triangles)
    wanted = int(len(triangles) * share)
    best, (ours, theirs) = times(lambda: palpate.decimate(mesh, max_triangles=wanted),
                                 lambda: peer.simplify_quadric_decimation(wanted))
    distance = palpate.compare(palpate.TriangleMesh(np.asarray(theirs.vertices), np.asarray(theirs.triangles)), mesh)
    report(f"decimation to {wanted} triangles", best, f"Hausdorff distance {ours.distance:.3f} and {max(distance.hausdorff):.3f} mm")


if __name__ == "__main__":
    print(f"{'':46} {'Palpate':>12} {'Open3D':>12} {'ratio':>7}")
    registration(400, 100_000)
    registration(400, 10_000)
    queries(400, 100_000)
    files(400)
    decimation(300, 0.05)
