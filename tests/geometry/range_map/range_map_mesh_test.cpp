// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/range_map_mesh.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <numbers>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <string>

#include "file_testing.h"
#include "not_finite.h"
#include "palpate/core/error.h"
#include "repository.h"

namespace palpate::geometry {
namespace {

namespace fs = std::filesystem;

constexpr double kFloat = 1e-7;  // rounding of a depth to float, relative to it

Camera camera_of(double focal_length_px) {
  return {.width = 61,
          .height = 47,
          .fx = focal_length_px,
          .fy = 0.99 * focal_length_px,
          .cx = 29.3,
          .cy = 24.1};
}

/// Depths along the axis that `depth` gives for each ray (x / z, y / z, 1).
RangeMap seen(const Camera& camera, const std::function<double(const Eigen::Vector3d&)>& depth) {
  RangeMap map{ImageF(camera.height, camera.width), camera};
  for (int row = 0; row < camera.height; ++row)
    for (int col = 0; col < camera.width; ++col)
      map.z(row, col) = static_cast<float>(depth(undistort(camera, {col, row}).homogeneous()));
  return map;
}

/// The plane through (0, 0, distance) whose normal is turned by `tilt` from the axis.
struct Plane {
  double distance;
  double tilt;
  [[nodiscard]] Eigen::Vector3d normal() const {  // towards the camera
    const Eigen::Vector3d axis(0.6, 0.8, 0);
    return Eigen::AngleAxisd(tilt, axis) * -Eigen::Vector3d::UnitZ();
  }
  double operator()(const Eigen::Vector3d& ray) const {
    return distance * normal().z() / normal().dot(ray);
  }
};

Eigen::Index cells(const Camera& camera) {
  return static_cast<Eigen::Index>((camera.width - 1) * (camera.height - 1));
}

double depth_range(const TriangleMesh& mesh, Eigen::Index triangle) {
  Eigen::Vector3d z;
  for (int i = 0; i < 3; ++i) z[i] = mesh.vertices(2, mesh.triangles(i, triangle));
  return z.maxCoeff() - z.minCoeff();
}

TEST(RangeMapMesh, APlaneIsWholeInItsPlaceAndFacesTheCamera) {
  for (const double tilt : {0.0, 0.5, -1.1}) {
    const Plane plane{700.1, tilt};
    const RangeMap map = seen(camera_of(603.7), plane);
    const auto [mesh, pixel, width, height] = mesh_range_map(map);
    EXPECT_EQ(Eigen::Vector2i(width, height), Eigen::Vector2i(61, 47));
    EXPECT_EQ(mesh.triangles.cols(), 2 * cells(map.camera));
    ASSERT_EQ(mesh.vertices.cols(), map.z.size());
    for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
      const Eigen::Vector3d vertex = mesh.vertices.col(i);
      EXPECT_NEAR(plane.normal().dot(vertex - Eigen::Vector3d(0, 0, plane.distance)), 0,
                  kFloat * vertex.norm());
      const Eigen::Vector2d image = distort(map.camera, vertex.hnormalized());
      EXPECT_EQ(std::lround(image.y()) * map.camera.width + std::lround(image.x()),
                pixel[static_cast<std::size_t>(i)]);
    }
    // Edges of 1 mm and depths that are rounded by 3e-5 mm turn a normal by as much.
    constexpr double kNormal = 3e-4;
    const Eigen::Matrix3Xd normals = triangle_normals(mesh);
    EXPECT_LT((normals.colwise() - plane.normal()).colwise().norm().maxCoeff(), kNormal);
  }
}

TEST(RangeMapMesh, LensDistortionIsTakenIntoAccount) {
  Camera camera = camera_of(60.3);
  camera.distortion = {-0.21, 0.04, 0.003, -0.002};
  const Plane plane{700.1, 0.4};
  const RangeMap map = seen(camera, plane);
  const auto [mesh, pixel, width, height] = mesh_range_map(map);
  ASSERT_EQ(mesh.vertices.cols(), map.z.size());
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    const Eigen::Vector3d vertex = mesh.vertices.col(i);
    EXPECT_NEAR(plane.normal().dot(vertex - Eigen::Vector3d(0, 0, plane.distance)), 0,
                kFloat * vertex.norm());
  }
}

TEST(RangeMapMesh, AnObliquePlaneStaysWhole) {
  const Plane plane{700.1, 70 * std::numbers::pi / 180};
  const RangeMap map = seen(camera_of(603.7), plane);
  EXPECT_EQ(mesh_range_map(map).mesh.triangles.cols(), 2 * cells(map.camera));
}

TEST(RangeMapMesh, ASlopeIsNoStepHoweverSteep) {
  // From pixel to pixel of a coarse camera, the depth of this plane changes by more than the option
  // allows for a step.
  const RangeMap map = seen(camera_of(80.3), Plane{700.1, 1.0});
  const double max_step = 0.01;
  EXPECT_GT(map.z(20, 30) / map.z(20, 31) - 1 + std::abs(map.z(20, 30) / map.z(21, 30) - 1),
            2 * max_step);
  for (const double step : {max_step, 1e-4}) {
    const RangeMapMeshOptions options{step, std::numbers::pi / 2};
    EXPECT_EQ(mesh_range_map(map, options).mesh.triangles.cols(), 2 * cells(map.camera));
  }
}

TEST(RangeMapMesh, TwoPlanesOneBeforeTheOtherAreSeparate) {
  const Camera camera = camera_of(603.7);
  for (const double tilt : {0.0, 0.9}) {
    const RangeMap map = seen(camera, [&](const Eigen::Vector3d& ray) {
      return Plane{ray.x() < 0 ? 600.1 : 650.1, tilt}(ray);
    });
    const TriangleMesh mesh = mesh_range_map(map).mesh;
    EXPECT_EQ(mesh.triangles.cols(), 2 * (cells(camera) - (camera.height - 1)));
    for (Eigen::Index i = 0; i < mesh.triangles.cols(); ++i) {
      const double x = mesh.vertices(0, mesh.triangles(0, i));
      for (int k = 1; k < 3; ++k) EXPECT_EQ(mesh.vertices(0, mesh.triangles(k, i)) < 0, x < 0);
    }
  }
}

TEST(RangeMapMesh, AStepIsMeasuredAgainstTheNearerSide) {
  const Camera camera = camera_of(80.3);
  const double limit = 600.1 * RangeMapMeshOptions{}.max_depth_step;
  for (const bool near_on_the_left : {false, true})
    for (const bool near_on_top : {false, true})
      for (const double step : {0.999 * limit, 1.001 * limit}) {
        const RangeMap map = seen(camera, [&](const Eigen::Vector3d& ray) {
          const bool near = (ray.x() < 0) == near_on_the_left && (ray.y() < 0) == near_on_top;
          return near ? 600.1 : 600.1 + step;
        });
        const Eigen::Index triangles = mesh_range_map(map).mesh.triangles.cols();
        if (step < limit)
          EXPECT_EQ(triangles, 2 * cells(camera));
        else
          EXPECT_LT(triangles, 2 * cells(camera));
      }
}

TEST(RangeMapMesh, PixelsBetweenTwoSurfacesBelongToNeither) {
  const Camera camera = camera_of(603.7);
  // Between 600 and 660 stand one or two columns of pixels that saw both.
  for (const int mixed : {1, 2}) {
    RangeMap map =
        seen(camera, [](const Eigen::Vector3d& ray) { return ray.x() < 0 ? 600.1 : 660.1; });
    const int first = 30;
    for (int k = 0; k < mixed; ++k)
      map.z.col(first + k) =
          600.1F + 60.0F * static_cast<float>(k + 1) / static_cast<float>(mixed + 1);
    const RangeMapMesh result = mesh_range_map(map);
    EXPECT_EQ(result.mesh.triangles.cols(), 2 * (camera.width - 2 - mixed) * (camera.height - 1));
    for (Eigen::Index i = 0; i < result.mesh.triangles.cols(); ++i)
      EXPECT_EQ(depth_range(result.mesh, i), 0);
  }
}

TEST(RangeMapMesh, ASphereBeforeAPlaneHasNoWeb) {
  const Camera camera = camera_of(603.7);
  const Eigen::Vector3d center(0, 0, 500.1);
  const double radius = 14.9;
  const auto on_sphere = [&](const Eigen::Vector3d& point) {
    return std::abs((point - center).norm() - radius) < kFloat * 600;
  };
  const RangeMap map = seen(camera, [&](const Eigen::Vector3d& ray) {
    const double b = ray.dot(center) / ray.squaredNorm();
    const double root = b * b - (center.squaredNorm() - radius * radius) / ray.squaredNorm();
    return root > 0 ? b - std::sqrt(root) : 530.1;
  });
  const auto [mesh, pixel, width, height] = mesh_range_map(map);
  int sphere = 0;
  int plane = 0;
  for (Eigen::Index i = 0; i < mesh.triangles.cols(); ++i) {
    int corners = 0;
    for (const int corner : mesh.triangles.col(i))
      corners += on_sphere(mesh.vertices.col(corner)) ? 1 : 0;
    EXPECT_TRUE(corners == 0 || corners == 3) << i;
    (corners == 3 ? sphere : plane) += 1;
  }
  // A disk of radius r f / sqrt(z^2 - r^2) pixels shows the sphere, without the limb where it is
  // grazed.
  const double disk = std::numbers::pi * std::pow(radius * 603.7, 2) * 0.99 /
                      (center.squaredNorm() - radius * radius);
  EXPECT_GT(sphere, 2 * 0.85 * disk);
  EXPECT_LT(sphere, 2 * disk);
  EXPECT_GT(plane, 2 * (static_cast<double>(cells(camera)) - 1.25 * disk));
}

TEST(RangeMapMesh, CutsWhereTheSurfaceIsGrazed) {
  const RangeMap map = seen(camera_of(603.7), Plane{700.1, 1.2});
  const Eigen::Index all = 2 * cells(map.camera);
  // The rays of this camera are up to 0.06 rad off its axis.
  EXPECT_EQ(mesh_range_map(map, {.max_incidence = 1.27}).mesh.triangles.cols(), all);
  EXPECT_EQ(mesh_range_map(map, {.max_incidence = 1.13}).mesh.triangles.cols(), 0);
  const auto [mesh, pixel, width, height] = mesh_range_map(map, {.max_incidence = 1.2});
  EXPECT_GT(mesh.triangles.cols(), all / 4);
  EXPECT_LT(mesh.triangles.cols(), all * 3 / 4);
  const Eigen::Matrix3Xd normals = triangle_normals(mesh);
  for (Eigen::Index i = 0; i < mesh.triangles.cols(); ++i) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const int corner : mesh.triangles.col(i)) middle -= mesh.vertices.col(corner);
    EXPECT_LE(std::acos(normals.col(i).dot(middle.normalized())), 1.2 + 1e-12);
  }
}

TEST(RangeMapMesh, ThreeKnownCornersGiveOneTriangle) {
  const Camera camera = camera_of(603.7);
  for (const double unknown : {kNaN, 0.0, -3.0, std::numeric_limits<double>::infinity()}) {
    RangeMap map = seen(camera, Plane{700.1, 0.3});
    map.z(20, 30) = static_cast<float>(unknown);
    const auto [mesh, pixel, width, height] = mesh_range_map(map);
    EXPECT_EQ(mesh.triangles.cols(), 2 * cells(camera) - 4);
    EXPECT_EQ(mesh.vertices.cols(), map.z.size() - 1);
  }
}

TEST(RangeMapMesh, APixelWithoutATriangleGivesNoVertex) {
  const Camera camera = camera_of(603.7);
  RangeMap map = seen(camera, [](const Eigen::Vector3d&) { return kNaN; });
  map.z(5, 5) = map.z(5, 6) = 700.1F;  // a pair
  map.z(30, 40) = map.z(31, 40) = map.z(31, 41) = 700.1F;
  const auto [mesh, pixel, width, height] = mesh_range_map(map);
  EXPECT_EQ(mesh.triangles.cols(), 1);
  EXPECT_EQ(pixel, (std::vector<int>{30 * 61 + 40, 31 * 61 + 40, 31 * 61 + 41}));
}

TEST(RangeMapMesh, TakesTheShorterDiagonal) {
  const Camera camera{.width = 2, .height = 2, .fx = 603.7, .fy = 603.7, .cx = 0.3, .cy = 0.4};
  RangeMap map{ImageF::Constant(2, 2, 700.1F), camera};
  const auto joined = [&](int a, int b) {
    const TriangleMesh mesh = mesh_range_map(map).mesh;
    EXPECT_EQ(mesh.triangles.cols(), 2);
    int together = 0;
    for (Eigen::Index i = 0; i < mesh.triangles.cols(); ++i)
      together +=
          (mesh.triangles.col(i).array() == a).any() && (mesh.triangles.col(i).array() == b).any()
              ? 1
              : 0;
    return together == 2;
  };
  map.z(0, 0) += 1;  // a b
  EXPECT_TRUE(joined(1, 2));
  map.z(0, 0) = map.z(0, 1);
  map.z(1, 0) += 1;  // c d
  EXPECT_TRUE(joined(0, 3));
}

TEST(RangeMapMesh, DoesNotDependOnTheUnitOfLength) {
  const Camera camera = camera_of(603.7);
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 4);  // steps on both sides of every limit
  const RangeMap map = seen(camera, [&](const Eigen::Vector3d& ray) {
    return Plane{ray.x() < 0 ? 600.1 : 615.1, 0.8}(ray) + noise(random);
  });
  const auto [mesh, pixel, width, height] = mesh_range_map(map);
  EXPECT_GT(mesh.triangles.cols(), cells(camera) / 4);
  EXPECT_LT(mesh.triangles.cols(), 2 * cells(camera) - 100);
  for (const float scale : {0x1p-20F, 0x1p-10F, 0x1p10F, 0x1p20F}) {
    const RangeMapMesh scaled = mesh_range_map({map.z * scale, camera});
    EXPECT_EQ(scaled.mesh.vertices, mesh.vertices * double{scale});
    EXPECT_EQ(scaled.mesh.triangles, mesh.triangles);
    EXPECT_EQ(scaled.source, pixel);
  }
}

TEST(RangeMapMesh, ARealHandIsNotJoinedToTheTorsoBehindIt) {
  const fs::path path = repository("demo/depth_camera/hand.png");
  const cv::Mat image = cv::imread(path.string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(image.type(), CV_16UC1);
  // Also as a camera with a quarter of the pixels would see it: there hand and torso are
  // neighbours.
  for (const int step : {1, 4}) {
    RangeMap map{ImageF(image.rows / step, image.cols / step),
                 {.width = image.cols / step,
                  .height = image.rows / step,
                  .fx = 476.007 / step,
                  .fy = 476.007 / step,
                  .cx = 313.683 / step,
                  .cy = 242.755 / step}};
    for (int row = 0; row < map.z.rows(); ++row)
      for (int col = 0; col < map.z.cols(); ++col)
        map.z(row, col) =
            0.125F * static_cast<float>(image.at<std::uint16_t>(row * step, col * step));
    const auto [mesh, pixel, width, height] = mesh_range_map(map);
    for (Eigen::Index i = 0; i < mesh.triangles.cols(); ++i) EXPECT_LT(depth_range(mesh, i), 30);
    const auto known = static_cast<double>((map.z > 0).count());
    EXPECT_GT(static_cast<double>(mesh.vertices.cols()), (step == 1 ? 0.999 : 0.99) * known);
  }
}

TEST(RangeMapMesh, RenderedObjectsStayWholeAndApart) {
  for (const char* name : {"duck", "flag_a", "flag_b", "plane"}) {
    const fs::path path = repository("demo/truth") / name;
    const RangeMap map{
        read_depth_tiff(path.string() + ".tiff"),
        {.width = 640, .height = 480, .fx = 1100, .fy = 1100, .cx = 319.5, .cy = 239.5}};
    const cv::Mat id = cv::imread(path.string() + "_id.png", cv::IMREAD_GRAYSCALE);
    ASSERT_EQ(id.size(), cv::Size(640, 480));
    const RangeMapMesh built = mesh_range_map(map);
    const TriangleMesh& mesh = built.mesh;
    EXPECT_GT(static_cast<double>(mesh.vertices.cols()),
              0.995 * static_cast<double>((map.z > 0).count()))
        << name;
    for (Eigen::Index i = 0; i < mesh.triangles.cols(); ++i) {
      const auto object = [&](int k) {
        return id.data[built.source[static_cast<std::size_t>(mesh.triangles(k, i))]];
      };
      if (object(0) == object(1) && object(1) == object(2)) continue;
      EXPECT_LT(depth_range(mesh, i), 0.02 * mesh.vertices(2, mesh.triangles(0, i))) << name;
    }
  }
}

TEST(RangeMapMesh, AMapWithoutSurfaceGivesAnEmptyMesh) {
  const Camera camera{.width = 1, .height = 1, .fx = 603.7, .fy = 603.7};
  EXPECT_EQ(mesh_range_map({ImageF::Constant(1, 1, 700.1F), camera}).mesh.triangles.cols(), 0);
  const RangeMap map = seen(camera_of(603.7), [](const Eigen::Vector3d&) { return kNaN; });
  EXPECT_EQ(mesh_range_map(map).mesh.vertices.cols(), 0);
}

TEST(RangeMapMesh, RefusesBadOptionsAndAnotherCamera) {
  const RangeMap map = seen(camera_of(603.7), Plane{700.1, 0.3});
  const auto refuse = [](const RangeMap& input, const RangeMapMeshOptions& options,
                         const char* words) {
    EXPECT_THROWS_MESSAGE(static_cast<void>(mesh_range_map(input, options)), InvalidInput, words);
  };
  for (const double bad : {0.0, -0.1, kNaN, std::numeric_limits<double>::infinity()})
    refuse(map, {.max_depth_step = bad}, "max_depth_step");
  for (const double bad : {0.0, -0.1, kNaN, 1.6})
    refuse(map, {.max_incidence = bad}, "max_incidence");
  RangeMap other = map;
  other.camera.width = 62;
  refuse(other, {}, "61 x 47 px, but the camera is 62 x 47 px");
}

}  // namespace
}  // namespace palpate::geometry
