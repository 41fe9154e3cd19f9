// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// What the visitor does with mouse, fingers, pen, keys or gamepad, as presses and drags of the tool; what is left moves the camera.
const Interaction = (() => {
  'use strict';
  const kKeySpeed = 0.35;       // of the picture's height a second: an arrow key, or the stick
  const kStickRest = 0.15;      // of a stick's way, within which it rests
  const kWheelDepth = 0.0012;   // of the depth a unit of the wheel
  const kShiftDepth = 0.006;    // of the depth a pixel, with Shift
  const kKeyDepth = 1.12;       // a key's factor of the depth

  /** `scene`: { canvas, camera, tool, pick(x, y), home(), wake(), depthChanged() }. Returns what is hovered, and what runs each frame. */
  function attach(scene) {
    const { canvas, camera, tool, wake } = scene;
    const stage = canvas.parentElement;
    const held = new Set();      // keys that move
    const self = { hovered: null, engaged: false };
    let aim = null;              // where in the picture the tool is wanted, or null
    let padPresses = false;

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

    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const onKey = {
      Space: () => { if (tool.mode !== 'press') pressAt(startAim()); },
      '+': () => changeDepth(kKeyDepth), '=': () => changeDepth(kKeyDepth), '-': () => changeDepth(1 / kKeyDepth),
    };
    const orbit = Orbit.attach({
      canvas, camera, wake, home: scene.home,
      grab(place) {
        aim = place;
        return pressAt(place);
      },
      drag(place, before, event) {
        if (event.shiftKey) changeDepth(Math.exp((place.y - before.y) * kShiftDepth));
        else aim = place;
        if (event.pointerType === 'pen' && event.pressure > 0) tool.share = Math.min(1, 2 * event.pressure);
      },
      release: () => tool.lift(),
      hover(place) { aim = place; },
      wheel(event, lines) {
        if (tool.mode !== 'press') return false;
        changeDepth(Math.exp(-event.deltaY * lines * kWheelDepth));
        return true;
      },
      key(event) {
        const action = onKey[event.code] ?? onKey[event.key];
        if (arrows[event.code]) held.add(event.code);
        else if (action) { if (event.code !== 'Space' || !event.repeat) action(); }
        else return false;
        return true;
      },
    });
    Orbit.connectButtons(() => ({ camera, home: scene.home, wake }));

    canvas.addEventListener('keyup', (event) => {
      held.delete(event.code);
      if (event.code === 'Space' && orbit.act === null) tool.lift();
      wake();
    });
    canvas.addEventListener('blur', () => {
      held.clear();
      if (orbit.act === null) tool.lift();
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
    window.addEventListener('gamepadconnected', wake);

    /** Once a frame; returns whether the next frame is needed for keys or a gamepad. */
    self.advance = (milliseconds) => {
      const way = kKeySpeed * camera.height * Math.min(100, milliseconds) / 1000;
      for (const key of held) moveAim(arrows[key][0] * way, arrows[key][1] * way);
      const pad = readGamepad(way);
      if (tool.mode === 'press' && aim) tool.drag(camera.ray(aim.x, aim.y));
      self.hovered = aim && tool.mode === 'idle' && (orbit.act === null || orbit.act === 'taken') ? scene.pick(aim.x, aim.y) : null;
      stage.classList.toggle('off', orbit.act === null && aim !== null && tool.mode === 'idle' && self.hovered === null);
      return held.size > 0 || pad;
    };

    return self;
  }

  return { attach };
})();
