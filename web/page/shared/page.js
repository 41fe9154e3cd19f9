// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Elements of the page, its colours, and words for its visitor.
const Page = (() => {
  'use strict';
  const element = (id) => document.getElementById(id);
  const write = (id, text) => { if (element(id).textContent !== text) element(id).textContent = text; };

  /** A colour of the scheme in use, as text. */
  const color = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  /** The same as three numbers, for WebGL. */
  const parts = (name) => [1, 3, 5].map((i) => parseInt(color(name).slice(i, i + 2), 16) / 255);

  /** Calls when the system asks for the other scheme. */
  const onScheme = (changed) => matchMedia('(prefers-color-scheme: dark)').addEventListener('change', changed);

  const pixelRatio = () => Math.min(2, window.devicePixelRatio || 1);

  /** Lets a canvas have as many pixels as it is shown with; calls with its width and height [px of the page]. */
  function followSize(canvas, changed) {
    const resize = () => {
      const width = Math.max(1, canvas.clientWidth), height = Math.max(1, canvas.clientHeight);
      canvas.width = Math.round(width * pixelRatio());
      canvas.height = Math.round(height * pixelRatio());
      changed(width, height);
    };
    new ResizeObserver(resize).observe(canvas);
    resize();
  }

  /** Instead of an object that cannot be shown. */
  function failure(text) {
    element('message').hidden = false;
    write('message', text);
    element('page').classList.add('failed');
  }

  /** After a failure that is over. */
  function recover() {
    if (!element('page').classList.contains('failed')) return;
    element('message').hidden = true;
    element('page').classList.remove('failed');
  }

  return { element, write, color, parts, onScheme, pixelRatio, followSize, failure, recover };
})();
