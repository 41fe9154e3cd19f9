// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// What every picture in space needs of raw WebGL2: context, programs, buffers, backdrop, and light.
const WebGl = (() => {
  'use strict';
  const kMissing = 'This browser does not offer WebGL2, with which the object is drawn. A current browser with hardware acceleration switched on shows it.';

  const kBackdrop = [`
    out vec2 v_place;
    void main() { v_place = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2); gl_Position = vec4(2.0 * v_place - 1.0, 0.0, 1.0); }`, `
    in vec2 v_place;
    uniform vec3 u_sky, u_floor;
    void main() {
      float grain = fract(sin(dot(gl_FragCoord.xy, vec2(12.9898, 78.233))) * 43758.5453) / 255.0;  // against bands
      o_color = vec4(mix(u_floor, u_sky, smoothstep(0.0, 1.0, 1.15 - length((v_place - vec2(0.45, 0.65)) * 1.25))) + grain, 1.0);
    }`];

  /** In fragment shaders: a surface of colour `base`, seen from `to_eye`. */
  const kLit = `
    vec3 lit(vec3 base, vec3 normal, vec3 to_eye, vec3 light) {
      float key = max(dot(normal, light), 0.0);
      float wrap = 0.5 + 0.5 * dot(normal, light);
      float facing = max(dot(normal, to_eye), 0.0);
      float shine = pow(max(dot(normal, normalize(light + to_eye)), 0.0), 38.0);
      return base * (0.27 + 0.33 * wrap + 0.48 * key + 0.08 * facing) + 0.12 * shine + 0.10 * pow(1.0 - facing, 4.0) * wrap;
    }`;

  /** The context of a canvas, or null if the browser has no WebGL2. */
  function contextOf(canvas) {
    // Without a graphics processor, smooth edges would take half of the time of a frame.
    return canvas.getContext('webgl2', { antialias: true, alpha: false, failIfMajorPerformanceCaveat: true })
      ?? canvas.getContext('webgl2', { antialias: false, alpha: false });
  }

  function compile(gl, [vertex, fragment]) {
    const program = gl.createProgram();
    const head = '#version 300 es\nprecision highp float;\n';
    for (const [type, text] of [[gl.VERTEX_SHADER, head + vertex], [gl.FRAGMENT_SHADER, `${head}out vec4 o_color;\n${fragment}`]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) throw new Error(gl.getProgramInfoLog(program));
    const places = {};
    for (let i = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i-- > 0;) {
      const { name } = gl.getActiveUniform(program, i);
      places[name] = gl.getUniformLocation(program, name);
    }
    return { program, places };
  }

  const setters = { 1: 'uniform1fv', 3: 'uniform3fv', 4: 'uniform4fv', 9: 'uniformMatrix3fv', 16: 'uniformMatrix4fv' };

  /** Uses a program and sets its uniforms; a number, or an array whose length tells the type. */
  function use(gl, { program, places }, values) {
    gl.useProgram(program);
    for (const [name, value] of Object.entries(values)) {
      const array = typeof value === 'number' ? [value] : value;
      const matrix = array.length > 4 ? [false] : [];
      gl[setters[array.length]](places[name] ?? null, ...matrix, array);
    }
  }

  function bufferOf(gl, data, usage = gl.STATIC_DRAW, target = gl.ARRAY_BUFFER) {
    const buffer = gl.createBuffer();
    gl.bindBuffer(target, buffer);
    gl.bufferData(target, data, usage);
    return buffer;
  }

  /** Binds attribute `index` to three floats at `offset` in each `stride` bytes of the bound buffer. */
  function attribute(gl, index, stride, offset) {
    gl.enableVertexAttribArray(index);
    gl.vertexAttribPointer(index, 3, gl.FLOAT, false, stride, offset);
  }

  function vertexArray(gl, fill) {
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    fill();
    gl.bindVertexArray(null);
    return array;
  }

  /** Begins a picture: fills it with the backdrop. */
  function drawBackdrop(gl, program, colors) {
    gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
    gl.disable(gl.BLEND);
    gl.disable(gl.DEPTH_TEST);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    use(gl, program, { u_sky: colors.sky, u_floor: colors.floor });
    gl.bindVertexArray(null);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  return { contextOf, compile, use, bufferOf, attribute, vertexArray, drawBackdrop, kBackdrop, kLit, kMissing };
})();
