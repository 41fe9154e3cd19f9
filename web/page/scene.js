// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The solids that show tool, force and friction, and the scales at which they are drawn.
const Scene = (() => {
  'use strict';
  const { along, scale, norm, unit } = Algebra;
  const kArrow = 0.42;        // of the diagonal: length of the arrow at the reference force
  const kShaft = 0.0075;      // of the diagonal: its radius
  const kTip = [0.021, 0.06]; // of the diagonal: radius and length of its tip
  const kBall = 0.014;        // of the diagonal: radius of a tool whose size is unknown
  const kTrials = 7;          // presses that tell the reference force
  const kTrialTicks = 100;

  /** A force [N] that presses of `depth` mm reach on this object, rounded up: the scale of arrow and chart. */
  function referenceForce(player, normals, nearest, depth) {
    let largest = 0;
    for (let i = 0; i < Math.min(kTrials, nearest.length); ++i) {
      const contact = Math.floor((i + 0.5) * nearest.length / Math.min(kTrials, nearest.length));
      const place = [...player.contacts.subarray(3 * contact, 3 * contact + 3)];
      const normal = unit([...normals.subarray(3 * nearest[contact], 3 * nearest[contact] + 3)]);
      player.reset();
      for (let tick = 0; tick <= kTrialTicks; ++tick) {
        player.step(...along(place, normal, depth * (0.1 - 1.1 * tick / kTrialTicks)));
      }
      largest = Math.max(largest, norm(player.output().force));
    }
    player.reset();
    return Chart.roundUp(largest > 0 ? largest : 1);
  }

  /** `reference` [N], `diagonal` [mm]; `toolRadius` is 0 if unknown. */
  function make({ reference, diagonal, toolRadius }) {
    const lengthOfNewton = kArrow * diagonal / reference;
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
        { shape: 'cone', origin, axis, size: [wide, wide, height], color: [...color, 0.26] },
      ];
    }

    /** `hovered`: where the tool would touch, or null. */
    function solids(tool, hovered, colors) {
      const round = [radius, radius, radius];
      if (tool.mode === 'idle') {
        if (!hovered) return [];
        const { position, normal } = hovered;
        const wide = [1.7 * radius, 1.7 * radius, 1.7 * radius];
        return [
          { shape: 'ring', origin: position, axis: normal, size: wide, color: colors.force },
          { shape: 'ball', origin: along(position, normal, 1.6 * radius), axis: normal, size: round, color: [...colors.tool, 0.4] },
        ];
      }
      const shown = [{ shape: 'ball', origin: tool.ballCenter(radius), axis: tool.normal, size: round, color: colors.tool }];
      if (tool.state === 0) return shown;
      const stateColor = tool.state === 1 ? colors.stick : colors.slip;
      return [...shown, ...arrow(tool.position, tool.outcome.force, colors.force), ...frictionCone(tool.position, tool.outcome, stateColor)];
    }

    return { solids, lengthOfNewton };
  }

  return { make, referenceForce };
})();
