// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/model.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_set>

#include "model/field_document_format.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/haptics/rotation.h"

namespace palpate::haptics {
namespace {

void check_contact(const ContactModel& contact, const std::string& name) {
  if (!contact.position.allFinite()) throw InvalidInput(name + ": its position is not finite");
  if (!is_rotation(contact.frame, kFrameTolerance)) {
    throw InvalidInput(name + ": its frame must hold three orthogonal unit axes, right-handed");
  }
  if (!(std::abs(contact.friction_axis.norm() - 1) <= kFrameTolerance)) {
    throw InvalidInput(name + ": its friction axis must be a unit vector");
  }
  const auto check = [&](const char* field, std::optional<double> value, const char* unit = "") {
    if (value) require([&] { return name + ": " + field; }, *value, at_least(0).finite(), unit);
  };
  check("friction", contact.friction);
  require([&] { return name + ": load_exponent"; }, contact.load_exponent,
          at_least(-kLargestLoadExponent).at_most(kLargestLoadExponent));
  check("friction_error", contact.friction_error);
  check("friction_lower_bound", contact.friction_lower_bound);
  check("rms", contact.rms, "N");
  check("chi2", contact.chi2);
  check("noise_floor", contact.noise_floor, "N");
  check("condition", contact.condition);
  if (contact.uncertainty) {
    check("uncertainty: force", contact.uncertainty->force, "N");
    check("uncertainty: displacement", contact.uncertainty->displacement, "mm");
    check("uncertainty: across", contact.uncertainty->across);
    check("uncertainty: between", contact.uncertainty->between, "mm^-1.25");
  }
  check_force_field(contact.field, name.c_str());
  if (contact.strength) {
    check("strength: value", contact.strength->value, "N");
    require([&] { return name + ": strength: trend"; }, contact.strength->trend.sum(), finite());
  }
  if (!contact.compliance) return;
  const Eigen::Vector<double, 6>& values = contact.compliance->values;
  if (!(std::abs(contact.compliance->direction.norm() - 1) <= kFrameTolerance)) {
    throw InvalidInput(name + ": the direction of its compliance must be a unit vector");
  }
  // Written so that NaN is refused.
  const bool positive = values(2) > 0 && values(3) > 0 && values(5) > 0 &&
                        values(3) * values(5) > values(4) * values(4);
  if (!positive || !values.allFinite() || !contact.compliance->trend.allFinite()) {
    throw InvalidInput(name +
                       ": its compliance must be finite, with u_z > 0 and c positive definite");
  }
}

void check_interpolation(const Interpolation& given) {
  const bool counts = given.rule == BlendRule::compliances;
  const double force = given.reference_force, reach = given.reach;
  require("the model's interpolation: reference_depth", given.reference_depth, at_least(0).finite(),
          "mm");
  require("the model's interpolation: reference_force", force,
          (counts ? above(0) : at_least(0)).finite(), "N");
  require("the model's interpolation: reach", reach, at_least(0).finite(), "mm");
}

void check_weights(const Model& model) {
  const geometry::SurfaceWeights& given = model.surface_weights;
  const Eigen::Index count = model.surface.vertices.cols();
  if (given.contacts.cols() != count || given.weights.cols() != count) {
    throw InvalidInput("the model has weights for " + std::to_string(given.contacts.cols()) +
                       " vertices, its surface has " + std::to_string(count));
  }
  for (Eigen::Index v = 0; v < count; ++v) {
    const std::string name = "the weights at vertex " + std::to_string(v) + " of the surface";
    for (const int contact : given.contacts.col(v)) {
      if (contact >= -1 && contact < static_cast<int>(model.contacts.size())) continue;
      throw InvalidInput(name + " name contact " + std::to_string(contact) +
                         "; expected -1 (none) to " + std::to_string(model.contacts.size() - 1));
    }
    // Written so that NaN is refused.
    const bool is_none = given.contacts(0, v) < 0;
    const double error = std::abs(given.weights.col(v).sum() - (is_none ? 0 : 1));
    if (given.weights.col(v).minCoeff() >= 0 && error <= geometry::kBarycentricTolerance) continue;
    throw InvalidInput(name + " must be >= 0 and sum to 1, or to 0 where no contact has influence");
  }
}

void check_offsets(const PressingOffsets& given) {
  const auto check = [](const char* field, double value, const Interval& range,
                        const char* unit = "") {
    require([&] { return std::string("Model::pressing_offsets: ") + field; }, value, range, unit);
  };
  for (Eigen::Index i = 0; i < 3; ++i) {
    check("force", given.force(i), finite(), "N");
    check("force_error", given.force_error(i), at_least(0).finite(), "N");
  }
  check("touch", given.touch, finite(), "mm");
  check("touch_error", given.touch_error, at_least(0).finite(), "mm");
  check("touch_spread", given.touch_spread, at_least(0).finite(), "mm");
  check("height_slope", given.height_slope, finite());
  check("height_slope_error", given.height_slope_error, at_least(0).finite());
  check("hysteresis", given.hysteresis, finite().below(1));
  check("hysteresis_error", given.hysteresis_error, at_least(0).finite());
}

}  // namespace

const char* to_string(FrictionSource source) {
  switch (source) {
    case FrictionSource::samples:
      return "samples";
    case FrictionSource::other_contacts:
      return "other_contacts";
    case FrictionSource::none:
      return "none";
    case FrictionSource::lower_bound:
      return "lower_bound";
  }
  return "unknown";
}

const char* to_string(BlendRule rule) {
  switch (rule) {
    case BlendRule::forces:
      return "forces";
    case BlendRule::compliances:
      return "compliances";
  }
  return "unknown";
}

void check_model(const Model& model) {
  geometry::check_mesh(model.surface, "the model's surface");
  if (model.contacts.size() < 3) {
    throw InvalidInput("the model has " + std::to_string(model.contacts.size()) +
                       " contacts; at least three are needed");
  }
  std::unordered_set<long long> ids;
  for (std::size_t i = 0; i < model.contacts.size(); ++i) {
    const std::string name =
        "contact " + std::to_string(model.contacts[i].id) + " (entry " + std::to_string(i) + ")";
    check_contact(model.contacts[i], name);
    if (!ids.insert(model.contacts[i].id).second)
      throw InvalidInput(name + ": another contact has the same id; ids must be unique");
  }
  check_interpolation(model.interpolation);
  require("Model::probe_radius", model.probe_radius, above(0).finite(), "mm");
  const bool has_exponent =
      std::any_of(model.contacts.begin(), model.contacts.end(),
                  [](const ContactModel& contact) { return contact.load_exponent != 0; });
  if (model.rate.size() > DelayedDisplacements::kMost) {
    throw InvalidInput("the model's rate has " + std::to_string(model.rate.size()) +
                       " terms; there are at most " + std::to_string(DelayedDisplacements::kMost));
  }
  for (const RateTerm& term : model.rate) {
    require("the model's rate: share", term.share, above(0).finite());
    require("the model's rate: time", term.time, above(0).finite(), "s");
  }
  require("the model's friction_force", model.friction_force,
          (has_exponent ? above(0) : at_least(0)).finite(), "N");
  if (model.response) {
    check_surface_response(*model.response, model.surface.vertices.cols(),
                           static_cast<Eigen::Index>(model.contacts.size()),
                           "the response of the model's surface");
  }
  if (model.noise) {
    require("the model's noise: force", model.noise->force, at_least(0).finite(), "N");
    require("the model's noise: displacement", model.noise->displacement, at_least(0).finite(),
            "mm");
  }
  if (model.samples_fingerprint && !is_fingerprint(*model.samples_fingerprint)) {
    throw InvalidInput("Model::samples_fingerprint is \"" + *model.samples_fingerprint +
                       "\"; it must be 16 hexadecimal digits in lower case");
  }
  if (model.pressing_offsets) check_offsets(*model.pressing_offsets);
  if (model.surface_weights.contacts.cols() > 0) check_weights(model);
  if (model.triangles.cols() > 0 || model.surface_weights.contacts.cols() == 0) {
    geometry::check_mesh(contact_mesh(model), "the model's triangles of contacts");
  }
  if (!is_rotation(model.T_surface_acquisition.linear(), kFrameTolerance) ||
      !model.T_surface_acquisition.translation().allFinite()) {
    throw InvalidInput("the model's registration must be a rotation and a finite translation");
  }
}

bool has_unknown_friction(const ContactModel& contact) {
  return contact.friction_source == FrictionSource::none && contact.friction == 0;
}

int unknown_friction_count(const Model& model) {
  return static_cast<int>(
      std::count_if(model.contacts.begin(), model.contacts.end(), has_unknown_friction));
}

Eigen::Matrix3d pressing_frame(const ContactModel& contact) {
  if (!contact.compliance) return contact.frame;
  return contact.frame * rotation_between(Eigen::Vector3d::UnitZ(), contact.compliance->direction);
}

geometry::SurfaceWeights vertex_weights(const Model& model) {
  if (model.surface_weights.contacts.cols() > 0) return model.surface_weights;
  return geometry::project_weights(model.surface, contact_mesh(model));
}

geometry::TriangleMesh contact_mesh(const Model& model) {
  geometry::TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(model.contacts.size()));
  for (std::size_t i = 0; i < model.contacts.size(); ++i) {
    mesh.vertices.col(static_cast<Eigen::Index>(i)) = model.contacts[i].position;
  }
  mesh.triangles = model.triangles;
  return mesh;
}

}  // namespace palpate::haptics
