// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/scale_model.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "build/forget_samples.h"
#include "build/interpolated_as.h"
#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/require.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/haptics/force_field_fit.h"
#include "palpate/haptics/passivity_certificate.h"
#include "palpate/haptics/rotation.h"
#include "palpate/haptics/rounding.h"
#include "palpate/haptics/transform_field.h"

namespace palpate::haptics {
namespace {

Eigen::Matrix3d stretch(const ScaleModelOptions& options) {
  const double volume = options.factor * options.factor * options.factor;
  require("ScaleModelOptions::factor", options.factor, above(0).finite());
  require("the cube of ScaleModelOptions::factor", volume, above(0).finite());
  if (!options.axis) return options.factor * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d axis = options.axis->stableNormalized();
  if (!options.axis->allFinite() || !(axis.norm() > 0)) {
    throw InvalidInput("scale_model(): axis must be finite and not zero");
  }
  return Eigen::Matrix3d::Identity() + (options.factor - 1) * axis * axis.transpose();
}

// Factor of the energy at a given strain.
double energy_factor(ForceScaling forces, double volume) {
  return forces == ForceScaling::material ? volume : std::cbrt(volume);
}

// Updates what is known of a field that `transform_field` has refitted, because it is no longer the
// fit of the samples.
void tell_refit(ContactModel& contact) {
  const bool convex = std::ranges::none_of(
      contact.field.bases, [](const Multiquadric& base) { return base.weight < 0; });
  contact.fit_mode = convex ? FitMode::convex : FitMode::certified;
  contact.passivity = convex ? Passivity::convex : Passivity::certified;
  contact.chi2.reset();
  contact.condition.reset();
}

TransformedField scale_contact(const Eigen::Matrix3d& S, ForceScaling forces,
                               const std::optional<double>& largest_force, ContactModel& contact) {
  const Eigen::Matrix3d before = contact.frame;
  const Eigen::Vector3d z = S.inverse() * before.col(2);
  contact.frame = rotation_between(before.col(2), z) * before;
  contact.friction_axis = (S * contact.friction_axis).normalized();
  contact.compliance.reset();  // it belonged to the old field
  contact.strength.reset();
  contact.uncertainty.reset();
  if (forces == ForceScaling::feel) {
    contact = rounded(std::move(contact));
    return {.field = contact.field};
  }
  const double volume = S.determinant();
  const double factor = energy_factor(forces, volume);
  // Maps displacements in the old frame to the new one. The inverse is used because frames are
  // rounded: it keeps a uniform S uniform.
  const Eigen::Matrix3d displacements_by = contact.frame.inverse() * S * before;
  TransformedField transformed =
      transform_field(contact.field, displacements_by, factor, largest_force);
  contact.field = transformed.field;
  const double forces_by = factor / std::cbrt(volume);
  contact.rms = std::hypot(contact.rms * forces_by, transformed.rms);
  if (contact.noise_floor) *contact.noise_floor *= forces_by;
  if (!transformed.exact) tell_refit(contact);
  contact = rounded(std::move(contact));
  return transformed;
}

// A dent is round, so that a response that is stretched along an axis alone is not one any more.
std::optional<SurfaceResponse> scaled_response(std::optional<SurfaceResponse> response,
                                               const ScaleModelOptions& options) {
  if (!response || options.axis) return std::nullopt;
  response->reach *= options.factor;
  response->displacements *= static_cast<float>(options.factor);
  response->moves =
      (response->moves.cast<float>() * static_cast<float>(options.factor)).cast<Eigen::half>();
  for (double* error :
       {&response->rms, &response->largest, &response->kept_rms, &response->kept_largest}) {
    *error *= options.factor;
  }
  return response;
}

std::string description(const ScaleModelOptions& options) {
  std::ostringstream out;
  out << "by " << options.factor;
  if (options.axis) {
    out << " along (" << options.axis->x() << ", " << options.axis->y() << ", " << options.axis->z()
        << ")";
  }
  out << ", " << to_string(options.forces);
  return out.str();
}

}  // namespace

const char* to_string(ForceScaling forces) {
  switch (forces) {
    case ForceScaling::material:
      return "material";
    case ForceScaling::forces:
      return "forces";
    case ForceScaling::feel:
      return "feel";
  }
  return "unknown";
}

ScaledModel scale_model(const Model& model, const ScaleModelOptions& options) {
  const Eigen::Matrix3d S = stretch(options);
  check_model(model);
  ScaledModel result{.model = model};
  Model& scaled = result.model;
  const Eigen::Vector3d middle = geometry::bounding_box(model.surface).center();
  const auto moved = [&](const Eigen::Matrix3Xd& points) {
    return Eigen::Matrix3Xd((S * (points.colwise() - middle)).colwise() + middle);
  };
  scaled.surface.vertices = moved(model.surface.vertices);
  forget_samples(scaled);
  scaled.response = scaled_response(std::move(scaled.response), options);
  std::optional<double> largest_force;
  if (model.interpolation.rule == BlendRule::compliances)
    largest_force = model.interpolation.reference_force;
  const double size = geometry::bounding_diagonal(scaled.surface);
  std::vector<TransformedField> fields(scaled.contacts.size());
  parallel_for(scaled.contacts.size(), [&](std::size_t i) {
    ContactModel& contact = scaled.contacts[i];
    contact.position = rounded_position(moved(contact.position), size);
    fields[i] = scale_contact(S, options.forces, largest_force, contact);
  });
  for (const TransformedField& field : fields) {
    result.refitted += field.exact ? 0 : 1;
    result.refit_rms = std::max(result.refit_rms, field.rms);
    result.refit_largest = std::max(result.refit_largest, field.largest);
  }
  if (options.axis) {
    scaled.probe_radius.reset();  // a stretched ball is none
  } else if (scaled.probe_radius && options.forces != ForceScaling::feel) {
    *scaled.probe_radius *= options.factor;
  }
  std::string& before = scaled.made["scaled"];
  before += (before.empty() ? "" : "; ") + description(options);
  // With `material`, the forces of pressing scale with the object; otherwise they stay the same.
  const double factor =
      options.forces == ForceScaling::material ? std::pow(S.determinant(), 2.0 / 3) : 1;
  scaled.friction_force *= factor;
  Interpolation as = scaled.interpolation;
  as.reference_force *= factor;
  if (options.forces != ForceScaling::feel) as.reference_depth *= std::cbrt(S.determinant());
  scaled = interpolated_as(std::move(scaled), as);
  return result;
}

}  // namespace palpate::haptics
