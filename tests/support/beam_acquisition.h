// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"
#include "strip_acquisition.h"

// Measurements of a foam beam clamped at one end whose truth is known (probing/closed_form.h).
namespace palpate::support {

using probing::Beam;

/// Three rows of ten contacts.
inline std::vector<Eigen::Vector2d> beam_places(const Beam& beam = {}) {
  std::vector<Eigen::Vector2d> places;
  for (int row = -1; row <= 1; ++row) {
    for (int k = 0; k < 10; ++k) {
      places.emplace_back((0.08 + 0.1 * k) * beam.length, 0.35 * row * beam.width);
    }
  }
  return places;
}

/// Every `every`th place, from the second on, is probed densely, and the others with 10 samples
/// each; contacts have the ids of their places.
inline probing::Acquisition beam_acquisition(const Beam& beam, std::size_t every,
                                             const StripProbing& dense) {
  constexpr double kRatio = 0.5;
  const StripProbing sparse{
      .normal_forces = {0.8, 2.4}, .directions = 4, .seed = dense.seed + 1000};
  probing::Acquisition acquisition;
  ObjectProbe<Beam> densely(beam, dense), sparsely(beam, sparse, 1'000'000);
  const std::vector<Eigen::Vector2d> places = beam_places(beam);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i % every == 1) {
      densely.probe(acquisition, places[i].x(), places[i].y());
    } else {
      sparsely.probe_sparsely(acquisition, places[i].x(), places[i].y(), kRatio);
    }
  }
  return acquisition;
}

/// Mesh of the upper side.
inline geometry::TriangleMesh beam_surface(const Beam& beam = {}) {
  constexpr int kAlong = 20, kAcross = 4;
  geometry::TriangleMesh mesh;
  mesh.vertices.resize(3, (kAlong + 1) * (kAcross + 1));
  mesh.triangles.resize(3, 2 * kAlong * kAcross);
  for (int j = 0; j <= kAcross; ++j) {
    for (int i = 0; i <= kAlong; ++i) {
      mesh.vertices.col(j * (kAlong + 1) + i) =
          surface_at(beam, beam.length * i / kAlong, beam.width * (j / double{kAcross} - 0.5));
    }
  }
  int triangle = 0;
  for (int j = 0; j < kAcross; ++j) {
    for (int i = 0; i < kAlong; ++i) {
      const int corner = j * (kAlong + 1) + i, above = corner + kAlong + 1;
      mesh.triangles.col(triangle++) << corner, above, corner + 1;
      mesh.triangles.col(triangle++) << corner + 1, above, above + 1;
    }
  }
  return mesh;
}

}  // namespace palpate::support
