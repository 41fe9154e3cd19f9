#!/usr/bin/env python3
# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Makes one file of a kind of page: puts styles, scripts and, where the page has it, player.wasm into its page.html.
Data and title are left for `palpate export --html`.

usage: assemble_page.py FOLDER OUTPUT [PLAYER.WASM]; FOLDER has page.html, and parts.txt, which names styles and scripts
"""
import base64
import gzip
import pathlib
import sys

folder, output, *wasm = map(pathlib.Path, sys.argv[1:])
# Scripts in the order of their dependence: each uses only those before it.
parts = [folder / name for name in (folder / "parts.txt").read_text().split()]
own = {path.name for path in folder.iterdir() if path.suffix in (".css", ".js")}
missing = own ^ {path.name for path in parts if ".." not in path.parts}
if missing:
    sys.exit(f"{folder / 'parts.txt'}: must name each style and script once; it differs in {', '.join(sorted(missing))}")

page = (folder / "page.html").read_text()
texts = {
    "/*{{style}}*/": "".join(path.read_text() for path in parts if path.suffix == ".css"),
    "/*{{script}}*/": "".join(path.read_text() for path in parts if path.suffix == ".js"),
}
if wasm:
    texts["{{wasm}}"] = base64.b64encode(gzip.compress(wasm[0].read_bytes(), 9, mtime=0)).decode()
for mark, text in texts.items():
    if page.count(mark) != 1:
        sys.exit(f"{folder / 'page.html'}: has {mark} {page.count(mark)} times, not once")
    page = page.replace(mark, text)
output.parent.mkdir(exist_ok=True)
output.write_text(page)
