# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Range maps and meshes with values that are known, written without Palpate."""
import array
import math
import random
import struct

kWidth, kHeight = 160, 120
kFrames = 3
kFocal, kCenter = 170.0, (81.3, 57.9)  # [px]
kDistortion = (-0.21, 0.06, 0.001, -0.002)  # k1 k2 p1 p2
kCamera = f"""%YAML:1.0
---
camera_size: [{kWidth}, {kHeight}]
camera_matrix: !!opencv-matrix
   {{ rows: 3, cols: 3, dt: d, data: [{kFocal}, 0., {kCenter[0]}, 0., {kFocal}, {kCenter[1]}, 0., 0., 1.] }}
camera_distortion: !!opencv-matrix
   {{ rows: 1, cols: 4, dt: d, data: [{", ".join(map(str, kDistortion))}] }}
"""


def write_tiff(path, values, bits):
    """One channel, uncompressed: 32-bit floating point or 8-bit whole numbers, row by row."""
    data = array.array({32: "f", 8: "B"}[bits], values).tobytes()
    fields = [(256, 3, kWidth), (257, 3, kHeight), (258, 3, bits), (259, 3, 1), (262, 3, 1), (273, 4, 8), (277, 3, 1), (278, 3, kHeight),
              (279, 4, len(data)), (339, 3, {32: 3, 8: 1}[bits])]
    entries = b"".join(struct.pack("<HHII", tag, kind, 1, value) for tag, kind, value in fields)
    start = 8 + len(data) + len(data) % 2
    path.write_bytes(struct.pack("<2sHI", b"II", 42, start) + data + bytes(len(data) % 2) + struct.pack("<H", len(fields)) + entries + bytes(4))


def single(value):
    """The value in single precision."""
    return struct.unpack("<f", struct.pack("<f", value))[0]


def frame(number):
    """Depths, deviations [mm] and reasons, row by row: a bump before a wall, which moves; without values in a disc and at the left.
    The last wall is farther away."""
    choose = random.Random(number)
    depths, sigmas, reasons = [], [], []
    for row in range(kHeight):
        for column in range(kWidth):
            bump = 40 * math.exp(-((column - 60 - 20 * number) ** 2 + (row - 50) ** 2) / 500)
            known = column > 4 and math.hypot(column - 120, row - 90) > 15
            depths.append(single((1000 if number == kFrames - 1 else 700) + 0.3 * row - bump + choose.gauss(0, 0.05)) if known else math.nan)
            sigmas.append(single(0.05 + 0.001 * column) if known else math.nan)
            reasons.append(0 if known else 4 if column > 4 else 1)
    return depths, sigmas, reasons


def write_range_maps(folder):
    """Returns the frames."""
    folder.mkdir(parents=True)
    (folder / "rig.yaml").write_text(kCamera)
    frames = [frame(number) for number in range(kFrames)]
    for number, (depths, sigmas, reasons) in enumerate(frames):
        write_tiff(folder / f"{number:06}.tiff", depths, 32)
        write_tiff(folder / f"{number:06}_sigma.tiff", sigmas, 32)
        write_tiff(folder / f"{number:06}_reasons.tiff", reasons, 8)
    return frames


def ray(column, row):
    """x / z and y / z of a pixel: the distortion of Brown and Conrady, inverted by iteration."""
    k1, k2, p1, p2 = kDistortion
    wanted = (column - kCenter[0]) / kFocal, (row - kCenter[1]) / kFocal
    x, y = wanted
    for _ in range(100):
        r2 = x * x + y * y
        radial = 1 + k1 * r2 + k2 * r2 * r2
        x, y = ((wanted[0] - 2 * p1 * x * y - p2 * (r2 + 2 * x * x)) / radial, (wanted[1] - p1 * (r2 + 2 * y * y) - 2 * p2 * x * y) / radial)
    return x, y


def write_meshes(folder, side=24):
    """A sheet that bends more and more, with the number "distance" of each vertex. Returns vertices [mm] and numbers of each."""
    folder.mkdir(parents=True)
    meshes = []
    corners = [(row * side + column, row * side + column + 1, (row + 1) * side + column, (row + 1) * side + column + 1)
               for row in range(side - 1) for column in range(side - 1)]
    triangles = [triangle for a, b, c, d in corners for triangle in ((a, b, c), (b, d, c))]
    for number in range(kFrames):
        vertices = [(500.123 + 3 * column, 3 * row, 2.7 * number * math.sin(column / 4)) for row in range(side) for column in range(side)]
        numbers = [math.nan if i % 50 == 7 else single(vertices[i][2] - 0.01 * i) for i in range(len(vertices))]
        lines = ["ply", "format ascii 1.0", f"element vertex {len(vertices)}", *(f"property double {axis}" for axis in "xyz"),
                 "property float distance", f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header",
                 *(" ".join(map(repr, [*vertex, value])) for vertex, value in zip(vertices, numbers)),
                 *(f"3 {a} {b} {c}" for a, b, c in triangles)]
        (folder / f"{number:06}.ply").write_text("\n".join(lines) + "\n")
        meshes.append((vertices, numbers))
    return meshes
