// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "model/field_document.h"
#include "palpate/haptics/contact_compliance.h"
#include "palpate/haptics/rounding.h"
#include "sheet_model.h"

namespace palpate::haptics {

/// Everything but the surface and its weights.
inline void expect_same_document(const Model& left, const Model& right) {
  EXPECT_EQ(left.triangles, right.triangles);
  EXPECT_EQ(left.triangulation, right.triangulation);
  EXPECT_EQ(left.samples_fingerprint, right.samples_fingerprint);
  EXPECT_EQ(left.pressing_offsets, right.pressing_offsets);
  EXPECT_EQ(left.made, right.made);
  EXPECT_EQ(left.interpolation, right.interpolation);
  EXPECT_EQ(left.probe_radius, right.probe_radius);
  EXPECT_EQ(left.friction_force, right.friction_force);
  EXPECT_EQ(left.rate, right.rate);
  EXPECT_EQ(left.noise, right.noise);
  EXPECT_EQ(left.T_surface_acquisition.matrix(), right.T_surface_acquisition.matrix());
  ASSERT_EQ(left.contacts.size(), right.contacts.size());
  for (std::size_t i = 0; i < left.contacts.size(); ++i) {
    const ContactModel &l = left.contacts[i], &r = right.contacts[i];
    EXPECT_EQ(l.id, r.id);
    EXPECT_EQ(l.position, r.position);
    EXPECT_EQ(l.frame, r.frame);
    EXPECT_EQ(l.field, r.field);
    EXPECT_EQ(l.friction, r.friction);
    EXPECT_EQ(l.load_exponent, r.load_exponent);
    EXPECT_EQ(l.friction_source, r.friction_source);
    EXPECT_EQ(l.friction_axis, r.friction_axis);
    EXPECT_EQ(l.friction_error, r.friction_error);
    EXPECT_EQ(l.friction_lower_bound, r.friction_lower_bound);
    EXPECT_EQ(l.samples, r.samples);
    EXPECT_EQ(l.rms, r.rms);
    EXPECT_EQ(l.fit_stop, r.fit_stop);
    EXPECT_EQ(l.fit_mode, r.fit_mode);
    EXPECT_EQ(l.shared_local, r.shared_local);
    EXPECT_EQ(l.passivity, r.passivity);
    EXPECT_EQ(l.chi2, r.chi2);
    EXPECT_EQ(l.noise_floor, r.noise_floor);
    EXPECT_EQ(l.condition, r.condition);
    EXPECT_EQ(l.compliance, r.compliance);
    EXPECT_EQ(l.strength, r.strength);
    EXPECT_EQ(l.uncertainty, r.uncertainty);
  }
}

inline void expect_same(const Model& left, const Model& right) {
  EXPECT_EQ(left.surface.vertices, right.surface.vertices);
  EXPECT_EQ(left.surface.triangles, right.surface.triangles);
  EXPECT_EQ(left.surface_weights.contacts, right.surface_weights.contacts);
  EXPECT_EQ(left.surface_weights.weights, right.surface_weights.weights);
  expect_same_document(left, right);
}

/// A model of awkward numbers, rounded as it is stored, in which every member differs from its
/// default somewhere.
inline Model some_model() {
  Model model = moved(uneven_model(), some_motion());
  model.T_surface_acquisition = some_motion();
  model.probe_radius = 2.5;
  model.contacts[1].friction_source = FrictionSource::other_contacts;
  model.contacts[1].friction_error = 0.0123;
  model.contacts[2].friction_source = FrictionSource::lower_bound;
  model.contacts[0].friction_lower_bound = 0.39;
  model.contacts[1].load_exponent = -0.0912;
  model.friction_force = 1.37;
  model.rate = rounded(std::vector<RateTerm>{{0.31, 0.0721}, {0.22, 1.0 / 3}});
  model.contacts[1].fit_mode = FitMode::certified;
  model.contacts[1].shared_local = true;
  model.contacts[2].passivity = Passivity::undecided;
  model.contacts[3].chi2 = 1.3;
  model.contacts[0].noise_floor = 0.017;
  model.contacts[1].condition = 1e5 / 3;
  model.contacts[1].uncertainty = ContactUncertainty{0.01 / 3, 0.02 / 3, 0.4, 1e-4 / 3};
  model.noise = MeasurementNoise{0.0123, 0.02};
  model.triangulation = geometry::ContactTriangulationMethod::voronoi_dual;
  model.samples_fingerprint = "0123456789abcdef";
  model.pressing_offsets = PressingOffsets{.force_found = true,
                                           .touch_found = true,
                                           .force = {0.1 / 3, -0.0, 0.2 / 3},
                                           .force_error = {0.01 / 3, 0.02, 1e-3 / 7},
                                           .along_direction = true,
                                           .touch = -0.19 / 3,
                                           .touch_error = 0.004 / 3,
                                           .touch_spread = 0.06 / 7,
                                           .height_slope = 2.9 / 3,
                                           .height_slope_error = 0.1 / 3,
                                           .hysteresis = -0.2 / 3,
                                           .hysteresis_error = 0.02 / 3};
  model.contacts[2].field = {};
  model.contacts[3].field.bases[0].weight = -0.0;
  for (ContactModel& contact : model.contacts) contact = rounded(std::move(contact));
  model.surface_weights = geometry::project_weights(model.surface, contact_mesh(model));
  return with_compliances(std::move(model), 1.9);
}

inline std::string field_document(const Model& model, ModelEncoding encoding) {
  std::ostringstream stream;
  write_field_document(stream, model, encoding);
  return stream.str();
}

}  // namespace palpate::haptics
