#!/usr/bin/env python3
# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Writes docs/extremes.md: what tests/extremes finds of each operation, theme by theme."""
import os
import subprocess
import sys
import tempfile
from pathlib import Path

THEMES = ["lengths 2^30", "forces 2^30", "2^100", "places", "turns", "orders", "degenerate", "options", "hosts", "conditioning"]

HEAD = """# Extremes

How each operation of the libraries handles very large, very small and invalid numbers. `./dev studies extremes_page` writes the
table from the results of `tests/extremes`. A test fails if a result is wrong and not listed below.

Each operation works on a small standard input: a sheet of 84 mm x 60 mm, a ball of about 40 mm, 400 points, 12 contacts with 576
samples, a trajectory, and a frame of 160 x 120 px.

| theme | what is done to the input | what must hold |
|---|---|---|
| lengths 2^30 | lengths times 2^-30, 2^-7 and 2^30 | the same numbers in the other unit |
| forces 2^30 | forces times 2^-30, 2^-7 and 2^30 | the same |
| 2^100 | lengths or forces times 2^-100 and 2^100 | the same, or rejected with an error message |
| places | moved by 2^20, 2^30 and 2^36 mm, to UTM and to geocentric coordinates | the result moves with the input |
| turns | rotated by 1e-12, pi - 1e-9, pi and 2.1 rad | the result rotates with the input |
| orders | vertices, triangles, points, contacts and samples in two other orders | the same, in that order |
| degenerate | stray and equal vertices, needles of 1e8, one triangle, sizes from 1e-6 to 1e6, contacts 1e-9 mm apart, friction 0 and 100, black and white frames, and more | finite results, or rejected with an error message |
| options | each field of the options at NaN, infinities, 0, +-1e+-300, and at, inside and outside its bounds | outside: rejected by name; inside: done within the time limit, finite or rejected |
| hosts | 2 and 8 threads, a locale with decimal commas, another time zone, memory filled with 0xa5, blocks of memory 48 bytes further or in pages of their own | the same to the last bit |
| conditioning | coordinates, forces and pixels changed at random by 2^-40 of their size; also on inputs that are nearly flat, round, in a line or parallel | the result changes by at most 2^-13, or within the error that it states, or it carries a word (*said*), such as a verdict that is not "accepted" |

*exact*: the same to the last bit. A number: the largest relative difference, within the stated tolerance of the operation, or within
the rounding of coordinates at that place. *finite*: only finiteness is tested. *n of m refused*: n of m cases are rejected with an
error message. A letter: a known deviation, listed below the table. An empty cell: the theme does not change the input of the
operation.

"""


GROWTH = """
## Growth

The same operations on inputs up to 8 times as wide at the same density, so with up to 64 times as many elements; frames and range
maps have as many more pixels. Processor time grows with a power of the number of elements, between the two numbers of the table.
Memory is the peak of a process of its own, beside the input, for each further element. In parentheses: at most this, as stated. The
tests assert memory always, and powers of time in the large size (`./dev check`), because times depend on what else runs.

`design_pattern` and `certify_passivity` have nothing that grows, and `identify_strip` has a model of one narrow sheet.

| operation | element | number | power of time | kB an element |
|---|---|---|---|---|
"""


TRADES = """
## Accuracy against cost

Options that make a result smaller or a call faster, each from accurate to cheap, on the standard input. Settings are in the unit
of the stated error, or numbers. The tests check that the cost never rises and is lower at the end, that the stated error never
falls, and that the error against an independent reference is within the stated one. Where the cost is empty, it is not counted.
Statistical errors, such as the standard deviations of depths and forces, are compared on the pages of these subjects
([sensing](sensing-accuracy.md), [models](trade-model.md), [reduced models](reduce.md)).

| option | settings | cost | stated error | error | measured against |
|---|---|---|---|---|---|
"""


def table_of(program):
    with tempfile.TemporaryDirectory() as folder:
        table = Path(folder) / "table.tsv"
        tested = subprocess.run([program, "--gtest_brief=1"], check=False, stdout=subprocess.DEVNULL,
                                env=dict(os.environ, PALPATE_EXTREMES_TABLE=str(table)))
        if tested.returncode != 0:
            sys.exit("tests/extremes fails; mend that first")
        return [line.split("\t") for line in table.read_text().splitlines()]


def main():
    program, page = sys.argv[1:]
    table, cells, reasons, growth, trades = table_of(program), {}, [], [], []
    # In the order of the list; what only the large size runs comes last.
    operations = list(dict.fromkeys([row[0] for row in table if row[1] == "hosts"] + [row[0] for row in table if row[1] not in ("growth", "trade")]))
    for operation, theme, found in table:
        if theme == "growth":
            element, number, power, most_power, size, most_size = found.split(" | ")
            growth.append(f"| {operation} | {element} | {number} | {power} ({most_power}) | {size} ({most_size}) |")
            continue
        if theme == "trade":
            trades.append(f"| {operation} | {found} |")
            continue
        if found.startswith("known: "):
            reason = found.removeprefix("known: ")
            if reason not in reasons:
                reasons.append(reason)
            found = chr(ord("A") + reasons.index(reason))
        cells[operation, theme] = found
    lines = [f"| operation | {' | '.join(THEMES)} |", "|---" * (1 + len(THEMES)) + "|"]
    for operation in operations:
        lines.append(f"| {operation} | " + " | ".join(cells.get((operation, theme), "") for theme in THEMES) + " |")
    lines += ["", "Known deviations:", ""]
    lines += [f"- {chr(ord('A') + i)}: {reason}." for i, reason in enumerate(reasons)]
    Path(page).write_text(HEAD + "\n".join(lines) + "\n" + GROWTH + "\n".join(growth) + "\n" + TRADES + "\n".join(trades) + "\n")


if __name__ == "__main__":
    main()
