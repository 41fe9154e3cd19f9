# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""What notebooks show of meshes, range maps and models."""
from __future__ import annotations

import html
import sys
from typing import Any

import numpy as np

from ._palpate import Error, Model, RangeMap, TriangleMesh


def paragraph(words: str) -> str:
    return "<p>" + html.escape(words).encode("ascii", "xmlcharrefreplace").decode() + "</p>"


def size_of(mesh: TriangleMesh) -> str:
    vertices = mesh.vertices[np.isfinite(mesh.vertices).all(axis=1)]
    if len(vertices) == 0:
        return "no vertices"
    return " × ".join(f"{length:.4g}" for length in np.ptp(vertices, axis=0)) + " mm"


def mesh_html(mesh: TriangleMesh) -> str:
    words = f"{len(mesh.vertices)} vertices, {len(mesh.triangles)} triangles, {size_of(mesh)}"
    return paragraph(words)


def range_map_html(map: RangeMap) -> str:
    z = map.z
    known = z[np.isfinite(z)]
    words = f"{z.shape[1]} × {z.shape[0]} pixels, "
    words += f"{len(known)} with a depth, {known.min():.4g} to {known.max():.4g} mm" if len(known) else "none with a depth"
    return paragraph(words)


def model_html(model: Model) -> str:
    friction = model.friction
    words = f"{len(model.contacts)} contacts, {size_of(model.surface)}; friction {friction.min():.2f} to {friction.max():.2f}"
    if model.unknown_friction:
        words += f", unknown at {model.unknown_friction}"
    return paragraph(words)


def frame_html(page: str, height: int) -> str:
    """A page within another."""
    return f'<iframe srcdoc="{html.escape(page)}" style="width:100%;height:{height}px;border:0"></iframe>'


def show(page: str, height: int) -> None:
    ipython: Any = sys.modules.get("IPython")  # a notebook has imported it
    if ipython is None or ipython.get_ipython() is None:
        raise Error(
            "Model.show(): needs a notebook, with the package IPython; here is none. Write the page with "
            "model.write_page('model.html') and open it in a browser"
        )
    ipython.display.display(ipython.display.HTML(frame_html(page, height)))
