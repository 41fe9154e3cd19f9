// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Geometry of the surface that is drawn: size, normals at vertices, where it faces.
const Surface = (() => {
  'use strict';
  const { subtract, norm, scale, add } = Algebra;

  /** Corners of the bounding box, its centre, and the length of its diagonal [mm]; vertices that are NaN do not count. */
  function extentOf(vertices) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < vertices.length; ++i) {
      if (vertices[i] < low[i % 3]) low[i % 3] = vertices[i];
      if (vertices[i] > high[i % 3]) high[i % 3] = vertices[i];
    }
    return { low, high, center: scale(add(low, high), 0.5), diagonal: norm(subtract(high, low)) };
  }

  /** Writes into `normals`, three numbers a vertex, the sum of twice the areas of its triangles, as vectors outwards. */
  function sumNormals(positions, triangles, normals) {
    normals.fill(0);
    for (let t = 0; t < triangles.length; t += 3) {
      const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
      const ux = positions[b] - positions[a], uy = positions[b + 1] - positions[a + 1], uz = positions[b + 2] - positions[a + 2];
      const vx = positions[c] - positions[a], vy = positions[c + 1] - positions[a + 1], vz = positions[c + 2] - positions[a + 2];
      const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
      normals[a] += x; normals[a + 1] += y; normals[a + 2] += z;
      normals[b] += x; normals[b + 1] += y; normals[b + 2] += z;
      normals[c] += x; normals[c + 1] += y; normals[c + 2] += z;
    }
  }

  /** Mean direction of the normals at the vertices `chosen`; shorter than 1 where they differ, near 0 all around. */
  function meanDirection(normals, chosen) {
    let sum = [0, 0, 0];
    for (const vertex of chosen) {
      const normal = [...normals.subarray(3 * vertex, 3 * vertex + 3)], length = norm(normal);
      if (length > 0) sum = add(sum, scale(normal, 1 / length));
    }
    return scale(sum, 1 / Math.max(1, chosen.length));
  }

  /** The nearest vertex, found by trying all. */
  function nearestOf([x, y, z], vertices) {
    let nearest = 0, least = Infinity;
    for (let i = 0; i < vertices.length; i += 3) {
      const distance = Math.hypot(vertices[i] - x, vertices[i + 1] - y, vertices[i + 2] - z);
      if (distance < least) [nearest, least] = [i / 3, distance];
    }
    return nearest;
  }

  /** For each of the points the nearest vertex; quick if it lies within `reach` mm. */
  function nearestVertices(points, vertices, reach) {
    // Each point stands in the 27 cells around it, so that a vertex looks into one cell only. Cells that share a key do no harm.
    const cells = new Map();
    const keyOf = (x, y, z) => Math.imul(x, 73856093) ^ Math.imul(y, 19349663) ^ Math.imul(z, 83492791);
    const cellOf = (array, i) => [0, 1, 2].map((k) => Math.floor(array[i + k] / reach));
    for (let p = 0; p < points.length; p += 3) {
      const [x, y, z] = cellOf(points, p);
      for (let n = 0; n < 27; ++n) {
        const key = keyOf(x + (n % 3) - 1, y + (Math.floor(n / 3) % 3) - 1, z + Math.floor(n / 9) - 1);
        cells.set(key, [...(cells.get(key) ?? []), p]);
      }
    }
    const nearest = new Int32Array(points.length / 3);
    const distances = new Float64Array(nearest.length).fill(Infinity);
    for (let i = 0; i < vertices.length; i += 3) {
      for (const p of cells.get(keyOf(...cellOf(vertices, i))) ?? []) {
        const distance = Math.hypot(vertices[i] - points[p], vertices[i + 1] - points[p + 1], vertices[i + 2] - points[p + 2]);
        if (distance < distances[p / 3]) {
          distances[p / 3] = distance;
          nearest[p / 3] = i / 3;
        }
      }
    }
    distances.forEach((distance, p) => {
      if (distance > reach) nearest[p] = nearestOf(points.subarray(3 * p, 3 * p + 3), vertices);
    });
    return nearest;
  }

  /**
   * The vertex of the first triangle that a ray hits, which is nearest to the place where it does; -1 if it hits none.
   * All triangles are tried (Moeller and Trumbore 1997).
   */
  function hit([ox, oy, oz], [dx, dy, dz], positions, triangles) {
    let nearest = Infinity, vertex = -1;
    for (let t = 0; t < triangles.length; t += 3) {
      const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
      const ax = positions[a], ay = positions[a + 1], az = positions[a + 2];
      const ux = positions[b] - ax, uy = positions[b + 1] - ay, uz = positions[b + 2] - az;
      const vx = positions[c] - ax, vy = positions[c + 1] - ay, vz = positions[c + 2] - az;
      const px = dy * vz - dz * vy, py = dz * vx - dx * vz, pz = dx * vy - dy * vx;
      const determinant = ux * px + uy * py + uz * pz;
      if (determinant === 0) continue;
      const sx = ox - ax, sy = oy - ay, sz = oz - az;
      const u = (sx * px + sy * py + sz * pz) / determinant;
      if (!(u >= 0 && u <= 1)) continue;
      const qx = sy * uz - sz * uy, qy = sz * ux - sx * uz, qz = sx * uy - sy * ux;
      const v = (dx * qx + dy * qy + dz * qz) / determinant;
      if (!(v >= 0 && u + v <= 1)) continue;
      const distance = (vx * qx + vy * qy + vz * qz) / determinant;
      if (!(distance > 0 && distance < nearest)) continue;
      nearest = distance;
      const w = 1 - u - v;
      const corner = u > v && u > w ? 1 : v > w ? 2 : 0;
      vertex = triangles[t + corner];
    }
    return vertex;
  }

  return { extentOf, sumNormals, meanDirection, nearestVertices, hit };
})();
