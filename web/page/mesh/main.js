// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The page of meshes: connects timeline, surface, legend and values.
(() => {
  'use strict';
  const { element, write } = Page;
  const kTooOld = 'This browser is too old to unpack the data: it lacks DecompressionStream. A browser of 2023 or later shows this page.';
  const facts = JSON.parse(element('facts-data').textContent);
  const meshes = Meshes.make(facts, document.querySelectorAll('script.block'));
  const names = facts.frames.map(({ name }) => name);
  const digits = Legend.decimals(facts.step);
  const extent = {
    low: facts.size.map((side) => -side / 2), high: facts.size.map((side) => side / 2), center: [0, 0, 0],
    diagonal: Math.hypot(...facts.size),
  };
  let mesh = null, shown = 0, vertex = -1, triangles = null;

  /** Numbers of vertices, colours of the file, and the plain surface, which is shown first if there is no colour. */
  const quantities = [
    ...(facts.colors ? [{ id: 'colors', name: 'Colours' }] : []),
    { id: 'plain', name: 'Plain' },
    ...facts.quantities.map(({ name, step, range }, i) => ({ id: String(i), name, index: i, step, range })),
  ];

  const stage = SurfaceStage.make({
    canvas: element('view'),
    options: () => ({ colored: legend.present.id !== 'plain', flat: element('flat').checked, edges: element('edges').checked }),
    inspect(found) {
      if (found < 0) return;
      element('hint').classList.add('done');
      vertex = found;
      showValues();
    },
  });

  function showValues() {
    const { index, name, step } = legend.present;
    for (const part of document.querySelectorAll('.of-quantity')) part.hidden = index === undefined;
    if (index !== undefined) write('value-name', name);
    if (vertex < 0 || !mesh) return;
    const value = index === undefined ? NaN : meshes.valueOf(mesh, index, vertex);
    write('value', Number.isNaN(value) ? 'unknown' : value.toFixed(Legend.decimals(step)));
    write('value-vertex', String(vertex));
    write('value-place', `${meshes.placeOf(mesh, vertex).map((x) => x.toFixed(digits)).join(', ')} mm`);
  }

  function paint() {
    if (!mesh || !stage) return;
    const { id, index } = legend.present;
    if (id !== 'plain') stage.setColors(meshes.colorsOf(mesh, index ?? null, legend.present));
    stage.wake();
  }

  const legend = Legend.make({
    single: names.length === 1,
    quantities,
    changed() {
      paint();
      showValues();
    },
    fit: () => mesh && meshes.rangeOf(mesh, legend.present.index),
  });

  const timeline = Timeline.make({
    names,
    async load(i) {
      triangles ??= await meshes.triangles();
      return meshes.load(i);
    },
    display(next, i) {
      mesh = next;
      shown = i;
      stage?.setSurface(mesh.positions, triangles, () => extent);
      paint();
      showValues();
    },
    failed: (error, i) => Page.failure(`The data of ${names[i]} in this page are damaged. Export the page again, or copy it again from where it came.`),
  });

  function tellFacts() {
    const size = facts.size.map((side) => Number(side.toPrecision(4)));
    write('facts', `${names.length === 1 ? '' : `${names.length} meshes of `}${facts.vertices} vertices, ${facts.triangles} triangles; ${size.join(' \u00d7 ')} mm`);
    const round = (length) => `${Number(length.toPrecision(2))} mm`;
    write('rounding', `In this page coordinates are rounded to whole multiples of ${round(facts.step)}, so that each is off by at most ${round(facts.step / 2)}`
      + facts.quantities.map(({ name, step }) => `; ${name} by at most ${Number((step / 2).toPrecision(2))}`).join('') + '. Measure in the files, not in the page.');
    const first = names.length === 1 ? '' : ' of the first mesh';
    const figures = [
      ['Vertices', facts.vertices], ['Triangles', facts.triangles], ['Size', `${size.join(' \u00d7 ')} mm`],
      [`Area${first}`, facts.area === null ? 'not a surface' : `${Number(facts.area.toPrecision(5))} mm\u00b2`],
      ['Open edges', facts.open_edges === null ? 'edges with more than two triangles, or turned ones'
        : facts.open_edges === 0 ? 'none: closed' : facts.open_edges],
    ];
    for (const [name, value] of figures) {
      const term = document.createElement('dt'), text = document.createElement('dd');
      term.textContent = name;
      text.textContent = String(value);
      element('figures').append(term, text);
    }
  }

  tellFacts();
  showValues();
  if (stage) {
    Orbit.connectButtons(stage.present);
    for (const id of ['edges', 'flat']) element(id).addEventListener('change', stage.wake);
    element('view').addEventListener('pointerdown', () => element('hint').classList.add('done'), { once: true });
  }

  window.palpate = {
    /** Resolves when the first mesh is shown. */
    ready: Bytes.supported ? timeline.show(0).then(() => { if (!stage) throw new Error(WebGl.kMissing); })
      : Promise.reject(new Error(kTooOld)),
    /** Shows mesh i; resolves then. */
    show: (i) => timeline.show(i),
    shown: () => shown,
    /** Coordinates [mm] of a vertex of the mesh that is shown, and its numbers by name. */
    valuesAt: (i) => ({
      place: meshes.placeOf(mesh, i),
      ...Object.fromEntries(facts.quantities.map(({ name }, k) => [name, meshes.valueOf(mesh, k, i)])),
    }),
    /** Where on the page [px] a vertex is drawn, if nothing hides it. */
    placeOf(i) {
      const { x, y } = stage.placeOf([...mesh.positions.subarray(3 * i, 3 * i + 3)]), box = element('view').getBoundingClientRect();
      return { x: x + box.x, y: y + box.y };
    },
  };
  window.palpate.ready.catch((error) => Page.failure(error.message));
})();
