// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/contact_locator.h"

#include <Eigen/LU>
#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

#include "mesh/triangle_primitives.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

/// A point is on a side of a piece iff a coordinate is this close to 0 (rounding).
constexpr double kOnSide = 1e-7;

/// A contact in a triangle, seen from it.
struct Visit {
  int triangle;
  int contact;
};

/// The contacts inside triangles or on their edges; those on an edge belong to every triangle
/// there.
std::vector<Visit> list_visits(const TriangleMesh& surface,
                               std::span<const SurfacePoint> contacts) {
  std::vector<Visit> visits;
  std::vector<std::tuple<std::pair<int, int>, int>> on_edges;
  std::vector<char> at_edge(static_cast<size_t>(surface.vertices.cols()), 0);
  for (size_t i = 0; i < contacts.size(); ++i) {
    if (contacts[i].triangle < 0) continue;
    const Vector3d at = snap_to_edges(contacts[i].barycentric);
    const Eigen::Vector3i corners = surface.triangles.col(contacts[i].triangle);
    int least = 0;
    if (at.maxCoeff() == 1) continue;
    if (at.minCoeff(&least) > 0) {
      visits.push_back({.triangle = contacts[i].triangle, .contact = static_cast<int>(i)});
      continue;
    }
    const auto ends = std::minmax({corners[(least + 1) % 3], corners[(least + 2) % 3]});
    on_edges.emplace_back(ends, static_cast<int>(i));
    at_edge[static_cast<size_t>(ends.first)] = at_edge[static_cast<size_t>(ends.second)] = 1;
  }
  std::sort(on_edges.begin(), on_edges.end());
  for (Eigen::Index t = 0; t < surface.triangles.cols() && !on_edges.empty(); ++t) {
    const Eigen::Vector3i corners = surface.triangles.col(t);
    for (int k = 0; k < 3; ++k) {
      const auto ends = std::minmax({corners[k], corners[(k + 1) % 3]});
      if (at_edge[static_cast<size_t>(ends.first)] == 0) continue;
      auto found = std::lower_bound(
          on_edges.begin(), on_edges.end(), std::pair<int, int>(ends),
          [](const auto& entry, const auto& edge) { return std::get<0>(entry) < edge; });
      for (; found != on_edges.end() && std::get<0>(*found) == std::pair<int, int>(ends); ++found) {
        visits.push_back({.triangle = static_cast<int>(t), .contact = std::get<1>(*found)});
      }
    }
  }
  std::sort(visits.begin(), visits.end(), [](const Visit& a, const Visit& b) {
    return std::pair(a.triangle, a.contact) < std::pair(b.triangle, b.contact);
  });
  return visits;
}

void check_weights(const TriangleMesh& surface, size_t contact_count,
                   const SurfaceWeights& weights) {
  if (weights.contacts.cols() != surface.vertices.cols() ||
      weights.weights.cols() != surface.vertices.cols()) {
    throw InvalidInput("ContactLocator: there are weights for " +
                       std::to_string(weights.weights.cols()) + " vertices, the surface has " +
                       std::to_string(surface.vertices.cols()) +
                       "; pass the weights that were made for this surface");
  }
  for (Eigen::Index v = 0; v < surface.vertices.cols(); ++v) {
    for (int k = 0; k < 3; ++k) {
      const int contact = weights.contacts(k, v);
      const double weight = weights.weights(k, v);
      if (contact < -1 || (contact >= 0 && static_cast<size_t>(contact) >= contact_count)) {
        throw InvalidInput("ContactLocator: the weights of vertex " + std::to_string(v) +
                           " name contact " + std::to_string(contact) + "; there are " +
                           std::to_string(contact_count) + ", and -1 stands for none");
      }
      require([&] { return "ContactLocator(): a weight of vertex " + std::to_string(v); }, weight,
              at_least(0).finite());
    }
  }
}

/// Empty if there are no weights.
ContactWeights normalised(ContactWeights weights, double sum) {
  if (!(sum > 0 && sum < std::numeric_limits<double>::infinity())) return {};
  const double factor = 1 / sum;
  for (int i = 0; i < weights.count; ++i) weights.weights[static_cast<size_t>(i)] *= factor;
  return weights;
}

}  // namespace

ContactLocator::ContactLocator(const TriangleMesh& surface, std::span<const SurfacePoint> contacts,
                               const SurfaceWeights& weights) {
  check_mesh(surface, "ContactLocator");
  check_weights(surface, contacts.size(), weights);
  for (Eigen::Index v = 0; v < surface.vertices.cols(); ++v) {
    // Sorted, so that most neighbours have the same contacts in the same places.
    std::array<std::pair<int, double>, 3> entries;
    for (int k = 0; k < 3; ++k) {
      const int contact = weights.contacts(k, v);
      const bool counts = contact >= 0 && weights.weights(k, v) > 0;
      entries[static_cast<size_t>(k)] =
          counts ? std::pair(contact, weights.weights(k, v)) : std::pair(-1, 0.0);
    }
    std::sort(entries.begin(), entries.end(), std::greater{});
    Row& row = rows_.emplace_back();
    for (size_t k = 0; k < 3; ++k) std::tie(row.contacts[k], row.weights[k]) = entries[k];
  }
  for (const auto& corners : surface.triangles.colwise()) {
    triangles_.push_back({.rows = {corners[0], corners[1], corners[2]}, .first_piece = -1});
  }
  for (size_t i = 0; i < contacts.size(); ++i) {
    const std::string what = "ContactLocator: contact " + std::to_string(i);
    if (contacts[i].triangle >= 0) check_surface_point(surface, contacts[i], what.c_str());
    rows_.push_back({.weights = {1, 0, 0}, .contacts = {static_cast<int>(i), -1, -1}});
  }
  const std::vector<Visit> visits = list_visits(surface, contacts);
  for (size_t begin = 0; begin < visits.size();) {
    const int t = visits[begin].triangle;
    std::vector<int> inside;
    size_t end = begin;
    for (; end < visits.size() && visits[end].triangle == t; ++end) {
      inside.push_back(visits[end].contact);
    }
    cut(t, contacts, inside);
    begin = end;
  }
}

void ContactLocator::cut(int triangle, std::span<const SurfacePoint> contacts,
                         std::span<const int> inside) {
  struct Part {
    std::array<int, 3> rows;
    Eigen::Matrix3d corners;  // columns: barycentric coordinates in the triangle
  };
  Triangle& whole = triangles_[static_cast<size_t>(triangle)];
  const auto vertex_count = static_cast<int>(rows_.size() - contacts.size());
  std::vector<Part> parts = {{.rows = whole.rows, .corners = Eigen::Matrix3d::Identity()}};
  for (const int contact : inside) {
    const SurfacePoint& place = contacts[static_cast<size_t>(contact)];
    const Vector3d own = snap_to_edges(place.barycentric);
    Vector3d at = Vector3d::Zero();
    // Compare the vertices' indices, because the place may be given in the neighbouring triangle.
    for (int k = 0; k < 3; ++k) {
      const int vertex =
          triangles_[static_cast<size_t>(place.triangle)].rows[static_cast<size_t>(k)];
      for (int j = 0; j < 3; ++j) {
        if (whole.rows[static_cast<size_t>(j)] == vertex) at[j] = own[k];
      }
    }
    std::vector<Part> finer;
    for (const Part& part : parts) {
      const Vector3d in_part = part.corners.fullPivLu().solve(at);
      if (in_part.minCoeff() < -kOnSide) {
        finer.push_back(part);
        continue;
      }
      for (int k = 0; k < 3; ++k) {
        if (in_part[k] <= kOnSide) continue;
        Part& piece = finer.emplace_back(part);
        piece.rows[static_cast<size_t>(k)] = vertex_count + contact;
        piece.corners.col(k) = at;
      }
    }
    parts = std::move(finer);
  }
  whole.first_piece = static_cast<int>(pieces_.size());
  for (const Part& part : parts) {
    pieces_.push_back({.rows = part.rows, .from_triangle = part.corners.inverse()});
  }
  end_.resize(pieces_.size(), static_cast<int>(pieces_.size()));
}

ContactWeights ContactLocator::locate(const SurfacePoint& at) const noexcept {
  ContactWeights result;
  const bool exists = at.triangle >= 0 && at.triangle < static_cast<int>(triangles_.size());
  if (!exists || !at.barycentric.allFinite()) return result;
  const Triangle& triangle = triangles_[static_cast<size_t>(at.triangle)];
  std::array<int, 3> rows = triangle.rows;
  Vector3d barycentric = at.barycentric;
  if (triangle.first_piece >= 0) {
    double best = -std::numeric_limits<double>::infinity();
    const auto first = static_cast<size_t>(triangle.first_piece);
    for (size_t i = first; i < static_cast<size_t>(end_[first]); ++i) {
      const Vector3d in_piece = pieces_[i].from_triangle * at.barycentric;
      if (!(in_piece.minCoeff() > best)) continue;
      best = in_piece.minCoeff();
      barycentric = in_piece;
      rows = pieces_[i].rows;
    }
  }
  const Row& a = rows_[static_cast<size_t>(rows[0])];
  const Row& b = rows_[static_cast<size_t>(rows[1])];
  const Row& c = rows_[static_cast<size_t>(rows[2])];
  barycentric = barycentric.cwiseMax(0);  // negative by rounding only
  double sum = 0;
  if (a.contacts == b.contacts && b.contacts == c.contacts) {
    for (size_t k = 0; k < 3 && a.contacts[k] >= 0; ++k) {
      result.contacts[k] = a.contacts[k];
      result.weights[k] = barycentric[0] * a.weights[k] + barycentric[1] * b.weights[k] +
                          barycentric[2] * c.weights[k];
      sum += result.weights[k];
      ++result.count;
    }
    return normalised(result, sum);
  }
  for (int corner = 0; corner < 3; ++corner) {
    const double share = barycentric[corner];
    if (!(share > 0)) continue;
    const Row& row = rows_[static_cast<size_t>(rows[static_cast<size_t>(corner)])];
    for (size_t k = 0; k < 3; ++k) {
      if (row.contacts[k] < 0) continue;
      const double weight = share * row.weights[k];
      sum += weight;
      int i = 0;
      while (i < result.count && result.contacts[static_cast<size_t>(i)] != row.contacts[k]) ++i;
      if (i == result.count) {
        result.contacts[static_cast<size_t>(result.count++)] = row.contacts[k];
      }
      result.weights[static_cast<size_t>(i)] += weight;
    }
  }
  return normalised(result, sum);
}

}  // namespace palpate::geometry
