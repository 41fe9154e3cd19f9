// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The surface of a range map in space: a grid of its pixels, cut where depths jump. It is drawn, not measured: use `palpate mesh` for measurements.
const Relief = (() => {
  'use strict';
  const kMostVertices = 300000;  // of more, each second pixel is drawn in both directions, each third, ...
  const kMostPixels = 2000000;   // the same, known or not
  const kLargestStep = 0.02;     // of the depth, between neighbours on one surface, as in `palpate mesh`

  /** The distance of the pixels that are drawn; `known` have a depth. */
  const strideOf = (width, height, known) => Math.max(1, Math.ceil(Math.sqrt(Math.max(known / kMostVertices, width * height / kMostPixels))));

  /** `depths`: codes of the map's pixels; `rays`: x / z and y / z of those that are drawn. Faces the camera, whose frame it has. */
  function make({ depths, width, height, stride, step, rays: [rayX, rayY] }) {
    const across = Math.ceil(width / stride), down = Math.ceil(height / stride);
    const positions = new Float32Array(3 * across * down);
    for (let j = 0, i = 0; j < down; ++j) {
      for (let column = 0; column < across; ++column, ++i) {
        const code = depths[j * stride * width + column * stride];
        const z = code === Bytes.kUnknown ? NaN : code * step;
        positions[3 * i] = z * rayX[i];
        positions[3 * i + 1] = z * rayY[i];
        positions[3 * i + 2] = z;
      }
    }
    const corners = new Uint32Array(6 * Math.max(0, across - 1) * Math.max(0, down - 1));
    let count = 0;
    const depth = (i) => (Number.isNaN(positions[3 * i]) ? NaN : positions[3 * i + 2]);
    function add(a, b, c) {
      const x = depth(a), y = depth(b), z = depth(c);
      const near = Math.min(x, y, z);
      if (!(Math.max(x, y, z) - near <= kLargestStep * near)) return;  // also if one is unknown
      corners[count] = a;
      corners[count + 1] = b;
      corners[count + 2] = c;
      count += 3;
    }
    for (let j = 0; j + 1 < down; ++j) {
      for (let i = j * across; i + 1 < (j + 1) * across; ++i) {
        const right = i + 1, below = i + across, beyond = below + 1;
        const falls = Math.abs(depth(i) - depth(beyond)), rises = Math.abs(depth(right) - depth(below));
        if (Number.isNaN(falls) || rises <= falls) {
          add(i, below, right);
          add(right, below, beyond);
        } else {
          add(i, below, beyond);
          add(i, beyond, right);
        }
      }
    }
    return { positions, triangles: corners.slice(0, count) };
  }

  return { make, strideOf };
})();
