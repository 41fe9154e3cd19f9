// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The simulated tool: it follows what the visitor wants at 1 kHz, without jumps, and each tick is played.
const Tool = (() => {
  'use strict';
  const { add, subtract, along, mix, dot, unit, norm } = Algebra;
  const kMostTicks = 60;         // a frame computes; a slower display slows the tool down rather than the page
  const kGap = 0.006;            // of the diagonal: how far above the surface a press begins
  const kFollow = 0.02;          // [s] in which the tool follows the pointer
  const kTurn = 0.1;             // [s] in which its direction follows the surface
  const kSink = 0.28;            // [s] in which it sinks in
  const kLift = 0.05;            // [s] in which it is lifted
  const kFastest = 0.004;        // of the diagonal a tick: a flick of the pointer stays a motion
  const kSteepest = 0.12;        // cosine at which a ray no longer says where on a plane
  const kReach = 0.12;           // of the diagonal: how far from its plane the surface is followed
  const kDepths = [0.002, 0.16]; // of the diagonal: range of the depth of a press
  const kFirstDepth = 0.05;

  const fraction = (time) => 1 - Math.exp(-0.001 / time);

  /** `onTick(state index)` is called after each tick. */
  function make(player, diagonal, onTick) {
    const gap = kGap * diagonal;
    const tool = {
      mode: 'idle',              // idle, press, lift
      position: [0, 0, 0],       // [mm]
      normal: [0, 0, 1],         // outwards; the tool is pressed against it
      depth: kFirstDepth * diagonal,
      share: 1,                  // of the depth that is wanted; a trigger is pulled in parts
      state: 0,
      outcome: player.output(),
    };
    let base = [0, 0, 0], wantedBase = base, wantedNormal = tool.normal, sunk = 0, debt = 0;

    tool.depthRange = kDepths.map((part) => part * diagonal);
    tool.setDepth = (depth) => { tool.depth = Math.min(tool.depthRange[1], Math.max(tool.depthRange[0], depth)); };

    /** Begins a press where the undeformed surface was picked. */
    tool.press = ({ position, normal }) => {
      player.reset();
      base = wantedBase = position;
      tool.normal = wantedNormal = normal;
      sunk = -gap;
      debt = 0;
      tool.position = along(base, tool.normal, gap);
      tool.mode = 'press';
    };

    /** Lets go: the tool is lifted off the surface. */
    tool.lift = () => { if (tool.mode === 'press') tool.mode = 'lift'; };

    /** Ends at once, without lifting. */
    tool.stop = () => {
      player.reset();
      tool.mode = 'idle';
      tool.state = 0;
      tool.outcome = player.output();
    };

    /** Drags to where the ray meets the plane of the press, and from there to the surface: another part of the object that the ray happens to hit is not jumped to. */
    tool.drag = ({ origin, direction }) => {
      if (tool.mode !== 'press') return;
      const slant = dot(direction, wantedNormal);
      if (slant > -kSteepest) return;
      const onPlane = along(origin, direction, dot(subtract(wantedBase, origin), wantedNormal) / slant);
      const reach = kReach * diagonal;
      const hit = player.pick(along(onPlane, wantedNormal, reach), wantedNormal.map((x) => -x));
      const near = hit && norm(subtract(hit.position, onPlane)) < 2 * reach && dot(hit.normal, wantedNormal) > 0;
      wantedBase = near ? hit.position : onPlane;
      if (near) wantedNormal = hit.normal;
    };

    function tick() {
      const step = mix(base, wantedBase, fraction(kFollow));
      const moved = subtract(step, base), length = norm(moved), most = kFastest * diagonal;
      base = length > most ? along(base, moved, most / length) : step;
      tool.normal = unit(mix(tool.normal, wantedNormal, fraction(kTurn)), tool.normal);
      const wanted = tool.mode === 'press' ? tool.share * (tool.depth + gap) - gap : -2 * gap;
      sunk += (wanted - sunk) * fraction(tool.mode === 'press' ? kSink : kLift);
      tool.position = along(base, tool.normal, -sunk);
      tool.state = player.step(...tool.position);
      tool.outcome = player.output();
      onTick(tool);
      if (tool.mode === 'lift' && sunk < -gap) tool.stop();
    }

    /** Plays as many ticks as milliseconds went by; returns whether the surface may have moved. */
    tool.advance = (milliseconds) => {
      if (tool.mode === 'idle') return false;
      debt = Math.min(kMostTicks, debt + milliseconds);
      for (; debt >= 1 && tool.mode !== 'idle'; --debt) tick();
      return true;
    };

    /** Where a ball of the radius touches when the tool is there. */
    tool.ballCenter = (radius) => add(tool.position, tool.normal.map((x) => x * radius));

    return tool;
  }

  return { make };
})();
