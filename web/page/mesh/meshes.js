// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The meshes of the page, unpacked when they are wanted.
const Meshes = (() => {
  'use strict';
  const kUnknown = Bytes.kUnknown;

  /** `facts` are those of the page. A mesh has places [steps from the middle], codes of its quantities, and colours. */
  function make(facts, blocks) {
    const count = facts.vertices;

    async function triangles() {
      const reader = Bytes.reader(await Bytes.of(blocks[0]));
      const corners = [0, 1, 2].map(() => reader.codes(1, facts.triangles));
      return Uint32Array.from({ length: 3 * facts.triangles }, (_, i) => corners[i % 3][Math.floor(i / 3)]);
    }

    async function load(i) {
      const reader = Bytes.reader(await Bytes.of(blocks[i + 1]));
      const row = () => reader.codes(1, count);
      const places = [row(), row(), row()];
      const positions = new Float32Array(3 * count);
      for (let k = 0; k < 3; ++k) for (let v = 0; v < count; ++v) positions[3 * v + k] = places[k][v] * facts.step;
      const quantities = facts.quantities.map(row);
      return { places, positions, quantities, colors: facts.colors ? [row(), row(), row()] : null };
    }

    const valueOf = (mesh, i, vertex) => {
      const code = mesh.quantities[i][vertex];
      return code === kUnknown ? NaN : code * facts.quantities[i].step;
    };

    return {
      load, triangles, valueOf,
      /** Coordinates of a vertex [mm], in the frame of the file. */
      placeOf: (mesh, vertex) => mesh.places.map((codes, k) => facts.middle[k] + codes[vertex] * facts.step),
      /** Packed colours of the vertices: of quantity i on its scale, or those of the file. */
      colorsOf(mesh, i, scale) {
        if (i === null) {
          const [red, green, blue] = mesh.colors;
          return Uint32Array.from(red, (r, v) => ColorMap.packed([r, green[v], blue[v]]));
        }
        const shade = ColorMap.shadeOf(scale.low, scale.high);
        return Uint32Array.from(mesh.quantities[i], (code, v) => (code === kUnknown ? ColorMap.unknown : shade(valueOf(mesh, i, v))));
      },
      /** The range between which 98 % of a mesh's values lie, or null. */
      rangeOf(mesh, i) {
        const codes = mesh.quantities[i].filter((code) => code !== kUnknown).sort();
        if (codes.length === 0) return null;
        const aside = Math.floor(codes.length / 100), { step } = facts.quantities[i];
        return { low: codes[aside] * step, high: codes[codes.length - 1 - aside] * step };
      },
    };
  }

  return { make };
})();
