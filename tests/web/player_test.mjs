// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0

// The player of a page computes what `palpate play` does. node player_test.mjs FOLDER, which make_page.py has filled.
import assert from 'node:assert';
import fs from 'node:fs';
import test from 'node:test';
import zlib from 'node:zlib';

const folder = process.argv[2];
const page = fs.readFileSync(`${folder}/model.html`, 'utf8');
const LARGEST_DIFFERENCE = 1e-9;  // [N], [mm]

function bytesOf(id) {
  const text = page.match(new RegExp(`id="${id}"[^>]*>([^<]*)<`))[1];
  return zlib.gunzipSync(Buffer.from(text.trim(), 'base64'));
}

async function instantiate() {
  const none = new Proxy({}, { get: () => () => 52 });
  const { instance } = await WebAssembly.instantiate(bytesOf('player'), { wasi_snapshot_preview1: none });
  instance.exports._initialize();
  return instance.exports;
}

function open(player, model) {
  const place = player.palpate_allocate(model.length);
  new Uint8Array(player.memory.buffer, place, model.length).set(model);
  player.palpate_open(place, model.length);
}

function readTrace(name) {
  const rows = fs.readFileSync(`${folder}/${name}`, 'utf8').split('\n').filter((row) => row && !row.startsWith('#'));
  assert.equal(rows.shift(), 't,x,y,z,cx,cy,cz,fx,fy,fz,state');
  return rows.map((row) => {
    const cells = row.split(',');
    return { numbers: cells.slice(1, 10).map(Number), state: ['free', 'stick', 'slip'].indexOf(cells[10]) };
  });
}

for (const name of ['trace.csv', 'wild_trace.csv']) {
  test(`plays ${name} as the command does`, async () => {
    const player = await instantiate();
    open(player, bytesOf('model'));
    const trace = readTrace(name);
    const seen = [0, 0, 0];
    trace.forEach(({ numbers, state }, tick) => {
      const [x, y, z, cx, cy, cz, fx, fy, fz] = numbers;
      assert.equal(player.palpate_step(x, y, z), state, `state in tick ${tick}`);
      seen[state] += 1;
      const output = new Float64Array(player.memory.buffer, player.palpate_output(), 6);
      [fx, fy, fz, cx, cy, cz].forEach((expected, i) => {
        assert.ok(Math.abs(output[i] - expected) <= LARGEST_DIFFERENCE, `tick ${tick}: ${output[i]} for ${expected}`);
      });
    });
    assert.ok(Math.min(...seen) > 100, `free, stick and slip occur: ${seen}`);
  });
}

test('describes a contact consistently', async () => {
  const player = await instantiate();
  open(player, bytesOf('model'));
  let slips = 0;
  for (const { numbers } of readTrace('trace.csv')) {
    const state = player.palpate_step(...numbers.slice(0, 3));
    const out = new Float64Array(player.memory.buffer, player.palpate_output(), 16).slice();
    if (state === 0) {
      assert.deepEqual([...out.slice(6, 12), ...out.slice(13)], new Array(9).fill(0));
      continue;
    }
    assert.ok(Math.abs(Math.hypot(...out.slice(6, 9)) - 1) < 1e-9, 'the axis is a unit vector');
    assert.ok(Math.abs(Math.hypot(out[10], out[11]) - Math.hypot(...out.slice(0, 3))) < 1e-9, 'parts make up the force');
    assert.ok(Math.abs(out[11]) <= out[9] * out[10] + 1e-3 || state === 2, 'a contact that sticks is in its cone');
    assert.ok(out[12] > 0, 'its error is stated');
    slips += state === 2;
  }
  assert.ok(slips > 100);
});

test('draws the surface with the contact under the tool, and as it was when the tool has left', async () => {
  const player = await instantiate();
  open(player, bytesOf('model'));
  const count = 3 * player.palpate_vertex_count();
  const drawn = () => {
    const place = player.palpate_deform(0);  // first: it may grow the memory, which makes an older buffer useless
    return new Float32Array(player.memory.buffer, place, count).slice();
  };
  const [x, y, z] = new Float64Array(player.memory.buffer, player.palpate_vertices(), 3);
  const rest = drawn();
  assert.ok(Math.abs(rest[0] - x) + Math.abs(rest[1] - y) + Math.abs(rest[2] - z) < 1e-3);
  assert.ok(player.palpate_pick(0, 0, 0, 0, 0, 1));
  const [px, py, pz, , , nz] = new Float64Array(player.memory.buffer, player.palpate_picked(), 6);
  const depth = -Math.sign(nz) * 3;
  for (let i = -100; i <= 100; ++i) player.palpate_step(px, py, pz + (depth * i) / 100);
  const pressed = drawn();
  let largest = 0, moved = 0;
  for (let v = 0; v < count; v += 3) {
    const way = Math.hypot(pressed[v] - rest[v], pressed[v + 1] - rest[v + 1], pressed[v + 2] - rest[v + 2]);
    largest = Math.max(largest, way);
    moved += way > 0;
  }
  assert.ok(largest > 2.5 && largest < 3.01, `the dent is ${largest} mm deep`);
  assert.ok(moved > 10 && moved < count / 6, 'only what is near moves');
  player.palpate_step(px, py, pz - 2 * depth);
  assert.deepEqual(drawn(), rest);
});

test('stops at a model that is damaged or of another version', async () => {
  const model = bytesOf('model');
  const damage = [
    model.subarray(0, model.length / 2),
    Buffer.concat([model, Buffer.of(0)]),
    Buffer.concat([Buffer.from('another!'), model.subarray(8)]),
    Buffer.alloc(0),
  ];
  for (const damaged of damage) {
    const player = await instantiate();
    assert.throws(() => open(player, damaged), WebAssembly.RuntimeError);
  }
});
