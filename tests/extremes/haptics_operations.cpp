// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "operations.h"
#include "palpate.h"
#include "palpate/core/error.h"
#include "palpate/devices/safety_filter.h"
#include "palpate/geometry/surface_map.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/build_model.h"
#include "palpate/haptics/contact_compliance.h"
#include "palpate/haptics/deformed_shape.h"
#include "palpate/haptics/evaluate.h"
#include "palpate/haptics/force_field_fit.h"
#include "palpate/haptics/friction_cone.h"
#include "palpate/haptics/identify.h"
#include "palpate/haptics/merge_models.h"
#include "palpate/haptics/model_bytes.h"
#include "palpate/haptics/passivity_certificate.h"
#include "palpate/haptics/playback.h"
#include "palpate/haptics/reduce_model.h"
#include "palpate/haptics/scale_model.h"
#include "palpate/haptics/transfer_model.h"

namespace palpate::extremes {
namespace {

using namespace haptics;
using Eigen::Vector3d;

/// [relative] to which the models round their numbers, as in their files.
constexpr double kRounded = 1e-5;
/// The same of errors, of which fewer digits count.
constexpr double kRoundedRms = 1e-3;
/// Parameters that an iteration found, which ends where they change little.
constexpr double kFitted = 1e-4;
/// Forces of a field that was fitted with a noise of three digits, and with other bases if it
/// differs.
constexpr double kRoundedNoise = 0.05;
/// Errors of such fields where contacts were left out.
constexpr double kOtherBases = 0.5;

ForceField field_of(const Input& input) {
  const double mm = input.length, newton = input.force;
  return {
      {{3 * newton, 4 * mm, mm * Vector3d(0.3, -0.2, 0.5)},
       {2 * newton, 6 * mm, mm * Vector3d(-0.4, 0.1, 0.2), Vector3d(0.2, 0.1, 1).normalized()}}};
}

Results field(const Input& input, const Change&) {
  const ForceField springs = field_of(input);
  const Eigen::Index count = input.displacements.cols();
  Eigen::Matrix3Xd forces(3, count);
  Eigen::VectorXd energies(count), stiffest(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    forces.col(i) = force(springs, input.displacements.col(i));
    energies[i] = potential(springs, input.displacements.col(i));
    stiffest[i] = stiffness(springs, input.displacements.col(i)).trace();
  }
  // Numbers that are not finite remain so.
  return {unknown_allowed(numbers("energies", energies, kEnergy, &Order::samples)),
          unknown_allowed(numbers("stiffness", stiffest, kStiffness, &Order::samples)),
          {.name = "forces",
           .values = forces,
           .kind = kForce,
           .elements = &Order::samples,
           .may_be_unknown = true}};
}

Results field_fit(const Input& input, FitMode mode) {
  FitOptions options{.mode = mode};
  options.noise = {.displacement = 0.03 * input.length, .force = 0.01 * input.force};
  const FitResult found = fit_force_field(input.displacements, input.forces, options);
  Eigen::Matrix3Xd forces(3, input.displacements.cols());
  for (Eigen::Index i = 0; i < forces.cols(); ++i)
    forces.col(i) = force(found.field, input.displacements.col(i));
  return {{.name = "forces",
           .values = forces,
           .kind = kForce,
           .elements = &Order::samples,
           .tolerance = 1e-2},
          number("noise floor", found.noise_floor, kForce, kRoughly)};
}

Results certificate(const Input& input, const Change&) {
  const PassivityCertificate found =
      certify_passivity(field_of(input), reachable_volume(input.displacements),
                        {.energy_tolerance = 1e-3 * input.length * input.force});
  return {number("passive", is_passive(found) ? 1 : 0),
          number("radius", found.volume.radius, kLength), number("cells", found.cells)};
}

Results friction(const Input& input, const Change&) {
  const FrictionFit found = fit_friction(
      input.trials, Vector3d::UnitZ(),
      {.force_noise = 0.01 * input.force, .prior = {.force_noise = 0.01 * input.force}});
  return {number("coefficient", found.coefficient, kNumber, 1e-6),
          number("error", found.coefficient_error, kNumber, 1e-6),
          number("lower bound", found.lower_bound, kNumber, 1e-6),
          number("noise", found.noise, kForce, 1e-6)};
}

BuildOptions build_options_of(const Input& input) {
  BuildOptions options;
  options.on_surface *= input.length;
  options.max_distance *= input.length;
  options.max_motion *= input.length;
  options.friction.load.force *= input.force;
  options.force_noise = 0.01 * input.force;
  options.fit.noise = {.displacement = 0.03 * input.length, .force = 0.01 * input.force};
  return options;
}

/// Forces of a model at its contacts, by their numbers.
Result forces_at_contacts(const Model& model, const Input& input, double tolerance) {
  const BlendedField blended(model);
  Eigen::Matrix3Xd forces(3, static_cast<Eigen::Index>(model.contacts.size()));
  Eigen::Index i = 0;
  for (const ContactModel& contact : model.contacts) {
    const Vector3d displacement =
        input.length * (contact.frame.col(2) + 0.3 * (input.place.linear() * Vector3d::UnitX()));
    forces.col(i++) = blended.force(contact.position, displacement);
  }
  return vectors("forces", forces, kForce, &Order::contacts, tolerance);
}

Results building(const Input& input, const Change& change) {
  BuildOptions options = build_options_of(input);
  change(fields_of(options));
  const BuildResult found = build_model(input.acquisition, input.sheet, options);
  double rms = 0;
  for (const ContactModel& contact : found.model.contacts) rms = std::max(rms, contact.rms);
  return {stating(forces_at_contacts(found.model, input, kRoundedNoise), rms),
          number("left out", static_cast<double>(found.left_out.size()))};
}

Results compliances(const Input& input, const Change&) {
  const Model model = with_compliances(model_of(input), 1 * input.force);
  return {forces_at_contacts(model, input, 1e-6)};
}

/// A displacement into the sheet at each of the places about it.
Results blending(const Input& input, const Change&) {
  const BlendedField blended(model_of(input));
  Eigen::Matrix3Xd forces(3, input.places.cols());
  const Vector3d displacement = input.place.linear() * (input.length * Vector3d(0.4, -0.2, -1.1));
  for (Eigen::Index i = 0; i < forces.cols(); ++i)
    forces.col(i) = blended.force(input.places.col(i), displacement);
  return {vectors("forces", forces, kForce, &Order::places)};
}

PlaybackOptions playback_options_of(const Input& input) {
  PlaybackOptions options;
  options.longest_step *= input.length;
  return options;
}

Results playing(const Input& input, const Change& change) {
  PlaybackOptions options = playback_options_of(input);
  change(fields_of(options));
  const std::vector<TracePoint> trace = play(Playback(model_of(input), options), input.trajectory);
  Eigen::Matrix3Xd forces(3, static_cast<Eigen::Index>(trace.size()));
  Eigen::VectorXd states(forces.cols());
  for (Eigen::Index i = 0; i < forces.cols(); ++i) {
    forces.col(i) = trace[static_cast<std::size_t>(i)].force;
    states[i] = static_cast<double>(trace[static_cast<std::size_t>(i)].state);
  }
  return {vectors("forces", forces, kForce, nullptr, 1e-3),
          numbers("states", states, kNumber, nullptr, 0.5)};
}

Results device_of_c(const Input& input, const Change&) {
  const std::vector<std::byte> bytes = to_bytes(model_of(input));
  const auto must = [](palpate_status status) {
    if (status == PALPATE_INVALID) throw InvalidInput(palpate_error_text());
    if (status != PALPATE_OK) throw Error(palpate_error_text());
  };
  palpate_model* model = nullptr;
  must(palpate_model_open_bytes(bytes.data(), bytes.size(), &model));
  const PlaybackOptions options = playback_options_of(input);
  const std::string words = fmt::format("longest_step={}", options.longest_step);
  palpate_player* player = nullptr;
  const palpate_status created = palpate_player_create(model, words.c_str(), &player);
  palpate_model_close(model);
  must(created);
  Eigen::Matrix3Xd forces(3, static_cast<Eigen::Index>(input.trajectory.size()));
  for (Eigen::Index i = 0; i < forces.cols(); ++i) {
    palpate_tick tick{};
    tick.struct_size = sizeof tick;
    const Vector3d& tool = input.trajectory[static_cast<std::size_t>(i)].tool;
    must(palpate_player_step(player, tool.data(), 1e-3, &tick));
    forces.col(i) = Eigen::Map<const Vector3d>(tick.force);
  }
  palpate_player_destroy(player);
  return {vectors("forces", forces, kForce, nullptr, 1e-3)};
}

std::vector<Query> queries_of(const Input& input) {
  std::multimap<long long, Vector3d> positions;  // of degenerate input, two of one number
  for (const probing::Contact& contact : input.acquisition.contacts)
    positions.emplace(contact.id, contact.position);
  std::vector<Query> queries;
  for (const probing::Sample& sample : input.acquisition.samples) {
    if (sample.slipped) continue;
    const auto [first, last] = positions.equal_range(sample.contact);
    for (auto at = first; at != last; ++at)
      queries.push_back({at->second, sample.b - at->second, sample.force});
  }
  return queries;
}

Results evaluation(const Input& input, const Change& change) {
  QueryOptions options{.max_distance = 2 * input.length};
  change(fields_of(options));
  const QueryErrors found = evaluate_queries(model_of(input), queries_of(input), options);
  return {number("rms", found.rms, kForce), number("median", found.median, kForce),
          number("p90", found.p90, kForce)};
}

Results left_out(const Input& input, const Change& change) {
  LeaveOneOutOptions options;
  change(fields_of(options));
  const Model model = build_model(input.acquisition, input.sheet, build_options_of(input)).model;
  const LeaveOneOut found = leave_one_out(model, input.acquisition, options);
  return {number("rms", found.rms, kForce, kOtherBases)};
}

Results scaling(const Input& input, const Change&) {
  const ScaledModel found =
      scale_model(model_of(input), {.factor = 2, .forces = ForceScaling::forces});
  return {number("refitted", found.refitted),
          number("rms", found.model.contacts.front().rms, kForce)};
}

Results model_merging(const Input& input, const Change& change) {
  MergeModelsOptions options{.max_distance = 2 * input.length};
  change(fields_of(options));
  const Model side = model_of(input);
  const std::array sides = {SideModel{.model = side, .name = "left"},
                            SideModel{.model = side, .name = "right"}};
  const MergedModel found = merge_models(sides, options);
  return {number("contacts", static_cast<double>(found.model.contacts.size())),
          number("left out", static_cast<double>(found.left_out.size())),
          number("area", static_cast<double>(found.components))};
}

Results transfer(const Input& input, const Change&) {
  const Model model = model_of(input);
  geometry::TriangleMesh target = input.sheet;
  const Vector3d middle = input.place.translation();
  target.vertices = (1.25 * (input.sheet.vertices.colwise() - middle)).colwise() + middle;
  geometry::Landmarks landmarks{Eigen::Matrix3Xd(3, input.contacts.size()),
                                Eigen::Matrix3Xd(3, input.contacts.size())};
  for (Eigen::Index i = 0; i < landmarks.source.cols(); ++i) {
    const geometry::SurfacePoint& at = input.contacts[static_cast<std::size_t>(i)];
    landmarks.source.col(i) = geometry::position(input.sheet, at);
    landmarks.target.col(i) = geometry::position(target, at);
  }
  const geometry::SurfaceMap map = geometry::map_surface(input.sheet, target, landmarks);
  const TransferredModel found = transfer_model(model, target, map);
  return {number("contacts", static_cast<double>(found.model.contacts.size())),
          forces_at_contacts(found.model, input, 1e-4)};
}

Results reduction(const Input& input, const Change& change) {
  ReduceOptions options{.max_error = 0.3 * input.force,
                        .largest_force = 2 * input.force,
                        .largest_depth = 3 * input.length,
                        .strokes = 100};
  change(fields_of(options));
  const ReducedModel found = reduce_model(model_of(input), options);
  return {number("contacts", static_cast<double>(found.model.contacts.size()), kNumber, kRoughly),
          number("largest difference", found.difference.max, kForce, kRoughly),
          number("force", found.force_rms, kForce, kRoughly)};
}

Results identification(const Input& input, const Change& change) {
  IdentifyOptions options{.displacement_noise = 0.03 * input.length,
                          .force_noise = 0.01 * input.force};
  change(fields_of(options));
  const IdentifiedHalfSpace found =
      identify_half_space(input.acquisition, 3 * input.length, options);
  const bool is_sound = found.report.verdict == haptics::Verdict::describes;
  const std::string words = is_sound ? "" : haptics::to_string(found.report.verdict);
  return {saying(number("rms", found.report.rms, kLength, 1e-3), words),
          saying(number("explained", found.report.explained, kNumber, 1e-3), words)};
}

Results strip(const Input& input, const Change& change) {
  IdentifyOptions options{.displacement_noise = 0.03 * input.length,
                          .force_noise = 0.01 * input.force};
  change(fields_of(options));
  const IdentifiedStrip found = identify_strip(input.acquisition, options);
  const bool is_sound = found.report.verdict == haptics::Verdict::describes;
  const std::string words = is_sound ? "" : haptics::to_string(found.report.verdict);
  return {saying(number("rms", found.report.rms, kLength, 1e-3), words),
          saying(number("explained", found.report.explained, kNumber, 1e-3), words)};
}

Results drawing(const Input& input, const Change&) {
  const geometry::SurfacePoint at = contacts_in_order(input).front();
  const Vector3d displacement = input.place.linear() * (input.length * Vector3d(1, 0.5, -3));
  return {places("shape", drawn_shape(input.sheet, at, displacement, {.tip = 3 * input.length}),
                 &Order::sheet_vertices)};
}

Results safety(const Input& input, const Change& change) {
  devices::SafetyOptions options{
      .max_force = 3 * input.force, .slew = 1000 * input.force, .ramp = 0.05};
  change(fields_of(options));
  devices::SafetyFilter filter(options);
  const int ticks = 200 * input.extent * input.extent;
  Eigen::Matrix3Xd forces(3, ticks);
  for (int tick = 0; tick < ticks; ++tick) {
    const double now = 1e-3 * tick, size = 5 * input.force * std::sin(0.05 * tick);
    const devices::SafetyInput wanted{
        .now = now, .state_time = now, .force = size * Vector3d(0.6, 0, 0.8)};
    forces.col(tick) = filter.filter(wanted).force;
  }
  return {numbers("forces", forces.reshaped(), kForce)};
}

}  // namespace

std::vector<Operation> haptics_operations() {
  const auto fit = [](FitMode mode) {
    return [mode](const Input& input, const Change&) { return field_fit(input, mode); };
  };
  return {
      {"ForceField", kSamples, field},
      {"fit_force_field: convex", kSamples, fit(FitMode::convex)},
      {"fit_force_field: certified", kSamples, fit(FitMode::certified), 0, 0, 3, true},
      {"fit_force_field: local", kSamples, fit(FitMode::local), 0, 0, 3, true},
      {"certify_passivity", kSamples, certificate},
      {"fit_friction", kTrials, friction},
      {"build_model", kOptions | kSheet | kAcquisition, building, kRoundedNoise, 1e4, 5},
      {"with_compliances", kSheet | kContacts | kForces, compliances, kRounded, 1e3},
      {"BlendedField", kSheet | kContacts | kPlaces | kForces, blending, 0, 64},
      {"Playback", kOptions | kSheet | kContacts | kTrajectory | kForces, playing, 0, 1e3},
      {"SafetyFilter::filter", kOptions | kForces, safety},
      {"C interface", kSheet | kContacts | kTrajectory | kForces, device_of_c, 0, 1e3},
      {"evaluate_queries", kOptions | kSheet | kContacts | kAcquisition, evaluation, 0, 1e3},
      {"leave_one_out", kOptions | kSheet | kAcquisition, left_out, kOtherBases, 1e4, 5, true},
      {"scale_model", kSheet | kContacts | kForces, scaling, kRoundedRms, 64},
      {"merge_models", kOptions | kSheet | kContacts | kForces, model_merging, 0, 0, 3},
      {"transfer_model", kSheet | kContacts | kForces, transfer, kRounded, 1e4, 3},
      {"reduce_model", kOptions | kSheet | kContacts | kForces, reduction, kRoundedNoise, 1e4, 5,
       true},
      {"identify_half_space", kOptions | kAcquisition, identification, kFitted, 1e4, 3},
      {"identify_strip", kOptions | kAcquisition, strip, kFitted, 1e4, 3, true},
      {"drawn_shape", kSheet | kContacts, drawing, 0, 64},
  };
}

}  // namespace palpate::extremes
