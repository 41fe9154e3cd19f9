// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// A camera that turns about the object like a turntable.
const Camera = (() => {
  'use strict';
  const { add, subtract, scale, along, dot, cross, unit, norm, multiply } = Algebra;
  const kFieldOfView = 0.5;           // [rad] vertical
  const kMargin = 0.84;               // of the picture is filled by the object
  const kLargestPitch = 1.5;          // [rad] short of straight above, where there is no right and left
  const kPitches = [0.5, 0.95];       // [rad] of the first view: from above, so that a dent is seen, not from straight above
  const kTurn = 0.4;                  // [rad] of the first view: from beside, so that the shape is seen

  /** `extent` of the object, `facing` its mean direction outwards (short if it faces all around). */
  function make(extent, facing) {
    // A surface that a camera measured faces it, against +z with +y down; other objects stand on the ground, +z up.
    const up = facing[2] < -0.5 ? [0, -1, 0] : [0, 0, 1];
    const side = unit(cross(up, Math.abs(up[2]) > 0.5 ? [0, 1, 0] : [0, 0, 1]));
    const front = cross(side, up);
    const seen = norm(facing) > 0.3 ? unit(facing) : unit(add(front, up));
    const camera = { yaw: 0, pitch: 0, distance: 1, target: extent.center, width: 1, height: 1, moved: false };

    function axes() {
      const horizontal = add(scale(front, Math.cos(camera.yaw)), scale(side, Math.sin(camera.yaw)));
      const back = add(scale(horizontal, Math.cos(camera.pitch)), scale(up, Math.sin(camera.pitch)));
      const right = unit(cross(up, back));
      return { right, up: cross(back, right), back };
    }

    /** Distance at which the bounding box fills the picture. */
    function fittingDistance() {
      const { right, up: above, back } = axes();
      const tangent = Math.tan(kFieldOfView / 2) * kMargin;
      let distance = 0;
      for (let corner = 0; corner < 8; ++corner) {
        const p = subtract([0, 1, 2].map((k) => (corner >> k & 1 ? extent.high : extent.low)[k]), camera.target);
        const needed = Math.max(Math.abs(dot(p, right)) * camera.height / camera.width, Math.abs(dot(p, above)));
        distance = Math.max(distance, needed / tangent + dot(p, back));
      }
      return distance;
    }

    camera.home = () => {
      const flat = Math.hypot(dot(seen, front), dot(seen, side));
      camera.yaw = (flat > 0.1 ? Math.atan2(dot(seen, side), dot(seen, front)) : 0) + kTurn;
      camera.pitch = Math.min(kPitches[1], Math.max(kPitches[0], Math.asin(dot(seen, up))));
      camera.target = extent.center;
      camera.distance = fittingDistance();
      camera.moved = false;
    };

    /** The object has another size or place; the view stays until it is asked for. */
    camera.setExtent = (other) => { extent = other; };

    /** Sets the size of the picture [px]; the first view is fitted again until the visitor has moved it. */
    camera.resize = (width, height) => {
      camera.width = width;
      camera.height = height;
      if (!camera.moved) camera.distance = fittingDistance();
    };

    camera.turn = (dx, dy) => {
      camera.yaw -= dx * 0.008;
      camera.pitch = Math.min(kLargestPitch, Math.max(-kLargestPitch, camera.pitch + dy * 0.008));
      camera.moved = true;
    };

    camera.zoom = (factor) => {
      camera.distance = Math.min(6 * extent.diagonal, Math.max(0.15 * extent.diagonal, camera.distance * factor));
      camera.moved = true;
    };

    camera.pan = (dx, dy) => {
      const { right, up: above } = axes();
      const size = camera.sizeOfPixel();
      camera.target = along(along(camera.target, right, -dx * size), above, dy * size);
      camera.moved = true;
    };

    /** [mm] that one pixel shows at the target. */
    camera.sizeOfPixel = () => 2 * Math.tan(kFieldOfView / 2) * camera.distance / camera.height;

    /** Ray through the pixel (x, y) of the picture, y down. */
    camera.ray = (x, y) => {
      const { right, up: above, back } = axes();
      const size = camera.sizeOfPixel();
      const aim = along(along(scale(back, -camera.distance), right, (x - camera.width / 2) * size), above, (camera.height / 2 - y) * size);
      return { origin: along(camera.target, back, camera.distance), direction: unit(aim) };
    };

    /** What the shaders need: matrix, eye, and light that comes from above the visitor's left shoulder. */
    camera.shot = () => {
      const { right, up: above, back } = axes();
      const eye = along(camera.target, back, camera.distance);
      const near = Math.max(0.02 * extent.diagonal, camera.distance - 3 * extent.diagonal);
      const far = camera.distance + 3 * extent.diagonal;
      const f = 1 / Math.tan(kFieldOfView / 2), depth = 1 / (near - far);
      const projection = [f * camera.height / camera.width, 0, 0, 0, 0, f, 0, 0, 0, 0, (near + far) * depth, -1, 0, 0, 2 * near * far * depth, 0];
      const view = [
        right[0], above[0], back[0], 0, right[1], above[1], back[1], 0, right[2], above[2], back[2], 0,
        -dot(right, eye), -dot(above, eye), -dot(back, eye), 1];
      return { matrix: multiply(projection, view), eye, light: unit(add(add(scale(right, -0.7), scale(above, 0.55)), scale(back, 0.75))) };
    };

    camera.home();
    return camera;
  }

  return { make };
})();
