#!/usr/bin/env python3
# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Puts style, scripts and player.wasm into page.html. Model and title are left for `palpate export --html`."""
import base64
import gzip
import pathlib
import sys

page_folder, wasm, output = map(pathlib.Path, sys.argv[1:])
# Scripts in the order of their dependence: each uses only those before it.
scripts = (page_folder / "scripts.txt").read_text().split()
missing = {path.name for path in page_folder.glob("*.js")} ^ set(scripts)
if missing:
    sys.exit(f"{page_folder / 'scripts.txt'}: must name each .js file once; it differs in {', '.join(sorted(missing))}")

page = (page_folder / "page.html").read_text()
parts = {
    "/*{{style}}*/": (page_folder / "page.css").read_text(),
    "/*{{script}}*/": "".join((page_folder / name).read_text() for name in scripts),
    "{{wasm}}": base64.b64encode(gzip.compress(wasm.read_bytes(), 9, mtime=0)).decode(),
}
for mark, text in parts.items():
    if page.count(mark) != 1:
        sys.exit(f"{page_folder / 'page.html'}: has {mark} {page.count(mark)} times, not once")
    page = page.replace(mark, text)
output.write_text(page)
