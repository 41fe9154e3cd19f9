// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/model_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "palpate/geometry/contact_triangulation.h"
#include "palpate/haptics/realignment.h"
#include "palpate/pictures/draw_contacts.h"
#include "palpate/pictures/draw_distances.h"
#include "palpate/pictures/draw_force_field.h"
#include "palpate/pictures/draw_forces.h"
#include "shared/words.h"

namespace palpate::apps {

namespace {

std::string if_known(std::optional<double> force) { return force ? newtons(*force, 3) : "unknown"; }

}  // namespace

std::vector<std::size_t> contacts_by_error(const haptics::Model& model) {
  std::vector<std::size_t> order(model.contacts.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return model.contacts[a].rms < model.contacts[b].rms;
  });
  return order;
}

std::size_t median_contact(const haptics::Model& model) {
  return contacts_by_error(model)[model.contacts.size() / 2];
}

void draw_model_contacts(const fs::path& png, const haptics::Model& model,
                         const std::string& title) {
  // Each vertex belongs to the contact with the largest weight there.
  const geometry::TriangleMesh contacts = haptics::contact_mesh(model);
  const geometry::SurfaceWeights weights = haptics::vertex_weights(model);
  std::vector<long long> ids;
  for (const haptics::ContactModel& contact : model.contacts) ids.push_back(contact.id);
  pictures::draw_contacts(png, model.surface, weights.contacts.row(0).transpose(), contacts, ids,
                          title);
}

void draw_contact_field(const fs::path& png, const haptics::Model& model,
                        const probing::CheckedAcquisition& acquisition, std::size_t contact) {
  const haptics::ContactModel& fitted = model.contacts.at(contact);
  const std::size_t source = acquisition.find(fitted.id).value();
  const haptics::ForceSamples held =
      haptics::realign(acquisition.contacts()[source], acquisition.samples_of(source));
  std::vector<bool> on_boundary;
  for (const haptics::PairKind kind : held.kinds)
    on_boundary.push_back(kind == haptics::PairKind::friction_boundary);

  const Eigen::Matrix3d to_local = fitted.frame.transpose() * model.T_surface_acquisition.linear();
  pictures::draw_force_field(
      png,
      {.displacements = to_local * held.displacements,
       .forces = to_local * held.forces,
       .on_boundary = on_boundary},
      {.field =
           [&](const Eigen::Vector3d& displacement) {
             return haptics::force(fitted.field, displacement);
           },
       .friction_axis = Eigen::Vector3d::UnitZ(),
       .friction_coefficient = fitted.friction},
      fmt::format("Contact {}: measured and fitted forces, RMS {}, friction coefficient {}",
                  fitted.id, newtons(fitted.rms, 3),
                  haptics::has_unknown_friction(fitted) ? "unknown"
                                                        : fmt::format("{:.2f}", fitted.friction)));
}

void draw_leave_one_out(const fs::path& png, const haptics::Model& model,
                        const haptics::LeaveOneOut& errors) {
  const geometry::SurfaceWeights weights = haptics::vertex_weights(model);
  Eigen::VectorXd at_vertices(weights.contacts.cols());
  for (Eigen::Index v = 0; v < at_vertices.size(); ++v) {
    at_vertices(v) = weights.contacts(0, v) < 0 ? std::nan("") : 0;
    for (int k = 0; k < 3 && weights.contacts(k, v) >= 0; ++k) {
      const auto contact = static_cast<std::size_t>(weights.contacts(k, v));
      at_vertices(v) += weights.weights(k, v) * errors.per_contact[contact].rms;
    }
  }
  Eigen::VectorXd of_triangles(model.surface.triangles.cols());
  for (Eigen::Index t = 0; t < of_triangles.size(); ++t) {
    of_triangles(t) = at_vertices(model.surface.triangles.col(t)).mean();
  }
  double largest = 0;
  for (const haptics::ContactError& error : errors.per_contact)
    largest = std::max(largest, error.rms);
  pictures::draw_distances(
      png, model.surface, of_triangles,
      {.title = "Contacts predicted without themselves",
       .subtitle = fmt::format("RMS {}; inside {}, at the border {}", newtons(errors.rms, 3),
                               if_known(errors.interior_rms), if_known(errors.border_rms)),
       .limit = largest > 0 ? largest : 1,
       .scale = "RMS of the force error (N)",
       .one_sided = true});
}

void draw_trace(const fs::path& png, std::span<const haptics::TracePoint> trace,
                const std::string& title) {
  const auto count = static_cast<Eigen::Index>(trace.size());
  Eigen::VectorXd times(count);
  Eigen::Matrix3Xd forces(3, count);
  Eigen::VectorXi states(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const haptics::TracePoint& point = trace[static_cast<std::size_t>(i)];
    times(i) = point.time;
    forces.col(i) = point.force;
    states(i) = static_cast<int>(point.state);
  }
  pictures::draw_forces(png, times, forces, states, title);
}

}  // namespace palpate::apps
