// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The page of range maps: connects timeline, image, surface, legend and values.
(() => {
  'use strict';
  const { element, write } = Page;
  const kTooOld = 'This browser is too old to unpack the data: it lacks DecompressionStream. A browser of 2023 or later shows this page.';
  const facts = JSON.parse(element('facts-data').textContent);
  const { width, height } = facts;
  const frames = Frames.make(facts, document.querySelectorAll('script.block'));
  const names = facts.frames.map(({ name }) => name);
  const depthDigits = Legend.decimals(facts.step);
  let frame = null, shown = 0, mark = null, requested = false, reliefFits = false;

  /** What can be shown, depths first if there are any. */
  function quantities() {
    const list = [];
    if (facts.depth) list.push({ id: 'depth', name: 'Depth', unit: 'mm', step: facts.step, range: facts.depth });
    if (facts.sigma) list.push({ id: 'sigma', name: 'Deviation', unit: 'mm', digits: Legend.threeDigits(facts.sigma.low), range: facts.sigma, log: true });
    if (facts.reasons) list.push({ id: 'reason', name: 'Reason', words: facts.reasons });
    return list;
  }

  const image = ImageView.make(element('image'), width, height);
  const stride = Relief.strideOf(width, height, Math.max(...facts.frames.map(({ known }) => known)));
  const inspect = (pixel) => {
    if (!pixel) return;
    mark = pixel;
    element('hint').classList.add('done');
    showValues();
    wake();
  };
  const stage = SurfaceStage.make({
    canvas: element('view'),
    options: () => ({ colored: !element('plain').checked, flat: false, edges: false }),
    inspect(vertex) {
      const across = Math.ceil(width / stride);
      if (vertex >= 0) inspect({ column: stride * (vertex % across), row: stride * Math.floor(vertex / across) });
    },
  });
  let rays = null;

  const inSpace = () => element('in-space').checked;

  function wake() {
    if (inSpace()) {
      stage?.wake();
      return;
    }
    if (!requested) requestAnimationFrame(drawImage);
    requested = true;
  }

  function drawImage() {
    requested = false;
    if (!inSpace()) image.draw({ hatch: Page.color('--hatch'), sign: Page.color('--mark'), line: Page.color('--line') }, mark);
  }

  const millimetres = (value, digits) => `${value.toFixed(digits)} mm`;

  function showValues() {
    const values = mark && frame ? frames.valuesAt(frame, mark.row * width + mark.column) : null;
    const unknown = values ? 'unknown' : '\u2013';
    write('value-pixel', mark ? `column ${mark.column}, row ${mark.row}` : '\u2013');
    write('value-depth', values && !Number.isNaN(values.depth) ? millimetres(values.depth, depthDigits) : unknown);
    write('value-sigma', values && !Number.isNaN(values.sigma) ? `\u00b1 ${millimetres(values.sigma, Legend.threeDigits(values.sigma))}` : unknown);
    write('value-reason', values && values.reason !== null ? facts.reasons[values.reason] : unknown);
  }

  /** Colours what is seen; the surface has those of the pixels that are its vertices. */
  function paint() {
    if (!frame) return;
    legend.follow();
    const one = legend.present;
    if (one.words) legend.count(frames.countsOf(frame));
    if (inSpace() && stage) stage.setColors(frames.colorsOf(frame, one, stride).map((color) => color || ColorMap.unknown));
    else image.setColors(frames.colorsOf(frame, one));
    wake();
  }

  /** The surface of the frame, if it is looked at. */
  async function raise() {
    if (!inSpace() || !stage || !frame || reliefFits) return;
    reliefFits = true;
    rays ??= await frames.rays(stride);
    const { positions, triangles } = Relief.make({ depths: frame.depths, width, height, stride, step: facts.step, rays });
    stage.setSurface(positions, triangles, () => Surface.extentOf(usedOf(positions, triangles)));
  }

  /** Coordinates of the corners: pixels without triangles do not count. */
  const usedOf = (positions, triangles) => {
    const used = new Float32Array(3 * triangles.length);
    triangles.forEach((vertex, i) => used.set(positions.subarray(3 * vertex, 3 * vertex + 3), 3 * i));
    return used;
  };

  function tellFrame() {
    const { known } = facts.frames[shown];
    write('known', known === 0 ? 'No pixel of this frame has a depth.'
      : `${known} of ${width * height} pixels have a depth (${(100 * known / (width * height)).toFixed(1)}\u00a0%).`);
    const lacks = { sigma: !frame.sigmas && 'Deviations', reason: !frame.reasons && 'Reasons' }[legend.present.id];
    write('notice', lacks ? `${lacks} of this frame were not stored.` : '');
  }

  async function display(next, i) {
    frame = next;
    shown = i;
    reliefFits = false;
    tellFrame();
    await raise();
    paint();
    showValues();
  }

  const legend = Legend.make({
    single: names.length === 1,
    quantities: quantities(),
    changed() {
      if (!frame) return;
      tellFrame();
      paint();
    },
    fit: () => frame && frames.rangeOf(frame, legend.present.id),
  });

  const tellDamage = (what) => Page.failure(`The ${what} in this page are damaged. Export the page again, or copy it again from where it came.`);

  const timeline = Timeline.make({
    names, load: frames.load, display,
    failed: (error, i) => tellDamage(`data of ${names[i]}`),
  });

  function chooseView() {
    element('hint').classList.add('done');
    element('image').hidden = inSpace();
    element('view').hidden = !inSpace();
    element('message').hidden = !inSpace() || stage !== null;
    if (inSpace() && !stage) write('message', `${WebGl.kMissing} The image needs none: choose it above.`);
    element('plain-row').hidden = !inSpace() || !stage;
    raise().then(paint, () => tellDamage('data of the camera'));
  }

  function tellFacts() {
    const [one, many] = facts.exact ? ['Depth image', 'depth images'] : ['Range map', 'range maps'];
    write('facts', `${names.length === 1 ? one : `${names.length} ${many}`} of ${width} \u00d7 ${height} pixels`);
    const micro = (length) => `${Number((1000 * length).toPrecision(2))} \u00b5m`;
    const least = facts.sigma ? `; the smallest deviation here is ${micro(facts.sigma.min)}` : '';
    const lost = facts.exact ? 'In this page depths are exact, as in the depth images. '
      : `In this page depths are rounded to whole multiples of ${micro(facts.step)}: they are off by at most ${micro(facts.step / 2)}${least}. `;
    write('rounding', `${lost}${facts.sigma ? 'Deviations are off by at most 1 %. ' : ''}Unknown pixels and reasons are as they were decoded. Measure in the files, not in the page.`);
    write('drawn', `The surface is drawn from ${stride === 1 ? 'all pixels' : `one pixel of ${stride} \u00d7 ${stride}`}, and cut where the depth of neighbours differs by more than 2 %.`);
    for (const [row, present] of [['sigma', facts.sigma], ['reason', facts.reasons]]) {
      for (const part of document.querySelectorAll(`.of-${row}`)) part.hidden = !present;
    }
  }

  tellFacts();
  Page.followSize(element('image'), (shownWidth, shownHeight) => {
    image.camera.resize(shownWidth, shownHeight);
    wake();
  });
  const look = (place) => { if (place) inspect(image.pixelAt(place)); };
  Orbit.attach({
    canvas: element('image'), camera: image.camera, home: image.camera.home, wake, hover: look,
    grab(place) { look(place); return false; },
  });
  Orbit.connectButtons(() => (inSpace() && stage ? stage.present() : { camera: image.camera, home: image.camera.home, wake }));
  for (const choice of document.querySelectorAll('[name=where]')) choice.addEventListener('change', chooseView);
  element('plain').addEventListener('change', wake);
  Page.onScheme(wake);

  window.palpate = {
    /** Resolves when the first frame is shown. */
    ready: Bytes.supported ? timeline.show(0) : Promise.reject(new Error(kTooOld)),
    /** Shows frame i; resolves then. */
    show: (i) => timeline.show(i),
    shown: () => shown,
    /** Depth and deviation [mm] and reason of a pixel of the frame that is shown. */
    valuesAt: (column, row) => frames.valuesAt(frame, row * width + column),
    /** Where in the frame of the camera [mm] a pixel is drawn in space; NaN where it is not. */
    async pointAt(column, row) {
      rays ??= await frames.rays(stride);
      const { depth } = frames.valuesAt(frame, row * width + column);
      const [x, y] = rays.map((ray) => ray[row / stride * Math.ceil(width / stride) + column / stride] * depth);
      return [x, y, depth];
    },
    /** Where on the page [px] a pixel of the image is. */
    placeOf(column, row) {
      const { x, y } = image.placeOf({ column, row }), box = element('image').getBoundingClientRect();
      return { x: x + box.x, y: y + box.y };
    },
  };
  window.palpate.ready.catch((error) => Page.failure(error.message));
})();
