// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Draws the scene with raw WebGL2: backdrop, surface, contacts, and the solids that show the tool and the force.
const Renderer = (() => {
  'use strict';
  const { frameAbout } = Algebra;
  const { compile, use, bufferOf, attribute, vertexArray } = WebGl;
  const kHidden = 0.22;  // opacity of what lies behind the surface

  const kSurface = [`
    layout(location = 0) in vec3 a_position;
    layout(location = 1) in vec3 a_normal;
    layout(location = 2) in vec3 a_rest;
    uniform mat4 u_matrix;
    out vec3 v_position, v_normal;
    out float v_moved;
    void main() {
      v_position = a_position;
      v_normal = a_normal;
      v_moved = length(a_position - a_rest);
      gl_Position = u_matrix * vec4(a_position, 1.0);
    }`, `
    in vec3 v_position, v_normal;
    in float v_moved;
    uniform vec3 u_eye, u_light, u_front, u_back, u_dent;
    uniform float u_depth;
    ${WebGl.kLit}
    void main() {
      vec3 to_eye = normalize(u_eye - v_position);
      vec3 normal = normalize(v_normal);
      bool front = gl_FrontFacing;
      if (!front) normal = -normal;
      vec3 base = front ? mix(u_front, u_dent, 0.55 * smoothstep(0.0, 1.0, v_moved / u_depth)) : u_back;
      o_color = vec4(lit(base, normal, to_eye, u_light), 1.0);
    }`];

  const kSolid = [`
    layout(location = 0) in vec3 a_position;
    layout(location = 1) in vec3 a_normal;
    uniform mat4 u_matrix;
    uniform mat3 u_frame;
    uniform vec3 u_origin, u_scale;
    out vec3 v_normal, v_position;
    void main() {
      v_position = u_origin + u_frame * (a_position * u_scale);
      v_normal = u_frame * (a_normal / u_scale);
      gl_Position = u_matrix * vec4(v_position, 1.0);
    }`, `
    in vec3 v_normal, v_position;
    uniform vec3 u_eye, u_light;
    uniform vec4 u_color;
    void main() {
      vec3 to_eye = normalize(u_eye - v_position);
      vec3 normal = normalize(v_normal);
      if (dot(normal, to_eye) < 0.0) normal = -normal;
      float shine = pow(max(dot(normal, normalize(u_light + to_eye)), 0.0), 50.0);
      o_color = vec4(u_color.rgb * (0.62 + 0.42 * max(dot(normal, u_light), 0.0)) + 0.25 * shine * u_color.a, u_color.a);
    }`];

  const kDots = [`
    layout(location = 0) in vec3 a_position;
    uniform mat4 u_matrix;
    uniform vec3 u_eye;
    uniform float u_size, u_lift;
    void main() {
      gl_Position = u_matrix * vec4(a_position + u_lift * normalize(u_eye - a_position), 1.0);
      gl_PointSize = u_size;
    }`, `
    uniform vec3 u_color;
    void main() {
      float away = 2.0 * length(gl_PointCoord - 0.5);
      if (away > 1.0) discard;
      o_color = vec4(u_color, 0.75 * smoothstep(1.0, 0.6, away));
    }`];

  /** A renderer for the canvas, or null if the browser has no WebGL2. */
  function make(canvas, { rest, triangles, dotCount }) {
    const gl = WebGl.contextOf(canvas);
    if (!gl) return null;
    const programs = { backdrop: compile(gl, WebGl.kBackdrop), surface: compile(gl, kSurface), solid: compile(gl, kSolid), dots: compile(gl, kDots) };
    const buffers = {};
    const surface = vertexArray(gl, () => {
      buffers.position = bufferOf(gl, rest, gl.DYNAMIC_DRAW);
      attribute(gl, 0, 0, 0);
      buffers.normal = bufferOf(gl, rest.byteLength, gl.DYNAMIC_DRAW);
      attribute(gl, 1, 0, 0);
      bufferOf(gl, rest);
      attribute(gl, 2, 0, 0);
      bufferOf(gl, triangles, gl.STATIC_DRAW, gl.ELEMENT_ARRAY_BUFFER);
    });
    const dots = vertexArray(gl, () => {
      buffers.dots = bufferOf(gl, 12 * dotCount, gl.DYNAMIC_DRAW);
      attribute(gl, 0, 0, 0);
    });
    const shapes = {};
    for (const [name, corners] of Object.entries(Shapes)) {
      const array = vertexArray(gl, () => {
        bufferOf(gl, corners);
        attribute(gl, 0, 24, 0);
        attribute(gl, 1, 24, 12);
      });
      shapes[name] = { array, count: corners.length / 6 };
    }

    function write(buffer, data) {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferSubData(gl.ARRAY_BUFFER, 0, data);
    }

    function drawSolids(solids, shot, opacity) {
      for (const { shape, origin, axis, size, color } of solids) {
        use(gl, programs.solid, {
          u_matrix: shot.matrix, u_eye: shot.eye, u_light: shot.light, u_frame: frameAbout(axis), u_origin: origin, u_scale: size,
          u_color: [color[0], color[1], color[2], (color[3] ?? 1) * opacity],
        });
        gl.bindVertexArray(shapes[shape].array);
        gl.drawArrays(gl.TRIANGLES, 0, shapes[shape].count);
      }
    }

    /** Solids: opaque ones first. `dent` is the displacement [mm] that gets the whole tint; dots are lifted by `lift` mm, so that a slanted surface does not cut them. */
    function draw(shot, colors, { solids, showDots, dotSize, dent, lift }) {
      WebGl.drawBackdrop(gl, programs.backdrop, colors);
      gl.enable(gl.DEPTH_TEST);
      use(gl, programs.surface, {
        u_matrix: shot.matrix, u_eye: shot.eye, u_light: shot.light, u_front: colors.surface, u_back: colors.back,
        u_dent: colors.dent, u_depth: dent,
      });
      gl.bindVertexArray(surface);
      gl.drawElements(gl.TRIANGLES, triangles.length, gl.UNSIGNED_INT, 0);

      gl.enable(gl.BLEND);
      gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
      gl.depthMask(false);
      if (showDots) {
        use(gl, programs.dots, { u_matrix: shot.matrix, u_eye: shot.eye, u_size: dotSize, u_lift: lift, u_color: colors.dot });
        gl.bindVertexArray(dots);
        gl.drawArrays(gl.POINTS, 0, dotCount);
      }
      // What the surface hides shows through, faintly: a force is never out of sight in a dent.
      gl.depthFunc(gl.GREATER);
      drawSolids(solids, shot, kHidden);
      gl.depthFunc(gl.LEQUAL);
      gl.depthMask(true);
      drawSolids(solids.filter(({ color }) => color[3] === undefined), shot, 1);
      gl.depthMask(false);
      drawSolids(solids.filter(({ color }) => color[3] !== undefined), shot, 1);
      gl.depthMask(true);
    }

    return {
      draw,
      /** New positions (3 V), normals and places of the dots. */
      update(positions, normals, dotPositions) {
        write(buffers.position, positions);
        write(buffers.normal, normals);
        write(buffers.dots, dotPositions);
      },
    };
  }

  return { make };
})();
