// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "query/texture_seams.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include "base/disjoint_sets.h"
#include "base/numbers.h"
#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

/// Charts are moved apart by this many diagonals of the mesh, so that the nearest place to a point
/// within the mesh is in the same chart.
constexpr double kApart = 4;

/// A triangle whose area in the texture is below this fraction of the square of its longest side
/// there has no direction in the texture, and is not compared.
constexpr double kLeastArea = 1e-9;

/// Most mm of the surface per unit of the texture: the largest singular value of the map from the
/// texture to the triangle. 0 if the triangle has no area in the texture.
double most_stretch(const Eigen::Matrix<double, 3, 2>& edges, const Eigen::Matrix2d& in_texture) {
  const double longest = in_texture.colwise().squaredNorm().maxCoeff();
  if (!(std::abs(in_texture.determinant()) > kLeastArea * longest)) return 0;
  const Eigen::Matrix<double, 3, 2> map = edges * in_texture.inverse();
  const Eigen::Matrix2d square = map.transpose() * map;
  const double mean = square.trace() / 2;
  const double rest = std::hypot((square(0, 0) - square(1, 1)) / 2, square(0, 1));
  return std::sqrt(mean + rest);
}

bool same(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a == b || (a.hasNaN() && b.hasNaN());
}

/// The charts, numbered from 0, of the vertices.
std::vector<int> charts_of(const TriangleMesh& mesh, int& count) {
  const auto vertices = static_cast<int>(mesh.vertices.cols());
  SignedSets sets(vertices);
  for (const auto& corners : mesh.triangles.colwise()) {
    sets.join(corners[0], corners[1]);
    sets.join(corners[0], corners[2]);
  }
  std::vector<int> chart(static_cast<std::size_t>(vertices));
  count = 0;
  for (int v = 0; v < vertices; ++v) {
    const int root = sets.root_of(v).root;  // the lowest, so it has its number
    chart[static_cast<std::size_t>(v)] =
        root == v ? count++ : chart[static_cast<std::size_t>(root)];
  }
  return chart;
}

}  // namespace

SeamedMesh split_at_seams(const TriangleMesh& mesh, const CornerTexture& texture) {
  const Eigen::Index count = mesh.triangles.cols();
  if (texture.coordinates.cols() != count ||
      (texture.number.size() != 0 && texture.number.size() != count))
    throw InvalidInput("decimate: the texture has " + std::to_string(texture.coordinates.cols()) +
                       " triangles and " + std::to_string(texture.number.size()) +
                       " numbers, the mesh " + std::to_string(count) + " triangles");
  /// A place of a vertex in the texture.
  struct Place {
    Eigen::Vector2d at;
    int number;
    int next;  ///< another one of the same vertex, or kNone
    int split;
  };
  std::vector<Place> places;
  std::vector<int> newest(static_cast<std::size_t>(mesh.vertices.cols()), kNone);
  Eigen::Matrix3Xi place_of(3, count);
  for (Eigen::Index t = 0; t < count; ++t) {
    const int number = texture.number.size() == 0 ? -1 : texture.number[t];
    for (int k = 0; k < 3; ++k) {
      int& last = newest[static_cast<std::size_t>(mesh.triangles(k, t))];
      const Eigen::Vector2d at = texture.coordinates.block<2, 1>(2 * k, t);
      int place = last;
      while (place != kNone && !(places[static_cast<std::size_t>(place)].number == number &&
                                 same(places[static_cast<std::size_t>(place)].at, at)))
        place = places[static_cast<std::size_t>(place)].next;
      if (place == kNone) {
        place = static_cast<int>(places.size());
        places.push_back({.at = at, .number = number, .next = last, .split = kNone});
        last = place;
      }
      place_of(k, t) = place;
    }
  }
  SeamedMesh seamed;
  seamed.texture.resize(2, static_cast<Eigen::Index>(places.size()));
  for (std::size_t v = 0; v < newest.size(); ++v) {
    for (int i = newest[v]; i != kNone; i = places[static_cast<std::size_t>(i)].next) {
      Place& place = places[static_cast<std::size_t>(i)];
      place.split = static_cast<int>(seamed.source.size());
      seamed.texture.col(place.split) = place.at;
      seamed.source.push_back(static_cast<int>(v));
      seamed.number.push_back(place.number);
    }
  }
  seamed.mesh.vertices = mesh.vertices(Eigen::all, seamed.source);
  seamed.mesh.triangles =
      place_of.unaryExpr([&](int place) { return places[static_cast<std::size_t>(place)].split; });
  return seamed;
}

TextureStandard::TextureStandard(const SeamedMesh& input)
    : texture_(input.texture), apart_(kApart * bounding_diagonal(input.mesh)) {
  int count = 0;
  chart_ = charts_of(input.mesh, count);
  side_ = static_cast<int>(std::ceil(std::cbrt(count)));
  charts_ = input.mesh;
  for (Eigen::Index v = 0; v < charts_.vertices.cols(); ++v)
    charts_.vertices.col(v) += shift(chart_[static_cast<std::size_t>(v)]);
  stretch_.resize(charts_.triangles.cols());
  for (Eigen::Index t = 0; t < stretch_.size(); ++t) {
    const Eigen::Vector3i corners = charts_.triangles.col(t);
    Eigen::Matrix<double, 3, 2> edges;
    Eigen::Matrix2d in_texture;
    for (int k = 0; k < 2; ++k) {
      edges.col(k) = input.mesh.vertices.col(corners[k + 1]) - input.mesh.vertices.col(corners[0]);
      in_texture.col(k) = texture_.col(corners[k + 1]) - texture_.col(corners[0]);
    }
    stretch_[t] = most_stretch(edges, in_texture);
  }
  query_.emplace(charts_);
}

Eigen::Vector3d TextureStandard::shift(int chart) const {
  return apart_ * Eigen::Vector3d(chart % side_, chart / side_ % side_, chart / side_ / side_);
}

bool TextureStandard::slips(const TriangleMesh& mesh, int triangle, double tolerance) const {
  const Eigen::Vector3i corners = mesh.triangles.col(triangle);
  const Eigen::Vector3d moved = shift(chart_[static_cast<std::size_t>(corners[0])]);
  const Eigen::Matrix<double, 2, 3> at_corners = texture_(Eigen::all, corners);
  const Eigen::Vector3d centre = Eigen::Vector3d::Constant(1.0 / 3);
  std::array<Eigen::Vector3d, 7> places = {centre};
  for (int k = 0; k < 3; ++k) {
    places[static_cast<std::size_t>(1 + k)] = (centre + Eigen::Vector3d::Unit(k)) / 2;
    places[static_cast<std::size_t>(4 + k)] =
        (Eigen::Vector3d::Ones() - Eigen::Vector3d::Unit(k)) / 2;
  }
  for (const Eigen::Vector3d& place : places) {
    const Eigen::Vector3d point =
        position(mesh, {.triangle = triangle, .barycentric = place}) + moved;
    const ClosestPoint below = query_->closest_point(point);
    if (!(below.distance <= tolerance)) return true;
    const Eigen::Vector3i of_input = charts_.triangles.col(below.at.triangle);
    const Eigen::Vector2d there = texture_(Eigen::all, of_input) * below.at.barycentric;
    const double slip = (at_corners * place - there).norm() * stretch_[below.at.triangle];
    if (slip > tolerance) return true;  // false without a texture, where it is NaN
  }
  return false;
}

}  // namespace palpate::geometry
