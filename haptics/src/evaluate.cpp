// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/evaluate.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "palpate/error.h"
#include "palpate/geometry/comparison.h"
#include "palpate/geometry/contact_triangulation.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/realignment.h"

namespace palpate::haptics {
namespace {

std::vector<geometry::SurfacePoint> surface_points(const Model& model) {
  const geometry::SurfaceQuery query(model.surface);
  std::vector<geometry::SurfacePoint> points;
  for (const ContactModel& contact : model.contacts) {
    points.push_back(query.closest_point(contact.position).at);
  }
  return points;
}

// Samples of a contact in the frame of the surface; displacements count from the contact as
// measured.
ForceSamples samples_on_surface(const Model& model, const probing::Acquisition& acquisition,
                                long long contact) {
  const auto found = std::find_if(acquisition.contacts.begin(), acquisition.contacts.end(),
                                  [&](const probing::Contact& c) { return c.id == contact; });
  ForceSamples samples;
  if (found != acquisition.contacts.end()) samples = realign(*found, acquisition.samples);
  if (samples.forces.cols() == 0) {
    throw InvalidInput("leave_one_out(): contact " + std::to_string(contact) +
                       " of the model has no samples in the acquisition; pass the acquisition that "
                       "the model was made of");
  }
  const Eigen::Matrix3d rotation = model.T_surface_acquisition.linear();
  samples.displacements = rotation * samples.displacements;
  samples.forces = rotation * samples.forces;
  return samples;
}

Model without_contact(const Model& model, std::vector<geometry::SurfacePoint> points,
                      std::size_t i) {
  Model rest = model;
  rest.contacts.erase(rest.contacts.begin() + static_cast<std::ptrdiff_t>(i));
  points.erase(points.begin() + static_cast<std::ptrdiff_t>(i));
  geometry::ContactTriangulation triangulation =
      geometry::triangulate_contacts(model.surface, points);
  rest.triangles = std::move(triangulation.mesh.triangles);
  rest.surface_weights = std::move(triangulation.weights);
  return rest;
}

}  // namespace

QueryErrors evaluate_queries(const Model& model, std::span<const Query> queries) {
  if (queries.empty())
    throw InvalidInput("evaluate_queries(): there is no query; pass at least one");
  const BlendedField field(model);
  std::vector<double> errors;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Query& query = queries[i];
    if (!query.contact.allFinite() || !query.displacement.allFinite() || !query.force.allFinite())
      throw InvalidInput("evaluate_queries(): query " + std::to_string(i) +
                         " is not finite; leave it out");
    errors.push_back((field.force(query.contact, query.displacement) - query.force).norm());
    if (!std::isfinite(errors.back()))
      throw SolverError("evaluate_queries(): the model's force at query " + std::to_string(i) +
                        " is not finite; the model is broken");
  }
  const geometry::ErrorStatistics statistics = geometry::error_statistics(std::move(errors));
  return {static_cast<int>(statistics.count), statistics.rms, statistics.median, statistics.p90};
}

LeaveOneOut leave_one_out(const Model& model, const probing::Acquisition& acquisition) {
  check_model(model);
  if (model.contacts.size() < 4) {
    throw InvalidInput(
        "leave_one_out(): the model has three contacts; without one of them nothing is left "
        "to interpolate, at least four are needed");
  }
  const std::vector<geometry::SurfacePoint> points = surface_points(model);
  LeaveOneOut result;
  result.per_contact.resize(model.contacts.size());
  tbb::parallel_for(std::size_t{0}, model.contacts.size(), [&](std::size_t i) {
    const ContactModel& contact = model.contacts[i];
    const ForceSamples samples = samples_on_surface(model, acquisition, contact.id);
    const BlendedField field(without_contact(model, points, i));
    const Blend at = field.blend(contact.position);
    std::vector<double> errors;
    for (Eigen::Index s = 0; s < samples.forces.cols(); ++s) {
      errors.push_back(
          (field.force(at, samples.displacements.col(s)) - samples.forces.col(s)).norm());
    }
    const geometry::ErrorStatistics statistics = geometry::error_statistics(std::move(errors));
    result.per_contact[i] = {contact.id, statistics.rms, static_cast<int>(statistics.count)};
  });
  double sum = 0, count = 0;
  for (const ContactError& error : result.per_contact) {
    sum += error.rms * error.rms * error.samples;
    count += error.samples;
  }
  result.rms = std::sqrt(sum / count);
  return result;
}

}  // namespace palpate::haptics
