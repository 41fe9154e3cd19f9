// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// A surface in space, shaded and coloured, with or without the edges of its triangles.
const SurfaceView = (() => {
  'use strict';
  const { compile, use, bufferOf, attribute, vertexArray } = WebGl;
  const kReliefOfColors = 0.5;  // of the shading is left where colours mean numbers

  const kSurface = [`
    layout(location = 0) in vec3 a_position;
    layout(location = 1) in vec3 a_normal;
    layout(location = 2) in vec4 a_color;
    uniform mat4 u_matrix;
    out vec3 v_position, v_normal, v_color;
    void main() {
      v_position = a_position;
      v_normal = a_normal;
      v_color = a_color.rgb;
      gl_Position = u_matrix * vec4(a_position, 1.0);
    }`, `
    in vec3 v_position, v_normal, v_color;
    uniform vec3 u_eye, u_light, u_front, u_back;
    uniform float u_colored, u_relief, u_flat;
    ${WebGl.kLit}
    void main() {
      vec3 to_eye = normalize(u_eye - v_position);
      vec3 normal = u_flat > 0.5 ? normalize(cross(dFdx(v_position), dFdy(v_position))) : normalize(v_normal);
      if (dot(normal, to_eye) < 0.0) normal = -normal;
      vec3 base = u_colored > 0.5 ? v_color : gl_FrontFacing ? u_front : u_back;
      o_color = vec4(mix(base, lit(base, normal, to_eye, u_light), u_relief), 1.0);
    }`];

  const kEdges = [`
    layout(location = 0) in vec3 a_position;
    uniform mat4 u_matrix;
    void main() { gl_Position = u_matrix * vec4(a_position, 1.0); }`, `
    uniform vec3 u_color;
    void main() { o_color = vec4(u_color, 1.0); }`];

  /** Both ends of the three edges of each triangle. */
  function edgesOf(triangles) {
    const edges = new Uint32Array(2 * triangles.length);
    for (let t = 0; t < triangles.length; t += 3) {
      for (let k = 0; k < 3; ++k) {
        edges[2 * (t + k)] = triangles[t + k];
        edges[2 * (t + k) + 1] = triangles[t + (k + 1) % 3];
      }
    }
    return edges;
  }

  /** A view on the canvas, or null if the browser has no WebGL2. */
  function make(canvas) {
    const gl = WebGl.contextOf(canvas);
    if (!gl) return null;
    const programs = {}, buffers = {};
    let surface = null, wires = null, wiresFit = false;
    let positions = new Float32Array(0), normals = positions, triangles = new Uint32Array(0), colors = new Uint32Array(0);

    function build() {
      programs.backdrop = compile(gl, WebGl.kBackdrop);
      programs.surface = compile(gl, kSurface);
      programs.edges = compile(gl, kEdges);
      surface = vertexArray(gl, () => {
        buffers.positions = bufferOf(gl, positions, gl.DYNAMIC_DRAW);
        attribute(gl, 0, 0, 0);
        buffers.normals = bufferOf(gl, normals, gl.DYNAMIC_DRAW);
        attribute(gl, 1, 0, 0);
        buffers.colors = bufferOf(gl, colors, gl.DYNAMIC_DRAW);
        gl.enableVertexAttribArray(2);
        gl.vertexAttribPointer(2, 4, gl.UNSIGNED_BYTE, true, 0, 0);
        buffers.triangles = bufferOf(gl, triangles, gl.DYNAMIC_DRAW, gl.ELEMENT_ARRAY_BUFFER);
      });
      wires = vertexArray(gl, () => {
        gl.bindBuffer(gl.ARRAY_BUFFER, buffers.positions);
        attribute(gl, 0, 0, 0);
        buffers.edges = bufferOf(gl, 4, gl.DYNAMIC_DRAW, gl.ELEMENT_ARRAY_BUFFER);
      });
      wiresFit = false;
    }

    function write(name, data) {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffers[name]);
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
    }

    /** Indices belong to a vertex array. */
    function writeIndices(array, name, data) {
      gl.bindVertexArray(array);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffers[name]);
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
      gl.bindVertexArray(null);
    }

    function drawEdges(shot, color) {
      if (!wiresFit) writeIndices(wires, 'edges', edgesOf(triangles));
      wiresFit = true;
      use(gl, programs.edges, { u_matrix: shot.matrix, u_color: color });
      gl.bindVertexArray(wires);
      gl.drawElements(gl.LINES, 2 * triangles.length, gl.UNSIGNED_INT, 0);
    }

    build();
    return {
      /** Another surface: 3 V coordinates, 3 T corners. Vertices that no triangle uses may be NaN. */
      setSurface(newPositions, newTriangles) {
        positions = newPositions;
        normals = new Float32Array(positions.length);
        Surface.sumNormals(positions, newTriangles, normals);
        write('positions', positions);
        write('normals', normals);
        if (newTriangles === triangles) return;
        triangles = newTriangles;
        writeIndices(surface, 'triangles', triangles);
        wiresFit = false;
      },
      /** A packed colour for each vertex. */
      setColors(newColors) {
        colors = newColors;
        write('colors', colors);
      },
      clear: (scheme) => WebGl.drawBackdrop(gl, programs.backdrop, scheme),
      /** `scheme`: colours sky, floor, surface, back and edge. */
      draw(shot, scheme, { colored, flat, edges }) {
        WebGl.drawBackdrop(gl, programs.backdrop, scheme);
        gl.enable(gl.DEPTH_TEST);
        gl.enable(gl.POLYGON_OFFSET_FILL);
        gl.polygonOffset(1, 1);  // edges lie before their triangles
        use(gl, programs.surface, {
          u_matrix: shot.matrix, u_eye: shot.eye, u_light: shot.light, u_front: scheme.surface, u_back: scheme.back,
          u_colored: Number(colored), u_relief: colored ? kReliefOfColors : 1, u_flat: Number(flat),
        });
        gl.bindVertexArray(surface);
        gl.drawElements(gl.TRIANGLES, triangles.length, gl.UNSIGNED_INT, 0);
        gl.disable(gl.POLYGON_OFFSET_FILL);
        if (edges) drawEdges(shot, scheme.edge);
      },
      /** After the browser has lost and restored the context. */
      rebuild: build,
      hit: ({ origin, direction }) => Surface.hit(origin, direction, positions, triangles),
      normals: () => normals,
    };
  }

  return { make };
})();
