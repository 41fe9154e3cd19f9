// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/force_field_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "haptics_testing.h"
#include "not_finite.h"
#include "sticking_ball.h"

namespace palpate::haptics {
namespace {

using ::testing::HasSubstr;

const FitOptions kLocalFit{.mode = FitMode::local};

// Largest difference of two fields where there are data.
double distance(const ForceField& left, const ForceField& right, const Eigen::Matrix3Xd& places) {
  return (forces_at(left, places) - forces_at(right, places)).colwise().norm().maxCoeff();
}

TEST(FitForceField, RecoversOneBase) {
  const ForceField truth{{{3.3, 4.5, {1.2, -0.4, 2}}}};
  const Eigen::Matrix3Xd places = random_points(60, 8);
  const FitResult fit = fit_force_field(places, forces_at(truth, places),
                                        {.mode = FitMode::local, .accuracy = 1e-3, .epsilon = 4.5});
  EXPECT_EQ(fit.stop, FitStop::accurate);
  ASSERT_EQ(fit.field.bases.size(), 1U);
  // The solver stops at 1e-6 of the data's scale.
  EXPECT_LT((fit.field.bases[0].center - truth.bases[0].center).norm(), 1e-3);
  EXPECT_NEAR(fit.field.bases[0].weight, 3.3, 1e-3);
}

TEST(FitForceField, RecoversAFieldInItsSpan) {
  const ForceField truth = some_field();
  const Eigen::Matrix3Xd places = random_points(100, 6), others = random_points(50, 5, 9);
  const Eigen::Matrix3Xd forces = forces_at(truth, places);
  const FitResult fit = fit_force_field(
      places, forces,
      {.mode = FitMode::local, .accuracy = 0.01, .epsilon = truth.bases[0].epsilon});
  EXPECT_EQ(fit.stop, FitStop::accurate);
  EXPECT_LT(fit.rms, 0.01);
  EXPECT_LT(distance(fit.field, truth, others), 0.05);
  const Eigen::Matrix3Xd residual = forces_at(fit.field, places) - forces;
  EXPECT_NEAR(fit.rms, std::sqrt(residual.colwise().squaredNorm().mean()), 1e-12);
}

TEST(FitForceField, StaysStableWhereTheDataAreNot) {
  // Near zero the object pulls the tool along x: a negative spring that no passive object has.
  const Eigen::Matrix3Xd places = random_points(80, 2);
  Eigen::Matrix3Xd forces = 0.5 * places;
  forces.row(0) *= -1;
  const FitResult fit =
      fit_force_field(places, forces, {.mode = FitMode::local, .max_bases = 4, .epsilon = 1.5});
  EXPECT_GE(fit.smallest_stiffness, 0);
  EXPECT_GE(stiffness_at_zero(fit.field), 0);
  EXPECT_NO_THROW(check_force_field(fit.field, "fit"));
  // The other axes are not given up for it.
  EXPECT_NEAR(force(fit.field, {0, 1, 0}).y(), 0.5, 0.15);
}

TEST(FitForceField, DoesNotDependOnTheOrderOfSamples) {
  const Eigen::Matrix3Xd places = random_points(50, 6);
  const Eigen::Matrix3Xd forces = forces_at(some_field(), places);
  const FitResult fit = fit_force_field(places, forces, {.mode = FitMode::local, .max_bases = 2});
  const FitResult reversed = fit_force_field(places.rowwise().reverse(), forces.rowwise().reverse(),
                                             {.mode = FitMode::local, .max_bases = 2});
  EXPECT_EQ(fit.field, reversed.field);
}

TEST(FitForceField, ScalesExactlyWithTheUnits) {
  const Eigen::Matrix3Xd places = random_points(50, 6);
  const Eigen::Matrix3Xd forces = forces_at(some_field(), places);
  const FitResult fit =
      fit_force_field(places, forces, {.mode = FitMode::local, .accuracy = 0x1p-6, .max_bases = 3});
  for (const double length : {0x1p-10, 0x1p10}) {
    for (const double newton : {0x1p-30, 0x1p10}) {
      const FitResult other =
          fit_force_field(length * places, newton * forces,
                          {.mode = FitMode::local, .accuracy = newton * 0x1p-6, .max_bases = 3});
      EXPECT_EQ(other.field, scaled(fit.field, newton, length));
      EXPECT_EQ(other.rms, newton * fit.rms);
      EXPECT_EQ(other.iterations, fit.iterations);
    }
  }
}

TEST(FitForceField, TurnsWithTheFrame) {
  const Eigen::Matrix3d turn = some_rotation();
  const ForceField truth{{{3.3, 4.5, {1.2, -0.4, 2}}}};
  const Eigen::Matrix3Xd places = random_points(60, 8);
  const Eigen::Matrix3Xd forces = forces_at(truth, places);
  const FitOptions options{
      .mode = FitMode::local, .accuracy = 0.2, .max_bases = 3};  // epsilon is not the truth's
  const FitResult fit = fit_force_field(places, forces, options);
  const FitResult turned = fit_force_field(turn * places, turn * forces, options);
  const Eigen::Matrix3Xd expected = turn * forces_at(fit.field, places);
  // The solver stops at 1e-6 of the data's scale of 3 N.
  EXPECT_LT((forces_at(turned.field, turn * places) - expected).colwise().norm().maxCoeff(), 1e-2);
  EXPECT_NEAR(turned.rms, fit.rms, 1e-3);
}

TEST(FitForceField, SurvivesPoorData) {
  const Eigen::Matrix3Xd one = Eigen::Vector3d(0.3, 0.1, 2.2);
  const Eigen::Matrix3Xd alike = one.replicate(1, 9);
  Eigen::Matrix3Xd line(3, 9);
  for (int i = 0; i < 9; ++i) line.col(i) = i * one;
  for (const Eigen::Matrix3Xd& places : {one, alike, line}) {
    const FitResult fit = fit_force_field(places, 0.5 * places, kLocalFit);
    EXPECT_LT(fit.rms, 0.1) << places.cols();
    EXPECT_GE(stiffness_at_zero(fit.field), 0);
    EXPECT_TRUE(force(fit.field, {5, 5, 5}).allFinite());
  }
}

TEST(FitForceField, SaysWhenTheDataDoNotDetermineAField) {
  const Eigen::Matrix3Xd zero = Eigen::Matrix3Xd::Zero(3, 5), some = random_points(5, 1);
  const FitResult rigid = fit_force_field(zero, some, kLocalFit);
  EXPECT_EQ(rigid.stop, FitStop::not_determined);
  EXPECT_GT(rigid.rms, 0);
  EXPECT_EQ(force(rigid.field, {1, 2, 3}), Eigen::Vector3d::Zero());
  const FitResult nothing = fit_force_field(some, zero, kLocalFit);
  EXPECT_EQ(nothing.stop, FitStop::accurate);
  EXPECT_EQ(force(nothing.field, {1, 2, 3}), Eigen::Vector3d::Zero());
}

TEST(FitForceField, FitsForcesOfANanonewton) {
  const Eigen::Matrix3Xd places = random_points(40, 5);
  const FitResult fit =
      fit_force_field(places, 1e-9 * places, {.mode = FitMode::local, .accuracy = 1e-10});
  EXPECT_LE(fit.rms, 1e-10);
}

// Displacements that err by `deviation` in each component.
Eigen::Matrix3Xd with_noise(const Eigen::Matrix3Xd& places, double deviation) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal(0, deviation);
  return places.unaryExpr([&](double value) { return value + normal(random); });
}

void expect_usable(const FitResult& fit) {
  EXPECT_NO_THROW(check_force_field(fit.field, "fit"));
  EXPECT_TRUE(is_passive(fit.certificate)) << to_string(fit.certificate.passivity);
  EXPECT_TRUE(std::isfinite(fit.rms) && std::isfinite(fit.chi2) && std::isfinite(fit.noise_floor));
  EXPECT_STRNE(to_string(fit.stop), "unknown");
}

TEST(FitForceField, ComparesErrorsWithTheNoiseInEachMode) {
  const ForceField truth{{{3.3, 4.5, {1.2, -0.4, 2}}}};
  const Eigen::Matrix3Xd places = random_points(100, 6);
  const Eigen::Matrix3Xd measured = with_noise(places, 0.05);
  for (const FitMode mode : {FitMode::convex, FitMode::certified, FitMode::local}) {
    const FitResult fit = fit_force_field(
        measured, forces_at(truth, places),
        {.mode = mode, .max_bases = 2, .noise = {.displacement = 0.05, .force = 0}});
    EXPECT_NEAR(fit.chi2, 1, 0.3) << to_string(mode);
    EXPECT_NEAR(fit.rms / fit.noise_floor, 1, 0.2) << to_string(mode);
    EXPECT_EQ(fit.displacement_noise, 0.05);
    EXPECT_EQ(fit.condition.has_value(), mode == FitMode::convex);
  }
}

TEST(FitForceField, IsUsableWithMoreBasesThanSamples) {
  const Eigen::Matrix3Xd places = random_points(4, 5);
  for (const FitMode mode : {FitMode::convex, FitMode::certified}) {
    expect_usable(
        fit_force_field(places, forces_at(some_field(), places), {.mode = mode, .max_bases = 20}));
  }
}

TEST(FitForceField, IsUsableAndTellsOfOutliersWhereItIsCertified) {
  const ForceField truth{{{3.3, 4.5, {1.2, -0.4, 2}}}};
  const Eigen::Matrix3Xd places = random_points(100, 6);
  Eigen::Matrix3Xd measured = with_noise(places, 0.02);
  for (const Eigen::Index wrong : {7, 40, 77}) measured(wrong % 3, wrong) += 1;
  const FitResult fit = fit_force_field(
      measured, forces_at(truth, places),
      {.mode = FitMode::certified, .max_bases = 2, .noise = {.displacement = 0.02}});
  expect_usable(fit);
  EXPECT_GE(fit.outliers, 1);
  EXPECT_LE(fit.outliers, 6);
  EXPECT_LT(distance(fit.field, truth, places), 0.3);
}

// Forces of an energy k / 2 |x|^2 that foam adds k |x|^6 / (6 d^4) to.
TEST(FitForceField, FollowsFoamThatStiffens) {
  constexpr double kStiffness = 0.2, kDensified = 4;
  const Eigen::Matrix3Xd places = random_points(120, 6);
  Eigen::Matrix3Xd forces = kStiffness * places;
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    forces.col(i) *= 1 + std::pow(places.col(i).norm() / kDensified, 4);
  }
  const double extent = std::sqrt(forces.colwise().squaredNorm().mean());
  for (const FitMode mode : {FitMode::convex, FitMode::certified}) {
    const FitResult fit = fit_force_field(places, forces, {.mode = mode, .max_bases = 4});
    expect_usable(fit);
    EXPECT_LT(fit.rms, 0.6 * extent) << to_string(mode);
  }
}

// Forces of an energy k / 2 |x|^2 + h exp(-|x - c|^2 / (2 s^2)): past the bump they fall.
TEST(FitForceField, IsUsableOverABump) {
  constexpr double kStiffness = 0.3, kHeight = 1.5, kWidth = 1.2;
  const Eigen::Vector3d center(0, 0, 4);
  const Eigen::Matrix3Xd places = random_points(120, 6);
  Eigen::Matrix3Xd forces = kStiffness * places;
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    const Eigen::Vector3d off = places.col(i) - center;
    forces.col(i) -=
        kHeight / (kWidth * kWidth) * std::exp(-off.squaredNorm() / (2 * kWidth * kWidth)) * off;
  }
  const double extent = std::sqrt(forces.colwise().squaredNorm().mean());
  for (const FitMode mode : {FitMode::convex, FitMode::certified}) {
    const FitResult fit = fit_force_field(places, forces, {.mode = mode, .max_bases = 4});
    expect_usable(fit);
    EXPECT_LT(fit.rms, 0.6 * extent) << to_string(mode);
  }
}

TEST(FitForceField, RefusesWhatItCannotUse) {
  Eigen::Matrix3Xd places = random_points(5, 1);
  const Eigen::Matrix3Xd forces = places;
  EXPECT_THAT(refusal([&] { return fit_force_field(places.leftCols(0), forces.leftCols(0)); }),
              HasSubstr("at least one"));
  EXPECT_THAT(refusal([&] { return fit_force_field(places.leftCols(4), forces); }),
              HasSubstr("4 displacements and 5"));
  EXPECT_THAT(refusal([&] { return fit_force_field(places, forces, {.accuracy = kNaN}); }),
              HasSubstr("accuracy"));
  EXPECT_THAT(refusal([&] { return fit_force_field(places, forces, {.max_bases = 0}); }),
              HasSubstr("max_bases"));
  EXPECT_THAT(refusal([&] {
                return fit_force_field(places, forces, {.mode = FitMode::local, .epsilon = -1});
              }),
              HasSubstr("epsilon is -1"));
  EXPECT_THAT(refusal([&] { return fit_force_field(places, forces, {.epsilon = 1}); }),
              HasSubstr("choose the mode certified"));
  EXPECT_THAT(refusal([&] { return fit_force_field(places, forces, {.noise = {.force = -1}}); }),
              HasSubstr("noise.force"));
  EXPECT_THAT(
      refusal([&] { return fit_force_field(places, forces, {.noise = {.displacement = kNaN}}); }),
      HasSubstr("noise.displacement"));
  places(1, 3) = kNaN;
  EXPECT_THAT(refusal([&] { return fit_force_field(places, forces); }), HasSubstr("sample 3"));
}

struct StickingPairs {
  Eigen::Matrix3Xd displacements, forces;
};

StickingPairs sticking_pairs(const std::vector<Eigen::Vector3d>& forces) {
  const auto count = static_cast<Eigen::Index>(forces.size());
  StickingPairs pairs{Eigen::Matrix3Xd(3, count), Eigen::Matrix3Xd(3, count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    pairs.forces.col(i) = forces[static_cast<std::size_t>(i)];
    pairs.displacements.col(i) = palpate::support::sticking_ball(pairs.forces.col(i));
  }
  return pairs;
}

// Random forces up to 3 N in a cone of friction 0.72.
StickingPairs random_sticking_pairs(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Eigen::Vector3d> forces;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * uniform(random);
    const double ratio = 0.72 * std::sqrt(uniform(random)), size = 0.1 + 2.9 * uniform(random);
    forces.push_back(
        size * Eigen::Vector3d(ratio * std::cos(angle), ratio * std::sin(angle), 1).normalized());
  }
  return sticking_pairs(forces);
}

// Five normal forces, each alone and with four drags, as `palpate bake` computes them.
StickingPairs planned_sticking_pairs() {
  std::vector<Eigen::Vector3d> forces;
  for (int level = 0; level < 5; ++level) {
    const double normal = 0.15 + 0.66 * level;
    forces.emplace_back(0, 0, normal);
    for (int k = 0; k < 4; ++k) {
      const double angle = std::numbers::pi / 2 * k + 2.4 * level;
      const double most = std::min(0.78 * normal, std::sqrt(9 - normal * normal));
      const double size = ((level + k) % 2 == 0 ? 1 : 0.55) * most;
      forces.emplace_back(size * std::cos(angle), size * std::sin(angle), normal);
    }
  }
  return sticking_pairs(forces);
}

double query_error(const ForceField& field, const StickingPairs& pairs) {
  return std::sqrt(
      (forces_at(field, pairs.displacements) - pairs.forces).colwise().squaredNorm().mean());
}

// Exact pairs of a ball that sticks are no gradient. A field with many bases follows a few of them,
// and is wrong between.
TEST(FitForceField, PredictsForcesThatDependOnThePathAlmostAsWellAsAnyFieldCan) {
  const StickingPairs queries = random_sticking_pairs(200, 2);
  const FitNoise noise{.displacement = 0.005, .force = 0.002};
  const StickingPairs many = random_sticking_pairs(400, 3), few = planned_sticking_pairs();
  const double least = query_error(
      fit_force_field(many.displacements, many.forces, {.mode = FitMode::certified}).field,
      queries);
  const FitResult followed =
      fit_force_field(few.displacements, few.forces, {.try_certified = false, .noise = noise});
  EXPECT_GT(query_error(followed.field, queries), 2 * least);
  const FitResult compared =
      fit_force_field(few.displacements, few.forces, {.compare_always = true, .noise = noise});
  EXPECT_LT(query_error(compared.field, queries), 1.35 * least);
  EXPECT_TRUE(is_passive(compared.certificate));
}

// StickingPairs without noise, of a field that many bases describe: nothing is taken for noise.
TEST(FitForceField, StillFollowsExactPairsOfAnEnergyIfItComparesFields) {
  const ForceField truth{{{2, 1, {0, 0, 3}}, {1.5, 0.6}, {1, 0.8, {1, 0, 1}}, {1, 2, {0, -2, 1}}}};
  const Eigen::Matrix3Xd places = random_points(40, 2.5), others = random_points(100, 2.3, 4);
  const FitNoise noise{.displacement = 0.005, .force = 0.002};
  const auto error = [&](bool compare) {
    const FitResult fit = fit_force_field(places, forces_at(truth, places),
                                          {.compare_always = compare, .noise = noise});
    return query_error(fit.field, {others, forces_at(truth, others)});
  };
  EXPECT_LT(error(true), std::max(1.2 * error(false), 0.01));
}

TEST(AssessForceField, GivesTheFiguresOfTheFitThatFoundTheField) {
  const Eigen::Matrix3Xd displacements = random_points(60, 5);
  Eigen::Matrix3Xd forces(3, 60);
  for (Eigen::Index i = 0; i < 60; ++i) {
    forces.col(i) = force(spring(3, 4), displacements.col(i)) + 0.01 * random_points(60, 1).col(i);
  }
  forces.col(7) += Eigen::Vector3d(1, -1, 1);
  const FitResult fit = fit_force_field(displacements, forces);
  const int parameters = 5 * static_cast<int>(fit.field.bases.size());
  const FitResult assessed = assess_force_field(fit.field, displacements, forces, parameters);
  EXPECT_NEAR(assessed.rms, fit.rms, 1e-9);
  EXPECT_NEAR(assessed.chi2, fit.chi2, 1e-6 * fit.chi2);
  EXPECT_NEAR(assessed.noise_floor, fit.noise_floor, 1e-9);
  EXPECT_EQ(assessed.outliers, 1);
  EXPECT_EQ(assessed.stop, FitStop::explained);
  EXPECT_EQ(assessed.certificate.passivity, Passivity::convex);
  // A field that is none of the samples'.
  EXPECT_EQ(assess_force_field(spring(1, 4), displacements, forces, 5).stop, FitStop::unexplained);
  // Forces that are all zero.
  EXPECT_NEAR(assess_force_field({}, displacements, 0 * forces, 5).rms, 0, 1e-12);
  EXPECT_THAT(refusal([&] {
                return assess_force_field({{{1, -1}}}, displacements, forces, 5);
              }),
              HasSubstr("epsilon"));
}

}  // namespace
}  // namespace palpate::haptics
