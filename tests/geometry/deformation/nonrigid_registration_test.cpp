// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/nonrigid_registration.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <limits>
#include <vector>

#include "file_testing.h"
#include "mesh_corpus.h"
#include "not_finite.h"
#include "palpate/core/error.h"
#include "palpate/geometry/error_statistics.h"
#include "range_map_scene.h"
#include "test_surfaces.h"
#include "told_progress.h"

namespace palpate::geometry {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr int kWidth = 192;  // pixels of 3 mm

TriangleMesh rest_mesh() { return test::bumpy(12000); }

const DeformationGraph& rest_graph() {
  static const DeformationGraph graph(rest_mesh(), {.nodes = 250});
  return graph;
}

Vector3d poked_and_bent(const Vector3d& rest, double depth = 20) {
  return test::bent(test::dented_block(rest, depth));
}

/// Distances of the vertices in `which` from their true places.
ErrorStatistics errors(const Matrix3Xd& found, const Matrix3Xd& truth,
                       const std::vector<bool>& which) {
  std::vector<double> distances;
  for (Eigen::Index v = 0; v < truth.cols(); ++v) {
    if (which[static_cast<std::size_t>(v)]) {
      distances.push_back((found.col(v) - truth.col(v)).norm());
    }
  }
  return error_statistics(distances);
}

std::vector<bool> all(const TriangleMesh& mesh) {
  return std::vector(static_cast<std::size_t>(mesh.vertices.cols()), true);
}

TEST(RegisterDeformed, LeavesASurfaceThatHasNotMoved) {
  const TriangleMesh rest = rest_mesh();
  const RangeMap map = test::render(rest, test::bumpy_camera(kWidth));
  const DeformedSurface found = register_deformed(rest_graph(), map);
  EXPECT_EQ(found.stop, NonRigidStop::converged);
  // The planes of pixels 3 mm wide on ripples that bend by 1 / 20 mm.
  EXPECT_LT(errors(found.vertices, rest.vertices, all(rest)).rms, 0.1);
  EXPECT_LT(found.rms, 0.1);
  EXPECT_GT(found.matched, 0.97);
}

TEST(RegisterDeformed, IsNotPulledByDepthsThatAreBiasedAtTheBorder) {
  const TriangleMesh rest = rest_mesh();
  RangeMap map = test::render(rest, test::bumpy_camera(kWidth));
  const ImageF exact = map.z;
  // Like the windows of a fringe sensor: too near at the upper border, too far at the lower one.
  for (Eigen::Index row = 3; row + 3 < exact.rows(); ++row) {
    for (Eigen::Index col = 0; col < exact.cols(); ++col) {
      if (std::isnan(exact(row - 3, col))) map.z(row, col) -= 6;
      if (std::isnan(exact(row + 3, col))) map.z(row, col) += 6;
    }
  }
  const DeformedSurface found = register_deformed(rest_graph(), map);
  EXPECT_EQ(found.stop, NonRigidStop::converged);
  EXPECT_LT(errors(found.vertices, rest.vertices, all(rest)).rms, 0.15);
}

/// A plane of 100 mm that faces the camera, pressed in by 3 mm within 9 mm of its middle, and its
/// range map; no depth within 6 mm, where a tool stands.
struct PressedPlane {
  TriangleMesh rest, pressed;
  RangeMap map;
  Eigen::Index middle = 0;

  PressedPlane() {
    constexpr int kSide = 51;
    rest.vertices.resize(3, kSide * kSide);
    for (int i = 0; i < kSide * kSide; ++i)
      rest.vertices.col(i) << 2 * (i % kSide) - 50, 2 * (i / kSide) - 50, 700;
    rest.triangles.resize(3, 2 * (kSide - 1) * (kSide - 1));
    for (int y = 0, t = 0; y + 1 < kSide; ++y) {
      for (int x = 0; x + 1 < kSide; ++x) {
        const int corner = y * kSide + x;
        rest.triangles.col(t++) << corner, corner + kSide, corner + 1;
        rest.triangles.col(t++) << corner + 1, corner + kSide, corner + kSide + 1;
      }
    }
    middle = kSide * kSide / 2;
    pressed = test::deformed(rest, [](const Vector3d& p) {
      return Vector3d(p.x(), p.y(), p.z() + 3 * std::exp(-p.head<2>().squaredNorm() / 81));
    });
    const Camera camera{
        .width = 200, .height = 200, .fx = 1000, .fy = 1000, .cx = 99.5, .cy = 99.5};
    map = test::render(pressed, camera);
    for (Eigen::Index v = 0; v < 200; ++v)
      for (Eigen::Index u = 0; u < 200; ++u)
        if (std::hypot(static_cast<double>(v) - 99.5, static_cast<double>(u) - 99.5) * 0.7 < 6)
          map.z(v, u) = std::numeric_limits<float>::quiet_NaN();
  }
};

TEST(RegisterDeformed, APlaneThatIsHeldDoesNotSlideInItself) {
  const PressedPlane plane;
  const DeformationGraph graph(plane.rest, {.nodes = 250});
  // A fault at one side that pulls along the plane, as depths beside a shadow do.
  RangeMap faulty = plane.map;
  for (Eigen::Index v = 60; v < 140; ++v)
    for (Eigen::Index u = 40; u < 60; ++u) faulty.z(v, u) += 0.15F * static_cast<float>(u - 40);
  const auto slid = [&](double hold) {
    const DeformedSurface found =
        register_deformed(graph, faulty, {.stiffness = 0.01, .hold = hold});
    return (found.vertices - plane.rest.vertices).topRows<2>().rowwise().mean().norm();
  };
  const double held = slid(0.003), free = slid(0);
  EXPECT_LT(held, 0.1) << free;
  EXPECT_LT(held, 0.3 * free);
}

TEST(RegisterDeformed, GoesThroughWhatIsKnownWhereTheMapShowsNothing) {
  const PressedPlane plane;
  const DeformationGraph graph(plane.rest, {.nodes = 600});
  const KnownVertex tool{static_cast<int>(plane.middle), plane.pressed.vertices.col(plane.middle)};
  std::vector<bool> hidden(all(plane.rest));
  for (std::size_t v = 0; v < hidden.size(); ++v)
    hidden[v] = plane.rest.vertices.col(static_cast<Eigen::Index>(v)).head<2>().norm() < 6;
  const NonRigidOptions held{.hold = 0.003};
  const DeformedSurface alone = register_deformed(graph, plane.map, held),
                        with = register_deformed(graph, plane.map, held, {}, {&tool, 1});
  EXPECT_LT((with.vertices.col(plane.middle) - tool.place).norm(), 0.2);
  EXPECT_LT(errors(with.vertices, plane.pressed.vertices, hidden).rms,
            0.6 * errors(alone.vertices, plane.pressed.vertices, hidden).rms);
  EXPECT_THROW(
      (void)register_deformed(graph, plane.map, held, {}, std::vector{KnownVertex{.vertex = -1}}),
      InvalidInput);
  EXPECT_THROW((void)register_deformed(graph, plane.map, held, {},
                                       std::vector{KnownVertex{0, Vector3d::Constant(kNaN)}}),
               InvalidInput);
}

TEST(RegisterDeformed, FindsARigidMotion) {
  const TriangleMesh rest = rest_mesh();
  const Isometry3d T = Eigen::Translation3d(9.1, -6.3, 690.7) *
                       Eigen::AngleAxisd(0.05, Vector3d(0.3, 0.8, -0.5).normalized()) *
                       Eigen::Translation3d(0, 0, -700);
  const TriangleMesh moved = test::moved(rest, T);
  const RangeMap map = test::render(moved, test::bumpy_camera(kWidth));
  const DeformedSurface found = register_deformed(rest_graph(), map);
  EXPECT_EQ(found.stop, NonRigidStop::converged);
  EXPECT_LT(errors(found.vertices, moved.vertices, test::visible(moved.vertices, moved, map)).rms,
            0.1);
  for (const Isometry3d& motion : found.node_motions) {
    EXPECT_LT(Eigen::AngleAxisd((motion.inverse() * T).linear()).angle(), 0.02);
  }
}

TEST(RegisterDeformed, FollowsADentAndABend) {
  for (const bool has_lens : {false, true}) {
    Camera camera = test::bumpy_camera(kWidth);
    if (has_lens) camera.distortion = {-0.21, 0.04, 0.003, -0.002};
    const TriangleMesh moved =
        test::deformed(rest_mesh(), [](const Vector3d& p) { return poked_and_bent(p); });
    const RangeMap map = test::render(moved, camera);
    const DeformedSurface found = register_deformed(rest_graph(), map);
    EXPECT_EQ(found.stop, NonRigidStop::converged);
    const std::vector<bool> visible = test::visible(moved.vertices, moved, map);
    const ErrorStatistics error = errors(found.vertices, moved.vertices, visible);
    EXPECT_LT(error.rms, 1.0);
    EXPECT_LT(error.median, 0.5);
    for (std::size_t v = 0; v < visible.size(); ++v) {
      if (found.sight[v] != VertexSight::seen) continue;
      const auto i = static_cast<Eigen::Index>(v);
      // The measured point is on the vertex's ray, and that is in its pixel or the next.
      const Vector3d measured = found.measured.col(i);
      EXPECT_LT(measured.cross(found.vertices.col(i)).norm(), 1e-9 * measured.squaredNorm());
      const Eigen::Vector2d image = distort(camera, measured.hnormalized());
      EXPECT_EQ(std::lround(image.y()) * camera.width + std::lround(image.x()), found.pixel[v]);
    }
  }
}

TEST(RegisterDeformed, ToleratesNoiseHolesAndATool) {
  const TriangleMesh moved =
      test::deformed(rest_mesh(), [](const Vector3d& p) { return poked_and_bent(p); });
  const Vector3d tip = poked_and_bent({test::kDent.x(), test::kDent.y(), 640});
  const TriangleMesh scene =
      test::together(moved, test::rod(tip, tip + Vector3d(-130, 90, -150), 9));
  RangeMap map = test::render(scene, test::bumpy_camera(kWidth));
  const std::vector<bool> before_tool = test::visible(moved.vertices, scene, map);
  test::add_noise(map, 0.25, 5);
  test::punch_holes(map, 0.15, 6);
  const std::vector<bool> visible = test::visible(moved.vertices, scene, map);
  // The noise is low beside the dent of 20 mm, which a low stiffness follows best.
  const DeformedSurface found = register_deformed(rest_graph(), map, {.stiffness = 0.01});
  EXPECT_EQ(found.stop, NonRigidStop::converged);
  EXPECT_LT(errors(found.vertices, moved.vertices, visible).rms, 1.0);

  std::vector<bool> hidden = visible;
  hidden.flip();
  EXPECT_LT(errors(found.vertices, moved.vertices, hidden).rms, 1.5);
  // Under the tool the surface is not measured; it has followed by most of the dent.
  const double gate = NonRigidOptions{}.min_correspondence * bounding_diagonal(rest_mesh());
  long behind = 0;
  long named = 0;
  for (std::size_t v = 0; v < before_tool.size(); ++v) {
    const auto i = static_cast<Eigen::Index>(v);
    const bool on_map = std::isfinite(found.measured(0, i));
    EXPECT_EQ(on_map, found.sight[v] == VertexSight::seen);
    EXPECT_EQ(on_map, found.pixel[v] >= 0);
    EXPECT_EQ(on_map, std::isfinite(found.distance[i]));
    if (on_map) {
      // The distance from the plane is at most that along the ray, and within the gate.
      const double along_ray = (found.measured.col(i) - found.vertices.col(i)).norm();
      EXPECT_LE(std::abs(found.distance[i]), std::min(along_ray * (1 + 1e-12), gate));
      EXPECT_EQ(found.distance[i] > 0, found.vertices(2, i) < found.measured(2, i));
    }
    if (before_tool[v] || (moved.vertices.col(i) - tip).norm() < 30) continue;
    ++behind;
    named += found.sight[v] == VertexSight::occluded || found.sight[v] == VertexSight::hole ||
                     found.sight[v] == VertexSight::outside
                 ? 1
                 : 0;
  }
  EXPECT_GT(behind, 50);
  EXPECT_GT(named, 0.85 * static_cast<double>(behind));
}

/// [mm] The median of `sigma_along` where the surface is seen.
double median_along(const DeformedSurface& found) {
  std::vector<double> along;
  for (std::size_t v = 0; v < found.sight.size(); ++v) {
    if (found.sight[v] == VertexSight::seen)
      along.push_back(found.sigma_along[static_cast<Eigen::Index>(v)]);
  }
  EXPECT_GT(along.size(), found.sight.size() / 5);
  return error_statistics(along).median;
}

TEST(RegisterDeformed, FollowsGrowthOfTheWholeSurface) {
  const TriangleMesh rest = rest_mesh();
  const Vector3d centre = rest.vertices.rowwise().mean();
  for (const double growth : {0.97, 1.04}) {
    const TriangleMesh moved = test::deformed(
        rest, [&](const Vector3d& p) -> Vector3d { return centre + growth * (p - centre); });
    RangeMap map = test::render(moved, test::bumpy_camera(kWidth));
    test::add_noise(map, 0.3, 3);
    const std::vector<bool> visible = test::visible(moved.vertices, moved, map);
    const DeformedSurface found = register_deformed(rest_graph(), map);
    EXPECT_EQ(found.stop, NonRigidStop::converged);
    EXPECT_LT(errors(found.vertices, moved.vertices, visible).rms,
              0.1 * errors(rest.vertices, moved.vertices, visible).rms)
        << growth;
  }
}

/// Intensities of a plane z = 700 mm that has moved along itself, under a light that falls off to
/// one side.
ImageF texture_of_plane(const Camera& camera, const Eigen::Vector2d& shift, double light) {
  const Eigen::Matrix2Xd rays = pixel_rays(camera);
  ImageF image(camera.height, camera.width);
  for (Eigen::Index i = 0; i < rays.cols(); ++i) {
    const Eigen::Vector2d seen = 700 * rays.col(i), p = seen - shift;
    const double albedo = 100 + 25 * std::sin(p.x() / 1.7 + 0.4 * p.y()) +
                          25 * std::sin(p.y() / 1.9 - 0.3 * p.x() + 1);
    image(i / camera.width, i % camera.width) =
        static_cast<float>(light * albedo * (1 + 0.003 * seen.x()) + 20 * (light - 1));
  }
  return image;
}

TEST(RegisterDeformed, FollowsATextureWhereDepthsShowNothing) {
  const TriangleMesh rest = PressedPlane().rest;
  const Eigen::Vector2d shift(1.6, -1.1);
  TriangleMesh moved = rest;
  moved.vertices.topRows<2>().colwise() += shift;
  const Camera camera{.width = 200, .height = 200, .fx = 1000, .fy = 1000, .cx = 99.5, .cy = 99.5};
  RangeMap before = test::render(rest, camera), after = test::render(moved, camera);
  test::add_noise(before, 0.3, 1);
  test::add_noise(after, 0.3, 2);
  const DeformationGraph graph(rest, {.nodes = 250});
  // Any position of the vertices along the plane in the first frame is as good as another.
  const DeformedSurface start = register_deformed(graph, before);
  Matrix3Xd truth = start.vertices;
  truth.topRows<2>().colwise() += shift;
  SeenIntensities seen{.image = texture_of_plane(camera, shift, 1.4),
                       .vertices = vertex_intensities(
                           camera, texture_of_plane(camera, Eigen::Vector2d::Zero(), 1), start)};
  const DeformedSurface blind = register_deformed(graph, after, {}, start.node_motions),
                        found = register_deformed(graph, after, {}, start.node_motions, {}, seen);
  const std::vector<bool> visible = test::visible(moved.vertices, moved, after);
  EXPECT_GT(errors(blind.vertices, truth, visible).median, 1);
  EXPECT_LT(errors(found.vertices, truth, visible).median, 0.2);
  EXPECT_GT(median_along(blind), 1);
  EXPECT_LT(median_along(found), 0.2);
  // The unit of the intensities does not matter.
  SeenIntensities brighter = seen;
  brighter.image *= 8;
  brighter.vertices *= 8;
  EXPECT_NEAR(median_along(register_deformed(graph, after, {}, start.node_motions, {}, brighter)),
              median_along(found), 1e-6);

  // An image that has nothing to do with the surface gives no information.
  test::add_noise(before, 20, 3);
  seen.image = before.z;
  EXPECT_GT(median_along(register_deformed(graph, after, {}, start.node_motions, {}, seen)), 1);
  seen.image = ImageF::Zero(3, 4);
  EXPECT_THROWS_MESSAGE(
      static_cast<void>(register_deformed(graph, after, {}, start.node_motions, {}, seen)),
      InvalidInput, "the intensities are 4 x 3 px");
  seen.vertices.conservativeResize(Eigen::NoChange, 7);
  EXPECT_THROWS_MESSAGE(
      static_cast<void>(register_deformed(graph, after, {}, start.node_motions, {}, seen)),
      InvalidInput, "7 vertices have intensities");
}

TEST(RegisterDeformed, StaysOnAPlateWhereNothingShowsAShift) {
  // Sliding cannot be seen; it must not be invented either.
  TriangleMesh plate = rest_mesh();
  for (Eigen::Index v = 0; v < plate.vertices.cols(); ++v) {
    plate.vertices.col(v) *= 700 / plate.vertices(2, v);
  }
  const DeformationGraph graph(plate, {.nodes = 250});
  const TriangleMesh moved =
      test::deformed(plate, [](const Vector3d& p) { return poked_and_bent(p); });
  const RangeMap map = test::render(moved, test::bumpy_camera(kWidth));
  const DeformedSurface found = register_deformed(graph, map);
  EXPECT_EQ(found.stop, NonRigidStop::converged);
  const ErrorStatistics error =
      errors(found.vertices, moved.vertices, test::visible(moved.vertices, moved, map));
  EXPECT_LT(error.rms, 5);
  EXPECT_LT(found.rms, 0.3);
}

TEST(RegisterDeformed, TracksASequenceThatLeavesTheReachOfTheStart) {
  const TriangleMesh rest = rest_mesh();
  std::vector<Isometry3d> start;
  RangeMap last;
  for (int frame = 1; frame <= 7; ++frame) {
    const TriangleMesh moved = test::deformed(rest, [&](const Vector3d& p) -> Vector3d {
      return poked_and_bent(p, 3.0 * frame) + frame * Vector3d(3, 2, 11);
    });
    const RangeMap map = test::render(moved, test::bumpy_camera(kWidth));
    const DeformedSurface surface = register_deformed(rest_graph(), map, {}, start);
    EXPECT_EQ(surface.stop, NonRigidStop::converged) << frame;
    const auto visible = test::visible(moved.vertices, moved, map);
    EXPECT_LT(errors(surface.vertices, moved.vertices, visible).rms, 1.0) << frame;
    start = surface.node_motions;
    last = map;
  }
  EXPECT_NE(register_deformed(rest_graph(), last).stop, NonRigidStop::converged);
}

TEST(RegisterDeformed, SaysWhenThereIsNothingToLieOn) {
  const TriangleMesh rest = rest_mesh();
  RangeMap map = test::render(rest, test::bumpy_camera(kWidth));
  const RangeMap unknown{ImageF::Constant(map.z.rows(), map.z.cols(), static_cast<float>(kNaN)),
                         map.camera};
  RangeMap beside = map;
  beside.camera.cx += 3 * kWidth;
  RangeMap before = map;
  before.z -= 200;
  RangeMap negative = map;
  negative.z *= -1;
  for (const RangeMap& other : {unknown, beside, before, negative}) {
    const DeformedSurface found = register_deformed(rest_graph(), other);
    EXPECT_EQ(found.stop, NonRigidStop::no_overlap);
    EXPECT_LT((found.vertices - rest.vertices).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_TRUE(std::isnan(found.rms));
    EXPECT_EQ(found.matched, 0);
  }
}

TEST(RegisterDeformed, RefusesAMapThatMostlyShowsSomethingElse) {
  RangeMap map = test::render(rest_mesh(), test::bumpy_camera(kWidth));
  map.z.rightCols(kWidth * 8 / 10) = 400;
  const DeformedSurface found = register_deformed(rest_graph(), map);
  EXPECT_EQ(found.stop, NonRigidStop::poor_match);
  EXPECT_NEAR(found.matched, 0.2, 0.05);
  EXPECT_EQ(register_deformed(rest_graph(), map, {.min_matched = 0.1}).stop,
            NonRigidStop::converged);
}

TEST(RegisterDeformed, StopsWhenItMayGoNoFurther) {
  const TriangleMesh moved =
      test::deformed(rest_mesh(), [](const Vector3d& p) { return poked_and_bent(p); });
  const RangeMap map = test::render(moved, test::bumpy_camera(kWidth));
  const DeformedSurface found = register_deformed(rest_graph(), map, {.max_iterations = 3});
  EXPECT_EQ(found.stop, NonRigidStop::max_iterations);
  EXPECT_EQ(found.iterations, 3);
}

TEST(RegisterDeformed, TellsItsProgress) {
  const RangeMap map = test::render(rest_mesh(), test::bumpy_camera(kWidth));
  check_progress(
      [&](const auto& progress) {
        (void)register_deformed(rest_graph(), map, {.progress = progress});
      },
      3);
}

TEST(RegisterDeformed, DoesNotDependOnTheUnitOfLength) {
  const TriangleMesh moved =
      test::deformed(rest_mesh(), [](const Vector3d& p) { return poked_and_bent(p); });
  RangeMap map = test::render(moved, test::bumpy_camera(kWidth));
  test::add_noise(map, 0.25, 5);
  const DeformedSurface found = register_deformed(rest_graph(), map);
  for (const double scale : {0x1p-10, 0x1p10}) {
    const DeformationGraph graph(test::scaled(rest_mesh(), scale), {.nodes = 250});
    RangeMap scaled = map;
    scaled.z *= static_cast<float>(scale);
    const DeformedSurface other = register_deformed(graph, scaled);
    EXPECT_EQ(other.vertices, found.vertices * scale);
    EXPECT_EQ(other.sight, found.sight);
    EXPECT_EQ(other.rms, found.rms * scale);
  }
}

TEST(RegisterDeformed, DoesNotDependOnTheNumberOfThreads) {
  const TriangleMesh moved =
      test::deformed(rest_mesh(), [](const Vector3d& p) { return poked_and_bent(p, 12.0); });
  RangeMap map = test::render(moved, test::bumpy_camera(kWidth));
  test::add_noise(map, 0.25, 7);
  const DeformedSurface together = register_deformed(rest_graph(), map);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const DeformedSurface alone = register_deformed(rest_graph(), map);
  EXPECT_EQ(together.vertices, alone.vertices);
  EXPECT_EQ(together.pixel, alone.pixel);
  EXPECT_EQ(together.sigma_across, alone.sigma_across);
  EXPECT_EQ(together.sigma_along, alone.sigma_along);
}

TEST(RegisterDeformed, RefusesBadOptionsAndAnotherStart) {
  const RangeMap map{ImageF::Constant(3, 4, 700.1F),
                     {.width = 4, .height = 3, .fx = 4, .fy = 4, .cx = 1.5, .cy = 1}};
  const auto refuse = [&](const NonRigidOptions& options, const char* words) {
    EXPECT_THROWS_MESSAGE(static_cast<void>(register_deformed(rest_graph(), map, options)),
                          InvalidInput, words);
  };
  refuse({.max_iterations = 0}, "max_iterations is 0; it must be >= 1");
  for (const double bad : {0.0, -1.0, kNaN}) {
    refuse({.max_correspondence = bad}, "max_correspondence");
    refuse({.min_correspondence = bad}, "min_correspondence");
    refuse({.max_normal_angle = bad}, "max_normal_angle");
    refuse({.stiffness = bad}, "stiffness");
  }
  refuse({.hold = -1}, "NonRigidOptions::hold is -1");
  refuse({.min_correspondence = 0.07}, "at most max_correspondence");
  refuse({.max_normal_angle = 1.6}, "pi/2");
  refuse({.min_matched = 1.1}, "min_matched");
  refuse({.min_matched = kNaN}, "min_matched");

  std::vector<Isometry3d> start(3, Isometry3d::Identity());
  EXPECT_THROWS_MESSAGE(static_cast<void>(register_deformed(rest_graph(), map, {}, start)),
                        InvalidInput, "3 node motions, the graph has 250");
  start.assign(250, Isometry3d::Identity());
  start[17].translation().y() = kNaN;
  EXPECT_THROWS_MESSAGE(static_cast<void>(register_deformed(rest_graph(), map, {}, start)),
                        InvalidInput, "motion 17");
  RangeMap other = map;
  other.camera.width = 5;
  EXPECT_THROWS_MESSAGE(static_cast<void>(register_deformed(rest_graph(), other)), InvalidInput,
                        "the camera is 5 x 3 px");
}

}  // namespace
}  // namespace palpate::geometry
