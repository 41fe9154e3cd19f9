// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/evaluate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "build/pressing_rate.h"
#include "build/pressing_records.h"
#include "build/uncertainty.h"
#include "model/compliance_kriging.h"
#include "model/contact_places.h"
#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/require.h"
#include "palpate/geometry/range_map_score.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/left_out_contact.h"
#include "palpate/haptics/realignment.h"
#include "palpate/probing/csv.h"
#include "palpate/probing/fingerprint.h"

namespace palpate::haptics {
namespace {

// Largest distance between a contact of the acquisition, projected onto the surface, and that of
// the model, relative to the surface's diagonal: surfaces are stored in single precision.
constexpr double kSamePlaceRatio = 1e-5;
// Step of the central difference for the stiffness, relative to the displacement.
constexpr double kStepRatio = 1e-3;
// Largest number of vertices, evenly selected, that are candidates for suggested contacts.
constexpr Eigen::Index kMaxCandidates = 4000;
// Largest distance of suggested contacts from the contacts' triangles, relative to the spacing of
// contacts. Further out the object may be held, and errors grow with the distance anyway.
constexpr double kMaxBeyond = 0.5;

void check_same_samples(const Model& model, const probing::CheckedAcquisition& acquisition) {
  const std::optional<std::string>& fitted_to = model.samples_fingerprint;
  if (!fitted_to) {
    throw InvalidInput(
        "leave_one_out(): the model does not say which samples it was fitted to; a model that was "
        "scaled, transferred or merged was fitted to none. Pass the model as it was fitted");
  }
  const std::string given = probing::fingerprint(acquisition.records());
  if (*fitted_to == given) return;
  throw InvalidInput("leave_one_out(): the acquisition holds other samples (fingerprint " + given +
                     ") than the model was made of (" + *fitted_to +
                     "): errors of prediction and of another measurement would be mixed up. Pass "
                     "the acquisition that the model was made of, or fit it to this one");
}

// Takes off what the rate adds to the forces, by the contact's own field: those that stay are
// predicted. `samples` are in the frame of the acquisition.
void take_off_rate(const ContactModel& contact, const Model& model,
                   const probing::Contact& measured, std::span<const probing::Sample> records,
                   ForceSamples& samples) {
  if (model.rate.empty()) return;
  const Eigen::Matrix3d to_local = contact.frame.transpose() * model.T_surface_acquisition.linear();
  samples.forces -=
      to_local.transpose() * pressed_rate_forces(model.rate, contact.field, contact.id, records,
                                                 to_local * samples.displacements,
                                                 -(to_local * measured.normal).normalized());
}

// The realigned samples of a contact of the model, in the frame of the surface. Displacements are
// relative to the measured contact.
ForceSamples samples_of(const ContactModel& contact, const Model& model,
                        const probing::CheckedAcquisition& acquisition,
                        const geometry::SurfaceQuery& surface) {
  const std::optional<std::size_t> source = acquisition.find(contact.id);
  if (!source || acquisition.samples_of(*source).empty()) {
    throw InvalidInput("leave_one_out(): contact " + std::to_string(contact.id) +
                       " of the model has no samples in the acquisition; pass the acquisition "
                       "that the model was made of");
  }
  const probing::Contact& measured = acquisition.contacts()[*source];
  const Eigen::Vector3d there = model.T_surface_acquisition * measured.position;
  const double distance = (surface.closest_point(there).position - contact.position).norm();
  if (!(distance <= kSamePlaceRatio * geometry::bounding_diagonal(model.surface))) {
    throw InvalidInput(
        fmt::format("leave_one_out(): contact {} of the acquisition lies {:g} mm along the surface "
                    "from that of the model; pass the acquisition that the model was made of",
                    contact.id, distance));
  }
  ForceSamples samples;
  if (const std::optional<PressingOffsets>& offsets = model.pressing_offsets) {
    const double height =
        (contact.position - there).dot(model.T_surface_acquisition.linear() * measured.normal);
    samples = corrected(pressed_contact(measured, acquisition.samples_of(*source), height),
                        *offsets, expected_touch(*offsets, height));
  } else {
    samples = realign(measured, acquisition.samples_of(*source));
  }
  const Eigen::Matrix3d rotation = model.T_surface_acquisition.linear();
  take_off_rate(contact, model, measured, acquisition.samples_of(*source), samples);
  samples.displacements = rotation * samples.displacements;
  samples.forces = rotation * samples.forces;
  return samples;
}

// [N] Standard deviation of the normal force at the reference displacement at a place.
std::optional<double> expected_error(const BlendedField& field, BlendRule rule, const Blend& at,
                                     const Surroundings& around, const Covariance& covariance) {
  if (around.contacts.empty()) return std::nullopt;
  const KrigingPrediction predicted = predict_compliance(around, covariance);
  if (rule == BlendRule::forces) return covariance.amplitude(2) * std::sqrt(predicted.variance);
  const Eigen::Vector3d displacement = at.field_frame * predicted.value.head<3>();
  const Eigen::Vector3d step = kStepRatio * predicted.value(2) * at.field_frame.col(2);
  const double change =
      (field.force(at, displacement + step) - field.force(at, displacement - step))
          .dot(at.field_frame.col(2));
  const double stiffness = change / (2 * step.norm());
  return covariance.amplitude(2) * std::sqrt(predicted.variance) * std::abs(stiffness);
}

// Sums of products of a model's forces and known ones.
struct ForceSums {
  double model = 0, product = 0, known = 0;  // [N^2]

  void add(const Eigen::Vector3d& model_force, const Eigen::Vector3d& known_force) {
    model += model_force.squaredNorm();
    product += model_force.dot(known_force);
    known += known_force.squaredNorm();
  }
  void explain(QueryErrors& errors) const {
    if (!(known > 0)) return;
    errors.explained = (2 * product - model) / known;
    if (!(model > 0)) return;
    errors.scale = product / model;
    errors.explained_if_scaled = product * product / (model * known);
  }
};

// Sums of squared errors, as stated and relative to that.
struct StatedSums {
  double stated = 0, relative = 0, count = 0;

  void add(double error, double deviation) {
    stated += deviation * deviation;
    // If no error is stated, the actual one must be zero.
    relative += error > 0 ? error * error / (deviation * deviation) : 0;
    ++count;
  }
  [[nodiscard]] std::optional<StatedErrors> errors() const {
    if (!(count > 0)) return std::nullopt;
    return StatedErrors{std::sqrt(stated / count), std::sqrt(relative / count)};
  }
};

ContactError predict_contact(const BlendedField& field, const Blend& at,
                             const Eigen::Vector3d& place,
                             const std::optional<MeasurementNoise>& noise,
                             const ForceSamples& samples) {
  std::vector<double> errors;
  StatedSums stated;
  double spread = 0;
  for (Eigen::Index s = 0; s < samples.forces.cols(); ++s) {
    const Eigen::Vector3d displacement = samples.displacements.col(s);
    const Eigen::Vector3d force = field.force(at, displacement);
    errors.push_back((force - samples.forces.col(s)).norm());
    const std::optional<double> deviation = field.deviation(place, displacement);
    if (deviation && noise) {
      stated.add(errors.back(),
                 std::sqrt(*deviation * *deviation +
                           noise_variance(*noise, field.stiffness(at, displacement))));
    }
    for (std::size_t k = 0; k < static_cast<std::size_t>(at.contacts.count); ++k) {
      Blend alone = at;
      alone.contacts.count = 1;
      alone.contacts.contacts[0] = at.contacts.contacts[k];
      alone.contacts.weights[0] = 1;
      alone.warps[0] = at.warps[k];
      spread += at.contacts.weights[k] * (field.force(alone, displacement) - force).squaredNorm();
    }
  }
  const geometry::ErrorStatistics statistics = geometry::error_statistics(std::move(errors));
  ContactError error;
  error.rms = statistics.rms;
  error.samples = static_cast<int>(statistics.count);
  error.spread = std::sqrt(spread / static_cast<double>(samples.forces.cols()));
  error.stated = stated.errors();
  return error;
}

// RMS of the errors that count; nullopt if there are none.
std::optional<double> pooled_rms(const std::vector<ContactError>& errors,
                                 const std::vector<bool>& counts) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    if (!counts[i]) continue;
    sum += errors[i].rms * errors[i].rms * errors[i].samples;
    count += errors[i].samples;
  }
  return count > 0 ? std::optional(std::sqrt(sum / count)) : std::nullopt;
}

std::optional<StatedErrors> pooled_stated(const std::vector<ContactError>& errors) {
  double squares = 0, relative = 0, count = 0;
  for (const ContactError& error : errors) {
    if (!error.stated) continue;
    squares += error.samples * error.stated->rms * error.stated->rms;
    relative += error.samples * error.stated->ratio * error.stated->ratio;
    count += error.samples;
  }
  if (!(count > 0)) return std::nullopt;
  return StatedErrors{std::sqrt(squares / count), std::sqrt(relative / count)};
}

// Ratio of measured to expected errors.
double expectation_scale(const std::vector<ContactError>& errors) {
  double measured = 0, expected = 0;
  for (const ContactError& error : errors) {
    if (!error.expected || !(*error.expected > 0)) continue;
    measured += error.rms * error.rms;
    expected += *error.expected * *error.expected;
  }
  return expected > 0 ? std::sqrt(measured / expected) : 1;
}

std::vector<SuggestedContact> suggest_contacts(const Model& model, const ComplianceKriging& kriging,
                                               double scale, int count) {
  if (model.triangles.cols() == 0) return {};
  const BlendedField field(model);
  const geometry::SurfaceQuery triangles(contact_mesh(model));
  const geometry::TriangleMesh& surface = model.surface;
  const Eigen::Index stride = (surface.vertices.cols() + kMaxCandidates - 1) / kMaxCandidates;
  std::vector<SuggestedContact> candidates(
      static_cast<std::size_t>((surface.vertices.cols() + stride - 1) / stride));
  parallel_for(candidates.size(), [&](std::size_t i) {
    const Eigen::Vector3d place = surface.vertices.col(stride * static_cast<Eigen::Index>(i));
    if (triangles.closest_point(place).distance > kMaxBeyond * kriging.spacing) return;
    const Blend at = field.blend(place);
    const std::vector<int> from(at.contacts.contacts.begin(),
                                at.contacts.contacts.begin() + at.contacts.count);
    const Surroundings around =
        surroundings(model, kriging.neighbours, from, place, at.field_frame, -1);
    const std::optional<double> error =
        expected_error(field, model.interpolation.rule, at, around, kriging.covariance);
    candidates[i] = {place, scale * error.value_or(0)};
  });
  std::erase_if(candidates, [](const SuggestedContact& c) { return !(c.expected > 0); });
  std::ranges::stable_sort(candidates, std::greater{}, &SuggestedContact::expected);
  std::vector<SuggestedContact> chosen;
  const auto is_near = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return (a - b).norm() < kriging.spacing / 2;
  };
  for (const SuggestedContact& candidate : candidates) {
    if (static_cast<int>(chosen.size()) >= count) break;
    const auto close_to = [&](const auto& other) {
      return is_near(other.position, candidate.position);
    };
    if (std::ranges::none_of(chosen, close_to) && std::ranges::none_of(model.contacts, close_to))
      chosen.push_back(candidate);
  }
  return chosen;
}

InvalidInput wrong_queries(const std::string& problem) {
  return InvalidInput(std::vector<MessagePart>{{"evaluate_queries()", true}, {": " + problem}});
}

}  // namespace

std::vector<Query> read_queries(const std::filesystem::path& path) {
  constexpr std::array<std::string_view, 9> kColumns = {"cx", "cy", "cz", "dx", "dy",
                                                        "dz", "fx", "fy", "fz"};
  probing::CsvReader row(path, kColumns);
  std::vector<Query> queries;
  while (row.next()) queries.push_back({row.vector(0), row.vector(3), row.vector(6)});
  if (queries.empty()) {
    throw FileError(path.string() +
                    ": there is no line of numbers below the column names; at least one is needed");
  }
  return queries;
}

void visit(QueryOptions& options, FieldVisitor& visitor) {
  visitor.begin("QueryOptions");
  visitor.real({"max_distance", "Refuse queries that are farther from the surface", "mm"},
               options.max_distance, at_least(0));
}

QueryErrors evaluate_queries(const Model& model, std::span<const Query> queries,
                             const QueryOptions& given) {
  const QueryOptions options = in_range(given);
  if (queries.empty()) throw wrong_queries("there is no query; pass at least one");
  const BlendedField field(model);
  std::vector<double> errors;
  StatedSums stated;
  ForceSums forces;
  const auto name_of = [&](std::size_t i) {
    return "query " + std::to_string(i + 1) + " of " + std::to_string(queries.size());
  };
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Query& query = queries[i];
    if (!query.contact.allFinite() || !query.displacement.allFinite() || !query.force.allFinite())
      throw wrong_queries(name_of(i) + " is not finite; leave it out");
    const double distance = field.surface().closest_point(query.contact).distance;
    if (!(distance <= options.max_distance)) {
      throw wrong_queries(
          fmt::format("the contact of {} is {:g} mm from the surface; at most {:g} mm are allowed. "
                      "Check that queries and model are in one frame",
                      name_of(i), distance, options.max_distance));
    }
    const Eigen::Vector3d force = field.force(query.contact, query.displacement);
    errors.push_back((force - query.force).norm());
    forces.add(force, query.force);
    if (const auto deviation = field.deviation(query.contact, query.displacement))
      stated.add(errors.back(), *deviation);
    if (!std::isfinite(errors.back()))
      throw SolverError("evaluate_queries(): the model's force at " + name_of(i) +
                        " is not finite; the model is broken");
  }
  const geometry::ErrorStatistics statistics = geometry::error_statistics(std::move(errors));
  QueryErrors result{static_cast<int>(statistics.count), statistics.rms, statistics.median,
                     statistics.p90, stated.errors()};
  forces.explain(result);
  return result;
}

void visit(LeaveOneOutOptions& options, FieldVisitor& visitor) {
  visitor.begin("LeaveOneOutOptions");
  visitor.whole({"suggestions",
                 "Number of positions for further contacts to suggest, where the expected error is "
                 "largest"},
                options.suggestions, at_least(0));
}

LeaveOneOut leave_one_out(const Model& model, const probing::CheckedAcquisition& acquisition,
                          const LeaveOneOutOptions& given) {
  const LeaveOneOutOptions options = in_range(given);
  check_model(model);
  if (model.contacts.size() < 4) {
    throw InvalidInput(
        "leave_one_out(): the model has three contacts; without one of them nothing is left "
        "to interpolate, at least four are needed");
  }
  check_same_samples(model, acquisition);
  const geometry::SurfaceQuery query(model.surface);
  std::vector<ForceSamples> samples;
  for (const ContactModel& contact : model.contacts)
    samples.push_back(samples_of(contact, model, acquisition, query));
  const ComplianceKriging kriging = learn_kriging(model);
  std::vector<bool> at_border = border_contacts(model);
  const LeftOutModels left_out(model, contact_places(model, query));
  LeaveOneOut result;
  result.per_contact.resize(model.contacts.size());
  std::mutex reporting;
  int done = 0;
  parallel_for(model.contacts.size(), [&](std::size_t i) {
    const ContactModel& contact = model.contacts[i];
    const BlendedField field(left_out.without(i));
    const Blend at = field.blend(contact.position);
    ContactError& error = result.per_contact[i];
    error = predict_contact(field, at, contact.position, model.noise, samples[i]);
    error.contact = contact.id;
    error.at_border = at_border[i];
    const auto index = static_cast<int>(i);
    error.expected = expected_error(
        field, model.interpolation.rule, at,
        surroundings(model, kriging.neighbours, {index}, contact.position, at.field_frame, index),
        kriging.covariance);
    if (!options.progress) return;
    const std::lock_guard lock(reporting);
    options.progress(++done, static_cast<int>(model.contacts.size()));
  });
  result.rms = *pooled_rms(result.per_contact, std::vector<bool>(at_border.size(), true));
  result.border_rms = pooled_rms(result.per_contact, at_border);
  result.stated = pooled_stated(result.per_contact);
  at_border.flip();
  result.interior_rms = pooled_rms(result.per_contact, at_border);
  if (options.suggestions > 0) {
    result.suggested = suggest_contacts(model, kriging, expectation_scale(result.per_contact),
                                        options.suggestions);
  }
  return result;
}

}  // namespace palpate::haptics
