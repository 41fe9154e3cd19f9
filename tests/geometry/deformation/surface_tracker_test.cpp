// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/surface_tracker.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "mesh_corpus.h"
#include "palpate/core/error.h"
#include "range_map_scene.h"
#include "refusal.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

constexpr int kTrackedWidth = 160;
const TrackingOptions kFewNodes{.nodes = 120};

TriangleMesh tracked_at(const Vector3d& shift) {
  return test::moved(test::bumpy(6000), Eigen::Isometry3d(Eigen::Translation3d(shift)));
}

RangeMap seen_at(const Vector3d& shift) {
  return test::render(tracked_at(shift), test::bumpy_camera(kTrackedWidth));
}

TEST(SurfaceTracker, FollowsAMotionOverSeveralFrames) {
  SurfaceTracker tracker(kFewNodes, tracked_at(Vector3d::Zero()));
  EXPECT_FALSE(tracker.has_start());
  for (int frame = 0; frame < 4; ++frame) {
    const Vector3d shift(0, 0, 6.0 * frame);
    const TrackedSurface found = tracker.track(seen_at(shift));
    ASSERT_EQ(found.lost, "");
    EXPECT_TRUE(tracker.has_start());
    EXPECT_LT(found.figures.rms, 0.3);
    EXPECT_LT(found.figures.stretch, 0.005);
    EXPECT_GT(found.figures.sigma_along, found.figures.sigma_across);
    EXPECT_LT(found.figures.sigma_along, 1);  // mm
    const Eigen::Matrix3Xd off = found.surface.vertices - tracked_at(shift).vertices;
    EXPECT_LT(off.colwise().norm().mean(), 1);  // pixels of 3.6 mm
  }
}

TEST(SurfaceTracker, LosesAHiddenSurfaceAndGoesOnFromTheFrameBefore) {
  SurfaceTracker tracker(kFewNodes, tracked_at(Vector3d::Zero()));
  const TrackedSurface first = tracker.track(seen_at(Vector3d::Zero()));
  RangeMap wall = seen_at(Vector3d::Zero());
  wall.z.setConstant(400);
  EXPECT_NE(tracker.track(wall).lost.find("min_visible"), std::string::npos);
  SurfaceTracker other(kFewNodes, tracked_at(Vector3d::Zero()));
  other.start_from(first.surface.node_motions);
  const RangeMap next = seen_at({0, 0, 3});
  const TrackedSurface after_loss = tracker.track(next);
  EXPECT_EQ(after_loss.lost, "");
  EXPECT_EQ(after_loss.surface.vertices, other.track(next).surface.vertices);
}

TEST(SurfaceTracker, RefusesAReferenceThatMustBeStretchedInTheFirstFrame) {
  // A twentieth larger, and so at other bumps.
  TriangleMesh larger = tracked_at(Vector3d::Zero());
  larger.vertices.topRows<2>() *= 1.05;
  const auto lost = [&](double max_stretch) {
    TrackingOptions options = kFewNodes;
    options.max_stretch = max_stretch;
    return SurfaceTracker(options, larger).track(seen_at(Vector3d::Zero())).lost;
  };
  EXPECT_EQ(lost(1), "");
  EXPECT_NE(lost(0).find("max_stretch"), std::string::npos);
}

TEST(SurfaceTracker, RefusesWrongOptionsAndAReferenceWithoutTriangles) {
  const auto refuse = [](const TrackingOptions& options) {
    return refusal([&] { return SurfaceTracker(options, tracked_at(Vector3d::Zero())); });
  };
  EXPECT_NE(refuse({.nodes = 0}).find("TrackingOptions::nodes is 0"), std::string::npos);
  EXPECT_NE(refuse({.reach = std::numeric_limits<double>::quiet_NaN()})
                .find("TrackingOptions::reach is nan"),
            std::string::npos);
  EXPECT_NE(refuse({.min_visible = 1.5}).find("TrackingOptions::min_visible is 1.5"),
            std::string::npos);
  EXPECT_NE(refusal([] { return SurfaceTracker({}, TriangleMesh{}); }).find("no triangles"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::geometry
