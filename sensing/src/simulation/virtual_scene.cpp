// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "simulation/virtual_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <string>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/geometry/mesh_measures.h"

namespace palpate::sensing {
namespace {

/// Rays to the light start above the surface by this fraction of the scene's size, or of the
/// distance from the origin if that is larger: far above the rounding of a hit (1e-15), far below
/// the resolution of a shadow.
constexpr double kLift = 1e-8;

void check_colors(const Eigen::Matrix3Xd& colors, const std::string& name) {
  for (Eigen::Index i = 0; i < colors.cols(); ++i) {
    for (const double value : colors.col(i))
      require([&] { return name + ": a colour of column " + std::to_string(i); }, value,
              at_least(0).at_most(1));
  }
}

void check_count(Eigen::Index count, Eigen::Index vertices, const std::string& name) {
  if (count == vertices) return;
  throw InvalidInput(name + ": has " + std::to_string(count) + " columns, but the mesh has " +
                     std::to_string(vertices) + " vertices; pass one for each");
}

/// Texel as reflectance, blue, green, red.
Eigen::Vector3d texel(const cv::Mat& texture, int row, int column) {
  Eigen::Vector3d value;
  for (int k = 0; k < 3; ++k) {
    const int at = column * texture.channels() + (texture.channels() == 1 ? 0 : k);
    value[k] = texture.depth() == CV_8U ? texture.ptr<std::uint8_t>(row)[at] / 255.0
                                        : texture.ptr<std::uint16_t>(row)[at] / 65535.0;
  }
  return value;
}

/// Red, green, blue.
Eigen::Vector3d texture_color(const cv::Mat& texture, const Eigen::Vector2d& coordinates) {
  const double x = coordinates.x() * texture.cols - 0.5;
  const double y = (1 - coordinates.y()) * texture.rows - 0.5;
  const auto wrap = [](double i, int size) {
    const double rest = std::fmod(i, size);
    return static_cast<int>(rest < 0 ? rest + size : rest);
  };
  const double left = std::floor(x), top = std::floor(y);
  const int c0 = wrap(left, texture.cols), c1 = wrap(left + 1, texture.cols);
  const int r0 = wrap(top, texture.rows), r1 = wrap(top + 1, texture.rows);
  const double fx = x - left, fy = y - top;
  const Eigen::Vector3d above = (1 - fx) * texel(texture, r0, c0) + fx * texel(texture, r0, c1);
  const Eigen::Vector3d below = (1 - fx) * texel(texture, r1, c0) + fx * texel(texture, r1, c1);
  const Eigen::Vector3d bgr = (1 - fy) * above + fy * below;
  return bgr.reverse();
}

}  // namespace

void check_body(const Body& body, std::size_t number) {
  const std::string name = "bodies[" + std::to_string(number) + "]";
  geometry::check_mesh(body.mesh, name.c_str());
  const Eigen::Index vertices = body.mesh.vertices.cols();
  if (body.end_vertices) {
    check_count(body.end_vertices->cols(), vertices, name + ".end_vertices");
    if (!body.end_vertices->allFinite()) {
      throw InvalidInput(name + ".end_vertices: all must be finite");
    }
  }
  check_colors(body.reflectance, name + ".reflectance");
  if (body.vertex_colors) {
    check_count(body.vertex_colors->cols(), vertices, name + ".vertex_colors");
    check_colors(*body.vertex_colors, name + ".vertex_colors");
  }
  if (body.texture) {
    check_count(body.texture_coordinates.cols(), vertices, name + ".texture_coordinates");
    if (!body.texture_coordinates.allFinite()) {
      throw InvalidInput(name + ".texture_coordinates: all must be finite");
    }
    const int type = body.texture->type();
    const bool is_known =
        type == CV_8UC1 || type == CV_8UC3 || type == CV_16UC1 || type == CV_16UC3;
    if (body.texture->empty() || !is_known) {
      throw InvalidInput(name + ".texture: 8 or 16 bit, 1 or 3 channels are expected");
    }
  }
  require(name + ".specular", body.specular, at_least(0).at_most(1));
  require(name + ".shininess", body.shininess, at_least(1).finite());
  require(name + ".crease_angle", body.crease_angle, at_least(0).at_most(std::numbers::pi), "rad");
}

VirtualScene::VirtualScene(std::span<const Body> bodies) : bodies_(bodies) {
  Eigen::Index vertices = 0, triangles = 0;
  for (const Body& body : bodies) {
    vertices += body.mesh.vertices.cols();
    triangles += body.mesh.triangles.cols();
    moves_ = moves_ || body.end_vertices;
  }
  mesh_.vertices.resize(3, vertices);
  mesh_.triangles.resize(3, triangles);
  vertices = triangles = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const geometry::TriangleMesh& part = bodies[b].mesh;
    mesh_.vertices.middleCols(vertices, part.vertices.cols()) = part.vertices;
    mesh_.triangles.middleCols(triangles, part.triangles.cols()) =
        part.triangles.array() + static_cast<int>(vertices);
    first_triangle_.push_back(static_cast<int>(triangles));
    body_of_.insert(body_of_.end(), static_cast<std::size_t>(part.triangles.cols()),
                    static_cast<int>(b));
    vertices += part.vertices.cols();
    triangles += part.triangles.cols();
  }
  const Eigen::AlignedBox3d box = geometry::bounding_box(mesh_);
  lift_ = kLift * (box.diagonal().norm() + box.max().cwiseMax(-box.min()).maxCoeff());
  query_.emplace(mesh_);
  set_normals();
}

void VirtualScene::move_to(double time) {
  Eigen::Index vertex = 0;
  for (const Body& body : bodies_) {
    const Eigen::Index count = body.mesh.vertices.cols();
    if (body.end_vertices) {
      mesh_.vertices.middleCols(vertex, count) =
          (1 - time) * body.mesh.vertices + time * *body.end_vertices;
    }
    vertex += count;
  }
  query_->move_vertices(mesh_.vertices);
  set_normals();
}

/// The normal at a corner is the area-weighted mean of the triangle normals around its vertex that
/// differ from its own triangle's normal by no more than the crease angle.
void VirtualScene::set_normals() {
  const Eigen::Index triangles = mesh_.triangles.cols();
  facets_ = geometry::triangle_normals(mesh_);
  std::vector<std::vector<int>> around(static_cast<std::size_t>(mesh_.vertices.cols()));
  Eigen::VectorXd area(triangles);
  for (int t = 0; t < triangles; ++t) {
    const Eigen::Vector3i corners = mesh_.triangles.col(t);
    const Eigen::Vector3d first = mesh_.vertices.col(corners[0]);
    area[t] = (mesh_.vertices.col(corners[1]) - first)
                  .cross(mesh_.vertices.col(corners[2]) - first)
                  .norm();
    if (!facets_.col(t).allFinite()) continue;
    for (const int v : corners) around[static_cast<std::size_t>(v)].push_back(t);
  }
  corner_normals_.resize(3, 3 * triangles);
  for (int t = 0; t < triangles; ++t) {
    const double least = std::cos(
        bodies_[static_cast<std::size_t>(body_of_[static_cast<std::size_t>(t)])].crease_angle);
    for (int k = 0; k < 3; ++k) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (const int other : around[static_cast<std::size_t>(mesh_.triangles(k, t))]) {
        if (facets_.col(other).dot(facets_.col(t)) >= least) {
          sum += area[other] * facets_.col(other);
        }
      }
      corner_normals_.col(3 * t + k) = sum.norm() > 0 ? sum.normalized() : facets_.col(t);
    }
  }
}

std::optional<SurfaceView> VirtualScene::look(const Eigen::Vector3d& direction) const {
  const auto hit = query_->first_hit(geometry::Ray{.direction = direction});
  if (!hit || !(hit->position.z() > 0)) return std::nullopt;
  const int triangle = hit->at.triangle;
  SurfaceView view{.body = body_of_[static_cast<std::size_t>(triangle)],
                   .at = hit->at,
                   .position = hit->position,
                   .facet = facets_.col(triangle),
                   .normal = corner_normals_.middleCols<3>(3 * triangle) * hit->at.barycentric};
  if (!view.facet.allFinite()) view.facet = view.normal = -direction.normalized();
  if (view.facet.dot(direction) > 0) {
    view.facet = -view.facet;
    view.normal = -view.normal;
  }
  view.normal.normalize();
  return view;
}

bool VirtualScene::sees(const SurfaceView& place, const Eigen::Vector3d& light) const {
  return !query_->first_hit(place.position + lift_ * place.facet, light);
}

Eigen::Vector3d VirtualScene::reflectance(const SurfaceView& place) const {
  const Body& body = this->body(place);
  Eigen::Vector3d color = body.reflectance;
  if (!body.vertex_colors && !body.texture) return color;
  const int own = place.at.triangle - first_triangle_[static_cast<std::size_t>(place.body)];
  const Eigen::Vector3i corners = body.mesh.triangles.col(own);
  const auto blend = [&](const auto& values) {
    return (values(Eigen::all, corners) * place.at.barycentric).eval();
  };
  if (body.vertex_colors) color.array() *= blend(*body.vertex_colors).array();
  if (body.texture) {
    color.array() *= texture_color(*body.texture, blend(body.texture_coordinates)).array();
  }
  return color;
}

}  // namespace palpate::sensing
