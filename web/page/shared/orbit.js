// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Mouse, fingers and keys that turn, move and zoom a camera. A page may take the first pointer for something else.
const Orbit = (() => {
  'use strict';
  const kWheelZoom = 0.0011;
  const kKeyTurn = 40;  // [px] of a drag that a key stands for
  const kTurns = { KeyA: [kKeyTurn, 0], KeyD: [-kKeyTurn, 0], KeyW: [0, kKeyTurn], KeyS: [0, -kKeyTurn] };

  /**
   * `camera` has turn(dx, dy), pan(dx, dy) and zoom(factor, place); home() shows the first view. The page may have
   * grab(place, event): whether the pointer that went down is taken; then drag(place, before, event) and release() follow;
   * hover(place or null); wheel(event, lines) and key(event): whether they are taken.
   * Returns an object whose `act` is what the pointers that are down do: taken, turn, pan, fingers (two or more), or null.
   */
  function attach({ canvas, camera, home, wake, grab, drag, release, hover, wheel, key }) {
    const stage = canvas.parentElement;
    const pointers = new Map();  // those that are down: id -> {x, y}
    const self = { act: null };
    let span = 0;                // [px] between two fingers

    const placeOf = (event) => {
      const box = canvas.getBoundingClientRect();
      return { x: event.clientX - box.left, y: event.clientY - box.top };
    };
    const middleOf = (places) => ({
      x: places.reduce((sum, place) => sum + place.x, 0) / places.length,
      y: places.reduce((sum, place) => sum + place.y, 0) / places.length,
    });
    const spanOf = ([a, b]) => Math.hypot(a.x - b.x, a.y - b.y);

    function show() {
      stage.classList.toggle('turning', self.act === 'turn' || self.act === 'pan');
      wake();
    }

    canvas.addEventListener('pointerdown', (event) => {
      const place = placeOf(event);
      canvas.focus({ preventScroll: true });
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, place);
      if (pointers.size > 1) {
        // A second finger means the camera: what the first has taken is let go.
        release?.();
        self.act = 'fingers';
        span = spanOf([...pointers.values()]);
      } else if (event.pointerType === 'mouse' && event.button !== 0) {
        self.act = event.button === 1 || event.shiftKey ? 'pan' : 'turn';
      } else {
        self.act = grab?.(place, event) ? 'taken' : 'turn';
      }
      event.preventDefault();
      show();
    });

    canvas.addEventListener('pointermove', (event) => {
      const place = placeOf(event), before = pointers.get(event.pointerId);
      if (!before) {
        if (event.pointerType !== 'touch') hover?.(place);
      } else {
        const old = middleOf([...pointers.values()]);
        pointers.set(event.pointerId, place);
        const places = [...pointers.values()], now = middleOf(places);
        if (self.act === 'taken') drag(place, before, event);
        else if (self.act === 'turn' || (self.act === 'fingers' && places.length === 2)) camera.turn(now.x - old.x, now.y - old.y);
        else camera.pan(now.x - old.x, now.y - old.y);
        if (self.act === 'fingers' && places.length === 2) {
          const wide = Math.max(1, spanOf(places));
          camera.zoom(span / wide, now);
          span = wide;
        }
      }
      show();
    });

    function pointerUp(event) {
      if (!pointers.delete(event.pointerId)) return;
      if (self.act === 'taken') release();
      if (pointers.size === 0) self.act = null;
      if (pointers.size === 2) span = spanOf([...pointers.values()]);
      if (event.pointerType === 'touch') hover?.(null);
      show();
    }
    canvas.addEventListener('pointerup', pointerUp);
    canvas.addEventListener('pointercancel', pointerUp);
    canvas.addEventListener('pointerleave', () => {
      if (self.act === null) hover?.(null);
      show();
    });
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());

    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      const lines = event.deltaMode === 1 ? 33 : 1;
      if (!wheel?.(event, lines)) camera.zoom(Math.exp(event.deltaY * lines * kWheelZoom), placeOf(event));
      show();
    }, { passive: false });

    const onKey = { KeyR: home, PageUp: () => camera.zoom(0.8), PageDown: () => camera.zoom(1.25) };
    canvas.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      if (kTurns[event.code]) camera.turn(...kTurns[event.code]);
      else if (onKey[event.code]) onKey[event.code]();
      else if (!key?.(event)) return;
      event.preventDefault();
      show();
    });

    return self;
  }

  /** The buttons beside the picture; each acts on what `present` returns then: { camera, home, wake }. */
  function connectButtons(present) {
    const views = { closer: ({ camera }) => camera.zoom(0.8), farther: ({ camera }) => camera.zoom(1.25), home: ({ home }) => home() };
    for (const [id, view] of Object.entries(views)) {
      document.getElementById(id).addEventListener('click', () => { view(present()); present().wake(); });
    }
  }

  return { attach, connectButtons };
})();
