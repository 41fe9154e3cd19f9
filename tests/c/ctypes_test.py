#!/usr/bin/env python3
# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Plays a trace through the C library, as a language that knows nothing of C++ would: LIBRARY, and FOLDER with a model and the
trace that `palpate play` recorded with it (../web/make_page.py). The numbers must be the same bits."""
import csv
import ctypes
import pathlib
import sys


class Tick(ctypes.Structure):
    _fields_ = [("struct_size", ctypes.c_uint32), ("state", ctypes.c_int32), ("force", ctypes.c_double * 3),
                ("contact", ctypes.c_double * 3)]


library = ctypes.CDLL(sys.argv[1])
folder = pathlib.Path(sys.argv[2])
library.palpate_error_text.restype = ctypes.c_char_p
library.palpate_player_step.argtypes = [ctypes.c_void_p, ctypes.c_double * 3, ctypes.c_double, ctypes.POINTER(Tick)]
library.palpate_player_create.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.POINTER(ctypes.c_void_p)]
library.palpate_model_close.argtypes = library.palpate_player_destroy.argtypes = [ctypes.c_void_p]


def check(status):
    if status != 0:
        sys.exit(f"status {status}: {library.palpate_error_text().decode()}")


model, player = ctypes.c_void_p(), ctypes.c_void_p()
check(library.palpate_model_open(str(folder / "model").encode(), ctypes.byref(model)))
check(library.palpate_player_create(model, None, ctypes.byref(player)))
library.palpate_model_close(model)
tick = Tick(struct_size=ctypes.sizeof(Tick))
ticks = touching = 0
with open(folder / "trace.csv", newline="") as file:
    for row in csv.DictReader(file):
        tool = (ctypes.c_double * 3)(*(float(row[axis]) for axis in "xyz"))
        check(library.palpate_player_step(player, tool, 1e-3, ctypes.byref(tick)))
        played = [*tick.contact, *tick.force, ("free", "stick", "slip")[tick.state]]
        recorded = [float(row[name]) for name in ("cx", "cy", "cz", "fx", "fy", "fz")] + [row["state"]]
        if played != recorded:
            sys.exit(f"tick {ticks}: {played} for {recorded}")
        ticks += 1
        touching += tick.state != 0
library.palpate_player_destroy(player)
if touching < 1000:
    sys.exit(f"only {touching} of {ticks} ticks touch")
print(f"{ticks} ticks, {touching} touch: the same bits")
