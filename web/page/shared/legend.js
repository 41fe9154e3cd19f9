// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Which quantity is shown, and what its colours mean: a scale whose ends can be set, or labels.
const Legend = (() => {
  'use strict';
  const { element, write } = Page;

  const kMostDecimals = 12;
  const kOwnScale = 0.5;  // of the scale of all frames: a frame with less gets a scale of its own
  /** Decimals that show whole multiples of a step. */
  function decimals(step) {
    let digits = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));
    const most = digits + 3;  // of a step that is not round
    while (digits < most && Math.abs(step * 10 ** digits - Math.round(step * 10 ** digits)) > 1e-6) ++digits;
    return Math.min(kMostDecimals, digits);
  }
  /** Decimals that show three digits of a number. */
  const threeDigits = (number) => (number > 0 ? Math.min(kMostDecimals, Math.max(0, 2 - Math.floor(Math.log10(number)))) : 0);

  /**
   * `quantities`: [{ id, name, unit, step or digits, range: { low, high, min, max }, log }, or { id, name, words } with `words` for
   * labels, or { id, name } for a colour of its own]. `log`: the scale is logarithmic. `single`: there is one frame. changed() is
   * called when another is chosen or a scale is set; fit() returns the range of the frame that is shown. Returns an object with
   * `present` (the quantity, with its `low` and `high`), follow() and count(labels).
   */
  function make({ quantities, single, changed, fit }) {
    const self = { present: quantities[0] };
    const low = element('low'), high = element('high');
    for (const one of quantities) {
      if (one.range) Object.assign(one, { low: one.range.low, high: one.range.high, digits: one.digits ?? decimals(one.step) });
      const label = document.createElement('label');
      label.innerHTML = '<input type="radio" name="shown"><span></span>';
      label.lastChild.textContent = one.name;
      label.firstChild.value = one.id;
      label.firstChild.addEventListener('change', () => self.choose(one.id));
      element('shown').append(label);
    }
    element('shown').hidden = quantities.length < 2;

    element('fit').hidden = single;
    if (single) write('whole', 'First scale');

    function drawBar() {
      const canvas = element('bar'), context = canvas.getContext('2d');
      canvas.width = 256;
      canvas.height = 1;
      const shade = ColorMap.shadeOf(0, 255);
      for (let x = 0; x < 256; ++x) {
        context.fillStyle = ColorMap.css(shade(x));
        context.fillRect(x, 0, 1, 1);
      }
    }

    function show() {
      const one = self.present;
      element('scale').hidden = !one.range;
      element('labels').hidden = !one.words;
      if (!one.range) return;
      const digits = one.log ? one.digits : Math.min(one.digits, threeDigits(one.high - one.low) + 1);
      for (const [input, value] of [[low, one.low], [high, one.high]]) {
        input.step = 10 ** -digits;
        input.value = value.toFixed(digits);
      }
      write('scale-name', `${one.name}${one.unit ? ` [${one.unit}]` : ''}${one.log ? ', logarithmic' : ''}`);
      write('middle', (one.log ? Math.sqrt(one.low * one.high) : (one.low + one.high) / 2).toFixed(digits));
    }

    function setScale(range) {
      Object.assign(self.present, range, { chosen: true });
      show();
      changed();
    }
    const typed = () => {
      const [from, to] = [Number(low.value), Number(high.value)];
      if (low.value !== '' && high.value !== '' && to > from && !(self.present.log && from <= 0)) setScale({ low: from, high: to });
      else show();
    };
    low.addEventListener('change', typed);
    high.addEventListener('change', typed);
    element('fit').addEventListener('click', () => { const range = fit(); if (range) setScale(range); });
    element('whole').addEventListener('click', () => setScale({ low: self.present.range.low, high: self.present.range.high }));

    self.choose = (id) => {
      self.present = quantities.find((one) => one.id === id);
      for (const input of element('shown').querySelectorAll('input')) input.checked = input.value === id;
      show();
      changed();
    };

    /** Fits a scale that nobody has set: to the frame that is shown if its values fill little of the scale of all frames. */
    self.follow = () => {
      const { range, log, chosen } = self.present;
      const own = range && !single && !chosen ? fit() : null;
      if (!own) return;
      const length = ({ low, high }) => (log ? Math.log(high / low) : high - low);
      const { low, high } = length(own) < kOwnScale * length(range) ? own : range;
      Object.assign(self.present, { low, high });
      show();
    };

    /** Lists the labels with their share of `counts`. */
    self.count = (counts) => {
      const all = counts.reduce((sum, count) => sum + count, 0);
      element('labels').replaceChildren(...self.present.words.map((word, i) => {
        const line = document.createElement('li'), swatch = document.createElement('b'), share = document.createElement('span');
        swatch.style.background = ColorMap.css(ColorMap.labels[i]);
        share.textContent = `${(100 * counts[i] / all).toFixed(2)} %`;
        share.className = 'number';
        line.append(swatch, word, share);
        line.classList.toggle('none', counts[i] === 0);
        return line;
      }));
    };

    drawBar();
    for (const input of element('shown').querySelectorAll('input')) input.checked = input.value === self.present.id;
    show();
    return self;
  }

  return { make, decimals, threeDigits };
})();
