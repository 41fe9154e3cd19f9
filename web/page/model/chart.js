// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// A strip chart of the last seconds: total, normal and tangential force; below it a band that says stick or slip.
const Chart = (() => {
  'use strict';
  const kSeconds = 5;
  const kCount = 1000 * kSeconds;  // ticks kept
  const kBand = 5;                 // [px] height of the band of states
  const kLines = ['total', 'normal', 'tangential'];

  /** The next of 1, 2, 5, 10, ... that is not below the value. */
  function roundUp(value) {
    const power = 10 ** Math.floor(Math.log10(value));
    return power * [1, 2, 5, 10].find((step) => step * power >= value * (1 - 1e-9));
  }

  /** `least`: [N] that the chart shows at least. */
  function make(canvas, least) {
    const context = canvas.getContext('2d');
    const kept = Object.fromEntries(kLines.map((name) => [name, new Float32Array(kCount)]));
    const states = new Uint8Array(kCount);
    let next = 0;                  // index of the oldest tick, which is written over next
    let quiet = kCount;            // ticks since the last force: then the chart is empty and rests

    function push(force, state) {
      for (const name of kLines) kept[name][next] = force[name];
      states[next] = state;
      next = (next + 1) % kCount;
      quiet = state === 0 ? quiet + 1 : 0;
    }

    /** Lets time go by without a tool. */
    function rest(milliseconds) {
      for (let i = Math.min(kCount, Math.round(milliseconds)); i-- > 0;) push({ total: 0, normal: 0, tangential: 0 }, 0);
    }

    /** Returns the force [N] at the top. */
    function draw(colors, ratio) {
      const width = canvas.clientWidth, height = canvas.clientHeight;
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      const largest = kept.total.reduce((most, force) => Math.max(most, force), least);
      const top = roundUp(largest), floor = height - kBand - 1, room = floor - 8;
      drawGrid(colors, width, floor, room, top);
      const columns = Math.max(1, Math.round(width));
      drawStates(colors, columns, height);
      context.lineJoin = 'round';
      for (const name of [...kLines].reverse()) {
        context.strokeStyle = colors[name];
        context.lineWidth = name === 'total' ? 2 : 1.5;
        context.beginPath();
        // The largest and the smallest of the ticks that share a column: a short peak is not lost.
        for (let column = 0; column < columns; ++column) {
          let low = Infinity, high = -Infinity;
          for (let i = Math.floor(column * kCount / columns); i < Math.floor((column + 1) * kCount / columns); ++i) {
            const force = kept[name][(next + i) % kCount];
            low = Math.min(low, force);
            high = Math.max(high, force);
          }
          for (const force of low < high ? [low, high] : [low]) context.lineTo(column, floor - force / top * room);
        }
        context.stroke();
      }
      return top;
    }

    function drawGrid(colors, width, floor, room, top) {
      context.fillStyle = context.strokeStyle = colors.quiet;
      context.lineWidth = 1;
      context.font = '11px system-ui, sans-serif';
      context.globalAlpha = 0.25;
      context.beginPath();
      for (let second = 1; second < kSeconds; ++second) {
        context.moveTo(width * second / kSeconds, 0);
        context.lineTo(width * second / kSeconds, floor);
      }
      for (const part of [0, 0.5, 1]) {
        context.moveTo(0, floor - part * room);
        context.lineTo(width, floor - part * room);
      }
      context.stroke();
      context.globalAlpha = 1;
      context.textBaseline = 'top';
      context.fillText(`${Number(top.toPrecision(2))} N`, 6, floor - room + 3);
      context.textAlign = 'right';
      context.fillText(`last ${kSeconds} s`, width - 6, floor - room + 3);
      context.textAlign = 'left';
    }

    function drawStates(colors, columns, height) {
      for (let column = 0; column < columns; ++column) {
        const state = states[(next + Math.floor((column + 0.5) * kCount / columns)) % kCount];
        if (state === 0) continue;
        context.fillStyle = state === 1 ? colors.stick : colors.slip;
        context.fillRect(column, height - kBand, 1, kBand);
      }
    }

    return { push, rest, draw, resting: () => quiet >= kCount };
  }

  return { make, roundUp };
})();
