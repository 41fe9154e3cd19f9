// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// False colours: viridis for numbers, whose steps look alike, and colours of labels that are easily told apart; as in the pictures of the command.
const ColorMap = (() => {
  'use strict';
  const kViridis = [[68, 1, 84], [72, 40, 120], [62, 73, 137], [49, 104, 142], [38, 130, 142], [31, 158, 137], [53, 183, 121],
    [110, 206, 88], [181, 222, 43], [253, 231, 37]];
  const kLabels = [[211, 211, 211], [0, 0, 0], [213, 94, 0], [0, 114, 178], [230, 159, 0], [0, 158, 115], [204, 121, 167], [86, 180, 233],
    [240, 228, 66], [120, 60, 20], [150, 0, 60], [70, 70, 160]];
  const kShades = 1024;
  const kUnknownShade = [150, 150, 150, 255];  // of vertices; unknown pixels are hatched

  /** Colours as bytes r, g, b, a in one number each, as images and buffers have them. */
  const packed = (() => {
    const bytes = new Uint8Array(4), whole = new Uint32Array(bytes.buffer);
    return ([r, g, b, a = 255]) => { bytes.set([r, g, b, a]); return whole[0]; };
  })();

  const shades = Uint32Array.from({ length: kShades }, (_, i) => {
    const place = i / (kShades - 1) * (kViridis.length - 1), left = Math.min(Math.floor(place), kViridis.length - 2);
    return packed(kViridis[left].map((from, k) => Math.round(from + (place - left) * (kViridis[left + 1][k] - from))));
  });
  const labels = Uint32Array.from(kLabels, packed);

  /** The colour of a number on a scale, clamped at its ends, as one packed number. */
  const shadeOf = (low, high) => {
    const steps = high > low ? (kShades - 1) / (high - low) : 0;
    return (value) => shades[Math.max(0, Math.min(kShades - 1, Math.round((value - low) * steps)))];
  };
  const css = (whole) => `rgb(${whole & 255} ${whole >> 8 & 255} ${whole >> 16 & 255})`;

  return { shadeOf, labels, packed, css, unknown: packed(kUnknownShade) };
})();
