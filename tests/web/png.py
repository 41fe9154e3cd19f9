# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
"""Pixels of the PNG images that Chromium writes: 8 bits, RGB or RGBA, not interlaced."""
import struct
import zlib


def rows_of(data):
    """Rows of (r, g, b) tuples."""
    width, height, depth, kind, _, _, interlaced = struct.unpack(">IIBBBBB", data[16:29])
    channels = {2: 3, 6: 4}[kind]
    if depth != 8 or interlaced:
        raise ValueError("only PNG images of 8 bits that are not interlaced are read")
    packed, place = b"", 8
    while place < len(data):
        size, name = struct.unpack(">I4s", data[place:place + 8])
        if name == b"IDAT":
            packed += data[place + 8:place + 8 + size]
        place += size + 12
    raw, stride = zlib.decompress(packed), width * channels
    before, rows = bytearray(stride), []
    for y in range(height):
        start = y * (stride + 1)
        before = _unfiltered(raw[start], bytearray(raw[start + 1:start + 1 + stride]), before, channels)
        rows.append(list(zip(before[0::channels], before[1::channels], before[2::channels])))
    return rows


def _unfiltered(kind, row, above, channels):
    """Undoes the filter of one row (PNG specification, section 9)."""
    if kind == 0:
        return row
    if kind == 2:
        return bytearray((a + b) & 255 for a, b in zip(row, above))
    for i, value in enumerate(row):
        left = row[i - channels] if i >= channels else 0
        if kind == 1:
            guess = left
        elif kind == 3:
            guess = (left + above[i]) // 2
        else:
            corner = above[i - channels] if i >= channels else 0
            a, b, c = abs(above[i] - corner), abs(left - corner), abs(left + above[i] - 2 * corner)
            guess = left if a <= b and a <= c else above[i] if b <= c else corner
        row[i] = (value + guess) & 255
    return row
