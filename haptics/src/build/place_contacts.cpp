// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "build/place_contacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "build/build_options.h"
#include "palpate/core/error.h"
#include "palpate/geometry/facing_share.h"
#include "palpate/geometry/registration.h"
#include "palpate/haptics/rounding.h"

namespace palpate::haptics {
namespace {

using geometry::ClosestPoint;
using geometry::SurfaceQuery;

// Positions without those that registration cannot bring to the surface, if at least three remain.
Eigen::Matrix3Xd positions(const std::vector<probing::Contact>& contacts, const SurfaceQuery& query,
                           const BuildOptions& options) {
  Eigen::Matrix3Xd all(3, static_cast<Eigen::Index>(contacts.size()));
  std::vector<Eigen::Index> near;
  for (Eigen::Index i = 0; i < all.cols(); ++i) {
    all.col(i) = contacts[static_cast<std::size_t>(i)].position;
    if (query.closest_point(all.col(i)).distance <= options.max_distance + options.max_motion)
      near.push_back(i);
  }
  return near.size() < 3 ? all : Eigen::Matrix3Xd(all(Eigen::all, near));
}

double distance_rms(const Eigen::Matrix3Xd& points, const SurfaceQuery& query) {
  double sum = 0;
  for (const auto& point : points.colwise()) {
    const double distance = query.closest_point(point).distance;
    sum += distance * distance;
  }
  return std::sqrt(sum / static_cast<double>(points.cols()));
}

// Decides whether and how to move the acquisition onto the surface.
void register_contacts(const Eigen::Matrix3Xd& points, const geometry::TriangleMesh& surface,
                       const SurfaceQuery& query, const BuildOptions& options,
                       BuildResult& result) {
  result.distance_rms = distance_rms(points, query);
  result.registration = RegistrationOutcome::not_needed;
  if (result.distance_rms <= options.on_surface) return;
  // Start from the measured positions without a search, because contacts are not meant to move far.
  // The verdict counts only if the registration has not converged: a few contacts on a plate may be
  // too few and slide, but they move at most `max_motion`, and each is checked afterwards.
  const geometry::Registration found = geometry::register_points(
      points, surface, {.search_rotation = 0, .search_translation = 0, .min_overlap = 1});
  if (found.verdict == geometry::RegistrationVerdict::not_converged) {
    result.registration = RegistrationOutcome::not_converged;
    return;
  }
  const Eigen::Matrix3Xd moved = found.T_target_source * points;
  if ((moved - points).colwise().norm().maxCoeff() > options.max_motion) {
    result.registration = RegistrationOutcome::too_far;
    return;
  }
  result.registration = RegistrationOutcome::accepted;
  result.model.T_surface_acquisition = found.T_target_source;
}

enum class Facing { outwards, inwards, unclear };

// Returns how each contact's normal agrees with the surface. The area that the probe covers counts
// as well as the triangle, which may face anywhere, for example where a scan is folded.
std::vector<Facing> facings(const std::vector<ClosestPoint>& places,
                            const std::vector<probing::Contact>& contacts,
                            const BuildResult& result) {
  const geometry::TriangleMesh& surface = result.model.surface;
  const Eigen::Matrix3Xd of_triangles = geometry::triangle_normals(surface);
  Eigen::Matrix3Xd outwards(3, static_cast<Eigen::Index>(contacts.size()));
  std::vector<geometry::SurfacePoint> points;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    outwards.col(static_cast<Eigen::Index>(i)) =
        result.model.T_surface_acquisition.linear() * contacts[i].normal;
    points.push_back(places[i].at);
  }
  const Eigen::VectorXd shares = geometry::facing_shares(
      surface, points, outwards, result.model.probe_radius.value_or(probing::kUsualTipRadius));
  std::vector<Facing> facing;
  for (Eigen::Index i = 0; i < shares.size(); ++i) {
    const int triangle = points[static_cast<std::size_t>(i)].triangle;
    const double here = of_triangles.col(triangle).dot(outwards.col(i)), there = shares[i] - 0.5;
    // A triangle without area has a NaN normal, for which all comparisons are false.
    facing.push_back(here > 0 || there > 0
                         ? (here < 0 || there < 0 ? Facing::unclear : Facing::outwards)
                     : here < 0 || there < 0 ? Facing::inwards
                                             : Facing::unclear);
  }
  return facing;
}

// Reverses the surface if more contacts see it from inside than from outside. Returns how the
// contacts then face it.
std::vector<Facing> orient_surface(std::vector<Facing> facing, BuildResult& result) {
  result.surface_flipped =
      std::ranges::count(facing, Facing::inwards) > std::ranges::count(facing, Facing::outwards);
  if (!result.surface_flipped) return facing;
  result.model.surface.triangles.row(1).swap(result.model.surface.triangles.row(2));
  for (Facing& one : facing) {
    if (one != Facing::unclear) one = one == Facing::inwards ? Facing::outwards : Facing::inwards;
  }
  return facing;
}

std::string millimetres(double distance) { return fmt::format("{:g} mm", distance); }

// The reason why a contact does not fit the surface; empty if it does.
std::string misfit(double distance, Facing facing, const BuildOptions& options) {
  if (!(distance <= options.max_distance))
    return "is " + millimetres(distance) + " from the surface";
  if (facing == Facing::inwards) return "has a normal that points into the surface";
  return {};
}

double extent(const Eigen::Matrix3Xd& points) {
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

// Says what is to be done about contacts that are far from the surface.
void what_brings_near(const std::vector<probing::Contact>& contacts, const BuildResult& result,
                      std::vector<MessagePart>& message) {
  constexpr double kOtherUnit = 50;  // units differ by 10 at least, most by 1000
  Eigen::Matrix3Xd places(3, static_cast<Eigen::Index>(contacts.size()));
  for (std::size_t i = 0; i < contacts.size(); ++i)
    places.col(static_cast<Eigen::Index>(i)) = contacts[i].position;
  const double of_contacts = extent(places);
  const double of_surface = geometry::bounding_diagonal(result.model.surface);
  if (of_contacts <= kOtherUnit * of_surface && of_surface <= kOtherUnit * of_contacts) {
    message.push_back(
        {"Check that contacts and surface belong together and are in one frame, or "
         "raise "});
    message.push_back({"BuildOptions::max_distance", true});
    message.push_back({". "});
    return;
  }
  message.push_back({"The contacts extend over " + millimetres(of_contacts) +
                     ", the surface over " + millimetres(of_surface) +
                     ": check the units of both. "});
}

void refuse_misfits(const std::vector<probing::Contact>& contacts, const BuildOptions& options,
                    const BuildResult& result) {
  const ContactMisfit& first = result.left_out.front();
  const std::string count = std::to_string(result.left_out.size());
  const bool far = first.reason.starts_with("is ");
  std::vector<MessagePart> message = {
      {"build_model()", true}, {": contact " + std::to_string(first.id) + " " + first.reason}};
  if (far) {
    message.push_back({" (registration: " + std::string(to_string(result.registration)) +
                       "); at most " + millimetres(options.max_distance) + " are allowed. "});
    what_brings_near(contacts, result, message);
  } else {
    message.push_back(
        {", those of most others point out of it; normals must point out of the "
         "object. Correct it. "});
  }
  message.push_back({result.left_out.size() == 1
                         ? std::string("This contact does not fit the surface")
                         : count + " contacts do not fit the surface"});
  if (2 * result.left_out.size() < contacts.size()) {
    message.push_back({"; "});
    message.push_back({"BuildOptions::max_left_out", true});
    message.push_back({" of " + count + " leaves out as many"});
  }
  throw InvalidInput(message);
}

}  // namespace

PlacedContacts place_contacts(const std::vector<probing::Contact>& contacts,
                              const SurfaceQuery& query, const BuildOptions& options,
                              BuildResult& result) {
  register_contacts(positions(contacts, query, options), result.model.surface, query, options,
                    result);
  std::vector<ClosestPoint> places;
  places.reserve(contacts.size());
  const double size = geometry::bounding_diagonal(result.model.surface);
  for (const probing::Contact& contact : contacts) {
    const Eigen::Vector3d measured = result.model.T_surface_acquisition * contact.position;
    ClosestPoint& place = places.emplace_back(query.closest_point(measured));
    // Check the values as they are stored.
    place.position = rounded_position(place.position, size);
    place.distance = (place.position - measured).norm();
  }
  const std::vector<Facing> facing = orient_surface(facings(places, contacts, result), result);
  PlacedContacts placed;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    std::string wrong = misfit(places[i].distance, facing[i], options);
    if (!wrong.empty()) {
      result.left_out.push_back({contacts[i].id, std::move(wrong)});
      continue;
    }
    placed.kept.push_back(i);
    placed.places.push_back(places[i]);
  }
  const std::size_t most = options.max_left_out ? static_cast<std::size_t>(*options.max_left_out)
                                                : contacts.size() / probing::kContactsPerMisfit;
  if (result.left_out.size() > most) refuse_misfits(contacts, options, result);
  if (placed.kept.size() < 3) {
    throw wrong_measurements("only " + std::to_string(placed.kept.size()) +
                             " contacts fit the surface; at least three are needed");
  }
  return placed;
}

}  // namespace palpate::haptics
