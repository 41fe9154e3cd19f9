// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The frames of a sequence: which one is shown, by slider, keys, or as time goes by.
const Timeline = (() => {
  'use strict';
  const { element, write } = Page;
  const kKept = 3;           // frames that are kept unpacked: before, now, next
  const kFirstSpeed = 5;     // frames a second

  /** load(i): promise of a frame; display(frame, i); failed(error, i). */
  function make({ names, load, display, failed }) {
    const slider = element('frame'), speed = element('speed');
    const kept = new Map();
    let wanted = 0, shown = -1, pumping = null, playing = false;
    const self = {};

    /** The promise of a frame, which is unpacked once as long as it is kept. */
    function frameOf(i) {
      const frame = kept.get(i) ?? load(i);
      kept.delete(i);
      kept.set(i, frame);  // now the youngest
      if (kept.size > kKept) kept.delete(kept.keys().next().value);
      return frame;
    }

    async function pump() {
      while (shown !== wanted) {
        const i = wanted;
        try {
          const frame = await frameOf(i);
          if (i !== wanted) continue;
          Page.recover();
          await display(frame, i);
        } catch (error) {
          failed(error, i);
        }
        shown = i;
      }
    }

    /** Shows frame i; resolves when a frame that was wanted last is shown. */
    self.show = (i) => {
      wanted = (i + names.length) % names.length;
      slider.value = String(wanted);
      slider.setAttribute('aria-valuetext', names[wanted]);
      write('frame-name', names.length > 1 ? `${wanted + 1} / ${names.length}  ${names[wanted]}` : names[0]);
      pumping ??= pump().finally(() => { pumping = null; });
      return pumping;
    };

    const until = (time) => new Promise((done) => {
      const look = () => (performance.now() >= time ? done() : requestAnimationFrame(look));
      requestAnimationFrame(look);
    });

    /** Every frame is shown: what is slow to unpack plays slowly. */
    async function play() {
      while (playing) {
        const due = performance.now() + 1000 / Number(speed.value);
        frameOf((wanted + 1) % names.length).catch(() => {});
        await until(due);
        if (playing) await self.show(wanted + 1);
      }
    }

    self.setPlaying = (on) => {
      if (on === playing || names.length < 2) return;
      playing = on;
      element('play').setAttribute('aria-pressed', String(on));
      element('play').setAttribute('aria-label', on ? 'Pause' : 'Play');
      if (on) play();
    };

    element('timeline').hidden = names.length < 2;
    slider.max = String(names.length - 1);
    slider.addEventListener('input', () => { self.setPlaying(false); self.show(Number(slider.value)); });
    element('play').addEventListener('click', () => self.setPlaying(!playing));
    speed.value = String(kFirstSpeed);
    const step = (by) => { self.setPlaying(false); self.show(wanted + by); };
    const keys = {
      Space: () => self.setPlaying(!playing), ArrowLeft: () => step(-1), ArrowRight: () => step(1),
      Home: () => step(-wanted), End: () => step(names.length - 1 - wanted),
    };
    document.addEventListener('keydown', (event) => {
      const own = event.target.closest('input, select, button, summary');
      if (!keys[event.code] || own || event.ctrlKey || event.metaKey || event.altKey || names.length < 2) return;
      event.preventDefault();
      keys[event.code]();
    });
    return self;
  }

  return { make };
})();
