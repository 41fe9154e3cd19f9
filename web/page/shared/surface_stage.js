// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// A surface that the visitor turns and looks at; the vertex under the pointer is told.
const SurfaceStage = (() => {
  'use strict';

  function readScheme() {
    return Object.fromEntries(['sky', 'floor', 'surface', 'back', 'edge'].map((name) => [name, Page.parts(`--gl-${name}`)]));
  }

  /**
   * `options()` returns what is drawn: { colored, flat, edges }; inspect(vertex) is called with the vertex under the pointer
   * (-1 for none). Returns null if the browser has no WebGL2.
   */
  function make({ canvas, options, inspect }) {
    const view = SurfaceView.make(canvas);
    if (!view) return null;
    let camera = null, orbit = null, scheme = readScheme(), requested = false, pointed = null, size = [1, 1], home = null;

    function wake() {
      if (!requested && !canvas.hidden) requestAnimationFrame(frame);
      requested = !canvas.hidden;
    }

    function frame() {
      requested = false;
      if (canvas.hidden) return;
      if (camera) view.draw(camera.shot(), scheme, options());
      else view.clear(scheme);
      if (camera && pointed && (orbit.act === null || orbit.act === 'turn')) inspect(view.hit(camera.ray(pointed.x, pointed.y)));
      pointed = null;
    }

    Page.onScheme(() => { scheme = readScheme(); wake(); });
    Page.followSize(canvas, (width, height) => {
      size = [width, height];
      camera?.resize(width, height);
      wake();
    });
    canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
    canvas.addEventListener('webglcontextrestored', () => { view.rebuild(); wake(); });

    return {
      wake,
      /** The first surface decides the first view; later ones are seen from where the visitor looks. `used`: vertices of it. */
      setSurface(positions, triangles, extentOf) {
        view.setSurface(positions, triangles);
        home = () => {
          camera.setExtent(extentOf());
          camera.home();
        };
        if (!camera && triangles.length > 0) {
          camera = Camera.make(extentOf(), Surface.meanDirection(view.normals(), triangles));
          camera.resize(...size);
          orbit = Orbit.attach({
            canvas, camera, wake, home: () => home(),
            grab(place) { pointed = place; return false; },
            hover(place) { pointed = place; },
          });
        }
        wake();
      },
      setColors(colors) {
        view.setColors(colors);
        wake();
      },
      /** For the buttons beside the picture. */
      present: () => (camera ? { camera, home, wake } : { camera: { zoom() {} }, home() {}, wake }),
      /** Where in the picture a place in space is shown [px], for tests. */
      placeOf(point) {
        const { matrix } = camera.shot(), w = [0, 1, 3].map((row) =>
          matrix[row] * point[0] + matrix[4 + row] * point[1] + matrix[8 + row] * point[2] + matrix[12 + row]);
        return { x: (1 + w[0] / w[2]) / 2 * size[0], y: (1 - w[1] / w[2]) / 2 * size[1] };
      },
    };
  }

  return { make };
})();
