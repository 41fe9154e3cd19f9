// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "contacts/coarse_triangulation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/numbers.h"
#include "contacts/boundary_helpers.h"
#include "contacts/contact_weights.h"
#include "contacts/helper_elimination.h"
#include "contacts/intrinsic_coarsening.h"
#include "contacts/intrinsic_triangulation.h"
#include "mesh/triangle_primitives.h"
#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

/// A tracked point is at a vertex iff the barycentric coordinate there is this close to 1: the
/// rounding of snapped coordinates.
constexpr double kAtVertex = 1e-7;

/// The connected part of each triangle, numbered by its lowest triangle; -1 for unused slots.
std::vector<int> parts(const IntrinsicTriangulation& surface, int& count) {
  std::vector<int> part(static_cast<size_t>(surface.triangle_slots()), -1);
  std::vector<int> pending;
  count = 0;
  for (int first = 0; first < surface.triangle_slots(); ++first) {
    if (!surface.is_alive(first) || part[static_cast<size_t>(first)] >= 0) continue;
    part[static_cast<size_t>(first)] = count;
    pending.push_back(first);
    while (!pending.empty()) {
      const int t = pending.back();
      pending.pop_back();
      for (int h = 3 * t; h < 3 * t + 3; ++h) {
        if (surface.opposite(h) == kNone) continue;
        const int other = surface.opposite(h) / 3;
        if (part[static_cast<size_t>(other)] >= 0) continue;
        part[static_cast<size_t>(other)] = count;
        pending.push_back(other);
      }
    }
    ++count;
  }
  return part;
}

}  // namespace

CoarsenedSurface::CoarsenedSurface(const TriangleMesh& mesh, std::span<const SurfacePoint> contacts,
                                   Eigen::Matrix3Xd places, WorkSteps& steps)
    : mesh_(mesh), places_(std::move(places)), surface_(mesh) {
  keep_parts_with(contacts);
  insert(contacts);
  pin_helpers();
  coarsen(surface_, pinned_, steps);
}

bool CoarsenedSurface::leave_out(int contact) {
  const auto found = std::ranges::find(contact_of_id_, contact);
  const auto left_out = static_cast<int>(found - contact_of_id_.begin());
  int count = 0;
  const std::vector<int> part = parts(surface_, count);
  const auto part_of = [&](int v) { return part[static_cast<size_t>(surface_.out(v) / 3)]; };
  bool is_alone = true;
  for (int id = 0; id < surface_.id_count() && is_alone; ++id) {
    is_alone = contact_of_id_[static_cast<size_t>(id)] < 0 || id == left_out ||
               part_of(id) != part_of(left_out);
  }
  if (is_alone) return false;
  *found = -1;
  for (int& number : contact_of_id_) number -= number > contact ? 1 : 0;
  const Eigen::Index after = places_.cols() - 1 - contact;
  places_.middleCols(contact, after) = places_.rightCols(after).eval();
  places_.conservativeResize(3, places_.cols() - 1);
  if (surface_.is_boundary(left_out)) return true;
  std::vector<char> others(static_cast<size_t>(surface_.id_count()), 1);
  others[static_cast<size_t>(left_out)] = 0;
  const WorkSteps::Progress nobody;
  WorkSteps steps(nobody, 1);
  coarsen(surface_, others, steps);
  return true;
}

TrianglesOfContacts CoarsenedSurface::triangles() {
  const bool is_simplicial = make_simplicial(surface_, [this](int id, int a, int b) {
    list_new_ids();
    positions_[static_cast<size_t>(id)] =
        (positions_[static_cast<size_t>(a)] + positions_[static_cast<size_t>(b)]) / 2;
  });
  if (!is_simplicial) {
    throw SolverError(
        "triangulate_contacts: no number of helpers makes all edges distinct; use voronoi_dual");
  }
  TrianglesOfContacts result;
  result.intrinsic = intrinsic();
  rows_ = spread_weights(surface_, contact_of_id_);
  turn_edges_to_contacts(surface_, contact_of_id_);
  result.triangles = triangles_of_contacts(surface_, contact_of_id_, rows_, places_);
  result.weights = weights();
  result.surface_labels = result.weights.contacts.row(0);
  return result;
}

// Leaves out parts without a contact, where nothing is known.
void CoarsenedSurface::keep_parts_with(std::span<const SurfacePoint> contacts) {
  int count = 0;
  const std::vector<int> part = parts(surface_, count);
  std::vector<char> has_contact(static_cast<size_t>(count), 0);
  for (const SurfacePoint& contact : contacts) {
    has_contact[static_cast<size_t>(part[static_cast<size_t>(contact.triangle)])] = 1;
  }
  slot_.resize(static_cast<size_t>(mesh_.triangles.cols()));
  TriangleMesh some{.vertices = mesh_.vertices,
                    .triangles = Eigen::Matrix3Xi(3, mesh_.triangles.cols())};
  int kept = 0;
  for (size_t t = 0; t < slot_.size(); ++t) {
    const bool keep = has_contact[static_cast<size_t>(part[t])] != 0;
    slot_[t] = keep ? kept : kNone;
    if (keep) some.triangles.col(kept++) = mesh_.triangles.col(static_cast<Eigen::Index>(t));
  }
  if (kept == mesh_.triangles.cols()) return;
  some.triangles.conservativeResize(3, kept);
  surface_ = IntrinsicTriangulation(some);
}

// Sets positions and contacts of new ids.
void CoarsenedSurface::list_new_ids() {
  for (auto id = positions_.size(); id < static_cast<size_t>(surface_.id_count()); ++id) {
    const int original = surface_.fan_of(static_cast<int>(id));
    positions_.emplace_back(original < mesh_.vertices.cols()
                                ? Eigen::Vector3d(mesh_.vertices.col(original))
                                : Eigen::Vector3d::Zero());
    contact_of_id_.push_back(-1);
  }
}

void CoarsenedSurface::insert(std::span<const SurfacePoint> contacts) {
  fans_end_ = surface_.id_count();
  std::vector<int> ids;
  for (const SurfacePoint& contact : contacts) {
    ids.push_back(surface_.track(slot_[static_cast<size_t>(contact.triangle)],
                                 snap_to_edges(contact.barycentric)));
  }
  surface_.remove_degenerate_triangles();
  list_new_ids();
  for (size_t i = 0; i < ids.size(); ++i) {
    int id = ids[i];
    int corner = 0;
    if (surface_.barycentric(id).maxCoeff(&corner) > 1 - kAtVertex) {
      const int v = surface_.from(3 * surface_.triangle_of_point(id) + corner);
      // Another contact may be there already, hardly farther away than coinciding contacts.
      if (contact_of_id_[static_cast<size_t>(v)] < 0) id = v;
    }
    if (!surface_.is_vertex(id)) surface_.make_vertex(id);
    contact_of_id_[static_cast<size_t>(id)] = static_cast<int>(i);
    positions_[static_cast<size_t>(id)] = places_.col(static_cast<Eigen::Index>(i));
  }
}

void CoarsenedSurface::pin_helpers() {
  pinned_.assign(static_cast<size_t>(surface_.id_count()), 0);
  int count = 0;
  const std::vector<int> part = parts(surface_, count);
  std::vector<double> area(static_cast<size_t>(count), 0);
  std::vector<double> contacts(static_cast<size_t>(count), 0);
  for (int t = 0; t < surface_.triangle_slots(); ++t) {
    if (!surface_.is_alive(t)) continue;
    area[static_cast<size_t>(part[static_cast<size_t>(t)])] += area_of_lengths(
        surface_.length(3 * t), surface_.length(3 * t + 1), surface_.length(3 * t + 2));
  }
  for (int id = 0; id < surface_.id_count(); ++id) {
    if (contact_of_id_[static_cast<size_t>(id)] < 0) continue;
    pinned_[static_cast<size_t>(id)] = 1;
    contacts[static_cast<size_t>(part[static_cast<size_t>(surface_.out(id) / 3)])] += 1;
  }
  std::vector<double> spacing(part.size(), 0);
  for (size_t t = 0; t < part.size(); ++t) {
    if (part[t] < 0) continue;
    const auto i = static_cast<size_t>(part[t]);
    spacing[t] = std::sqrt(area[i] / contacts[i]) * surface_.unit();
  }
  Eigen::Matrix3Xd positions(3, surface_.id_count());
  for (int id = 0; id < surface_.id_count(); ++id) {
    positions.col(id) = positions_[static_cast<size_t>(id)];
  }
  pin_border(surface_, positions, spacing, pinned_);
}

// The triangulation by contacts and helpers.
IntrinsicDelaunay CoarsenedSurface::intrinsic() const {
  IntrinsicDelaunay result;
  std::vector<int> number(contact_of_id_);
  std::vector<Eigen::Vector3d> helpers;
  for (int id = 0; id < surface_.id_count(); ++id) {
    if (!surface_.is_vertex(id) || contact_of_id_[static_cast<size_t>(id)] >= 0) continue;
    number[static_cast<size_t>(id)] =
        static_cast<int>(places_.cols()) + static_cast<int>(helpers.size());
    helpers.push_back(positions_[static_cast<size_t>(id)]);
  }
  result.helpers.resize(3, static_cast<Eigen::Index>(helpers.size()));
  for (size_t i = 0; i < helpers.size(); ++i) {
    result.helpers.col(static_cast<Eigen::Index>(i)) = helpers[i];
  }
  std::vector<int> column(static_cast<size_t>(surface_.triangle_slots()), kNone);
  int count = 0;
  for (int t = 0; t < surface_.triangle_slots(); ++t) {
    if (surface_.is_alive(t)) column[static_cast<size_t>(t)] = count++;
  }
  result.triangles.resize(3, count);
  result.opposite.resize(3, count);
  result.lengths.resize(3, count);
  for (int h = 0; h < 3 * surface_.triangle_slots(); ++h) {
    const int t = column[static_cast<size_t>(h / 3)];
    if (t == kNone) continue;
    const int other = surface_.opposite(h);
    result.triangles(h % 3, t) = number[static_cast<size_t>(surface_.from(h))];
    result.opposite(h % 3, t) =
        other == kNone ? -1 : 3 * column[static_cast<size_t>(other / 3)] + other % 3;
    result.lengths(h % 3, t) = surface_.length(h) * surface_.unit();
  }
  return result;
}

void CoarsenedSurface::add_row(int id, double factor, WeightRow& row) const {
  if (surface_.is_vertex(id)) {
    for (const auto& [contact, weight] : rows_[static_cast<size_t>(id)]) {
      row.push_back({.contact = contact, .weight = factor * weight});
    }
    return;
  }
  const int t = surface_.triangle_of_point(id);
  for (int k = 0; k < 3; ++k) {
    const double weight = surface_.barycentric(id)[k];
    if (weight > 0) add_row(surface_.from(3 * t + k), factor * weight, row);
  }
}

SurfaceWeights CoarsenedSurface::weights() const {
  const Eigen::Index count = mesh_.vertices.cols();
  SurfaceWeights result{.contacts = Eigen::Matrix3Xi::Constant(3, count, -1),
                        .weights = Eigen::Matrix3Xd::Zero(3, count)};
  // A vertex in which several fans touch gets the mean of their weights.
  std::vector<std::vector<int>> further(static_cast<size_t>(count));
  for (int id = static_cast<int>(count); id < fans_end_; ++id) {
    further[static_cast<size_t>(surface_.fan_of(id))].push_back(id);
  }
  WeightRow row;
  for (int v = 0; v < count; ++v) {
    if (!surface_.is_vertex(v) && surface_.triangle_of_point(v) == kNone) continue;
    std::vector<int>& fans = further[static_cast<size_t>(v)];
    fans.push_back(v);
    row.clear();
    for (const int id : fans) {
      if (contact_of_id_[static_cast<size_t>(id)] >= 0) row.clear();
      add_row(id, 1.0, row);
      if (contact_of_id_[static_cast<size_t>(id)] >= 0) break;
    }
    reduce_to_three(row);
    for (size_t k = 0; k < row.size(); ++k) {
      result.contacts(static_cast<Eigen::Index>(k), v) = row[k].contact;
      result.weights(static_cast<Eigen::Index>(k), v) = row[k].weight;
    }
  }
  return result;
}

}  // namespace palpate::geometry
