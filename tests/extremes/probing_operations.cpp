// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <memory>

#include "operations.h"
#include "palpate/probing/campaign.h"
#include "palpate/probing/campaign_options.h"
#include "palpate/probing/closed_form.h"
#include "palpate/probing/cone_posterior.h"
#include "palpate/probing/contact_plan.h"
#include "palpate/probing/contact_surface.h"
#include "palpate/probing/force_surrogate.h"
#include "palpate/probing/known_forces.h"
#include "palpate/probing/probing_program.h"
#include "palpate/probing/quasi_static_arm.h"
#include "palpate/probing/slip_detection.h"
#include "palpate/probing/specimen_trials.h"
#include "palpate/probing/touch_placement.h"

namespace palpate::extremes {
namespace {

using namespace probing;
using Eigen::Vector3d;

PlanOptions plan_options_of(const Input& input) {
  const double mm = input.length, newton = input.force;
  PlanOptions options{.spacing = 25 * mm,
                      .tip_radius = 3 * mm,
                      .border = 1.5 * mm,
                      .sensor = input.place * Vector3d(42 * mm, 30 * mm, 300 * mm),
                      .lowest_force = 0.15 * newton,
                      .levels = 2,
                      .directions = 3,
                      .max_force = 3 * newton};
  return options;
}

Results planning(const Input& input, const Change& change) {
  PlanOptions options = plan_options_of(input);
  change(fields_of(options));
  const ContactPlan plan = plan_contacts(input.sheet, options);
  Eigen::VectorXd forces(static_cast<Eigen::Index>(plan.normal_forces.size()));
  std::copy(plan.normal_forces.begin(), plan.normal_forces.end(), forces.begin());
  return {number("contacts", static_cast<double>(plan.contacts.size())),
          number("excluded", static_cast<double>(plan.excluded.size())),
          number("cover", plan.cover, kLength), numbers("forces", forces, kForce)};
}

/// An elastic half space, of which closed forms are known, in the units of the input.
ElasticBody body_of(const Input& input) {
  ElasticBody body;
  body.young_modulus *= input.force / (input.length * input.length);
  body.tool_radius *= input.length;
  body.size *= input.extent * input.length;
  return body;
}

ContactPlan plan_of(const Specimen& specimen, const Input& input) {
  PlanOptions options = plan_options_of(input);
  options.spacing = 45 * input.length;
  options.max_force = 1 * input.force;
  options.sensor = Vector3d(0, 0, 300 * input.length);
  // The half space has its own frame, in which it is seen from the side that is touched.
  const Eigen::Matrix3Xd normals = geometry::triangle_normals(specimen.surface());
  if (normals.col(0).z() < 0) options.sensor.z() *= -1;
  return plan_contacts(specimen.surface(), options);
}

Results trials(const Input& input, const Change&) {
  const std::unique_ptr<Specimen> specimen = make_specimen(body_of(input));
  const SpecimenTrials found = try_specimen(*specimen, plan_of(*specimen, input));
  Eigen::Matrix3Xd tools(3, static_cast<Eigen::Index>(found.acquisition.samples.size()));
  Eigen::Matrix3Xd forces = tools;
  for (Eigen::Index i = 0; i < tools.cols(); ++i) {
    tools.col(i) = found.acquisition.samples[static_cast<std::size_t>(i)].b;
    forces.col(i) = found.acquisition.samples[static_cast<std::size_t>(i)].force;
  }
  return {numbers("tools", tools.reshaped(), kLength),
          numbers("forces", forces.reshaped(), kForce)};
}

Results truth(const Input& input, const Change& change) {
  const std::unique_ptr<Specimen> specimen = make_specimen(body_of(input));
  KnownForceOptions options{.queries = 30 * input.extent * input.extent,
                            .margin = 8 * input.length,
                            .least_force = 0.1 * input.force,
                            .max_force = 1 * input.force};
  change(fields_of(options));
  const KnownForces found = known_forces(*specimen, options);
  Eigen::Matrix3Xd displacements(3, static_cast<Eigen::Index>(found.forces.size()));
  for (Eigen::Index i = 0; i < displacements.cols(); ++i)
    displacements.col(i) = found.forces[static_cast<std::size_t>(i)].displacement;
  return {number("known", static_cast<double>(displacements.cols())),
          numbers("displacements", displacements.reshaped(), kLength)};
}

Results surface_of_contacts(const Input& input, const Change& change) {
  ContactSurfaceOptions options{.tip_radius = 1.5 * input.length};
  change(fields_of(options));
  const ContactSurface found = contact_surface(input.acquisition.contacts, options);
  return {number("contacts", static_cast<double>(found.kept.size())),
          number("triangles", static_cast<double>(found.mesh.triangles.cols()))};
}

Results checked(const Input& input, const Change&) {
  const CheckedAcquisition found(input.acquisition);
  return {number("samples", static_cast<double>(found.samples().size())),
          number("of the first", static_cast<double>(found.samples_of(0).size()))};
}

Results slip(const Input& input, const Change&) {
  const SlipOptions options{.position_deviation = 0.02 * input.length,
                            .force_deviation = 0.005 * input.force};
  std::map<long long, const Contact*> contacts;  // in another order than their numbers
  for (const Contact& contact : input.acquisition.contacts) contacts[contact.id] = &contact;
  double slipped = 0;
  Eigen::VectorXd tests(static_cast<Eigen::Index>(input.acquisition.samples.size()));
  tests.setZero();
  Eigen::Index i = 0;
  for (const Sample& sample : input.acquisition.samples) {
    if (sample.a == sample.b) continue;  // was not dragged
    const Contact& contact = *contacts.at(sample.contact);
    SlipTrial trial{.contact = contact.position, .a = sample.a, .b = sample.b};
    trial.normal_force = sample.force.dot(contact.normal) * contact.normal;
    trial.tangential_force = sample.force - trial.normal_force;
    trial.a_again = sample.a + (sample.slipped ? 0.3 : 0.01) * (sample.b - sample.a);
    const auto judged = judge_slip(trial, options);
    tests[i++] = judged ? judged->t_squared : -1;
    slipped += judged && judged->slipped ? 1 : 0;
  }
  std::sort(tests.begin(), tests.end());
  return {number("slipped", slipped, kNumber, 0.05),
          // Of a statistic that is compared with some ten, differences below 1 mean nothing.
          stating(numbers("tests", tests, kNumber, nullptr, 1e-6), 1)};
}

Results cone(const Input& input, const Change&) {
  ConePosterior posterior(Vector3d::UnitZ(), {.force_noise = 0.01 * input.force});
  std::vector<ConeTrial> trials;
  for (const haptics::FrictionTrial& trial : input.trials)
    trials.push_back({trial.force, trial.slipped});
  posterior.add(trials);
  const ConeEstimate found = posterior.estimate();
  return {number("angle", found.angle), number("deviation", found.angle_deviation),
          number("coefficient", found.coefficient),
          number("slips", posterior.slip_probability(input.force * Vector3d(0.5, 0, 1)))};
}

Results surrogate(const Input& input, const Change&) {
  std::vector<ForcePair> pairs;
  for (Eigen::Index i = 0; i < input.forces.cols(); ++i)
    pairs.push_back({input.forces.col(i), input.displacements.col(i)});
  const ForceSurrogate found(
      pairs, {.position_noise = 0.022 * input.length, .force_noise = 0.01 * input.force});
  const PredictedDisplacement at = found.predict(input.force * Vector3d(0.3, 0.2, 1));
  return {numbers("mean", at.mean, kLength, nullptr, 1e-6),
          number("variance", at.covariance.trace(), kArea, 1e-6),
          number("compliance", found.mean_compliance(), kCompliance)};
}

Results placement(const Input& input, const Change& change) {
  const double radius = 2 * input.length;
  TouchPlacementOptions options{.T_camera_base_start = Eigen::Isometry3d::Identity(),
                                .tip_radius = radius,
                                .start_turn = 0.02,
                                .start_shift = 1 * input.length};
  change(fields_of(options));
  Eigen::Matrix3Xd tips(3, static_cast<Eigen::Index>(input.acquisition.contacts.size()));
  for (Eigen::Index i = 0; i < tips.cols(); ++i) {
    const Contact& contact = input.acquisition.contacts[static_cast<std::size_t>(i)];
    tips.col(i) = contact.position + radius * contact.normal;
  }
  const ArmPlacement found = place_by_touches(tips, input.sheet, options);
  return {number("used", found.used, kNumber, kAnything),
          saying(places("tips", found.T_camera_base * tips, &Order::contacts, 1e-3),
                 found.determined ? "" : found.reason)};
}

Results campaign(const Input& input, const Change& change) {
  const std::shared_ptr<const Specimen> specimen = make_specimen(body_of(input));
  CampaignOptions options;
  options.program.clearance *= input.length;
  options.program.position_noise *= input.length;
  options.program.force_noise *= input.force;
  change(fields_of(options));
  Campaign measured(plan_of(*specimen, input), options);
  QuasiStaticArmOptions arm;
  for (double* length : {&arm.position_noise, &arm.position_quantum, &arm.location_noise,
                         &arm.touch_noise, &arm.longest_slide, &arm.settled_speed, &arm.speed})
    *length *= input.length;
  arm.force_noise *= input.force;
  arm.tip_compliance *= input.length / input.force;
  const std::unique_ptr<Prober> prober = make_quasi_static_arm(specimen, arm);
  const int trials = 12 * input.extent * input.extent;
  double samples = 0;
  for (int i = 0; i < trials; ++i) {
    const std::optional<TrialOrder> order = measured.next();
    if (!order) break;
    const TrialResult result = run_trial(*prober, *order, options.program);
    measured.take({*order, result});
    samples += 1;
  }
  return {number("trials", samples), number("seconds", measured.progress().seconds)};
}

}  // namespace

std::vector<Operation> probing_operations() {
  return {
      {"plan_contacts", kOptions | kSheet | kForces, planning, 0, 64},
      {"try_specimen", kForces, trials, 1e-12},
      {"known_forces", kOptions | kForces, truth, 1e-12},
      {"contact_surface", kOptions | kAcquisition, surface_of_contacts},
      {"CheckedAcquisition", kAcquisition, checked, 0, 0},
      {"judge_slip", kAcquisition, slip, 0, 1e4},
      {"ConePosterior", kTrials, cone},
      {"ForceSurrogate", kSamples, surrogate, 1e-9},
      {"place_by_touches", kOptions | kSheet | kAcquisition, placement, 0, 1e4, 3},
      {"Campaign", kOptions | kForces, campaign, 1e-6, 0, 3},
  };
}

}  // namespace palpate::extremes
