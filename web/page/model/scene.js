// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The solids that show tool, force and friction, and the scales at which they are drawn.
const Scene = (() => {
  'use strict';
  const { along, scale, norm, unit } = Algebra;
  const kArrow = 0.36;        // of the diagonal: length of an arrow of the force at the top of the chart
  const kShaft = 0.0075;      // of the diagonal: its radius
  const kTip = [0.021, 0.06]; // of the diagonal: radius and length of its tip
  const kBall = 0.014;        // of the diagonal: radius of a tool whose size is unknown
  const kFollow = 0.3;        // of the way a frame, when the scale changes
  const kTrials = 24;         // presses that tell how the object is
  const kTrialTicks = 100;

  /** Forces [N] of a press at a contact, at kTrialTicks depths up to `depth` mm. */
  function tryPress(player, place, normal, depth) {
    const gap = 0.1 * depth, forces = [];
    player.reset();
    player.step(...along(place, normal, gap));
    for (let tick = 1; tick <= kTrialTicks; ++tick) {
      player.step(...along(place, normal, -depth * tick / kTrialTicks));
      forces.push(norm(player.output().force));
    }
    player.reset();
    return forces;
  }

  /**
   * What presses of this object are like. Up to `depth` [mm], at most `deepest`, the force grows at three of four contacts that
   * are tried: where it falls, the model is far from what was measured. There, one of four exceeds not even `force` [N].
   */
  function tryObject(player, normals, nearest, deepest) {
    const count = Math.min(kTrials, nearest.length);
    const trials = Array.from({ length: count }, (_, i) => {
      const contact = Math.floor((i + 0.5) * nearest.length / count);
      const vertex = 3 * nearest[contact];
      return tryPress(player, [...player.contacts.subarray(3 * contact, 3 * contact + 3)], unit([...normals.subarray(vertex, vertex + 3)]), deepest);
    });
    const ascending = (values) => values.sort((a, b) => a - b);
    const ticks = ascending(trials.map((forces) => 1 + forces.indexOf(Math.max(...forces))))[Math.floor(count / 4)];
    const force = ascending(trials.map((forces) => forces[ticks - 1]))[Math.floor(count / 4)];
    return { depth: deepest * ticks / kTrialTicks, force: Chart.roundUp(force > 0 ? force : 1) };
  }

  /** `reference` [N], `diagonal` [mm]; `toolRadius` is 0 if unknown. */
  function make({ reference, diagonal, toolRadius }) {
    let lengthOfNewton = kArrow * diagonal / reference;
    const radius = toolRadius > 0 ? toolRadius : kBall * diagonal;

    function arrow(origin, force, color) {
      const length = norm(force) * lengthOfNewton;
      if (!(length > 0.002 * diagonal)) return [];
      const axis = unit(force);
      const tip = Math.min(kTip[1] * diagonal, 0.6 * length), wide = kTip[0] / kTip[1] * tip;
      const thin = Math.min(kShaft * diagonal, 0.6 * wide);
      return [
        { shape: 'rod', origin, axis, size: [thin, thin, length - tip], color },
        { shape: 'tip', origin: along(origin, axis, length - tip), axis, size: [wide, wide, tip], color },
      ];
    }

    /** The arrow's end lies inside the rim while the contact holds: both are drawn at the same scale. */
    function frictionCone(origin, outcome, color) {
      const height = outcome.normalForce * lengthOfNewton, wide = outcome.friction * height;
      if (!(height > 0.002 * diagonal) || !(wide > 0)) return [];
      const axis = scale(outcome.intoObject, -1);
      return [
        { shape: 'ring', origin: along(origin, axis, height), axis, size: [wide, wide, wide], color },
        { shape: 'cone', origin, axis, size: [wide, wide, height], color: [...color, 0.2] },
      ];
    }

    /** Lets arrow and cone follow the scale of the chart, whose top is at `top` N. Returns the length [mm] of 1 N. */
    function fit(top) {
      lengthOfNewton += kFollow * (kArrow * diagonal / top - lengthOfNewton);
      return lengthOfNewton;
    }

    /** `hovered`: where the tool would touch, or null. */
    function solids(tool, hovered, colors) {
      const round = [radius, radius, radius];
      if (tool.mode === 'idle') {
        if (!hovered) return [];
        const { position, normal } = hovered;
        const wide = [1.7 * radius, 1.7 * radius, 1.7 * radius];
        return [
          { shape: 'halo', origin: position, axis: normal, size: wide, color: colors.force },
          { shape: 'ball', origin: along(position, normal, 1.6 * radius), axis: normal, size: round, color: [...colors.tool, 0.4] },
        ];
      }
      const shown = [{ shape: 'ball', origin: tool.ballCenter(radius), axis: tool.normal, size: round, color: colors.tool }];
      if (tool.state === 0) return shown;
      const stateColor = tool.state === 1 ? colors.stick : colors.slip;
      return [...shown, ...arrow(tool.position, tool.outcome.force, colors.force), ...frictionCone(tool.position, tool.outcome, stateColor)];
    }

    return { solids, fit };
  }

  return { make, tryObject };
})();
