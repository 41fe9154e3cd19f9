// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The page: opens the model, connects tool, picture, chart and words, and runs the frames.
(() => {
  'use strict';
  const kNear = 4;           // spacings of vertices, within which the one nearest to a contact mostly lies
  const kDot = 6.5;          // [px] size of a contact
  const kLongestFrame = 200; // [ms] of a frame that count
  const { element, parts } = Page;

  /** Colours of the scheme in use: arrays of three for WebGL, text for the chart. */
  function readColors() {
    const colors = { chart: { total: Page.color('--gl-force'), normal: Page.color('--chart-normal'), tangential: Page.color('--chart-tangential') } };
    for (const name of ['sky', 'floor', 'surface', 'back', 'dent', 'tool', 'force', 'dot']) colors[name] = parts(`--gl-${name}`);
    for (const name of ['stick', 'slip']) {
      colors[name] = parts(`--${name}`);
      colors.chart[name] = Page.color(`--${name}`);
    }
    colors.chart.quiet = Page.color('--quiet');
    return colors;
  }

  /** Computes what follows from the model alone. */
  function study(player) {
    const extent = Surface.extentOf(player.vertices);
    const normals = new Float32Array(player.vertices.length);
    Surface.sumNormals(player.vertices, player.triangles, normals);
    const spacing = extent.diagonal / Math.sqrt(player.vertices.length / 3);
    const nearest = Surface.nearestVertices(player.contacts, player.vertices, kNear * spacing);
    const facing = Surface.meanDirection(normals, [...nearest]);
    return { extent, normals, nearest, facing };
  }

  function run(player) {
    const { extent, normals, nearest, facing } = study(player);
    const canvas = element('view');
    const rest = new Float32Array(player.vertices);
    const dotPlaces = new Float32Array(3 * nearest.length);
    const model = { rest, triangles: player.triangles, dotCount: nearest.length };
    let renderer = Renderer.make(canvas, model);
    if (!renderer) {
      Page.failure(WebGl.kMissing);
      return () => {};
    }
    const camera = Camera.make(extent, facing);
    let last = null, requested = false, stale = true, colors = readColors(), chart = null;
    const tool = Tool.make(player, extent.diagonal, ({ outcome, state }) => {
      chart.push({ total: Math.hypot(...outcome.force), normal: outcome.normalForce, tangential: outcome.tangentialForce }, state);
    });
    const { depth, force: reference } = Scene.tryObject(player, normals, nearest, tool.depth);
    tool.setDepth(depth);
    chart = Chart.make(element('chart'), reference);
    const scene = Scene.make({ reference, diagonal: extent.diagonal, toolRadius: player.toolRadius });
    const readout = Readout.make({
      reference, extent, contactCount: nearest.length, toolRadius: player.toolRadius, shapeError: player.shapeError,
    });

    /** Asks for a frame; the page rests while nothing moves. */
    function wake() {
      if (!requested) requestAnimationFrame(frame);
      requested = true;
    }

    const showDepth = Readout.depthControl(tool, wake);
    const interaction = Interaction.attach({
      canvas, camera, tool, wake, home: camera.home, depthChanged: showDepth,
      /** What a tool would touch there: not the inside of an open surface. */
      pick(x, y) {
        const { origin, direction } = camera.ray(x, y);
        const hit = player.pick(origin, direction);
        return hit && Algebra.dot(hit.normal, direction) < 0 ? hit : null;
      },
    });

    function updateSurface() {
      const positions = player.deformed(element('nearest').checked);
      Surface.sumNormals(positions, player.triangles, normals);
      nearest.forEach((vertex, i) => {
        for (let k = 0; k < 3; ++k) dotPlaces[3 * i + k] = player.contacts[3 * i + k] + positions[3 * vertex + k] - rest[3 * vertex + k];
      });
      renderer.update(positions, normals, dotPlaces);
    }

    function frame(now) {
      const milliseconds = last === null ? 0 : Math.min(kLongestFrame, now - last);
      requested = false;
      last = now;
      const busy = interaction.advance(milliseconds);
      if (tool.mode === 'idle') chart.rest(milliseconds);
      stale = tool.advance(milliseconds) || stale;
      if (stale) updateSurface();
      stale = false;
      const ratio = Page.pixelRatio();
      renderer.draw(camera.shot(), colors, {
        solids: scene.solids(tool, interaction.hovered, colors), showDots: element('dots').checked,
        dent: tool.depthRange[1] / 2, dotSize: kDot * ratio, lift: 1.5 * kDot * camera.sizeOfPixel(),
      });
      readout.show(tool, scene.fit(chart.draw(colors.chart, ratio)), now);
      element('hint').classList.toggle('done', interaction.engaged);
      if (busy || tool.mode !== 'idle' || !chart.resting()) wake();
      else last = null;
    }

    Page.onScheme(() => { colors = readColors(); wake(); });
    element('dots').addEventListener('change', wake);
    element('nearest-row').hidden = player.shapeError < 0;
    element('nearest').addEventListener('change', () => {
      stale = true;
      wake();
    });
    canvas.addEventListener('webglcontextlost', (event) => event.preventDefault());
    canvas.addEventListener('webglcontextrestored', () => {
      renderer = Renderer.make(canvas, model);
      stale = true;
      wake();
    });
    Page.followSize(canvas, (width, height) => {
      camera.resize(width, height);
      wake();
    });
    return () => {
      tool.stop();
      stale = true;
      wake();
    };
  }

  let player = null, stop = null;
  window.palpate = {
    /** Resolves when the page can be used. */
    ready: Player.open().then((opened) => {
      player = opened;
      stop = run(player);
    }).catch((error) => {
      Page.failure(error.message);
      throw error;
    }),
    /** Plays 3 N coordinates of a tool with the player of this page; for tests. */
    play(tools) {
      stop();
      return player.play(tools);
    },
  };
  window.palpate.ready.catch(() => {});
})();
