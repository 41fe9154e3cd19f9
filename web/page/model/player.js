// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The playback of a model: the C++ of Palpate as WebAssembly. Lengths are in mm and forces in N, in the frame of the model.
const Player = (() => {
  'use strict';
  const kNotSupported = 52;  // ENOSYS of WASI: the player neither reads files nor prints
  const kDamaged = 'The model in this page is damaged. Export the page again, or copy it again from where it came.';
  const STATES = ['free', 'stick', 'slip'];

  /** Bytes of a script element; it is emptied: nobody needs the text again. */
  async function bytesOf(id) {
    const bytes = await Bytes.of(document.getElementById(id));
    document.getElementById(id).textContent = '';
    return bytes;
  }

  const systemCalls = new Proxy({}, { get: () => () => kNotSupported });

  /** Opens the model of the page. Rejects with an Error whose message is for the visitor. */
  async function open() {
    if (typeof WebAssembly !== 'object' || !Bytes.supported) {
      throw new Error('This browser is too old to compute the forces: it lacks WebAssembly. A browser of 2023 or later shows this page.');
    }
    const made = await WebAssembly.instantiate(await bytesOf('player'), { wasi_snapshot_preview1: systemCalls });
    const wasm = made.instance.exports;
    wasm._initialize?.();
    try {
      const model = await bytesOf('model');
      const place = wasm.palpate_allocate(model.length);
      new Uint8Array(wasm.memory.buffer, place, model.length).set(model);
      wasm.palpate_open(place, model.length);
    } catch (error) {  // data that were cut off or changed do not unpack, and the player stops at bytes that are no model
      throw new Error(kDamaged, { cause: error });
    }
    return wrap(wasm);
  }

  function wrap(wasm) {
    // Views are made after each call, which may let the memory grow: older ones become empty then.
    const doubles = (place, count) => new Float64Array(wasm.memory.buffer, place, count);
    const floats = (place, count) => new Float32Array(wasm.memory.buffer, place, count);
    const integers = (place, count) => new Int32Array(wasm.memory.buffer, place, count);
    const vertexCount = wasm.palpate_vertex_count();

    /** One tick of 1 ms with the tool at (x, y, z); returns the index into Player.STATES. */
    const step = (x, y, z) => wasm.palpate_step(x, y, z);
    const reset = () => wasm.palpate_reset();

    /** What the last tick computed; forces on the user. */
    function output() {
      const v = doubles(wasm.palpate_output(), 16);
      return {
        force: [v[0], v[1], v[2]],
        contact: [v[3], v[4], v[5]],
        intoObject: [v[6], v[7], v[8]],
        friction: v[9],
        normalForce: v[10],
        tangentialForce: v[11],
        deviation: v[12],
        displacement: [v[13], v[14], v[15]],
      };
    }

    /** First hit of the undeformed surface by a ray, or null. */
    function pick(origin, direction) {
      if (!wasm.palpate_pick(...origin, ...direction)) return null;
      const v = doubles(wasm.palpate_picked(), 6);
      return { position: [v[0], v[1], v[2]], normal: [v[3], v[4], v[5]] };
    }

    /** Plays 3 N coordinates of a tool from the beginning: `states` as indices, forces on the user, contacts. */
    function play(tools) {
      const count = Math.floor(tools.length / 3);
      const played = { states: new Int8Array(count), forces: new Float64Array(3 * count), contacts: new Float64Array(3 * count) };
      reset();
      for (let i = 0; i < count; ++i) {
        played.states[i] = step(tools[3 * i], tools[3 * i + 1], tools[3 * i + 2]);
        const v = doubles(wasm.palpate_output(), 6);
        played.forces.set(v.subarray(0, 3), 3 * i);
        played.contacts.set(v.subarray(3, 6), 3 * i);
      }
      reset();
      return played;
    }

    return {
      vertices: doubles(wasm.palpate_vertices(), 3 * vertexCount).slice(),
      triangles: integers(wasm.palpate_triangles(), 3 * wasm.palpate_triangle_count()).slice(),
      contacts: doubles(wasm.palpate_contacts(), 3 * wasm.palpate_contact_count()).slice(),
      toolRadius: wasm.palpate_tool_radius(),
      /** [mm] of the deformed surface, root mean square over recorded ones; below 0 if it is only drawn. */
      shapeError: wasm.palpate_shape_error(),
      /** Surface as drawn in the present state; valid until the next call. `nearest`: the nearest recorded one, not a blend. */
      deformed: (nearest) => floats(wasm.palpate_deform(nearest ? 1 : 0), 3 * vertexCount),
      step, reset, output, pick, play,
    };
  }

  return { open, STATES };
})();
