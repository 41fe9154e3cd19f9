// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Vectors are arrays of three numbers; a frame is nine, its columns the axes; a 4 x 4 matrix has its columns one after another, as WebGL has it.
const Algebra = (() => {
  'use strict';
  const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
  const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
  const along = (a, b, s) => [a[0] + b[0] * s, a[1] + b[1] * s, a[2] + b[2] * s];
  const mix = (a, b, s) => along(a, subtract(b, a), s);
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const norm = (a) => Math.hypot(a[0], a[1], a[2]);

  /** Unit vector along a, or `otherwise` if a has no direction. */
  const unit = (a, otherwise = [0, 0, 1]) => {
    const length = norm(a);
    return length > 0 ? scale(a, 1 / length) : otherwise;
  };

  /** Frame whose third axis is the unit vector `axis`. */
  const frameAbout = (axis) => {
    const least = axis.map(Math.abs).indexOf(Math.min(...axis.map(Math.abs)));
    const x = unit(cross(axis, [0, 1, 2].map((i) => (i === least ? 1 : 0))));
    return [...x, ...cross(axis, x), ...axis];
  };

  const multiply = (a, b) => {
    const product = new Float32Array(16);
    for (let column = 0; column < 4; ++column) {
      for (let row = 0; row < 4; ++row) {
        let sum = 0;
        for (let k = 0; k < 4; ++k) sum += a[4 * k + row] * b[4 * column + k];
        product[4 * column + row] = sum;
      }
    }
    return product;
  };

  return { add, subtract, scale, along, mix, dot, cross, norm, unit, frameAbout, multiply };
})();
