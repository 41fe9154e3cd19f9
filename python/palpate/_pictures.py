# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Small pictures for notebooks, as PNG files in memory: a shaded surface, and depths in false colour."""
from __future__ import annotations

import math
import struct
import zlib

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Pixels = npt.NDArray[np.uint8]

WIDTH, HEIGHT = 320, 240  # px
BACKGROUND = np.array([255, 255, 255], np.uint8)
SURFACE = np.array([205, 180, 150], np.float64)
DOT = np.array([200, 30, 30], np.uint8)
# From near to far: dark blue, green, yellow, as in perceptually uniform scales.
FALSE_COLORS = np.array([[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]], np.float64)


def png(pixels: Pixels) -> bytes:
    """PNG file of (rows, columns, 3) colours."""
    rows, columns, _ = pixels.shape

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    lines = b"".join(b"\0" + line.tobytes() for line in pixels)
    header = struct.pack(">IIBBBBB", columns, rows, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b"")


def depth_pixels(z: npt.NDArray[np.float32]) -> Pixels:
    """Depths in false colour, near ones bright; white where unknown. Large maps are thinned out to about WIDTH."""
    step = max(1, math.ceil(max(z.shape[1] / WIDTH, z.shape[0] / HEIGHT)))
    z = z[::step, ::step]
    known = np.isfinite(z)
    pixels = np.full((*z.shape, 3), BACKGROUND)
    if known.any():
        near, far = np.percentile(z[known], [1, 99])  # single wrong depths do not count
        share = np.clip((far - z[known]) / max(far - near, 1e-9), 0, 1) * (len(FALSE_COLORS) - 1)
        colors = [np.interp(share, range(len(FALSE_COLORS)), FALSE_COLORS[:, i]) for i in range(3)]
        pixels[known] = np.stack(colors, axis=1)
    return pixels


def view_from(normals: Array) -> tuple[Array, Array]:
    """Axes of the picture and the direction to the viewer: where most of the surface faces, or obliquely if it is closed.
    The picture's y axis is the world's as far as possible, which points down."""
    mean = normals.sum(axis=0)
    area = np.linalg.norm(normals, axis=1).sum()
    to_viewer = mean if np.linalg.norm(mean) > 0.3 * area else np.array([0.5, -0.6, -0.8])
    to_viewer = to_viewer / np.linalg.norm(to_viewer)
    down = np.array([0.0, 1.0, 0.0]) if abs(to_viewer[1]) < 0.95 else np.array([0.0, 0.0, 1.0])
    right = np.cross(to_viewer, down)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(right, to_viewer)]), to_viewer


def surface_pixels(vertices: Array, triangles: npt.NDArray[np.int32], dots: Array | None = None) -> Pixels:
    """A surface, shaded by its angle to the viewer, with `dots` on it. White if there is no triangle to be seen."""
    pixels = np.full((HEIGHT, WIDTH, 3), BACKGROUND)
    valid = ((triangles >= 0) & (triangles < len(vertices))).all(axis=1)
    corners = vertices[triangles[valid]]
    corners = corners[np.isfinite(corners).all(axis=(1, 2))]
    if len(corners) == 0:
        return pixels
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    axes, to_viewer = view_from(normals)
    low, high = (corners.reshape(-1, 3) @ axes.T).min(axis=0), (corners.reshape(-1, 3) @ axes.T).max(axis=0)
    scale = 0.94 * min(WIDTH / max(high[0] - low[0], 1e-9), HEIGHT / max(high[1] - low[1], 1e-9))

    def project(points: Array) -> Array:
        at: Array = (points @ axes.T - (low + high) / 2) * scale + [WIDTH / 2, HEIGHT / 2]
        return at

    lengths = np.linalg.norm(normals, axis=1)
    facing = np.abs(normals @ to_viewer) / np.maximum(lengths, 1e-300)
    nearest = np.full(HEIGHT * WIDTH, -np.inf)
    shade = np.zeros(HEIGHT * WIDTH)
    flat = project(corners)
    sides = np.abs(flat - np.roll(flat, 1, axis=1)).max(axis=(1, 2))
    # Each triangle becomes points less than a pixel apart, as many as a power of two along its longest side.
    powers = np.clip(np.ceil(np.log2(np.maximum(1.5 * sides, 1))), 0, 10).astype(int)
    for power in np.unique(powers):
        chosen = powers == power
        n = 2**power
        i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1))
        inside = i + j <= n
        weights = np.stack([n - i[inside] - j[inside], i[inside], j[inside]], axis=1) / n
        for part in np.array_split(np.flatnonzero(chosen), max(1, chosen.sum() * len(weights) // 500_000)):
            points = np.einsum("kc,tcd->tkd", weights, corners[part]).reshape(-1, 3)
            at = project(points).astype(int)
            index = at[:, 1] * WIDTH + at[:, 0]
            depth = points @ to_viewer
            order = np.argsort(depth, kind="stable")  # the nearest is written last
            order = order[depth[order] > nearest[index[order]]]
            nearest[index[order]] = depth[order]
            shade[index[order]] = np.repeat(facing[part], len(weights))[order]
    seen = np.isfinite(nearest)
    pixels.reshape(-1, 3)[seen] = SURFACE * (0.25 + 0.75 * shade[seen, None])
    if dots is not None:
        for column, row in project(dots).astype(int):
            pixels[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2] = DOT
    return pixels
