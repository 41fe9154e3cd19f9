// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/merge_models.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include "build/align_frames.h"
#include "build/contact_edges.h"
#include "build/interpolated_as.h"
#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "palpate/core/require.h"
#include "palpate/geometry/contact_triangulation.h"
#include "palpate/geometry/hole_filling.h"
#include "palpate/geometry/merge_scans.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/geometry/zipper_scans.h"
#include "palpate/haptics/rounding.h"

namespace palpate::haptics {
namespace {

using geometry::ClosestPoint;
using geometry::SurfaceQuery;

// Contacts of different sides closer than this are the same; relative to the median distance
// between neighbouring contacts.
constexpr double kSamePlace = 0.25;
// Closer contacts are always merged, because contacts closer than 1e-9 cannot be triangulated;
// relative to the surface's diagonal.
constexpr double kCoincide = 1e-8;
// Largest magnitude of an id: cannot overflow `long long`, and is exact in every JSON reader.
constexpr long long kLargestId = 1LL << 53;

std::string side_name(std::span<const SideModel> sides, std::size_t side) {
  const std::string number = "model " + std::to_string(side);
  return sides[side].name.empty() ? number : number + " (" + sides[side].name + ")";
}

constexpr std::array<std::string_view, 2> kSurfaces{"zippered", "averaged"};

// The pose with an exact rotation, because a text file may give only six digits.
Eigen::Isometry3d exact_pose(std::span<const SideModel> sides, std::size_t side) {
  constexpr double kRotation = 1e-6;
  const Eigen::Isometry3d& pose = sides[side].T_object_model;
  if (!pose.matrix().allFinite() || !pose.linear().isUnitary(kRotation) ||
      !(pose.linear().determinant() > 0)) {
    throw InvalidInput(side_name(sides, side) +
                       ": its pose must be a rotation (orthogonal to 1e-6, right-handed) and a "
                       "finite shift");
  }
  Eigen::Isometry3d result = pose;
  result.linear() = Eigen::Quaterniond(pose.linear()).normalized().toRotationMatrix();
  return result;
}

/// A contact that may enter the merged model.
struct MergeCandidate {
  SideContact source;
  ContactModel contact;     ///< in the frame of the object
  Eigen::Vector3d outward;  ///< normal of its side's surface there
  geometry::SurfacePoint at;
  double distance = 0;  ///< [mm] from the merged surface
};

void add_candidates(const SideModel& side, int index, const Eigen::Isometry3d& pose,
                    std::vector<MergeCandidate>& candidates) {
  const SurfaceQuery query(side.model.surface);
  const Eigen::Matrix3Xd normals = geometry::triangle_normals(side.model.surface);
  for (const ContactModel& contact : side.model.contacts) {
    MergeCandidate candidate{
        .source = {index, contact.id}, .contact = contact, .outward = {}, .at = {}};
    candidate.contact.uncertainty.reset();
    candidate.contact.compliance.reset();  // it was learnt from the contacts of this side
    candidate.contact.position = pose * contact.position;
    candidate.contact.frame = pose.linear() * contact.frame;
    candidate.contact.friction_axis = (pose.linear() * contact.friction_axis).normalized();
    candidate.outward =
        pose.linear() * normals.col(query.closest_point(contact.position).at.triangle);
    candidates.push_back(std::move(candidate));
  }
}

void merge_surfaces(std::span<const SideModel> sides, const std::vector<Eigen::Isometry3d>& poses,
                    const MergeModelsOptions& options, MergedModel& merged) {
  std::vector<geometry::Scan> scans;
  for (std::size_t i = 0; i < sides.size(); ++i)
    scans.push_back(
        {.mesh = sides[i].model.surface, .T_object_scan = poses[i], .name = side_name(sides, i)});
  geometry::TriangleMesh& surface = merged.model.surface;
  surface = options.surface == MergedSurface::zippered
                ? std::move(geometry::zipper_scans(scans).mesh)
                : std::move(geometry::merge_scans(scans).mesh);
  if (options.fill_holes > 0) {
    geometry::FilledMesh filled =
        geometry::fill_holes(surface, {.max_diameter = options.fill_holes});
    surface = std::move(filled.mesh);
    merged.holes_filled = filled.filled;
  }
  merged.components = geometry::connected_components(surface).count;
}

void place_on_surface(std::span<const SideModel> sides, const MergeModelsOptions& options,
                      MergedModel& merged, std::vector<MergeCandidate>& candidates) {
  const SurfaceQuery query(merged.model.surface);
  const double size = geometry::bounding_diagonal(merged.model.surface);
  const Eigen::Matrix3Xd normals = geometry::triangle_normals(merged.model.surface);
  for (MergeCandidate& candidate : candidates) {
    const std::string name = side_name(sides, static_cast<std::size_t>(candidate.source.side)) +
                             ": contact " + std::to_string(candidate.source.id);
    const ClosestPoint place = query.closest_point(candidate.contact.position);
    if (!(place.distance <= options.max_distance)) {
      throw InvalidInput(
          {{fmt::format("{} is {:g} mm from the merged surface; at most {:g} mm are allowed. Check "
                        "the poses, or raise ",
                        name, place.distance, options.max_distance)},
           {"MergeModelsOptions::max_distance", true}});
    }
    // A triangle without area has a NaN normal, which is no reason to refuse.
    if (normals.col(place.at.triangle).dot(candidate.outward) < 0) {
      throw InvalidInput(name +
                         " lies on the inside of the merged surface: two sides are nearer "
                         "to each other there than the surface can be merged. Check the poses");
    }
    candidate.contact.position = rounded_position(place.position, size);
    candidate.at = place.at;
    candidate.distance = place.distance;
    merged.largest_distance = std::max(merged.largest_distance, place.distance);
  }
}

// [mm] median length of the edges between contacts, 0 if there is none.
double neighbour_distance(std::span<const SideModel> sides) {
  std::vector<double> lengths;
  for (const SideModel& side : sides) {
    const std::vector<double> of_side = contact_edge_lengths(side.model);
    lengths.insert(lengths.end(), of_side.begin(), of_side.end());
  }
  return lengths.empty() ? 0 : median(lengths);
}

/// Contacts sorted by x, to find those near a place.
class NearContacts {
 public:
  NearContacts(const std::vector<MergeCandidate>& candidates, double distance)
      : candidates_(candidates), distance_(distance), along_x_(candidates.size()) {
    std::iota(along_x_.begin(), along_x_.end(), std::size_t{0});
    std::ranges::sort(along_x_, [&](std::size_t a, std::size_t b) { return x(a) < x(b); });
  }

  /// The nearest contact of another side at the same place that `counts`; `i` if there is none.
  [[nodiscard]] std::size_t nearest(std::size_t i, const std::vector<bool>& counts) const {
    std::size_t found = i;
    double least = distance_;
    auto other = std::ranges::lower_bound(along_x_, x(i) - distance_, {},
                                          [&](std::size_t k) { return x(k); });
    for (; other != along_x_.end() && x(*other) <= x(i) + distance_; ++other) {
      const MergeCandidate &a = candidates_[i], &b = candidates_[*other];
      if (!counts[*other] || a.source.side == b.source.side) continue;
      if (!(a.contact.frame.col(2).dot(b.contact.frame.col(2)) > 0)) continue;
      const double distance = (a.contact.position - b.contact.position).norm();
      if (distance > least || (distance == least && found != i)) continue;
      found = *other;
      least = distance;
    }
    return found;
  }

 private:
  [[nodiscard]] double x(std::size_t i) const { return candidates_[i].contact.position.x(); }

  const std::vector<MergeCandidate>& candidates_;
  double distance_;
  std::vector<std::size_t> along_x_;
};

// Selects the candidates to keep. The best come first, so that each is left out only for a better
// one that is kept.
std::vector<bool> keep_the_better(const std::vector<MergeCandidate>& candidates,
                                  MergedModel& merged) {
  std::vector<std::size_t> best_first(candidates.size());
  std::iota(best_first.begin(), best_first.end(), std::size_t{0});
  std::ranges::stable_sort(best_first, {}, [&](std::size_t i) {
    const ContactModel& contact = candidates[i].contact;
    return std::make_pair(contact.rms, -contact.samples);
  });
  const NearContacts near(candidates, merged.same_place);
  std::vector<bool> kept(candidates.size(), false);
  std::vector<std::size_t> instead(candidates.size());
  for (const std::size_t i : best_first) {
    instead[i] = near.nearest(i, kept);
    kept[i] = instead[i] == i;
  }
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!kept[i]) merged.left_out.push_back({candidates[i].source, candidates[instead[i]].source});
  }
  return kept;
}

// Offset between the ids of successive sides that makes all ids differ: 0 if they do already, else
// a power of ten.
long long id_stride(std::span<const SideModel> sides) {
  std::set<long long> ids;
  bool all_differ = true;
  for (const SideModel& side : sides) {
    for (const ContactModel& contact : side.model.contacts)
      all_differ = ids.insert(contact.id).second && all_differ;
  }
  if (all_differ) return 0;
  const auto further = static_cast<long long>(sides.size());
  // Check this first, because computing with ids near the limits of `long long` would overflow.
  bool too_large = *ids.begin() < -kLargestId || *ids.rbegin() > kLargestId;
  long long stride = 10;
  if (!too_large) {
    while (stride <= kLargestId && stride <= *ids.rbegin() - *ids.begin()) stride *= 10;
    const long long largest = std::max(-*ids.begin(), *ids.rbegin());
    too_large = stride > (kLargestId - largest) / further;
  }
  if (too_large) {
    throw InvalidInput(
        "merge_models(): contacts of different models have the same ids, and these "
        "are too large to be told apart by adding to them; ids below " +
        std::to_string(kLargestId / 100 / further) + " will do");
  }
  return stride;
}

void keep_contacts(std::span<const SideModel> sides, std::vector<MergeCandidate>& candidates,
                   std::vector<geometry::SurfacePoint>& places, MergedModel& merged) {
  const long long stride = id_stride(sides);
  const std::vector<bool> kept = keep_the_better(candidates, merged);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!kept[i]) continue;
    MergeCandidate& candidate = candidates[i];
    candidate.contact.id += stride * candidate.source.side;
    places.push_back(candidate.at);
    merged.source.push_back(candidate.source);
    merged.model.contacts.push_back(std::move(candidate.contact));
  }
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const std::string side = "model " + std::to_string(k);
    merged.model.made[side + " ids"] =
        "those of the model plus " + std::to_string(stride * static_cast<long long>(k));
  }
}

// Expresses all coefficients at one normal force: that of the first side whose friction depends on
// the load. `merged` has the contacts, and their sources.
void refer_friction(std::span<const SideModel> sides, MergedModel& merged) {
  for (const SideModel& side : sides) {
    if (merged.model.friction_force == 0) merged.model.friction_force = side.model.friction_force;
  }
  for (std::size_t i = 0; i < merged.model.contacts.size(); ++i) {
    ContactModel& contact = merged.model.contacts[i];
    if (contact.load_exponent == 0) continue;
    const auto side = static_cast<std::size_t>(merged.source[i].side);
    const double factor = std::pow(merged.model.friction_force / sides[side].model.friction_force,
                                   contact.load_exponent);
    contact.friction *= factor;
    contact.friction_lower_bound *= factor;
    if (contact.friction_error) *contact.friction_error *= factor;
  }
}

// The sides are of one object: how its force depends on the rate is kept if all agree.
void take_rate(std::span<const SideModel> sides, Model& merged) {
  const std::vector<RateTerm>& rate = sides[0].model.rate;
  if (std::ranges::all_of(sides, [&](const SideModel& side) { return side.model.rate == rate; }))
    merged.rate = rate;
  else
    merged.made["rate"] = "left out, because it differs between the models";
}

// The least of two reference values, of which 0 is none.
double least_known(double a, double b) { return a > 0 && b > 0 ? std::min(a, b) : std::max(a, b); }

// Compliances if a side blends them, with the least reference values of the sides.
Interpolation interpolation_of(std::span<const SideModel> sides) {
  Interpolation result;
  for (const SideModel& side : sides) {
    const Interpolation& given = side.model.interpolation;
    if (given.rule == BlendRule::compliances) result.rule = given.rule;
    result.reference_force = least_known(result.reference_force, given.reference_force);
    result.reference_depth = least_known(result.reference_depth, given.reference_depth);
  }
  return result;
}

// Of all sides, if they were measured with equal balls.
std::optional<double> probe_radius(std::span<const SideModel> sides) {
  const std::optional<double> first = sides[0].model.probe_radius;
  const bool same = std::ranges::all_of(
      sides, [&](const SideModel& side) { return side.model.probe_radius == first; });
  return same ? first : std::nullopt;
}

std::string to_text(const Eigen::Isometry3d& pose) {
  const Eigen::IOFormat rows(Eigen::FullPrecision, Eigen::DontAlignCols, " ", "; ");
  std::ostringstream out;
  out << pose.matrix().topRows<3>().format(rows);
  return out.str();
}

void tell_origin(std::span<const SideModel> sides, const std::vector<Eigen::Isometry3d>& poses,
                 const MergeModelsOptions& options, MergedModel& merged) {
  auto& made = merged.model.made;
  made["merged"] = std::to_string(sides.size()) + " models";
  made["surface"] = kSurfaces[static_cast<std::size_t>(options.surface)];
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const std::string side = "model " + std::to_string(k);
    const std::string made_before = side + " made ";
    for (const auto& [key, value] : sides[k].model.made) made[made_before + key] = value;
    made[side] = sides[k].name;
    made[side + " pose"] = to_text(poses[k]);
  }
  for (const LeftOutContact& out : merged.left_out) {
    std::ostringstream line;
    line << out.contact.id << " for " << out.kept.id << " of model " << out.kept.side << "; ";
    made["model " + std::to_string(out.contact.side) + " left out"] += line.str();
  }
}

}  // namespace

void visit(MergeModelsOptions& options, FieldVisitor& visitor) {
  visitor.begin("MergeModelsOptions");
  visitor.choice({"surface",
                  "Merged surface: zippered, the measured surfaces joined at seams; averaged, one "
                  "smooth surface through all of them"},
                 options.surface, kSurfaces);
  visitor.real({"fill_holes", "Fill holes of the merged surface up to this diameter", "mm"},
               options.fill_holes, at_least(0));
  visitor.real({"max_distance", "Largest distance of a contact from the merged surface", "mm"},
               options.max_distance, at_least(0));
  visitor.real({"same_place",
                "Contacts of two models that are at most this far apart count as one; the one that "
                "fits better is kept. Without it: a quarter of the median distance between "
                "neighbouring contacts",
                "mm"},
               options.same_place, at_least(0));
}

MergedModel merge_models(std::span<const SideModel> sides, const MergeModelsOptions& given) {
  const MergeModelsOptions options = in_range(given);
  if (sides.empty()) throw InvalidInput("merge_models(): there is no model");
  std::vector<Eigen::Isometry3d> poses;
  std::vector<MergeCandidate> candidates;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    try {
      check_model(sides[i].model);
    } catch (const InvalidInput& wrong) {
      throw InvalidInput(side_name(sides, i) + ": " + wrong.what());
    }
    poses.push_back(exact_pose(sides, i));
    add_candidates(sides[i], static_cast<int>(i), poses[i], candidates);
  }
  MergedModel merged;
  merge_surfaces(sides, poses, options, merged);
  merged.same_place = std::max(options.same_place.value_or(kSamePlace * neighbour_distance(sides)),
                               kCoincide * geometry::bounding_diagonal(merged.model.surface));
  place_on_surface(sides, options, merged, candidates);
  std::vector<geometry::SurfacePoint> places;
  keep_contacts(sides, candidates, places, merged);
  geometry::ContactTriangulation triangulation =
      geometry::triangulate_contacts(merged.model.surface, places);
  merged.model.triangles = std::move(triangulation.mesh.triangles);
  merged.model.surface_weights = std::move(triangulation.weights);
  for (const int i : triangulation.isolated)
    merged.isolated.push_back(merged.model.contacts[static_cast<std::size_t>(i)].id);
  align_frames(merged.model);
  take_rate(sides, merged.model);
  refer_friction(sides, merged);
  for (ContactModel& contact : merged.model.contacts) contact = rounded(std::move(contact));
  merged.model.probe_radius = probe_radius(sides);
  merged.model = interpolated_as(std::move(merged.model), interpolation_of(sides));
  tell_origin(sides, poses, options, merged);
  return merged;
}

}  // namespace palpate::haptics
