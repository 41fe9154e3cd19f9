// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The words and numbers beside the object.
const Readout = (() => {
  'use strict';
  const { norm } = Algebra;
  const kSpeakEvery = 1200;  // [ms] at least between two messages for a screen reader
  const kStates = {
    free: ['Free', 'The tool touches nothing.'],
    stick: ['Sticks', 'The tool holds at the contact.'],
    slip: ['Slips', 'The tool slides over the object.'],
  };
  const { element, write } = Page;

  /** `reference` [N] decides how many digits are shown, `extent` and `contactCount` are facts of the model. */
  function make({ reference, extent, contactCount, toolRadius, shapeError }) {
    const digits = Math.min(5, Math.max(0, 2 - Math.round(Math.log10(reference))));
    const newtons = (value) => value.toFixed(digits);
    const size = [0, 1, 2].map((k) => Number((extent.high[k] - extent.low[k]).toPrecision(3))).filter((length) => length > 0);
    let spokenState = 'free', spokenAt = 0;

    write('facts', `${size.join(' \u00d7 ')} mm, ${contactCount} contacts`);
    write('ball', toolRadius > 0 ? `The ball has the radius with which the object was measured, ${Number(toolRadius.toPrecision(3))} mm.`
      : 'The radius of the ball is not known; it is drawn only.');
    write('dent', shapeError >= 0
      ? `learnt from surfaces that a camera recorded, which it shows with an error of ${Number(shapeError.toPrecision(2))} mm (root mean square).`
      : 'drawn, not measured. It is a smooth shape around the tool.');

    function speak(state, force, now) {
      if (state === spokenState || now - spokenAt < kSpeakEvery) return;
      spokenState = state;
      spokenAt = now;
      write('spoken', state === 'free' ? kStates.free[0] : `${kStates[state][0]}, ${newtons(force)} newtons`);
    }

    /** `lengthOfNewton`: [mm] at which 1 N is drawn. */
    function show(tool, lengthOfNewton, now) {
      const { force, normalForce, tangentialForce, deviation, friction } = tool.outcome;
      const state = Player.STATES[tool.state], total = norm(force);
      element('state').dataset.state = state;
      write('state-word', kStates[state][0]);
      write('state-why', kStates[state][1]);
      write('newtons', newtons(total));
      write('deviation', tool.state !== 0 && Number.isFinite(deviation) ? `\u00b1 ${newtons(deviation)} N` : '');
      write('total', newtons(total));
      write('normal', newtons(normalForce));
      write('tangential', newtons(tangentialForce));
      if (tool.state !== 0 && Number.isFinite(friction)) write('friction', friction.toFixed(2));
      write('scale', `1 N is ${Number(lengthOfNewton.toPrecision(2))} mm long`);
      speak(state, total, now);
    }

    return { show };
  }

  /** The depth of a press: a slider, and its value in words. */
  function depthControl(tool, changed) {
    const slider = element('depth'), [low, high] = tool.depthRange;
    const show = () => {
      const words = `${Number(tool.depth.toPrecision(2))} mm`;
      slider.value = String(1000 * (tool.depth - low) / (high - low));
      slider.setAttribute('aria-valuetext', words);
      write('depth-value', words);
    };
    slider.addEventListener('input', () => {
      tool.setDepth(low + (high - low) * Number(slider.value) / 1000);
      show();
      changed();
    });
    show();
    return show;
  }

  return { make, depthControl };
})();
