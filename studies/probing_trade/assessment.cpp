// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "assessment.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "palpate/core/parallel_for.h"
#include "palpate/geometry/error_statistics.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/evaluate.h"
#include "palpate/haptics/left_out_contact.h"
#include "palpate/haptics/model_io.h"
#include "palpate/probing/acquisition_store.h"
#include "palpate/probing/specimen_response.h"
#include "scratch_folder.h"

namespace palpate::bench {
namespace {

using Eigen::Vector3d;

constexpr int kTruthsPerContact = 12;

// Forces of the friction cone at a contact, spread as the known forces are.
std::vector<haptics::Query> truths_at(const PreparedObject& object, const Vector3d& place) {
  const probing::FrictionCone cone = object.specimen->friction_cone(place);
  const probing::Contact here{.position = place, .normal = -cone.axis};
  const Eigen::Matrix3d frame = probing::tangent_frame(here);
  std::vector<haptics::Query> truths;
  for (int i = 0; i < kTruthsPerContact; ++i) {
    const double size = object.plan.options.max_force * (i + 0.5) / kTruthsPerContact;
    const double ratio = 0.9 * cone.coefficient * std::sqrt(std::fmod(i * std::numbers::phi, 1.0));
    const double angle = 2 * std::numbers::pi * std::fmod(i * std::numbers::sqrt2, 1.0);
    const Vector3d force =
        size *
        (frame.col(2) + ratio * (std::cos(angle) * frame.col(0) + std::sin(angle) * frame.col(1)))
            .normalized();
    std::string reason;
    const auto moved = probing::response_of(*object.specimen, place, force, reason);
    if (moved) truths.push_back({place, *moved, force});
  }
  return truths;
}

void predict_left_out(const PreparedObject& object, const haptics::Model& model,
                      Assessment& result) {
  const geometry::SurfaceQuery surface(model.surface);
  std::vector<geometry::SurfacePoint> points;
  for (const haptics::ContactModel& contact : model.contacts)
    points.push_back(surface.closest_point(contact.position).at);
  const std::vector<bool> border = haptics::border_contacts(model);
  std::vector<double> sums(model.contacts.size()), counts(model.contacts.size());
  const haptics::LeftOutModels left_out(model, points);
  parallel_for(model.contacts.size(), [&](std::size_t i) {
    const haptics::BlendedField field(left_out.without(i));
    for (const haptics::Query& truth : truths_at(object, model.contacts[i].position)) {
      sums[i] += (field.force(truth.contact, truth.displacement) - truth.force).squaredNorm();
      counts[i] += 1;
    }
  });
  for (const bool at : {false, true}) {
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < sums.size(); ++i) {
      if (border[i] != at) continue;
      sum += sums[i];
      count += counts[i];
    }
    (at ? result.left_out_border : result.left_out_inside) = std::sqrt(sum / count);
  }
}

std::uintmax_t size_of_folder(const std::filesystem::path& folder) {
  std::uintmax_t sum = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) sum += entry.file_size();
  return sum;
}

}  // namespace

Assessment assess(const PreparedObject& object, const probing::Acquisition& acquisition,
                  const haptics::BuildOptions& options, bool left_out) {
  const probing::CheckedAcquisition checked(acquisition);
  const haptics::BuildResult built =
      haptics::build_model(checked, object.specimen->surface(), options);
  Assessment result;
  std::vector<haptics::Query> queries;
  for (const probing::KnownForce& one : object.queries)
    queries.push_back({one.contact, one.displacement, one.force});
  result.error = haptics::evaluate_queries(built.model, queries).rms;
  std::vector<double> friction;
  for (const haptics::ContactModel& contact : built.model.contacts)
    friction.push_back(contact.friction -
                       object.specimen->friction_cone(contact.position).coefficient);
  const geometry::ErrorStatistics frictions = geometry::error_statistics(friction);
  result.friction_median = frictions.median;
  result.friction_p95 = frictions.p95;
  if (left_out) predict_left_out(object, built.model, result);
  const ScratchFolder folder;
  probing::write_acquisition(folder / "acquisition.db", checked);
  haptics::write_model(folder / "model", built.model);
  result.acquisition_bytes = std::filesystem::file_size(folder / "acquisition.db");
  result.model_bytes = size_of_folder(folder / "model");
  return result;
}

}  // namespace palpate::bench
