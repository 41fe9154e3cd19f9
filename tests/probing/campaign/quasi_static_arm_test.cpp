// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/quasi_static_arm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "palpate/core/error.h"
#include "palpate/probing/closed_form.h"
#include "palpate/probing/probing_program.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

const ElasticBody kBody{.young_modulus = 0.1, .tool_radius = 3, .friction = 0.6};

TrialOrder order(long long trial, double normal, double tangential,
                 const Vector3d& at = {0, 0, 700}) {
  return {.trial = trial,
          .contact = {.id = 0, .position = at, .normal = {0, 0, -1}},
          .direction = tangential > 0 ? 0 : -1,
          .normal_force = {0, 0, normal},
          .tangential_force = {tangential, 0, 0}};
}

QuasiStaticArmOptions exact() {
  return {.position_noise = 0,
          .position_quantum = 0,
          .force_noise = 0,
          .location_noise = 0,
          .touch_noise = 0,
          .tip_compliance = 0,
          .settled_speed = 1e-7};
}

TEST(QuasiStaticArm, WithoutErrorsMeasuresTheTruth) {
  const std::shared_ptr<const Specimen> body = make_specimen(kBody);
  const auto arm = make_quasi_static_arm(body, exact());
  ProgramOptions patient;
  patient.settle_limit = 60;
  const TrialResult result = run_trial(*arm, order(0, 1.5, 0.8), patient);
  const Vector3d at(0, 0, 700);
  constexpr double kLeft = 1e-7;  // [mm]
  EXPECT_LT((result.a - at - body->displacement(at, {0, 0, 1.5})).norm(), kLeft);
  EXPECT_LT((result.b - at - body->displacement(at, {0.8, 0, 1.5})).norm(), kLeft);
  EXPECT_LT((result.a_again - result.a).norm(), kLeft);
  EXPECT_EQ(result.outcome, TrialOutcome::held);
}

TEST(QuasiStaticArm, SlipsAtTheConeAndNowhereElse) {
  const auto arm = make_quasi_static_arm(make_specimen(kBody), exact());
  ProgramOptions patient;
  patient.settle_limit = 60;
  EXPECT_EQ(run_trial(*arm, order(0, 1, 0.599), patient).outcome, TrialOutcome::held);
  // The coefficient is the same everywhere: it slides as far as the arm follows.
  EXPECT_EQ(run_trial(*arm, order(1, 1, 0.601), patient).outcome, TrialOutcome::fell_off);
}

TEST(QuasiStaticArm, WaitsForWhatIsRetardedAndSaysHowMuchThatWas) {
  ElasticBody body = kBody;
  body.retarded = 0.3;
  body.retardation_time = 2;
  const std::shared_ptr<const Specimen> specimen = make_specimen(body);
  QuasiStaticArmOptions options = exact();
  options.settled_speed = 1e-4;
  options.start = {0, 0, 680};
  const auto arm = make_quasi_static_arm(specimen, options);
  ProgramOptions patient;
  patient.settle_limit = 60;
  const TrialResult result = run_trial(*arm, order(0, 1.5, 0.8), patient);
  const Vector3d at(0, 0, 700), pressed = specimen->displacement(at, {0, 0, 1.5}),
                                dragged = specimen->displacement(at, {0.8, 0, 1.5}) - pressed;
  // 0.3 d exp(-t / 2 s) / 2 s = 1e-4 mm/s; what is then left stays.
  constexpr double kLeft = 2 * 1e-4;
  const auto time = [](double way) { return 0.5 + 2 * std::log(0.3 * way / kLeft); };
  EXPECT_NEAR((result.a - at - pressed).norm(), kLeft, 1e-6);
  EXPECT_NEAR(result.creep, 0.3, kLeft / dragged.norm());
  EXPECT_EQ(result.outcome, TrialOutcome::held);
  // An approach of 3 s, three times at rest, and a lift at 30 mm/s.
  EXPECT_NEAR(result.seconds,
              3 + time(pressed.norm()) + 2 * time(dragged.norm()) + (20 + pressed.z()) / 30, 0.02);
  EXPECT_TRUE(std::isnan(result.work_dragging));
}

TEST(QuasiStaticArm, ScattersAsStated) {
  const std::shared_ptr<const Specimen> body = make_specimen(kBody);
  const auto arm = make_quasi_static_arm(body, {.settled_speed = 1e-4});
  const Vector3d at(0, 0, 700), truth = at + body->displacement(at, {0, 0, 1});
  constexpr int kCount = 2000;
  Eigen::Array3d squares = Eigen::Array3d::Zero();
  ProgramOptions patient;
  patient.settle_limit = 60;
  for (int i = 0; i < kCount; ++i)
    squares += (run_trial(*arm, order(i, 1, 0), patient).a - truth).array().square() / kCount;
  // Position: noise and rounding; along the surface also the place; all by the force's error.
  const double position = 0.02 * 0.02 + 0.03 * 0.03 / 12;
  const Vector3d compliance = body->displacement(at, {1, 0, 1});
  const double across = position + 0.02 * 0.02 + std::pow(0.01 * compliance.x(), 2);
  const double along = position + std::pow(0.01 * compliance.z(), 2);
  // The relative deviation of a mean of 2000 squares is 3 %.
  EXPECT_NEAR(squares.x(), across, 0.12 * across);
  EXPECT_NEAR(squares.y(), across, 0.12 * across);
  EXPECT_NEAR(squares.z(), along, 0.12 * along);
}

TEST(QuasiStaticArm, MicroslipStaysBehind) {
  QuasiStaticArmOptions options = exact();
  options.tip_compliance = 0.2;
  const auto arm = make_quasi_static_arm(make_specimen(kBody), options);
  ProgramOptions patient;
  patient.settle_limit = 60;
  patient.position_noise = 1;  // so that it does not count as a slip
  const TrialResult result = run_trial(*arm, order(0, 1, 0.54), patient);
  // 0.9 of the limit 0.6 N: 3/2 C mu N = 0.18 mm times 2 0.55^(2/3) - 0.1^(2/3) - 1.
  const double left = 0.18 * (2 * std::pow(0.55, 2.0 / 3) - std::pow(0.1, 2.0 / 3) - 1);
  EXPECT_NEAR((result.a_again - result.a).x(), left, 1e-6);
  EXPECT_GT(left, 0.02);
}

TEST(QuasiStaticArm, ATrialDoesNotDependOnThoseBefore) {
  const std::shared_ptr<const Specimen> sheet = make_specimen(Sheet{});
  const Vector3d at = surface_at(Sheet{}, 10, 12);
  const auto fresh = make_quasi_static_arm(sheet), used = make_quasi_static_arm(sheet);
  for (int i = 0; i < 3; ++i) (void)run_trial(*used, order(i, 2, 1.9, at), {});
  const TrialResult a = run_trial(*fresh, order(3, 0.7, 0.3, at), {}),
                    b = run_trial(*used, order(3, 0.7, 0.3, at), {}),
                    c = run_trial(*used, order(4, 0.7, 0.3, at), {});
  EXPECT_EQ(a.a, b.a);
  EXPECT_EQ(a.b, b.b);
  EXPECT_EQ(a.a_again, b.a_again);
  EXPECT_NE(a.a, c.a);
  const auto other = make_quasi_static_arm(sheet, {.seed = 2});
  EXPECT_NE(run_trial(*other, order(3, 0.7, 0.3, at), {}).a, a.a);
}

TEST(QuasiStaticArm, FindsNothingWhereThereIsNothingAndFallsOffEdges) {
  const auto arm = make_quasi_static_arm(make_specimen(kBody));
  EXPECT_EQ(run_trial(*arm, order(0, 1, 0, {0, 0, 720}), {}).outcome, TrialOutcome::no_contact);
  EXPECT_EQ(run_trial(*arm, order(1, 1, 0, {80, 0, 700}), {}).outcome, TrialOutcome::no_contact);
  EXPECT_EQ(run_trial(*arm, order(2, 1, 1, {48, 0, 700}), {}).outcome, TrialOutcome::fell_off);
}

TEST(QuasiStaticArm, GivesUpWhereTheObjectDoesNotComeToRest) {
  const auto arm = make_quasi_static_arm(make_specimen(kBody), {.time_constant = 4});
  EXPECT_EQ(run_trial(*arm, order(0, 1, 0.2), {}).outcome, TrialOutcome::unsettled);
}

// Thesis 6.2.1: 5300 samples in 17 hours.
/// An elastic body that breaks down above some force.
class WeakBody final : public Specimen {
 public:
  const geometry::TriangleMesh& surface() const override { return body_->surface(); }
  Vector3d displacement(const Vector3d& contact, const Vector3d& force) const override {
    if (force.norm() > 1) throw SolverError("no equilibrium");
    return body_->displacement(contact, force);
  }
  FrictionCone friction_cone(const Vector3d& contact) const override {
    return body_->friction_cone(contact);
  }

 private:
  std::shared_ptr<const Specimen> body_ = make_specimen(kBody);
};

TEST(QuasiStaticArm, DoesNotComeToRestWhereTheObjectHasNoEquilibrium) {
  const auto arm = make_quasi_static_arm(std::make_shared<const WeakBody>(), exact());
  ProgramOptions patient;
  patient.settle_limit = 60;
  EXPECT_EQ(run_trial(*arm, order(0, 0.9, 0), patient).outcome, TrialOutcome::held);
  const TrialResult failed = run_trial(*arm, order(1, 1.1, 0), patient);
  EXPECT_EQ(failed.outcome, TrialOutcome::unsettled);
  EXPECT_GE(failed.seconds, patient.settle_limit);
  EXPECT_EQ(failed.reason, "no equilibrium");
  const auto slow = make_quasi_static_arm(make_specimen(kBody), {.time_constant = 4});
  EXPECT_EQ(run_trial(*slow, order(0, 1, 0.2), {}).reason, "");  // it only takes too long
}

TEST(QuasiStaticArm, TakesAboutTwelveSecondsASample) {
  const auto arm = make_quasi_static_arm(make_specimen(Sheet{}));
  const Vector3d at = surface_at(Sheet{}, 0, 0), next = surface_at(Sheet{}, 14, 0);
  (void)run_trial(*arm, order(0, 1.5, 0.9, at), {});  // travels far
  EXPECT_NEAR(run_trial(*arm, order(1, 1.5, 0.9, next), {}).seconds, 12, 2);
}

TEST(QuasiStaticArm, RefusesOptionsOutOfRange) {
  const std::shared_ptr<const Specimen> body = make_specimen(kBody);
  EXPECT_THROW((void)make_quasi_static_arm(body, {.position_noise = -1}), InvalidInput);
  EXPECT_THROW((void)make_quasi_static_arm(body, {.kinetic_friction = 1.1}), InvalidInput);
  EXPECT_THROW((void)make_quasi_static_arm(body, {.speed = 0}), InvalidInput);
}

}  // namespace
}  // namespace palpate::probing
