// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The range maps of the page, unpacked when they are wanted.
const Frames = (() => {
  'use strict';
  const kUnknown = Bytes.kUnknown;

  /** `facts` are those of the page. A frame has codes of depths and, if they were stored, of deviations, and reasons. */
  function make(facts, blocks) {
    const { width, height } = facts;

    async function load(i) {
      const reader = Bytes.reader(await Bytes.of(blocks[i + 1]));
      const { sigma, reasons } = facts.frames[i];
      return {
        depths: reader.codes(height, width),
        sigmas: sigma ? reader.codes(height, width) : null,
        reasons: reasons ? reader.take(width * height) : null,
      };
    }

    /** x / z and y / z at every `stride`-th pixel, interpolated on the grid of the page. */
    async function rays(stride) {
      const { spacing, columns, rows, step } = facts.rays;
      const reader = Bytes.reader(await Bytes.of(blocks[0]));
      const grids = [reader.codes(rows, columns), reader.codes(rows, columns)];
      const across = Math.ceil(width / stride), down = Math.ceil(height / stride);
      /** The cell of a pixel on the grid, and how far in it; the last cell of a side may be narrower. */
      const cellOf = (pixel, count, side) => {
        const cell = Math.min(Math.floor(pixel / spacing), Math.max(0, count - 2)), from = cell * spacing;
        const to = Math.min(from + spacing, side - 1);
        return [cell, to > from ? (pixel - from) / (to - from) : 0];
      };
      return grids.map((codes) => {
        const result = new Float32Array(across * down);
        const at = (row, column) => {
          const code = codes[Math.min(row, rows - 1) * columns + Math.min(column, columns - 1)];
          return code === kUnknown ? NaN : code * step;
        };
        for (let j = 0; j < down; ++j) {
          const [row, v] = cellOf(j * stride, rows, height);
          for (let i = 0; i < across; ++i) {
            const [column, u] = cellOf(i * stride, columns, width);
            result[j * across + i] = (1 - v) * ((1 - u) * at(row, column) + u * at(row, column + 1))
              + v * ((1 - u) * at(row + 1, column) + u * at(row + 1, column + 1));
          }
        }
        return result;
      });
    }

    const depthOf = (code) => (code === kUnknown ? NaN : code * facts.step);
    const sigmaOf = (code) => (code === kUnknown ? NaN : Math.exp(code * facts.sigma_step));

    return {
      load, rays,
      /** Depth and deviation [mm], NaN where unknown, and code of the reason or null, of a pixel. */
      valuesAt: (frame, pixel) => ({
        depth: depthOf(frame.depths[pixel]),
        sigma: frame.sigmas ? sigmaOf(frame.sigmas[pixel]) : NaN,
        reason: frame.reasons ? frame.reasons[pixel] : null,
      }),

      /** Packed colours of every `stride`-th pixel, 0 where there is nothing to show. */
      colorsOf(frame, { id, low, high }, stride = 1) {
        const colors = new Uint32Array(Math.ceil(width / stride) * Math.ceil(height / stride));
        const codes = { depth: frame.depths, sigma: frame.sigmas, reason: frame.reasons }[id];
        if (!codes) return colors;
        const shade = id === 'sigma' ? ColorMap.shadeOf(Math.log(low), Math.log(high)) : ColorMap.shadeOf(low, high);
        const colorOf = {
          depth: (code) => shade(depthOf(code)), sigma: (code) => shade(code * facts.sigma_step), reason: (code) => ColorMap.labels[code],
        }[id];
        for (let row = 0, i = 0; row < height; row += stride) {
          for (let pixel = row * width; pixel < (row + 1) * width; pixel += stride, ++i) {
            if (codes[pixel] !== kUnknown) colors[i] = colorOf(codes[pixel]);
          }
        }
        return colors;
      },

      /** The range between which 98 % of a frame's values lie, or null. */
      rangeOf(frame, id) {
        const codes = (id === 'depth' ? frame.depths : frame.sigmas)?.filter((code) => code !== kUnknown).sort();
        if (!codes?.length) return null;
        const aside = Math.floor(codes.length / 100), valueOf = id === 'depth' ? depthOf : sigmaOf;
        return { low: valueOf(codes[aside]), high: valueOf(codes[codes.length - 1 - aside]) };
      },

      knownIn: (frame) => frame.depths.reduce((sum, code) => sum + (code !== kUnknown), 0),
      countsOf(frame) {
        const counts = facts.reasons.map(() => 0);
        for (const code of frame.reasons ?? []) ++counts[code];
        return counts;
      },
    };
  }

  return { make };
})();
