// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/reduce_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/geometry/mesh_distance.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/contact_compliance.h"
#include "palpate/haptics/model_io.h"
#include "sheet_model.h"
#include "sphere_model.h"
#include "told_progress.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

const Model& ball() {
  static const Model model = with_compliances(
      ball_model([](const Vector3d&) { return true; }, [](int) { return 0.0; }, 60, 3), 3);
  return model;
}

// RMS difference of the blended forces at places all over the ball, pressed by 1 to 4 mm.
double blended_difference(const Model& a, const Model& b) {
  const BlendedField of_a(a), of_b(b);
  double sum = 0;
  const std::vector<Vector3d> places = places_on_sphere(500);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vector3d press = -(1 + static_cast<double>(i % 4)) * places[i].normalized();
    sum += (of_a.force(places[i], press) - of_b.force(places[i], press)).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(places.size()));
}

TEST(ReduceModel, DiffersByNoMoreThanAllowed) {
  std::size_t before = ball().contacts.size();
  for (const double error : {0.04, 0.2}) {
    const ReducedModel reduced = reduce_model(ball(), {.max_error = error, .strokes = 1000});
    EXPECT_NO_THROW(check_model(reduced.model));
    EXPECT_LE(reduced.difference.rms, error);
    EXPECT_EQ(reduced.raised, 1);
    EXPECT_LT(blended_difference(ball(), reduced.model), 1.2 * error);
    EXPECT_LE(reduced.model.contacts.size(), before);
    before = reduced.model.contacts.size();
    EXPECT_EQ(reduced.predicted.size() + before, ball().contacts.size());
  }
  EXPECT_LT(before, 15U);
}

TEST(ReduceModel, StatesABoundOfTheDistanceBetweenTheSurfaces) {
  const Model fine = with_compliances(
      ball_model([](const Vector3d&) { return true; }, [](int) { return 0.0; }, 20, 4), 3);
  const ReducedModel reduced =
      reduce_model(fine, {.max_error = 0.5, .max_surface_error = 2, .strokes = 1000});
  EXPECT_LT(reduced.model.surface.vertices.cols(), fine.surface.vertices.cols() / 2);
  EXPECT_LE(reduced.surface_distance, 2);
  EXPECT_GT(reduced.surface_distance, 0);
  const geometry::HausdorffDistance distance =
      geometry::hausdorff_distance(fine.surface, reduced.model.surface);
  EXPECT_LE(distance.lower, reduced.surface_distance);
}

// A picture of fewer pixels tells less of the surface; the smaller of two limits holds.
TEST(ReduceModel, KeepsTheSurfaceWithinAPixelOfAPicture) {
  const Model fine = with_compliances(
      ball_model([](const Vector3d&) { return true; }, [](int) { return 0.0; }, 20, 4), 3);
  const double diagonal = geometry::bounding_diagonal(fine.surface);
  const auto with = [&](double pixels, std::optional<double> error) {
    return reduce_model(
        fine,
        {.max_error = 0.5, .max_surface_error = error, .picture_size = pixels, .strokes = 500});
  };
  const ReducedModel coarse = with(60, {}), sharp = with(600, {}),
                     limited = with(60, diagonal / 600);
  EXPECT_LE(coarse.surface_distance, diagonal / 60);
  EXPECT_GT(coarse.surface_distance, diagonal / 600);
  EXPECT_LE(sharp.surface_distance, diagonal / 600);
  EXPECT_LT(coarse.model.surface.vertices.cols(), sharp.model.surface.vertices.cols());
  EXPECT_EQ(limited.model.surface.vertices, sharp.model.surface.vertices);
}

TEST(ReduceModel, LosesTheContactsThatTheToolCannotReach) {
  std::vector<bool> above;
  for (const auto& vertex : ball().surface.vertices.colwise()) above.push_back(vertex.z() > 0);
  const ReducedModel reduced =
      reduce_model(ball(), {.max_error = 0.05, .strokes = 1000, .reachable = above});
  EXPECT_GT(reduced.out_of_reach.size(), 10U);
  EXPECT_LE(reduced.difference.rms, 0.05);
  for (const long long id : reduced.out_of_reach)
    EXPECT_LT(places_on_sphere(60)[static_cast<std::size_t>(id)].z(), 0.2 * kSphereRadius);
}

TEST(ReduceModel, RaisesTheErrorUntilTheFolderIsSmallEnough) {
  const ReducedModel wanted = reduce_model(ball(), {.max_error = 0.05, .strokes = 1000});
  const double size = 0.5 * wanted.size_after;
  const ReducedModel small =
      reduce_model(ball(), {.max_error = 0.05, .max_size = size, .strokes = 1000});
  EXPECT_GT(small.raised, 1);
  EXPECT_NEAR(small.allowed, 0.05 * small.raised, 1e-9);
  EXPECT_LE(small.difference.rms, small.allowed);
  const ScratchFolder scratch;
  write_model(scratch / "model", small.model);
  double written = 0;
  for (const auto& file : std::filesystem::directory_iterator(scratch / "model"))
    written += static_cast<double>(file.file_size());
  EXPECT_LE(written, size);
  EXPECT_THAT(refusal([&] { return reduce_model(ball(), {.max_size = 100, .strokes = 1000}); }),
              HasSubstr("ReduceOptions::max_size is 100; this model cannot be made smaller than"));
}

// The error of the object is that of the full model and that of the reduction.
TEST(ReduceModel, CountsTheErrorThatTheModelStates) {
  Model model = ball();
  for (ContactModel& contact : model.contacts)
    contact.uncertainty = {.force = 0.2, .displacement = 0, .across = 0, .between = 0};
  const ReducedModel reduced = reduce_model(model, {.max_error = 0.5, .strokes = 1000});
  ASSERT_TRUE(reduced.stated_before);
  const double own = *reduced.stated_before;
  EXPECT_NEAR(own, 0.2, 0.04);  // warps scale it
  EXPECT_NEAR(reduced.allowed, std::sqrt(0.5 * 0.5 - own * own), 1e-9);
  const ReducedModel too_much = reduce_model(model, {.max_error = 0.1, .strokes = 1000});
  EXPECT_NEAR(too_much.raised, 1.1 * own / 0.1, 1e-6);
  EXPECT_NEAR(too_much.allowed, std::sqrt(1.21 - 1) * own, 1e-9);
}

TEST(ReduceModel, TakesAShareOfTheForce) {
  const ReducedModel reduced = reduce_model(ball(), {.max_relative_error = 0.05, .strokes = 1000});
  EXPECT_NEAR(reduced.allowed / reduced.force_rms, 0.05, 0.002);  // of other strokes
  EXPECT_LE(reduced.difference.rms, reduced.allowed);
}

// Otherwise the difference would be too small: it is measured where it was made small.
TEST(ReduceModel, MeasuresWithOtherStrokesThanThoseThatChose) {
  for (const int seed : {0, 1}) {
    const ReducedModel reduced =
        reduce_model(ball(), {.max_error = 0.1, .strokes = 1000, .seed = seed});
    ASSERT_EQ(reduced.simpler_fields, 0);
    EXPECT_GT(std::abs(reduced.difference.rms - reduced.rms_of_contacts_and_surface), 1e-4);
  }
}

TEST(ReduceModel, GivesTheSameModelAgain) {
  const ReduceOptions options{.max_error = 0.1, .strokes = 1000};
  const ReducedModel a = reduce_model(ball(), options), b = reduce_model(ball(), options);
  EXPECT_EQ(a.predicted, b.predicted);
  EXPECT_EQ(a.model.surface.vertices, b.model.surface.vertices);
  EXPECT_EQ(a.difference.rms, b.difference.rms);
}

TEST(ReduceModel, TellsItsProgress) {
  check_progress(
      [](const std::function<void(int, int)>& progress) {
        static_cast<void>(reduce_model(
            sheet_model(),
            {.largest_depth = 3, .slip = false, .strokes = 100, .progress = progress}));
      },
      3);
}

TEST(ReduceModel, RefusesWhatCannotBe) {
  const auto refused = [](const ReduceOptions& options) {
    return refusal([&] { return reduce_model(sheet_model(), options); });
  };
  EXPECT_THAT(refused({.max_error = 0}), HasSubstr("ReduceOptions::max_error is 0"));
  EXPECT_THAT(refused({.max_error = 0.1}), HasSubstr("does not say how far it was measured"));
  EXPECT_THAT(refused({.largest_depth = 2, .reachable = {true}}),
              HasSubstr("reachable has 1 values; the surface of the model has 121 vertices"));
  EXPECT_THAT(refused({.largest_depth = 2, .reachable = std::vector<bool>(121, false)}),
              HasSubstr("0 contacts have influence in the region"));
}

}  // namespace
}  // namespace palpate::haptics
