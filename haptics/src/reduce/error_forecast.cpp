// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/error_forecast.h"

#include <array>
#include <cmath>

#include "model/force_variance.h"
#include "palpate/core/error.h"
#include "palpate/geometry/contact_locator.h"
#include "palpate/geometry/error_growth.h"
#include "palpate/haptics/blended_field.h"
#include "reduce/contact_error_parts.h"
#include "reduce/reduced_uncertainty.h"
#include "reduce/strokes.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

// [mm] Half the distance of two places that show how the force changes along the surface: about
// what a registration is wrong by.
constexpr double kHalfSlope = 0.25;

constexpr std::array kBudgetParts{
    &ErrorBudget::force_noise,     &ErrorBudget::position_noise,   &ErrorBudget::fit,
    &ErrorBudget::across,          &ErrorBudget::spacing,          &ErrorBudget::contrast,
    &ErrorBudget::per_depth_noise, &ErrorBudget::per_depth_offset, &ErrorBudget::per_registration};

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

/// Adds what the errors of the surface, and of the contacts on it, cause at one place.
class SurfaceParts {
 public:
  SurfaceParts(const BlendedField& field, const geometry::TriangleMesh& surface)
      : field_(field), normals_(geometry::triangle_normals(surface)) {}

  // \param squares [N^2/mm^2]
  void add(const geometry::ClosestPoint& at, const Blend& blend, const Vector3d& displacement,
           ErrorBudget& squares) const {
    const Vector3d normal = normals_.col(at.at.triangle);
    if (!normal.allFinite()) return;
    const double depth = (field_.stiffness(blend, displacement) * normal).squaredNorm();
    squares.per_depth_offset += depth;
    // A place takes the mean of the vertices around it.
    squares.per_depth_noise += depth * at.at.barycentric.squaredNorm();
    // The shift may go in any direction along the surface.
    const Vector3d first = normal.unitOrthogonal();
    for (const Vector3d& along : {first, Vector3d(normal.cross(first))})
      squares.per_registration += slope_square(at.position, along, displacement) / 2;
  }

 private:
  double slope_square(const Vector3d& place, const Vector3d& along,
                      const Vector3d& displacement) const {
    const geometry::ClosestPoint before =
                                     field_.surface().closest_point(place - kHalfSlope * along),
                                 behind =
                                     field_.surface().closest_point(place + kHalfSlope * along);
    const double apart = (behind.position - before.position).norm();
    if (!(apart > kHalfSlope)) return 0;  // at the border
    return (field_.force(field_.blend(behind.at), displacement) -
            field_.force(field_.blend(before.at), displacement))
               .squaredNorm() /
           (apart * apart);
  }

  const BlendedField& field_;
  Eigen::Matrix3Xd normals_;
};

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
  const ContactErrorParts of_contacts = contact_error_parts(model);
  const SurfaceParts of_surface(field, surface_);
  const auto count = static_cast<double>(ends.size());
  for (const StrokeEnd& end : ends) {
    const geometry::ClosestPoint at = query_.closest_point(end.contact);
    const Vector3d displacement = end.tool - end.contact;
    const Blend blend = field.blend(at.at);
    const auto of = [&](std::span<const ContactModel> contacts) {
      return force_variance(contacts, blend, at.position, displacement);
    };
    const ForceVariance whole = of(model.contacts);
    const double growth = geometry::error_growth(whole.reach);
    places_.push_back({at, growth > 0 ? whole.between * whole.distance / growth : 0});
    ErrorBudget squares{.force_noise = of(of_contacts.force_noise).contacts,
                        .position_noise = of(of_contacts.position_noise).contacts,
                        .fit = of(of_contacts.fit).contacts,
                        .across = of(of_contacts.across).contacts,
                        .spacing = whole.between * whole.distance,
                        .contrast = whole.contrast};
    of_surface.add(at, blend, displacement, squares);
    for (const auto part : kBudgetParts) present_.*part += squares.*part / count;
    reach_ += whole.reach / count;
    force_ += end.force.squaredNorm() / count;
  }
  for (const auto part : kBudgetParts) present_.*part = std::sqrt(present_.*part);
  force_ = std::sqrt(force_);
}

double ErrorForecast::of_contacts() const {
  ErrorBudget own = present_;
  own.spacing = own.contrast = 0;
  return own.stated();
}

ErrorBudget ErrorForecast::budget_with(std::span<const Vector3d> contacts) const {
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
  ErrorBudget budget = present_;
  budget.spacing = std::sqrt(growing / count);
  budget.contrast *= reach_ > 0 ? std::sqrt(reach / count / reach_) : 0;
  return budget;
}

}  // namespace palpate::haptics
