#!/usr/bin/env python3
# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Makes what the other tests here look at: PALPATE, the command, fits the sheet of DEMO, exports a page of it, and plays two
trajectories: that of the demo, and wild.csv, whose tool jumps about. Writes model.html and the traces into FOLDER."""
import pathlib
import random
import subprocess
import sys

palpate, demo, folder = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
folder.mkdir(parents=True, exist_ok=True)


def run(*words):
    subprocess.run([palpate, *map(str, words)], check=True, stdout=subprocess.DEVNULL)


def write_wild_trajectory(path, seconds=2):
    """Presses, slides, and jumps by up to 10 mm in a tick, over the sheet, which is near z = 700 mm."""
    choose = random.Random(1)
    tool = [0.0, 0.0, 702.0]
    lines = ["t,x,y,z"]
    for tick in range(1000 * seconds):
        reach = 10 if choose.random() < 0.02 else 0.05
        for axis, (low, high) in enumerate(((-30, 30), (-30, 30), (697, 705))):
            tool[axis] = min(max(tool[axis] + choose.uniform(-reach, reach), low), high)
        lines.append(",".join(map(repr, [tick / 1000, *tool])))
    path.write_text("\n".join(lines) + "\n")


run("probe", "import", demo / "sheet/contacts.csv", demo / "sheet/samples.csv", "-o", folder / "acquisition.db")
run("fit", folder / "acquisition.db", demo / "sheet/surface.ply", "-o", folder / "model")
run("export", folder / "model", "--html", "-o", folder / "model.html", "--title", "A <sheet> & its feel")
write_wild_trajectory(folder / "wild.csv")
run("play", folder / "model", "--trajectory", demo / "trajectory.csv", "--record", folder / "trace.csv")
run("play", folder / "model", "--trajectory", folder / "wild.csv", "--record", folder / "wild_trace.csv")
