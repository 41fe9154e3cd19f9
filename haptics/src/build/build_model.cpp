// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/build_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "build/build_options.h"
#include "build/contact_cones.h"
#include "build/contact_fields.h"
#include "build/place_contacts.h"
#include "build/pressing_rate.h"
#include "build/pressing_records.h"
#include "build/rule_errors.h"
#include "build/surface_refinement.h"
#include "build/uncertainty.h"
#include "fit/force_noise.h"
#include "fit/pressing_field.h"
#include "palpate/core/error.h"
#include "palpate/core/idle_fields.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/require.h"
#include "palpate/geometry/contact_triangulation.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/contact_compliance.h"
#include "palpate/haptics/contact_strength.h"
#include "palpate/haptics/realignment.h"
#include "palpate/haptics/rotation.h"
#include "palpate/haptics/rounding.h"
#include "palpate/probing/fingerprint.h"
#include "samples/repeated_forces.h"

namespace palpate::haptics {
namespace {

// Indices in the acquisition of the contacts with samples. The others are listed in the result.
std::vector<std::size_t> probed_contacts(const probing::CheckedAcquisition& acquisition,
                                         BuildResult& result) {
  std::vector<std::size_t> source;
  for (std::size_t i = 0; i < acquisition.contacts().size(); ++i) {
    if (acquisition.samples_of(i).empty())
      result.without_samples.push_back(acquisition.contacts()[i].id);
    else
      source.push_back(i);
  }
  if (source.size() < 3) {
    throw wrong_measurements("only " + std::to_string(source.size()) + " of " +
                             std::to_string(acquisition.contacts().size()) +
                             " contacts have samples; at least three are needed");
  }
  return source;
}

// Returns true if the samples of a contact determine its friction cone.
bool is_measured(const FrictionFit& cone, const probing::Contact& contact) {
  return (cone.stop == FrictionStop::converged || cone.stop == FrictionStop::frictionless) &&
         std::isfinite(cone.coefficient_error) && cone.axis.dot(contact.normal) < 0;
}

// The direction of pressing: the axis of the friction cone, or against the normal.
Eigen::Vector3d pressing_direction(const FrictionFit& cone, const probing::Contact& contact) {
  return is_measured(cone, contact) ? cone.axis : Eigen::Vector3d(-contact.normal.normalized());
}

// The directions are still in the frame of the acquisition.
void take_friction(const ContactReport& report, const probing::Contact& contact,
                   ContactModel& model) {
  const FrictionFit& cone = report.friction;
  const FrictionAxisFit& axis = report.friction_axis;
  const bool measured = is_measured(cone, contact);
  model.frame.col(2) = pressing_direction(cone, contact);
  model.friction_source = measured ? FrictionSource::samples : FrictionSource::none;
  model.friction = measured ? cone.coefficient : 0;
  if (measured) model.friction_error = cone.coefficient_error;
  model.friction_lower_bound = cone.lower_bound;
  model.friction_axis = axis.stop == FrictionAxisStop::converged ? *axis.axis : model.frame.col(2);
}

// All x axes are derived from one by the smallest rotation from the mean pressing direction, so
// that neighbours have similar ones.
void choose_frames(Model& model) {
  const Eigen::Matrix3d to_surface = model.T_surface_acquisition.linear();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const ContactModel& contact : model.contacts) mean += contact.frame.col(2);
  // On a closed object the pressing directions may cancel. Then any direction serves.
  if (!(mean.norm() > 0)) mean = model.contacts.front().frame.col(2);
  const Eigen::Matrix3d mean_frame = rotation_between(Eigen::Vector3d::UnitZ(), mean);
  for (ContactModel& contact : model.contacts) {
    contact.frame = to_surface * rotation_between(mean, contact.frame.col(2)) * mean_frame;
    contact.friction_axis = (to_surface * contact.friction_axis).normalized();
    contact = rounded(std::move(contact));
  }
}

// The lower quartile, over the contacts, of the largest force or displacement along the z axis:
// most contacts were measured up to it.
double reference(const std::vector<ForceSamples>& samples,
                 Eigen::Matrix3Xd ForceSamples::*vectors) {
  std::vector<double> largest;
  for (const ForceSamples& of_contact : samples)
    largest.push_back((of_contact.*vectors).row(2).maxCoeff());
  const auto quartile = largest.begin() + static_cast<std::ptrdiff_t>(largest.size() / 4);
  std::ranges::nth_element(largest, quartile);
  return *quartile;
}

// Turns samples from the frame of the acquisition into the local frames of their contacts.
void turn_into_local_frames(std::vector<ForceSamples>& samples, const Model& model) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Eigen::Matrix3d to_local =
        model.contacts[i].frame.transpose() * model.T_surface_acquisition.linear();
    samples[i].displacements = to_local * samples[i].displacements;
    samples[i].forces = to_local * samples[i].forces;
  }
}

Pairs pairs_of(const Probed& probed, const BuildOptions& options) {
  if (is_pressing_only(probed.acquisition, probed.source)) return pressed_pairs(probed, options);
  if (options.rate) {
    throw InvalidInput(std::vector<MessagePart>{
        {"BuildOptions::rate", true},
        {": how forces depend on the rate is fitted to contacts that were only "
         "pressed, with the time of each sample; some of these samples have drags, or "
         "displacements in several directions, and their motion between is not known"}});
  }
  Pairs pairs{.samples = std::vector<ForceSamples>(probed.size())};
  parallel_for(probed.size(), [&](std::size_t i) {
    pairs.samples[i] = realign(probed.contact(i), probed.samples(i));
  });
  return pairs;
}

// [N] Noise of forces, estimated from those that were repeated; 0: they show none.
double repeated_noise(const Probed& probed, const FitOptions& fit) {
  std::vector<RepeatedForce> groups;
  for (std::size_t i = 0; i < probed.size(); ++i) {
    const auto here = repeated_forces(probed.contact(i), probed.samples(i));
    groups.insert(groups.end(), here.begin(), here.end());
  }
  return repeated_force_noise(groups, fit.noise.displacement.value_or(kDisplacementNoise));
}

// The options of the fits with the noise that they take.
struct NoisyOptions {
  FitOptions fit;
  FrictionOptions friction;
  FrictionAxisOptions axis;
};

// Estimates the noise from all contacts, as one tool and one tracker measured them.
NoisyOptions with_noise(const Probed& probed, const Pairs& pairs, const BuildOptions& options) {
  NoisyOptions with{.fit = fit_options(options), .friction = options.friction, .axis = {}};
  FitNoise& noise = with.fit.noise;
  if (!noise.displacement) noise.displacement = pooled_displacement_noise(pairs.samples);
  if (options.force_noise) {
    noise.force = *options.force_noise;
  } else {
    noise.force = pairs.pressing ? pairs.pressing->force_noise
                                 : estimated_force_noise(
                                       pairs.samples, repeated_noise(probed, with.fit), with.fit);
  }
  noise.force = round_to_digits(noise.force, kNoiseDigits);
  if (noise.force > 0) {
    with.friction.steady_error *= noise.force / with.friction.force_noise;
    with.friction.force_noise = noise.force;
  }
  with.axis = {.displacement_noise = noise.displacement.value_or(kDisplacementNoise),
               .force_noise = with.friction.force_noise};
  return with;
}

// The noise that the model states.
MeasurementNoise stated_noise(const Pairs& pairs, const FitOptions& fit) {
  if (!pairs.pressing)
    return {.force = fit.noise.force,
            .displacement = fit.noise.displacement.value_or(kDisplacementNoise)};
  return {.force = pairs.pressing->force_noise,
          .displacement = along_pressing(*pairs.pressing) * pairs.pressing->offsets.touch_spread};
}

// Completes the report of a contact, except its field.
ContactReport with_friction(ContactReport report, const probing::Contact& contact,
                            std::span<const probing::Sample> records, const ForceSamples& samples,
                            const FrictionLoad& load, const FrictionAxisOptions& axis) {
  const std::vector<FrictionTrial> trials = friction_trials(contact, records);
  report.friction_contradictions = contradicting_trials(report.friction, trials, load);
  report.friction_trials = static_cast<int>(trials.size());
  const Eigen::VectorXd forces = samples.forces.colwise().norm();
  report.pairs = static_cast<int>(forces.size());
  report.largest_force = forces.maxCoeff();
  report.force_rms = std::sqrt(forces.squaredNorm() / static_cast<double>(forces.size()));
  report.friction_axis =
      fit_friction_axis(samples, pressing_direction(report.friction, contact), axis);
  return report;
}

// Fits the friction of every contact, in parallel.
void fit_friction(const Probed& probed, const std::vector<ForceSamples>& samples,
                  const NoisyOptions& with, const BuildOptions& options, BuildResult& result) {
  const ContactCones cones = fit_contact_cones(probed.acquisition, probed.source, with.friction);
  result.friction_load = cones.load;
  const FrictionLoad load = cones.load ? cones.load->load : FrictionLoad{};
  if (cones.load) result.model.friction_force = load.force;
  std::mutex reporting;
  int done = 0;
  parallel_for(probed.size(), [&](std::size_t i) {
    ContactReport& report = result.contacts[i];
    report.friction = cones.cones[i];
    report = with_friction(std::move(report), probed.contact(i), probed.samples(i), samples[i],
                           load, with.axis);
    take_friction(report, probed.contact(i), result.model.contacts[i]);
    result.model.contacts[i].load_exponent = load.exponent;
    const std::lock_guard lock(reporting);
    if (options.progress)
      options.progress(BuildStage::friction, ++done, static_cast<int>(probed.size()));
  });
  choose_frames(result.model);
}

struct FittedContacts {
  std::vector<ForceSamples> samples;  ///< in the local frames of the contacts
  double reference_force = 0;         ///< [N]
  double reference_depth = 0;         ///< [mm]
};

// Fits friction and field of every contact.
FittedContacts fit_contacts(const Probed& probed, const BuildOptions& options,
                            BuildResult& result) {
  Pairs pairs = pairs_of(probed, options);
  const NoisyOptions with = with_noise(probed, pairs, options);
  result.model.noise = stated_noise(pairs, with.fit);
  if (pairs.pressing) result.model.pressing_offsets = pairs.pressing->offsets;
  if (pairs.rate) result.model.rate = rounded(pairs.rate->terms);
  result.pressing = std::move(pairs.pressing);
  result.rate = std::move(pairs.rate);
  fit_friction(probed, pairs.samples, with, options, result);
  FittedContacts fitted{.samples = std::move(pairs.samples)};
  turn_into_local_frames(fitted.samples, result.model);
  fitted.reference_force = reference(fitted.samples, &ForceSamples::forces);
  fitted.reference_depth = reference(fitted.samples, &ForceSamples::displacements);
  if (result.pressing)
    take_pressing(fitted.samples, with.fit, result);
  else
    fit_fields(fitted.samples, with.fit, options, result);
  check_usable(result.contacts);
  check_predictions(fitted.samples, result);
  return fitted;
}

// Samples of pressing as the contacts around predict them, which do not know the own touch.
std::vector<ForceSamples> with_expected_touches(std::vector<ForceSamples> samples,
                                                const std::vector<double>& heights,
                                                const PressingEstimate& pressing) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].displacements.row(2).array() +=
        expected_touch(pressing.offsets, heights[i]) - pressing.curves[i].touch;
  }
  return samples;
}

// Takes the model by forces if its predictions are better. Errors of both that differ by less than
// a twentieth do, by chance, for objects that are the same everywhere.
void choose_rule(const std::vector<ForceSamples>& samples, Model by_forces, BuildResult& result) {
  result.rule_errors =
      left_out_errors_of_rules(result.model, by_forces, samples,
                               result.pressing ? Compared::along_pressing : Compared::whole_forces);
  constexpr double kClearlyBetter = 0.95;
  if (!result.rule_errors ||
      result.rule_errors->forces >= kClearlyBetter * result.rule_errors->compliances)
    return;
  result.model = std::move(by_forces);
}

// \param pressed no sample has a tangential stage: lower bounds then come from what is beside the
// normal in forces along it, and friction is unknown.
void fill_in_friction(bool pressed, Model& model) {
  std::vector<double> measured;
  for (const ContactModel& contact : model.contacts) {
    if (contact.friction_source == FrictionSource::samples) measured.push_back(contact.friction);
  }
  const Eigen::Map<const Eigen::ArrayXd> values(measured.data(),
                                                static_cast<Eigen::Index>(measured.size()));
  const double mean = measured.empty() ? 0 : values.mean();
  std::optional<double> scatter;
  if (measured.size() > 1) {
    scatter = std::sqrt((values - mean).square().sum() / static_cast<double>(measured.size() - 1));
  }
  for (ContactModel& contact : model.contacts) {
    if (contact.friction_source == FrictionSource::samples) continue;
    // A contact's own lower bound is a cautious coefficient (thesis 5.4.1).
    const bool bounded = !pressed && contact.friction_lower_bound > mean;
    contact.friction = bounded ? contact.friction_lower_bound : mean;
    contact.friction_error = bounded ? std::nullopt : scatter;
    contact.friction_source = bounded            ? FrictionSource::lower_bound
                              : measured.empty() ? FrictionSource::none
                                                 : FrictionSource::other_contacts;
    contact = rounded(std::move(contact));
  }
}

}  // namespace

const char* to_string(RegistrationOutcome outcome) {
  switch (outcome) {
    case RegistrationOutcome::not_needed:
      return "not_needed";
    case RegistrationOutcome::accepted:
      return "accepted";
    case RegistrationOutcome::too_far:
      return "too_far";
    case RegistrationOutcome::not_converged:
      return "not_converged";
  }
  return "unknown";
}

bool is_usable(const ContactReport& report) {
  return std::isfinite(report.fit.rms) && report.fit.rms <= report.largest_force;
}

double explained_share(const std::vector<ContactReport>& contacts) {
  double error = 0, force = 0;
  for (const ContactReport& contact : contacts) {
    const double pairs = contact.pairs;
    error += pairs * contact.fit.rms * contact.fit.rms;
    force += pairs * contact.force_rms * contact.force_rms;
  }
  return force > 0 ? std::max(0.0, 1 - error / force) : 0;
}

namespace {

struct Built {
  BuildResult result;
  double left_out = 0;  // [N] error of left-out contacts, if all were only pressed
};

Built build_with(const probing::CheckedAcquisition& acquisition,
                 const geometry::TriangleMesh& surface, const BuildOptions& options) {
  Built built;
  BuildResult& result = built.result;
  result.model.samples_fingerprint = probing::fingerprint(acquisition.records());
  result.model.probe_radius = acquisition.records().probe_radius;
  result.model.triangulation = options.triangulation;
  const std::vector<std::size_t> probed = probed_contacts(acquisition, result);
  std::vector<probing::Contact> contacts;
  contacts.reserve(probed.size());
  for (const std::size_t i : probed) contacts.push_back(acquisition.contacts()[i]);
  const geometry::SurfaceQuery query(surface);
  result.model.surface = surface;
  const auto [kept, places] = place_contacts(contacts, query, options, result);
  std::vector<std::size_t> source;
  source.reserve(kept.size());
  for (const std::size_t i : kept) source.push_back(probed[i]);
  contacts.clear();
  for (const std::size_t i : source) contacts.push_back(acquisition.contacts()[i]);

  result.model.contacts.resize(contacts.size());
  result.contacts.resize(contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    result.model.contacts[i].id = result.contacts[i].id = contacts[i].id;
    result.model.contacts[i].position = places[i].position;
    result.contacts[i].distance = places[i].distance;
  }
  Eigen::Matrix3Xd inward(3, static_cast<Eigen::Index>(contacts.size()));
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    inward.col(static_cast<Eigen::Index>(i)) =
        -(result.model.T_surface_acquisition.linear() * contacts[i].normal);
  }
  RefinedSurface refined = refine_surface(inward, result.model);
  result.surface_ends = std::move(refined.ends);
  geometry::ContactTriangulation triangulation = geometry::triangulate_contacts(
      result.model.surface, refined.places, {.method = options.triangulation});
  result.model.triangles = std::move(triangulation.mesh.triangles);
  result.model.surface_weights = std::move(triangulation.weights);
  for (const int i : triangulation.isolated) {
    result.isolated.push_back(contacts[static_cast<std::size_t>(i)].id);
  }
  std::vector<double> heights;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Eigen::Isometry3d& there = result.model.T_surface_acquisition;
    heights.push_back((places[i].position - there * contacts[i].position)
                          .dot(there.linear() * contacts[i].normal.normalized()));
  }
  const Probed found{acquisition, std::move(source), std::move(heights)};
  const auto [samples, pressed, depth] = fit_contacts(found, options, result);
  fill_in_friction(result.pressing.has_value(), result.model);
  const std::vector<ForceSamples> predicted =
      result.pressing ? with_expected_touches(samples, found.heights, *result.pressing) : samples;
  Model by_forces = depth > 0 ? with_strengths(result.model, depth) : result.model;
  if (options.blend_rule != BlendRule::forces && pressed > 0) {
    result.model = with_compliances(std::move(result.model), pressed);
    if (!options.blend_rule) choose_rule(predicted, std::move(by_forces), result);
  } else {
    result.model = std::move(by_forces);
  }
  const MeasurementNoise noise = *result.model.noise;
  result.model = with_uncertainty(std::move(result.model), samples, noise);
  if (result.pressing) built.left_out = left_out_pressing_error(result.model, predicted);
  return built;
}

}  // namespace

BuildResult build_model(const probing::CheckedAcquisition& acquisition,
                        const geometry::TriangleMesh& surface, const BuildOptions& options) {
  static_cast<void>(in_range(options));
  if (options.fit.mode != FitMode::convex)
    refuse_idle(options, "passive", {"try_certified", "compare_always"});
  Built built = build_with(acquisition, surface, options);
  const auto& pressing = built.result.pressing;
  if (!pressing || !(pressing->offsets.force_found || pressing->offsets.touch_found))
    return std::move(built.result);
  BuildOptions plain = options;
  plain.estimate_offsets = false;
  Built without = build_with(acquisition, surface, plain);
  return std::move((without.left_out < built.left_out ? without : built).result);
}

}  // namespace palpate::haptics
