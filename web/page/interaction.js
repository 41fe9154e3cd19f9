// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// What the visitor does with mouse, fingers, pen, keys or gamepad, as presses and drags of the tool and moves of the camera.
const Interaction = (() => {
  'use strict';
  const kKeySpeed = 0.35;       // of the picture's height a second: an arrow key, or the stick
  const kStickRest = 0.15;      // of a stick's way, within which it rests
  const kWheelDepth = 0.0012;   // of the depth a unit of the wheel
  const kWheelZoom = 0.0011;
  const kShiftDepth = 0.006;    // of the depth a pixel, with Shift
  const kKeyDepth = 1.12;       // a key's factor of the depth

  /** `scene`: { canvas, camera, tool, pick(x, y), home(), wake(), depthChanged() }. Returns what is hovered, and what runs each frame. */
  function attach(scene) {
    const { canvas, camera, tool } = scene;
    const stage = canvas.parentElement;
    const pointers = new Map();  // those that are down: id -> {x, y}
    const held = new Set();      // keys that move
    const self = { hovered: null, engaged: false };
    let aim = null;              // where in the picture the tool is wanted, or null
    let act = null;              // of the pointers that are down: tool, turn, pan, or fingers (two or more)
    let span = 0;                // [px] between two fingers
    let padPresses = false;

    const placeOf = (event) => {
      const box = canvas.getBoundingClientRect();
      return { x: event.clientX - box.left, y: event.clientY - box.top };
    };
    const middleOf = (places) => ({
      x: places.reduce((sum, place) => sum + place.x, 0) / places.length,
      y: places.reduce((sum, place) => sum + place.y, 0) / places.length,
    });
    const spanOf = ([a, b]) => Math.hypot(a.x - b.x, a.y - b.y);

    function changeDepth(factor) {
      tool.setDepth(tool.depth * factor);
      scene.depthChanged();
    }

    function pressAt(place) {
      const hit = scene.pick(place.x, place.y);
      if (!hit) return false;
      tool.share = 1;
      tool.press(hit);
      self.engaged = true;
      return true;
    }

    function show() {
      stage.classList.toggle('turning', act === 'turn' || act === 'pan');
      scene.wake();
    }

    canvas.addEventListener('pointerdown', (event) => {
      const place = placeOf(event);
      canvas.focus({ preventScroll: true });
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, place);
      if (pointers.size > 1) {
        // A second finger means the camera: what the first began to press is let go.
        tool.lift();
        act = 'fingers';
        span = spanOf([...pointers.values()]);
      } else if (event.pointerType === 'mouse' && event.button !== 0) {
        act = event.button === 1 || event.shiftKey ? 'pan' : 'turn';
      } else {
        aim = place;
        act = pressAt(place) ? 'tool' : 'turn';
      }
      event.preventDefault();
      show();
    });

    canvas.addEventListener('pointermove', (event) => {
      const place = placeOf(event), before = pointers.get(event.pointerId);
      if (!before) {
        if (event.pointerType !== 'touch') aim = place;
      } else {
        const old = middleOf([...pointers.values()]);
        pointers.set(event.pointerId, place);
        const places = [...pointers.values()], now = middleOf(places);
        if (act === 'tool') {
          if (event.shiftKey) changeDepth(Math.exp((place.y - before.y) * kShiftDepth));
          else aim = place;
          if (event.pointerType === 'pen' && event.pressure > 0) tool.share = Math.min(1, 2 * event.pressure);
        } else if (act === 'turn' || (act === 'fingers' && places.length === 2)) camera.turn(now.x - old.x, now.y - old.y);
        else camera.pan(now.x - old.x, now.y - old.y);
        if (act === 'fingers' && places.length === 2) {
          camera.zoom(span / Math.max(1, spanOf(places)));
          span = Math.max(1, spanOf(places));
        }
      }
      show();
    });

    function pointerUp(event) {
      if (!pointers.delete(event.pointerId)) return;
      if (act === 'tool') tool.lift();
      if (pointers.size === 0) act = null;
      if (pointers.size === 2) span = spanOf([...pointers.values()]);
      if (event.pointerType === 'touch') aim = null;
      show();
    }
    canvas.addEventListener('pointerup', pointerUp);
    canvas.addEventListener('pointercancel', pointerUp);
    canvas.addEventListener('pointerleave', () => {
      if (act === null) aim = null;
      show();
    });
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());

    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      const lines = event.deltaMode === 1 ? 33 : 1;
      if (tool.mode === 'press') changeDepth(Math.exp(-event.deltaY * lines * kWheelDepth));
      else camera.zoom(Math.exp(event.deltaY * lines * kWheelZoom));
      show();
    }, { passive: false });

    const views = {
      closer: () => camera.zoom(0.8),
      farther: () => camera.zoom(1.25),
      home: scene.home,
    };
    for (const [id, view] of Object.entries(views)) {
      document.getElementById(id).addEventListener('click', () => { view(); show(); });
    }

    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const turns = { KeyA: [40, 0], KeyD: [-40, 0], KeyW: [0, 40], KeyS: [0, -40] };
    const onKey = {
      Space: () => { if (tool.mode !== 'press') pressAt(startAim()); },
      KeyR: scene.home,
      '+': () => changeDepth(kKeyDepth), '=': () => changeDepth(kKeyDepth), '-': () => changeDepth(1 / kKeyDepth),
      PageUp: () => camera.zoom(0.8), PageDown: () => camera.zoom(1.25),
    };
    canvas.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const action = onKey[event.code] ?? onKey[event.key];
      if (arrows[event.code]) held.add(event.code);
      else if (turns[event.code]) camera.turn(...turns[event.code]);
      else if (action) { if (event.code !== 'Space' || !event.repeat) action(); }
      else return;
      event.preventDefault();
      show();
    });
    canvas.addEventListener('keyup', (event) => {
      held.delete(event.code);
      if (event.code === 'Space' && act === null) tool.lift();
      show();
    });
    canvas.addEventListener('blur', () => {
      held.clear();
      if (act === null) tool.lift();
    });

    /** Keys and sticks begin in the middle of the picture. */
    function startAim() {
      aim ??= { x: camera.width / 2, y: camera.height / 2 };
      return aim;
    }

    function moveAim(dx, dy) {
      const { x, y } = startAim();
      aim = { x: Math.min(camera.width, Math.max(0, x + dx)), y: Math.min(camera.height, Math.max(0, y + dy)) };
    }

    /** The first gamepad: left stick moves, right stick turns, a trigger or the first button presses. */
    function readGamepad(way) {
      const pad = navigator.getGamepads?.().find((one) => one?.connected);
      if (!pad) return false;
      const axis = (i) => (Math.abs(pad.axes[i] ?? 0) > kStickRest ? pad.axes[i] : 0);
      if (axis(0) || axis(1)) moveAim(axis(0) * way, axis(1) * way);
      if (axis(2) || axis(3)) camera.turn(axis(2) * way / 2, axis(3) * way / 2);
      const pull = Math.max(pad.buttons[7]?.value ?? 0, pad.buttons[0]?.value ?? 0);
      if (pull > kStickRest && !padPresses) padPresses = pressAt(startAim());
      if (padPresses) tool.share = pull;
      if (padPresses && pull <= kStickRest) {
        tool.lift();
        padPresses = false;
      }
      return true;
    }
    window.addEventListener('gamepadconnected', show);

    /** Once a frame; returns whether the next frame is needed for keys or a gamepad. */
    self.advance = (milliseconds) => {
      const way = kKeySpeed * camera.height * Math.min(100, milliseconds) / 1000;
      for (const key of held) moveAim(arrows[key][0] * way, arrows[key][1] * way);
      const pad = readGamepad(way);
      if (tool.mode === 'press' && aim) tool.drag(camera.ray(aim.x, aim.y));
      self.hovered = aim && tool.mode === 'idle' && (act === null || act === 'tool') ? scene.pick(aim.x, aim.y) : null;
      stage.classList.toggle('off', act === null && aim !== null && tool.mode === 'idle' && self.hovered === null);
      return held.size > 0 || pad;
    };

    return self;
  }

  return { attach };
})();
