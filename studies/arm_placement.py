# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""arm_placement.py PALPATE [RADIUS [POSES [SETS]]]: how well `calibrate arm --ball` places an arm by what the virtual sensor sees.

A ball of this radius (default 20 mm) on a rod is moved to POSES random places (default 12) before the bundled rig and a wall, seen,
decoded and given to `calibrate arm` with exact positions of the arm; SETS times (default 4). Prints the table of
docs/place-an-arm.md.
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
ROD = 5.0  # mm, radius
WALL = "900"  # mm


def ball_mesh(radius, rings=60, sectors=120):
    """Vertices and triangles of a ball about the origin; facets are up to 0.04 % of the radius off the sphere."""
    polar = np.pi * np.arange(1, rings) / rings
    around = 2 * np.pi * np.arange(sectors) / sectors
    rows = np.stack([np.outer(np.sin(polar), np.cos(around)), np.outer(np.sin(polar), np.sin(around)),
                     np.outer(np.cos(polar), np.ones(sectors))], axis=-1).reshape(-1, 3)
    vertices = radius * np.vstack([rows, [[0, 0, 1], [0, 0, -1]]])
    triangles = []
    for i in range(rings - 2):
        for k in range(sectors):
            a, b = i * sectors + k, i * sectors + (k + 1) % sectors
            triangles += [(a, a + sectors, b), (b, a + sectors, b + sectors)]
    top, last = len(rows), (rings - 2) * sectors
    for k in range(sectors):
        triangles += [(top, k, (k + 1) % sectors), (top + 1, last + (k + 1) % sectors, last + k)]
    return vertices, np.array(triangles)


def rod_mesh(direction, length=150.0, sectors=40):
    """A tube from the centre of the ball along a direction."""
    u = np.cross(direction, [0.3, 0.5, 0.8])
    u /= np.linalg.norm(u)
    v = np.cross(direction, u)
    around = 2 * np.pi * np.arange(sectors) / sectors
    ring = ROD * (np.outer(np.cos(around), u) + np.outer(np.sin(around), v))
    vertices = np.vstack([ring, ring + length * direction])
    triangles = []
    for k in range(sectors):
        n = (k + 1) % sectors
        triangles += [(k, n, k + sectors), (n, n + sectors, k + sectors)]
    return vertices, np.array(triangles)


def write_ply(path, vertices, triangles):
    with open(path, "wb") as file:
        file.write(b"ply\nformat binary_little_endian 1.0\ncomment unit mm\nelement vertex %d\nproperty double x\n"
                   b"property double y\nproperty double z\nelement face %d\nproperty list uchar int vertex_indices\nend_header\n"
                   % (len(vertices), len(triangles)))
        file.write(vertices.astype("<f8").tobytes())
        rows = np.zeros(len(triangles), dtype=[("n", "u1"), ("v", "<i4", 3)])
        rows["n"], rows["v"] = 3, triangles
        file.write(rows.tobytes())


def turned(vector):
    """The rotation with this rotation vector."""
    angle = np.linalg.norm(vector)
    x, y, z = np.asarray(vector) / angle
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


def run(*words):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stdout + done.stderr)
    return done.stdout


def one_set(palpate, folder, radius, poses, seed):
    """Error and stated deviation of shift [mm] and turn [degrees], and the RMS of the positions [mm]."""
    random = np.random.default_rng(seed)
    rotation, place = turned([1.4, 0.2, -0.1]), np.array([20.0, -190.0, 480.0])
    ball, rod = ball_mesh(radius), rod_mesh(np.array([0.25, -0.95, 0.2]) / np.linalg.norm([0.25, -0.95, 0.2]))
    vertices = np.vstack([ball[0], rod[0]])
    triangles = np.vstack([ball[1], rod[1] + len(ball[0])])
    centres = np.column_stack([random.uniform(-110, 110, poses), random.uniform(-60, 80, poses), random.uniform(640, 780, poses)])
    meshes = []
    for number, centre in enumerate(centres):
        meshes.append(folder / f"ball_{number:02}.ply")
        write_ply(meshes[-1], vertices + centre, triangles)
    run(palpate, "simulate", *meshes, "--rig", ROOT / "demo/rig.yaml", "--pattern", ROOT / "demo/pattern.yaml", "--wall", WALL,
        "--seed", seed, "-o", folder / "seen")
    run(palpate, "calibrate", "colors", folder / "seen/training/000000", "-o", folder / "colors.yaml")
    run(palpate, "decode", folder / "seen/frames", "--rig", ROOT / "demo/rig.yaml", "--pattern", ROOT / "demo/pattern.yaml",
        "--colors", folder / "colors.yaml", "-o", folder / "range")
    tips = (centres - place) @ rotation
    table = "range_map,x,y,z\n" + "".join(
        f"range/{number:06}.tiff,{x},{y},{z}\n" for number, (x, y, z) in enumerate(tips))
    (folder / "poses.csv").write_text(table)
    found = json.loads(run(palpate, "calibrate", "arm", "--ball", folder / "poses.csv", "--ball-radius", radius, "-o",
                           folder / "arm.json", "--json"))
    pose = np.array(found["pose"])
    turn = pose[:3, :3] @ rotation.T
    angle = np.degrees(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1)))
    centre = np.array(found["centre"])
    shift = np.linalg.norm(turn.T @ (centre - pose[:3, 3]) + place - centre)
    return (shift, np.linalg.norm(found["shift_deviation"]), angle, np.linalg.norm(found["R_deviation_deg"]), found["rms"],
            found["used"], found["warnings"])


def main(palpate, radius=20, poses=12, sets=4):
    print(f"ball of {radius} mm radius\n\n| set | shift: error, stated [mm] | turn: error, stated [degrees] | positions: RMS [mm] | "
          "found |\n|---|---|---|---|---|")
    ratios = []
    for seed in range(1, sets + 1):
        with tempfile.TemporaryDirectory() as folder:
            shift, shift_stated, turn, turn_stated, rms, used, warnings = one_set(palpate, Path(folder), radius, poses, seed)
        ratios += [shift / shift_stated, turn / turn_stated]
        print(f"| {seed} | {shift:.3f}, {shift_stated:.3f} | {turn:.4f}, {turn_stated:.4f} | {rms:.3f} | {used} of {poses} |", flush=True)
        for warning in warnings:
            print(f"  {warning['message']}", file=sys.stderr)
    print(f"\nerror over stated: {np.sqrt(np.mean(np.square(ratios))):.2f} (root mean square)")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve(), *map(int, sys.argv[2:4]))
