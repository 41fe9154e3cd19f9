// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "build/place_contacts.h"

#include <cmath>
#include <string>

#include "palpate/error.h"
#include "palpate/geometry/registration.h"

namespace palpate::haptics {
namespace {

using geometry::ClosestPoint;
using geometry::SurfaceQuery;

Eigen::Matrix3Xd positions(const std::vector<probing::Contact>& contacts) {
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(contacts.size()));
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    points.col(static_cast<Eigen::Index>(i)) = contacts[i].position;
  }
  return points;
}

double distance_rms(const Eigen::Matrix3Xd& points, const SurfaceQuery& query) {
  double sum = 0;
  for (const auto& point : points.colwise()) {
    const double distance = query.closest_point(point).distance;
    sum += distance * distance;
  }
  return std::sqrt(sum / static_cast<double>(points.cols()));
}

// Finds out whether and how the acquisition moves onto the surface.
void register_contacts(const Eigen::Matrix3Xd& points, const geometry::TriangleMesh& surface,
                       const SurfaceQuery& query, const BuildOptions& options,
                       BuildResult& result) {
  result.distance_rms = distance_rms(points, query);
  result.registration = RegistrationOutcome::not_needed;
  if (result.distance_rms <= options.on_surface) return;
  // From where they are, without a search: contacts are not meant to move far. For the same reason
  // the verdict does not count but for the steps' end: a few contacts on a plate are too few and
  // slide, yet move no further than the surface wants, at most `max_motion`, and each is checked to
  // be on the surface then.
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

// Turns the surface over if it is seen from inside at most contacts.
void orient_surface(const std::vector<ClosestPoint>& places,
                    const std::vector<probing::Contact>& contacts, BuildResult& result) {
  const Eigen::Matrix3Xd normals = geometry::triangle_normals(result.model.surface);
  const auto agrees = [&](std::size_t i) {
    const Eigen::Vector3d outwards =
        result.model.T_surface_acquisition.linear() * contacts[i].normal;
    return normals.col(places[i].at.triangle).dot(outwards) > 0;
  };
  std::size_t agreeing = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) agreeing += agrees(i) ? 1 : 0;
  result.surface_flipped = 2 * agreeing < contacts.size();
  if (result.surface_flipped) {
    result.model.surface.triangles.row(1).swap(result.model.surface.triangles.row(2));
  }
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (agrees(i) != result.surface_flipped) continue;
    throw InvalidInput("build_model(): the normal of contact " + std::to_string(contacts[i].id) +
                       " points into the surface, those of most others out of it; normals must "
                       "point out of the object");
  }
}

std::vector<ClosestPoint> find_places(const std::vector<probing::Contact>& contacts,
                                      const SurfaceQuery& query, const BuildOptions& options,
                                      const BuildResult& result) {
  std::vector<ClosestPoint> places;
  for (const probing::Contact& contact : contacts) {
    places.push_back(query.closest_point(result.model.T_surface_acquisition * contact.position));
    if (places.back().distance <= options.max_distance) continue;
    throw InvalidInput("build_model(): contact " + std::to_string(contact.id) + " is " +
                       std::to_string(places.back().distance) +
                       " mm from the surface (registration: " + to_string(result.registration) +
                       "); at most " + std::to_string(options.max_distance) +
                       " mm are allowed. Check that contacts and surface belong together and are "
                       "in one frame, or allow more");
  }
  return places;
}

}  // namespace

std::vector<ClosestPoint> place_contacts(const std::vector<probing::Contact>& contacts,
                                         const SurfaceQuery& query, const BuildOptions& options,
                                         BuildResult& result) {
  register_contacts(positions(contacts), result.model.surface, query, options, result);
  std::vector<ClosestPoint> places = find_places(contacts, query, options, result);
  orient_surface(places, contacts, result);
  return places;
}

}  // namespace palpate::haptics
