// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Solids of revolution about +z, from which arrow, ball, cone and rings are made: positions, and normals.
const Shapes = (() => {
  'use strict';
  const kSides = 40;

  /** Turns a profile of [radius, height, normal's radial part, normal's height] about the axis: triangles, six numbers a corner. */
  function revolve(profile) {
    const corners = [];
    const corner = ([radius, height, outwards, upwards], side) => {
      const angle = 2 * Math.PI * side / kSides, c = Math.cos(angle), s = Math.sin(angle);
      corners.push(radius * c, radius * s, height, outwards * c, outwards * s, upwards);
    };
    for (let i = 0; i + 1 < profile.length; ++i) {
      for (let side = 0; side < kSides; ++side) {
        corner(profile[i], side); corner(profile[i], side + 1); corner(profile[i + 1], side + 1);
        corner(profile[i], side); corner(profile[i + 1], side + 1); corner(profile[i + 1], side);
      }
    }
    return new Float32Array(corners);
  }

  /** A circle of the profile about (radius, 0). */
  const circle = (radius, thickness, steps, from, to) => Array.from({ length: steps + 1 }, (_, i) => {
    const angle = from + (to - from) * i / steps;
    return [radius + thickness * Math.cos(angle), thickness * Math.sin(angle), Math.cos(angle), Math.sin(angle)];
  });

  const slope = Math.SQRT1_2;
  return {
    ball: revolve(circle(0, 1, 20, -Math.PI / 2, Math.PI / 2)),
    /** From z = 0 to 1, radius 1, closed below. */
    rod: revolve([[0, 0, 0, -1], [1, 0, 0, -1], [1, 0, 1, 0], [1, 1, 1, 0]]),
    /** Base at z = 0 with radius 1, tip at z = 1. */
    tip: revolve([[0, 0, 0, -1], [1, 0, 0, -1], [1, 0, slope, slope], [0, 1, slope, slope]]),
    /** Apex at the origin, open at z = 1 with radius 1. */
    cone: revolve([[0, 0, slope, -slope], [1, 1, slope, -slope]]),
    /** Rings of radius 1 about the origin: a fine one for large radii, and another for small ones. */
    ring: revolve(circle(1, 0.015, 8, 0, 2 * Math.PI)),
    halo: revolve(circle(1, 0.1, 8, 0, 2 * Math.PI)),
  };
})();
