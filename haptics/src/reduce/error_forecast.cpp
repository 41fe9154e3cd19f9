// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/error_forecast.h"

#include <cmath>

#include "model/force_variance.h"
#include "palpate/core/error.h"
#include "palpate/geometry/contact_locator.h"
#include "palpate/geometry/error_growth.h"
#include "palpate/haptics/blended_field.h"
#include "reduce/reduced_uncertainty.h"
#include "reduce/strokes.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

// [mm^2] As `force_variance` computes it, but along the surface itself.
double reach_of(const Vector3d& place, const Vector3d& normal,
                const geometry::ContactWeights& weights, std::span<const Vector3d> contacts) {
  double square = 0;
  Vector3d middle = Vector3d::Zero();
  for (std::size_t k = 0; k < static_cast<std::size_t>(weights.count); ++k) {
    const Vector3d to = contacts[static_cast<std::size_t>(weights.contacts[k])] - place;
    square += weights.weights[k] * to.squaredNorm();
    middle += weights.weights[k] * to;
  }
  return geometry::error_reach(square, (middle - normal.dot(middle) * normal).squaredNorm());
}

}  // namespace

ErrorForecast::ErrorForecast(const Model& model, const ReduceOptions& needs)
    : surface_(model.surface), query_(surface_), triangulation_(model.triangulation) {
  check_model(model);
  StrokeSettings settings = stroke_settings(model, in_range(needs));
  settings.count = static_cast<int>(kChoosing * needs.strokes);
  const std::vector<StrokeEnd> ends = play_strokes(model, random_strokes(model, settings));
  if (!stated_error(model, ends)) {
    throw InvalidInput(
        "the model states no error, from which that with other contacts could follow; fit it again "
        "with this version, or from data with at least four contacts");
  }
  const BlendedField field(model);
  const auto count = static_cast<double>(ends.size());
  for (const StrokeEnd& end : ends) {
    const geometry::ClosestPoint at = query_.closest_point(end.contact);
    const ForceVariance parts =
        force_variance(model.contacts, field.blend(at.at), at.position, end.tool - end.contact);
    const double growth = geometry::error_growth(parts.reach);
    places_.push_back({at, growth > 0 ? parts.between * parts.distance / growth : 0});
    contacts_ += parts.contacts / count;
    contrast_ += parts.contrast / count;
    growing_ += parts.between * parts.distance / count;
    reach_ += parts.reach / count;
    force_ += end.force.squaredNorm() / count;
  }
  force_ = std::sqrt(force_);
}

double ErrorForecast::at_present() const { return std::sqrt(contacts_ + contrast_ + growing_); }

double ErrorForecast::of_contacts() const { return std::sqrt(contacts_); }

double ErrorForecast::with(std::span<const Vector3d> contacts) const {
  std::vector<geometry::SurfacePoint> points;
  std::vector<Vector3d> positions;
  for (const Vector3d& contact : contacts) {
    const geometry::ClosestPoint closest = query_.closest_point(contact);
    points.push_back(closest.at);
    positions.push_back(closest.position);
  }
  const geometry::ContactLocator locator(
      surface_, points,
      geometry::triangulate_contacts(surface_, points, {.method = triangulation_}).weights);
  const Eigen::Matrix3Xd normals = geometry::triangle_normals(surface_);
  double growing = 0, reach = 0;
  for (const Place& place : places_) {
    const double here = reach_of(place.at.position, normals.col(place.at.at.triangle),
                                 locator.locate(place.at.at), positions);
    growing += place.growing * geometry::error_growth(here);
    reach += here;
  }
  const auto count = static_cast<double>(places_.size());
  const double contrast = reach_ > 0 ? contrast_ * (reach / count) / reach_ : 0;
  return std::sqrt(contacts_ + contrast + growing / count);
}

}  // namespace palpate::haptics
