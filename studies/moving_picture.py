# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""moving_picture.py FOLDER OUTPUT.png: the moving picture of README.md, drawn by `palpate-view`.

FOLDER has the programs palpate and palpate-view. A model of the bundled sheet is pressed, and a circle is drawn on it. The picture
is an animated PNG of 256 colours, which browsers play; each frame holds only what changed since the one before.
After ./dev build: python3 -B studies/moving_picture.py build/release/apps/palpate docs/press.png
"""
import math
import os
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

import numpy as np
from PIL import Image

DEMO = Path(__file__).resolve().parent.parent / "demo"
PRESS, CIRCLE, LIFT, PAUSE = 0.7, 3.6, 0.5, 0.2  # s
DEPTH, ABOVE, RADIUS = 11.0, 3.0, 18.0           # mm
MIDDLE = (0.0, 4.0, 702.0)                       # mm
SIZE = (1000, 600)                               # px of the window
KEPT = (980, 560)                                # px of it from the upper left corner: without the scroll bar
EVERY = 2                                        # of 30 frames a second, every second one
SHRINK = 4, 5                                    # the picture is 4/5 as large
DITHER = 8                                       # levels of 255 between the lightest and the darkest dot of the pattern


def eased(share):
    share = min(max(share, 0.0), 1.0)
    return share * share * (3 - 2 * share)


def trajectory():
    """Positions of the tool for each millisecond, as CSV."""
    rows = ["t,x,y,z"]
    for k in range(round(1000 * (PRESS + CIRCLE + LIFT + PAUSE))):
        t = k / 1000
        depth = -ABOVE + (DEPTH + ABOVE) * (eased(t / PRESS) - eased((t - PRESS - CIRCLE) / LIFT))
        angle = math.pi + 2 * math.pi * eased((t - PRESS) / CIRCLE)
        x, y, z = MIDDLE
        rows.append(f"{t:.3f},{x + RADIUS * math.cos(angle):.4f},{y + RADIUS * math.sin(angle):.4f},{z + depth:.4f}")
    return "\n".join(rows) + "\n"


def kept(path):
    """The part of a picture of the window that is kept, made smaller."""
    with Image.open(path) as picture:
        part = picture.convert("RGB").crop((0, 0, *KEPT))
        return np.asarray(part.resize([side * SHRINK[0] // SHRINK[1] for side in KEPT], Image.Resampling.BOX))


def palette_of(colors, count):
    """White, and by median cut of the colours that occur, the means of boxes of them: `count` colours."""
    boxes = [np.unique(colors, axis=0)]
    while len(boxes) < count - 1:
        box = boxes.pop(int(np.argmax([np.ptp(box, axis=0).max() * len(box) ** 0.5 for box in boxes])))
        axis = np.ptp(box, axis=0).argmax()
        box = box[np.argsort(box[:, axis], kind="stable")]
        boxes += [box[:len(box) // 2], box[len(box) // 2:]]
    return np.array([[255, 255, 255], *(np.round(box.mean(axis=0)) for box in boxes)], np.uint8)


def nearest_of(palette):
    """The entry nearest to each colour of 6 bits a channel."""
    levels = np.linspace(0, 255, 64)
    nearest = [((np.stack(np.meshgrid([red], levels, levels, indexing="ij"), axis=-1).reshape(-1, 1, 3) - palette.astype(int)) ** 2)
               .sum(axis=2).argmin(axis=1) for red in levels]
    return np.array(nearest, np.uint8).reshape(64, 64, 64)


def indexed(image, nearest):
    """Entries of the palette, dithered in a fixed pattern, so that what does not move does not flicker."""
    pattern = np.array([[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]]) / 16 - 15 / 32
    height, width = image.shape[:2]
    tiled = np.tile(pattern, (height // 4 + 1, width // 4 + 1))[:height, :width, None]
    red, green, blue = np.moveaxis(np.clip(np.round(image + DITHER * tiled), 0, 255).astype(int) >> 2, 2, 0)
    return nearest[red, green, blue]


def write_animated(path, images, milliseconds):
    """APNG with one palette; entry 255 is transparent and stands for a pixel that does not change."""
    clear = 255
    palette = palette_of(np.concatenate([image[::3, ::3].reshape(-1, 3) for image in images[::4]]), clear)
    nearest = nearest_of(palette)
    frames = [indexed(image, nearest) for image in images]
    height, width = frames[0].shape

    def chunk(name, body):
        return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))

    def packed(part):
        return zlib.compress(b"".join(b"\0" + row.tobytes() for row in part), 9)

    out = [b"\x89PNG\r\n\x1a\n", chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)),
           chunk(b"acTL", struct.pack(">II", len(frames), 0)), chunk(b"PLTE", palette.tobytes() + b"\0\0\0"),
           chunk(b"tRNS", b"\xff" * clear + b"\0")]
    number = 0
    for k, frame in enumerate(frames):
        x0, y0, part = 0, 0, frame
        if k:
            changed = frame != frames[k - 1]
            rows, columns = np.flatnonzero(changed.any(axis=1)), np.flatnonzero(changed.any(axis=0))
            if len(rows):
                y0, y1, x0, x1 = rows[0], rows[-1] + 1, columns[0], columns[-1] + 1
            else:
                y1, x1 = 1, 1
            part = np.where(changed, frame, clear)[y0:y1, x0:x1]
        out.append(chunk(b"fcTL", struct.pack(">IIIIIHHBB", number, part.shape[1], part.shape[0], x0, y0, milliseconds, 1000, 0, int(k > 0))))
        number += 1
        if k:
            out.append(chunk(b"fdAT", struct.pack(">I", number) + packed(part)))
            number += 1
        else:
            out.append(chunk(b"IDAT", packed(part)))
    out.append(chunk(b"IEND", b""))
    path.write_bytes(b"".join(out))


def main(programs, output):
    with tempfile.TemporaryDirectory() as folder:
        def run(*words):
            subprocess.run([str(word) for word in words], cwd=folder, check=True, stdout=subprocess.DEVNULL)

        palpate = programs / "palpate"
        run(palpate, "-q", "probe", "import", DEMO / "sheet/contacts.csv", DEMO / "sheet/samples.csv", "-o", "acquisition.db")
        run(palpate, "-q", "fit", "acquisition.db", DEMO / "sheet/surface.ply", "-o", "sheet")
        (Path(folder) / "tools.csv").write_text(trajectory())
        view = [programs / "palpate-view", "sheet", "--trajectory", "tools.csv", "--movie", "movie", "--width", SIZE[0], "--height", SIZE[1]]
        run(*([] if os.environ.get("DISPLAY") else ["xvfb-run", "-a"]), *view)
        images = [kept(picture) for picture in sorted((Path(folder) / "movie").glob("*.png"))[::EVERY]]
    write_animated(output, images, EVERY * 1000 // 30)


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve(), Path(sys.argv[2]))
