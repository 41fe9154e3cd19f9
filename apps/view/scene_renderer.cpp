// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "scene_renderer.h"

#include <algorithm>
#include <cstddef>

#include "theme.h"

namespace palpate::view {
namespace {

constexpr float kHidden = 0.22F;          // opacity of what lies behind the surface
constexpr double kShaft = 0.0075;         // diagonals: radius of an arrow
constexpr double kTipRadius = 0.021;      // diagonals
constexpr double kTipLength = 0.06;       // diagonals
constexpr double kShortestArrow = 0.002;  // diagonals
constexpr double kTipShare = 0.6;         // at most, of an arrow's length

// The shaders of the page of a model (web/page/renderer.js), for OpenGL 3.3.
// The backdrop is a grid whose corners are coloured: without graphics hardware, a colour computed
// at each pixel would take longer than the object.
constexpr int kGrid = 16;
constexpr const char* kBackdropVertex = R"(
const int kGrid = 16;
const vec2 kCorners[6] = vec2[](vec2(0, 0), vec2(1, 0), vec2(1, 1), vec2(0, 0), vec2(1, 1), vec2(0, 1));
uniform vec3 u_sky, u_floor;
out vec3 v_color;
void main() {
  int cell = gl_VertexID / 6;
  vec2 place = (vec2(cell % kGrid, cell / kGrid) + kCorners[gl_VertexID % 6]) / float(kGrid);
  float near = 1.15 - length((place - vec2(0.45, 0.65)) * 1.25);
  v_color = mix(u_floor, u_sky, smoothstep(0.0, 1.0, near));
  gl_Position = vec4(2.0 * place - 1.0, 1.0, 1.0);  // at the far end
})";
constexpr const char* kBackdropFragment = R"(
in vec3 v_color;
out vec4 o_color;
void main() { o_color = vec4(v_color, 1.0); })";

constexpr const char* kSolidVertex = R"(
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
})";
constexpr const char* kSolidFragment = R"(
in vec3 v_normal, v_position;
out vec4 o_color;
uniform vec3 u_eye, u_light;
uniform vec4 u_color;
void main() {
  vec3 to_eye = normalize(u_eye - v_position);
  vec3 normal = normalize(v_normal);
  if (dot(normal, to_eye) < 0.0) normal = -normal;
  float shine = pow(max(dot(normal, normalize(u_light + to_eye)), 0.0), 50.0);
  o_color = vec4(u_color.rgb * (0.62 + 0.42 * max(dot(normal, u_light), 0.0))
                 + 0.25 * shine * u_color.a, u_color.a);
})";

constexpr const char* kPointVertex = R"(
layout(location = 0) in vec3 a_position;
layout(location = 1) in vec4 a_color;
uniform mat4 u_matrix;
uniform vec3 u_eye;
uniform float u_size, u_lift;
out vec4 v_color;
void main() {
  v_color = a_color;
  gl_Position = u_matrix * vec4(a_position + u_lift * normalize(u_eye - a_position), 1.0);
  gl_PointSize = u_size;
})";
constexpr const char* kPointFragment = R"(
in vec4 v_color;
out vec4 o_color;
void main() {
  float away = 2.0 * length(gl_PointCoord - 0.5);
  if (away > 1.0) discard;
  o_color = vec4(v_color.rgb, v_color.a * smoothstep(1.0, 0.6, away));
})";
constexpr const char* kLineFragment = R"(
in vec4 v_color;
out vec4 o_color;
void main() { o_color = v_color; })";

/// Columns: a right-handed frame with this z axis.
Eigen::Matrix3f frame_about(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d side = axis.unitOrthogonal();
  Eigen::Matrix3d frame;
  frame << side, axis.cross(side), axis;
  return frame.cast<float>();
}

}  // namespace

std::vector<Solid> arrow(const Eigen::Vector3d& origin, const Eigen::Vector3d& way, double diagonal,
                         const Eigen::Vector3f& color) {
  const double length = way.norm();
  if (!(length > kShortestArrow * diagonal)) return {};
  const Eigen::Vector3d axis = way / length;
  const double tip = std::min(kTipLength * diagonal, kTipShare * length);
  const double wide = kTipRadius / kTipLength * tip;
  const double thin = std::min(kShaft * diagonal, kTipShare * wide);
  return {{Shape::rod, origin, axis, {thin, thin, length - tip}, color},
          {Shape::tip, origin + (length - tip) * axis, axis, {wide, wide, tip}, color}};
}

void PointSet::put(const ColoredPoints& points) {
  count_ = static_cast<GLsizei>(points.positions.cols());
  array_.put_floats(0, 3, points.positions.data(),
                    sizeof(float) * static_cast<std::size_t>(points.positions.size()));
  array_.put_colors(1, points.colors.data(), static_cast<std::size_t>(points.colors.size()));
}

SceneRenderer::SceneRenderer()
    : backdrop_(kBackdropVertex, kBackdropFragment),
      solid_(kSolidVertex, kSolidFragment),
      point_(kPointVertex, kPointFragment),
      line_(kPointVertex, kLineFragment) {
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    const ShapeCorners corners = corners_of(static_cast<Shape>(i));
    const std::size_t bytes = sizeof(float) * static_cast<std::size_t>(corners.positions.size());
    shapes_[i].put_floats(0, 3, corners.positions.data(), bytes);
    shapes_[i].put_floats(1, 3, corners.normals.data(), bytes);
    counts_[i] = static_cast<GLsizei>(corners.positions.cols());
  }
}

void SceneRenderer::begin() {
  glDepthMask(GL_TRUE);
  glClear(GL_DEPTH_BUFFER_BIT);
}

void SceneRenderer::draw_backdrop() const {
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_FALSE);
  backdrop_.use();
  backdrop_.set("u_sky", color(kSky));
  backdrop_.set("u_floor", color(kFloor));
  nothing_.bind();
  glDrawArrays(GL_TRIANGLES, 0, 6 * kGrid * kGrid);
  glDepthMask(GL_TRUE);
}

void SceneRenderer::draw_all(const std::vector<Solid>& solids, bool opaque, bool transparent,
                             float opacity) const {
  for (const Solid& solid : solids) {
    if (solid.opacity < 1 ? !transparent : !opaque) continue;
    const auto shape = static_cast<std::size_t>(solid.shape);
    solid_.set("u_frame", frame_about(solid.axis));
    solid_.set("u_origin", Eigen::Vector3f(solid.origin.cast<float>()));
    solid_.set("u_scale", Eigen::Vector3f(solid.size.cast<float>()));
    solid_.set("u_color", Eigen::Vector4f(solid.color.x(), solid.color.y(), solid.color.z(),
                                          solid.opacity * opacity));
    shapes_[shape].bind();
    glDrawArrays(GL_TRIANGLES, 0, counts_[shape]);
  }
}

void SceneRenderer::draw(const std::vector<Solid>& solids, const Shot& shot) const {
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  solid_.use();
  solid_.set("u_matrix", shot.matrix);
  solid_.set("u_eye", shot.eye);
  solid_.set("u_light", shot.light);
  glDepthMask(GL_FALSE);
  glDepthFunc(GL_GREATER);
  draw_all(solids, true, true, kHidden);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_TRUE);
  draw_all(solids, true, false, 1);
  glDepthMask(GL_FALSE);
  draw_all(solids, false, true, 1);
  glDepthMask(GL_TRUE);
}

void SceneRenderer::draw_points(const PointSet& points, const Shot& shot, float size,
                                double lift) const {
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glEnable(GL_PROGRAM_POINT_SIZE);
  point_.use();
  point_.set("u_matrix", shot.matrix);
  point_.set("u_eye", shot.eye);
  point_.set("u_size", size);
  point_.set("u_lift", static_cast<float>(lift));
  points.bind();
  glDrawArrays(GL_POINTS, 0, points.count());
}

void SceneRenderer::draw_lines(const PointSet& lines, const Shot& shot) const {
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  line_.use();
  line_.set("u_matrix", shot.matrix);
  line_.set("u_eye", shot.eye);
  line_.set("u_size", 1.0F);
  line_.set("u_lift", 0.0F);
  lines.bind();
  glDrawArrays(GL_LINES, 0, lines.count());
}

}  // namespace palpate::view
