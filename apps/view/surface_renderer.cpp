// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surface_renderer.h"

#include <meshoptimizer.h>

#include <cstddef>
#include <string>
#include <vector>

#include "theme.h"

namespace palpate::view {
namespace {

/// A surface with this number of vertices is shaded at its vertices: the picture looks the same,
/// and a processor without graphics hardware draws it twice as fast.
constexpr Eigen::Index kDense = 30'000;

/// Of the triangles of a dense surface, in its coarse form.
constexpr double kCoarsePart = 0.3;

// Shared by both ways: light from one side, a soft one from all around, and a shine.
constexpr const char* kShading = R"(
uniform vec3 u_eye, u_light, u_back;
uniform float u_lit, u_dark;
vec3 shaded(vec3 to_eye, vec3 halfway, vec3 normal, vec3 base) {
  float key = dot(normal, u_light);
  float shine = max(dot(normal, halfway), 0.0);
  shine *= shine; shine *= shine; shine *= shine; shine *= shine; shine *= shine;
  float facing = max(dot(normal, to_eye), 0.0);
  vec3 lit = base * (0.435 + 0.165 * key + 0.48 * max(key, 0.0) + 0.08 * facing) + 0.12 * shine;
  return u_dark * mix(base, lit, u_lit);
}
)";

constexpr const char* kInputs = R"(
layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_normal;
layout(location = 2) in vec3 a_color;
uniform mat4 u_matrix;
)";

constexpr const char* kDenseVertex = R"(
uniform vec3 u_to_eye, u_halfway;  // as if the eye were far away
out vec3 v_color;
void main() {
  bool front = dot(a_normal, u_eye - a_position) > 0.0;
  v_color = shaded(u_to_eye, u_halfway, front ? a_normal : -a_normal, front ? a_color : u_back);
  gl_Position = u_matrix * vec4(a_position, 1.0);
})";
constexpr const char* kDenseFragment = R"(
in vec3 v_color;
out vec4 o_color;
void main() { o_color = vec4(v_color, 1.0); })";

constexpr const char* kCoarseVertex = R"(
out vec3 v_position, v_normal, v_color;
void main() {
  v_position = a_position;
  v_normal = a_normal;
  v_color = a_color;
  gl_Position = u_matrix * vec4(a_position, 1.0);
})";
constexpr const char* kCoarseFragment = R"(
in vec3 v_position, v_normal, v_color;
out vec4 o_color;
void main() {
  vec3 normal = normalize(v_normal);
  vec3 to_eye = normalize(u_eye - v_position);
  bool front = gl_FrontFacing;
  o_color = vec4(shaded(to_eye, normalize(u_light + to_eye), front ? normal : -normal, front ? v_color : u_back), 1.0);
})";

template <typename Matrix>
std::size_t bytes_of(const Matrix& matrix) {
  return sizeof(typename Matrix::Scalar) * static_cast<std::size_t>(matrix.size());
}

template <typename Matrix>
void replace_columns(VertexArray& array, GLuint index, const Matrix& matrix,
                     const VertexRange& range) {
  const std::size_t column =
      sizeof(typename Matrix::Scalar) * static_cast<std::size_t>(matrix.rows());
  array.replace(index, matrix.col(range.begin).data(),
                column * static_cast<std::size_t>(range.begin),
                column * static_cast<std::size_t>(range.end - range.begin));
}

}  // namespace

SurfaceRenderer::SurfaceRenderer()
    : dense_((std::string(kInputs) + kShading + kDenseVertex).c_str(), kDenseFragment),
      coarse_((std::string(kInputs) + kCoarseVertex).c_str(),
              (std::string(kShading) + kCoarseFragment).c_str()) {}

void SurfaceRenderer::put(const SurfaceShape& shape) {
  array_.put_floats(0, 3, shape.positions().data(), bytes_of(shape.positions()));
  array_.put_floats(1, 3, shape.normals().data(), bytes_of(shape.normals()));
  const Eigen::Matrix3Xi& triangles = shape.surface().triangles;
  std::vector<unsigned> corners(triangles.reshaped().begin(), triangles.reshaped().end());
  const auto vertices = static_cast<std::size_t>(shape.positions().cols());
  // In an order in which triangles that follow each other share vertices, which are computed once.
  meshopt_optimizeVertexCache(corners.data(), corners.data(), corners.size(), vertices);
  corners_ = static_cast<GLsizei>(corners.size());
  coarse_corners_ = 0;
  is_dense_ = shape.positions().cols() >= kDense;
  if (is_dense_) {
    const auto wanted = static_cast<std::size_t>(kCoarsePart * static_cast<double>(corners.size()));
    std::vector<unsigned> coarse(corners.size());
    coarse.resize(meshopt_simplifySloppy(coarse.data(), corners.data(), corners.size(),
                                         shape.positions().data(), vertices, 3 * sizeof(float),
                                         wanted, 1, nullptr));
    meshopt_optimizeVertexCache(coarse.data(), coarse.data(), coarse.size(), vertices);
    coarse_corners_ = static_cast<GLsizei>(coarse.size());
    corners.insert(corners.end(), coarse.begin(), coarse.end());
  }
  array_.put_indices(corners.data(), sizeof(unsigned) * corners.size());
}

void SurfaceRenderer::put_colors(const VertexColors& colors) {
  array_.put_colors(2, colors.data(), bytes_of(colors));
}

void SurfaceRenderer::update(const SurfaceShape& shape, const VertexRange& range) {
  if (range.begin == range.end) return;
  replace_columns(array_, 0, shape.positions(), range);
  replace_columns(array_, 1, shape.normals(), range);
}

void SurfaceRenderer::update_colors(const VertexColors& colors, const VertexRange& range) {
  if (range.begin < range.end) replace_columns(array_, 2, colors, range);
}

void SurfaceRenderer::draw(const Shot& shot, const SurfaceLook& look) const {
  if (corners_ == 0) return;
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_TRUE);
  const ShaderProgram& program = is_dense_ ? dense_ : coarse_;
  program.use();
  program.set("u_matrix", shot.matrix);
  program.set("u_eye", shot.eye);
  program.set("u_light", shot.light);
  program.set("u_back", color(kBack));
  program.set("u_lit", look.lit ? 1.0F : 0.0F);
  program.set("u_dark", 1.0F);
  program.set("u_to_eye", shot.to_eye);
  program.set("u_halfway", Eigen::Vector3f((shot.to_eye + shot.light).normalized()));
  array_.bind();
  if (look.wireframe) {
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(1, 1);
  }
  if (look.coarse && coarse_corners_ > 0 && !look.wireframe) {
    const std::size_t begin = sizeof(unsigned) * static_cast<std::size_t>(corners_);
    glDrawElements(GL_TRIANGLES, coarse_corners_, GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(begin));  // NOLINT: so OpenGL takes an offset
    return;
  }
  glDrawElements(GL_TRIANGLES, corners_, GL_UNSIGNED_INT, nullptr);
  if (!look.wireframe) return;
  glDisable(GL_POLYGON_OFFSET_FILL);
  constexpr float kDarkEdges = 0.35F;
  program.set("u_dark", kDarkEdges);
  glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
  glDrawElements(GL_TRIANGLES, corners_, GL_UNSIGNED_INT, nullptr);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

}  // namespace palpate::view
