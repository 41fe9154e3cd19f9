# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""What the tests of the Python module share."""
import csv
import os
import pathlib

import numpy as np

import palpate

REPOSITORY = pathlib.Path(os.environ["PALPATE_REPOSITORY"])
DEMO = REPOSITORY / "demo"
PAGE = pathlib.Path(os.environ["PALPATE_PAGE"])  # what tests/web/make_page.py made


def grid(columns, rows, spacing=1.0):
    """A flat square grid in the plane z = 0, its normals along z."""
    y, x = np.mgrid[:rows, :columns] * spacing
    vertices = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    first = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    lower = np.stack([first, first + 1, first + columns + 1], axis=1)
    upper = np.stack([first, first + columns + 1, first + columns], axis=1)
    return palpate.TriangleMesh(vertices, np.concatenate([lower, upper]))


def sheet_acquisition():
    return palpate.import_acquisition([DEMO / "sheet/contacts.csv", DEMO / "sheet/samples.csv"])


def recorded(name):
    """Tools (N, 3), contacts and forces (N, 6), and states of a trace that `palpate play` recorded."""
    with open(PAGE / name, newline="") as file:
        rows = list(csv.DictReader(file))

    def numbers(*names):
        return np.array([[float(row[name]) for name in names] for row in rows])

    return numbers(*"xyz"), numbers("cx", "cy", "cz", "fx", "fy", "fz"), np.array([row["state"] for row in rows])
