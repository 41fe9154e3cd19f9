# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""What notebooks show of meshes, range maps and models."""
from __future__ import annotations

import base64
import html
import sys
from typing import Any

import numpy as np

from . import _pictures
from ._palpate import Error, Model, RangeMap, TriangleMesh


def with_picture(pixels: _pictures.Pixels, words: str) -> str:
    data = base64.b64encode(_pictures.png(pixels)).decode()
    caption = html.escape(words).encode("ascii", "xmlcharrefreplace").decode()
    return f'<figure><img src="data:image/png;base64,{data}"><figcaption>{caption}</figcaption></figure>'


def size_of(mesh: TriangleMesh) -> str:
    vertices = mesh.vertices[np.isfinite(mesh.vertices).all(axis=1)]
    if len(vertices) == 0:
        return "no vertices"
    return " × ".join(f"{length:.4g}" for length in np.ptp(vertices, axis=0)) + " mm"


def mesh_html(mesh: TriangleMesh) -> str:
    words = f"{len(mesh.vertices)} vertices, {len(mesh.triangles)} triangles, {size_of(mesh)}"
    return with_picture(_pictures.surface_pixels(mesh.vertices, mesh.triangles), words)


def range_map_html(map: RangeMap) -> str:
    z = map.z
    known = z[np.isfinite(z)]
    words = f"{z.shape[1]} × {z.shape[0]} pixels, "
    words += f"{len(known)} with a depth, {known.min():.4g} to {known.max():.4g} mm" if len(known) else "none with a depth"
    return with_picture(_pictures.depth_pixels(z), words)


def model_html(model: Model) -> str:
    surface, friction = model.surface, model.friction
    words = f"{len(model.contacts)} contacts, {size_of(surface)}; friction {friction.min():.2f} to {friction.max():.2f}"
    if model.unknown_friction:
        words += f", unknown at {model.unknown_friction}"
    return with_picture(_pictures.surface_pixels(surface.vertices, surface.triangles, model.contacts), words)


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
