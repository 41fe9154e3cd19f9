// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Data in the page: bytes as gzip in base64, and images of codes in them (palpate/geometry/packed_image.h).
const Bytes = (() => {
  'use strict';
  const kUnknown = -(2 ** 31);  // kUnknownCode

  const supported = typeof DecompressionStream === 'function';

  /** Bytes of a script element that holds them. Rejects if they are damaged. */
  async function of(element) {
    const text = atob(element.textContent.trim());
    const bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
    const unpacked = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
    return new Uint8Array(await new Response(unpacked).arrayBuffer());
  }

  /** Reads what `pack` wrote, one image after the other. */
  function reader(bytes) {
    let place = 0;
    const take = (count) => {
      if (place + count > bytes.length) throw new Error('the data end too early');
      place += count;
      return bytes.subarray(place - count, place);
    };

    /** Codes of rows x columns, kUnknown where there is none. */
    function codes(rows, columns) {
      const count = rows * columns;
      const low = take(count), middle = take(count), high = take(count);
      const result = new Int32Array(count);
      let last = 0;
      for (let i = 0, column = 0; i < count; ++i, ++column) {
        if (column === columns) column = 0;
        const stored = low[i] | middle[i] << 8 | high[i] << 16;
        if (stored === 0) {
          result[i] = kUnknown;
          continue;
        }
        const left = column > 0 ? result[i - 1] : kUnknown;
        const above = i >= columns ? result[i - columns] : kUnknown;
        const corner = column > 0 && i >= columns ? result[i - columns - 1] : kUnknown;
        let predicted;
        if (left === kUnknown) predicted = above === kUnknown ? last : above;
        else if (above === kUnknown || corner === kUnknown) predicted = left;
        else predicted = Math.min(Math.max(left + above - corner, Math.min(left, above)), Math.max(left, above));
        last = result[i] = predicted + (stored & 1 ? stored >> 1 : -(stored >> 1));
      }
      return result;
    }

    return { codes, take };
  }

  return { of, reader, kUnknown, supported };
})();
