// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/convex_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "haptics_testing.h"
#include "palpate/haptics/force_field_fit.h"
#include "palpate/haptics/realignment.h"
#include "strip_acquisition.h"

namespace palpate::haptics {
namespace {

using support::Strip;

struct Contact {
  double x, y;
};

ForceSamples measured(const Contact& at, const Strip& strip = {},
                      const support::StripProbing& probing = {}) {
  const probing::Acquisition acquisition = support::strip_contact(at.x, at.y, strip, probing);
  return realign(acquisition.contacts.front(), acquisition.samples);
}

FitResult fit_measured(const ForceSamples& samples, FitOptions options = {}) {
  options.noise.displacement = samples.displacement_noise;
  return fit_force_field(samples.displacements, samples.forces, options);
}

// Root mean square of the error against the noise-free object, within its friction cone.
double true_error(const ForceField& field, const Contact& at, const Strip& strip) {
  const Eigen::Matrix3d frame = support::strip_frame(at.x, at.y);
  const support::StripCone cone = support::strip_cone(strip, at.x, at.y);
  double sum = 0;
  int count = 0;
  const Eigen::Matrix3Xd forces = random_points(400, 3.2, 7);
  for (const Eigen::Vector3d f : forces.colwise()) {
    if (f.z() < 0.15 || !holds(cone, f)) continue;
    const Eigen::Vector3d x = support::strip_displacement(strip, at.x, at.y, f);
    sum += (force(field, frame.transpose() * x) - frame.transpose() * f).squaredNorm();
    ++count;
  }
  EXPECT_GT(count, 20);
  return std::sqrt(sum / count);
}

void expect_convex(const FitResult& fit) {
  EXPECT_NO_THROW(check_force_field(fit.field, "fit"));
  EXPECT_EQ(fit.mode, FitMode::convex);
  EXPECT_EQ(fit.certificate.passivity, Passivity::convex);
  for (const Multiquadric& base : fit.field.bases) EXPECT_GE(base.weight, 0);
  EXPECT_TRUE(std::isfinite(fit.rms));
}

double largest_difference(const Eigen::Matrix3Xd& left, const Eigen::Matrix3Xd& right) {
  return (left - right).colwise().norm().maxCoeff() / right.colwise().norm().maxCoeff();
}

// Figures of the fits of all contacts of a sheet.
struct SheetFigures {
  std::vector<double> bases, errors;  // sorted
  double at_noise = 0;                // part with an rms up to 1.25 times the noise floor
};

SheetFigures fit_sheet(const Strip& strip, unsigned seed) {
  constexpr int kTruths = 40;
  SheetFigures figures;
  const std::vector<Eigen::Vector2d> places = support::strip_places();
  std::vector<ForceSamples> contacts;
  for (const Eigen::Vector2d& at : places)
    contacts.push_back(measured({at.x(), at.y()}, strip, {.seed = seed++}));
  FitOptions options;
  options.noise.displacement = pooled_displacement_noise(contacts);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const FitResult fit = fit_force_field(contacts[i].displacements, contacts[i].forces, options);
    figures.bases.push_back(static_cast<double>(fit.field.bases.size()));
    if (fit.rms <= 1.25 * fit.noise_floor) figures.at_noise += 1;
    double sum = 0;
    for (const support::StripTruth& truth : support::strip_truths(strip, {places[i]}, kTruths))
      sum += (force(fit.field, truth.displacement) - truth.force).squaredNorm();
    figures.errors.push_back(std::sqrt(sum / kTruths));
  }
  figures.at_noise /= static_cast<double>(places.size());
  std::sort(figures.bases.begin(), figures.bases.end());
  std::sort(figures.errors.begin(), figures.errors.end());
  return figures;
}

TEST(FitConvex, NeedsEightBasesForTheNoiseOfMostOfASheet) {
  const SheetFigures sheet =
      fit_sheet({.tension = 0.72, .axial = 45, .support = 50.6, .compliance = 0.22}, 500);
  EXPECT_LE(sheet.bases[sheet.bases.size() / 2], 8);
  EXPECT_GE(sheet.at_noise, 0.95);
  EXPECT_LE(sheet.errors[sheet.errors.size() / 2], 0.028);
  EXPECT_LE(sheet.errors[sheet.errors.size() * 9 / 10], 0.055);
}

TEST(FitConvex, NeedsFewMoreForASheetOverABlock) {
  const SheetFigures sheet = fit_sheet(
      {.tension = 0.85, .block = 1.4, .depth = 14, .block_low{-28, -8}, .block_high{3, 30}}, 700);
  EXPECT_LE(sheet.bases[sheet.bases.size() / 2], 9);
  EXPECT_GE(sheet.at_noise, 0.95);
  EXPECT_LE(sheet.errors[sheet.errors.size() / 2], 0.032);
  EXPECT_LE(sheet.errors[sheet.errors.size() * 9 / 10], 0.058);
}

TEST(FitConvex, ReachesTheNoiseOfAStretchedSheet) {
  for (const Contact at : {Contact{0, 0}, Contact{-28, 20}}) {
    const FitResult fit = fit_measured(measured(at));
    expect_convex(fit);
    EXPECT_EQ(fit.stop, FitStop::explained);
    EXPECT_LT(fit.rms, 1.25 * fit.noise_floor);
    EXPECT_GT(fit.rms, 0.5 * fit.noise_floor);
    EXPECT_LT(true_error(fit.field, at, {}), 0.05);
    EXPECT_LE(fit.field.bases.size(), std::size_t{kMaxConvexBases});
    EXPECT_GT(*fit.condition, 1);
  }
}

// Largest of the stiffness on the rays through all samples, at this part of their displacement.
double largest_stiffness(const ForceField& field, const ForceSamples& samples, double part) {
  double largest = 0;
  for (const Eigen::Vector3d x : samples.displacements.colwise())
    largest = std::max(largest, stiffness(field, part * x).norm());
  return largest;
}

TEST(FitConvex, BuildsNoWallWhereNothingWasMeasured) {
  for (const Contact at : {Contact{28, -20}, Contact{42, 20}, Contact{-42, -60}, Contact{21, 0}}) {
    for (const double block : {0.0, 1.5}) {
      const ForceSamples samples = measured(at, {.block = block});
      const ForceField field = fit_measured(samples).field;
      const double inside = largest_stiffness(field, samples, 1);
      // The sheet and the block may go on stiffening; 4 N/mm is the most the object can reach.
      for (const double part : {1.1, 1.2, 1.4, 2.0})
        EXPECT_LT(largest_stiffness(field, samples, part), 3 * inside) << at.x << " " << part;
    }
  }
}

TEST(FitConvex, FollowsAStiffBlockBelowTheSheet) {
  const Contact at{20, 0};
  const Strip strip{.block = 1.5};
  const FitResult fit = fit_measured(measured(at, strip));
  expect_convex(fit);
  EXPECT_EQ(fit.stop, FitStop::explained);
  EXPECT_LT(true_error(fit.field, at, strip), 0.05);
}

// Force of a foam that stiffens: k h sinh(z / h) along z and l h sinh(t / h) across it.
Eigen::Vector3d foam_force(const Eigen::Vector3d& x) {
  constexpr double kLength = 6, kNormal = 0.15, kTangential = 0.12;
  const double across = std::hypot(x.x(), x.y());
  const double slope =
      across > 0 ? kTangential * kLength * std::sinh(across / kLength) / across : kTangential;
  return {slope * x.x(), slope * x.y(), kNormal * kLength * std::sinh(x.z() / kLength)};
}

// As probed: five depths, eight directions, most samples near where they would slip.
std::vector<Eigen::Vector3d> foam_places() {
  std::vector<Eigen::Vector3d> places;
  for (const double depth : {1.0, 3.5, 6.0, 8.5, 10.5}) {
    for (int repeat = 0; repeat < 2; ++repeat) {
      places.emplace_back(0, 0, depth);
      for (int direction = 0; direction < 8; ++direction) {
        const double angle = 0.2 + direction * std::numbers::pi / 4;
        for (const double part : {0.5, 0.75, 0.88, 0.94, 0.97}) {
          const double across = part * depth;
          places.emplace_back(across * std::cos(angle), across * std::sin(angle), depth);
        }
      }
    }
  }
  return places;
}

TEST(FitConvex, FollowsAFoamBetweenTheLevelsOfForce) {
  const std::vector<Eigen::Vector3d> places = foam_places();
  Eigen::Matrix3Xd displacements(3, static_cast<Eigen::Index>(places.size()));
  Eigen::Matrix3Xd forces = displacements;
  for (const unsigned seed : {5U, 6U, 7U}) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, kDisplacementNoise);
    for (Eigen::Index i = 0; i < forces.cols(); ++i) {
      const Eigen::Vector3d& x = places[static_cast<std::size_t>(i)];
      forces.col(i) = foam_force(x);
      displacements.col(i) = x + Eigen::Vector3d{noise(random), noise(random), noise(random)};
    }
    const FitResult fit = fit_force_field(displacements, forces);
    expect_convex(fit);
    EXPECT_EQ(fit.stop, FitStop::explained);
    double sum = 0;
    int count = 0;
    const Eigen::Matrix3Xd others = random_points(900, 10.5, 11);
    for (const Eigen::Vector3d x : others.colwise()) {
      if (x.z() < 0.5 || std::hypot(x.x(), x.y()) > 0.9 * x.z()) continue;
      sum += (force(fit.field, x) - foam_force(x)).squaredNorm();
      ++count;
    }
    EXPECT_GT(count, 50);
    EXPECT_LT(std::sqrt(sum / count), 0.04);
  }
}

TEST(FitConvex, TakesOutliersForWhatTheyAre) {
  const Contact at{0, 20};
  ForceSamples samples = measured(at);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  int outliers = 0;
  for (Eigen::Index i = 5; i < samples.forces.cols(); i += 33, ++outliers) {
    const Eigen::Vector3d off{normal(random), normal(random), normal(random)};
    samples.displacements.col(i) += off.normalized();
  }
  ASSERT_GE(outliers, 3);
  const FitResult fit = fit_measured(samples), clean = fit_measured(measured(at));
  expect_convex(fit);
  EXPECT_EQ(fit.stop, FitStop::explained);
  EXPECT_GE(fit.outliers, 1);
  EXPECT_LE(fit.outliers, outliers);
  EXPECT_LT(true_error(fit.field, at, {}), true_error(clean.field, at, {}) + 0.01);
}

TEST(FitConvex, TurnsWithTheFrame) {
  const ForceSamples samples = measured({14, -20});
  const Eigen::Matrix3d turn = some_rotation();
  const FitResult fit = fit_measured(samples);
  ForceSamples turned = samples;
  turned.displacements = turn * samples.displacements;
  turned.forces = turn * samples.forces;
  const FitResult other = fit_measured(turned);
  EXPECT_LT(largest_difference(turn.transpose() * forces_at(other.field, turned.displacements),
                               forces_at(fit.field, samples.displacements)),
            1e-3);
}

TEST(FitConvex, KeepsToTheUnitOfLength) {
  const ForceSamples samples = measured({14, -20});
  const FitResult fit = fit_measured(samples);
  for (const double unit : {0x1p-10, 0x1p10, 1e-3, 25.4}) {
    ForceSamples other = samples;
    other.displacements *= unit;
    *other.displacement_noise *= unit;
    const FitResult found = fit_measured(other);
    if (std::exp2(std::round(std::log2(unit))) == unit) {
      EXPECT_EQ(found.field, scaled(fit.field, 1, unit));
      EXPECT_EQ(found.rms, fit.rms);
    }
    EXPECT_LT(largest_difference(forces_at(found.field, other.displacements),
                                 forces_at(fit.field, samples.displacements)),
              1e-3);
  }
}

TEST(FitConvex, DoesNotDependOnTheOrderOfSamples) {
  const ForceSamples samples = measured({-14, 0});
  ForceSamples reversed = samples;
  reversed.displacements = samples.displacements.rowwise().reverse();
  reversed.forces = samples.forces.rowwise().reverse();
  EXPECT_EQ(fit_measured(samples).field, fit_measured(reversed).field);
}

TEST(FitConvex, IsContentWithTheAccuracyAskedFor) {
  const ForceSamples samples = measured({0, 0});
  const FitResult best = fit_measured(samples), rough = fit_measured(samples, {.accuracy = 0.2});
  EXPECT_EQ(rough.stop, FitStop::accurate);
  EXPECT_LE(rough.rms, 0.2);
  EXPECT_LT(rough.field.bases.size(), best.field.bases.size());
  EXPECT_LE(fit_measured(samples, {.max_bases = 3}).field.bases.size(), 3U);
}

TEST(FitConvex, RecognisesAContactThatIsAsGoodAsRigid) {
  const Eigen::Matrix3Xd forces = random_points(60, 3);
  const Eigen::Matrix3Xd places = 0.02 * random_points(60, 1, 2);
  const FitResult fit = fit_force_field(places, forces, {.noise = {.displacement = 0.02}});
  expect_convex(fit);
  EXPECT_EQ(fit.stop, FitStop::rigid);
  // The forces' extent would move it by three times the noise, in three components.
  const double extent = std::sqrt(forces.colwise().squaredNorm().mean());
  EXPECT_NEAR(fit.smallest_stiffness, extent / (3 * std::sqrt(3.0) * 0.02), 1e-9);
  // With less noise the same displacements count.
  EXPECT_NE(fit_force_field(places, forces, {.noise = {.displacement = 1e-3}}).stop,
            FitStop::rigid);
}

TEST(FitConvex, FallsBackToACertifiedFieldWhereNoConvexOneExplainsTheSamples) {
  // A spring that pushes away along x: no passive object has it.
  const Eigen::Matrix3Xd places = random_points(80, 2);
  Eigen::Matrix3Xd forces = 0.5 * places;
  forces.row(0) *= -1;
  const FitResult fit = fit_force_field(places, forces, {.noise = {.displacement = 0.01}});
  EXPECT_EQ(fit.mode, FitMode::certified);
  EXPECT_NE(fit.stop, FitStop::explained);
  EXPECT_TRUE(is_passive(fit.certificate));
  EXPECT_NEAR(force(fit.field, {0, 1, 0}).y(), 0.5, 0.15);
}

TEST(FitConvex, HasNoBumpOfForceBetweenRestAndFewNoisyPairs) {
  // A certified field explains these pairs best, and resists with 9 N where nothing was measured.
  const Strip sheet{.tension = 0.86476878406409,
                    .axial = 55.20421990482985,
                    .compliance = 0.3272175127181143,
                    .lateral = 0.03694263668597926,
                    .taper = 0.43917559121855143};
  const support::StripProbing few{.normal_forces = {0.5, 1.5, 3},
                                  .directions = 3,
                                  .position_noise = 0.08,
                                  .location_noise = 0.08,
                                  .force_noise = 0.04,
                                  .seed = 128};
  support::ObjectProbe<Strip> probe(sheet, few);
  probing::Acquisition acquisition;
  probe.probe_sparsely(acquisition, -35, -40, 0.5);
  const ForceSamples samples = realign(acquisition.contacts.front(), acquisition.samples);
  const FitResult fit =
      fit_force_field(samples.displacements, samples.forces, {.noise = {.displacement = 0.1}});
  const double most = samples.forces.colwise().norm().maxCoeff();
  for (const auto& pair : samples.displacements.colwise()) {
    for (int step = 1; step <= 50; ++step)
      EXPECT_LT(force(fit.field, 0.02 * step * pair).norm(), 1.2 * most) << step;
  }
}

TEST(FitConvex, SurvivesPoorData) {
  const Eigen::Matrix3Xd one = Eigen::Vector3d(0.3, 0.1, 2.2), two = random_points(2, 3);
  Eigen::Matrix3Xd line(3, 9);
  for (int i = 0; i < 9; ++i) line.col(i) = i * one;
  for (const Eigen::Matrix3Xd& places : {one, Eigen::Matrix3Xd(one.replicate(1, 9)), line, two}) {
    for (const double noise : {0.0, 0.03}) {
      const FitResult fit =
          fit_force_field(places, 0.5 * places, {.noise = {.displacement = noise}});
      EXPECT_NO_THROW(check_force_field(fit.field, "fit"));
      EXPECT_TRUE(is_passive(fit.certificate)) << places.cols();
      EXPECT_LT(fit.rms, 0.1) << places.cols();
      EXPECT_TRUE(force(fit.field, {5, 5, 5}).allFinite());
    }
  }
}

TEST(FitConvex, TakesAnyUnit) {
  const Eigen::Matrix3Xd places = random_points(60, 5);
  const FitResult tiny = fit_force_field(places, 1e-9 * places);
  expect_convex(tiny);
  const FitResult exact =
      fit_force_field(places, 1e-9 * places, {.noise = {.displacement = 1e-3, .force = 1e-12}});
  expect_convex(exact);
  EXPECT_LT(exact.rms, 1e-10);
  for (const double length : {1e-3, 1e3}) {
    const FitResult fit = fit_force_field(length * places, places);
    expect_convex(fit);
  }
}

TEST(FitConvex, FollowsAnObjectThatSoftens) {
  const ForceField truth = spring(9, 4);
  const Eigen::Matrix3Xd places = random_points(120, 8), others = random_points(50, 6, 9);
  const FitResult fit = fit_force_field(places, forces_at(truth, places));
  expect_convex(fit);
  EXPECT_EQ(fit.stop, FitStop::explained);
  EXPECT_LT(largest_difference(forces_at(fit.field, others), forces_at(truth, others)), 0.02);
}

}  // namespace
}  // namespace palpate::haptics
