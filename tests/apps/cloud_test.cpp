// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate cloud`: a ball before a wall, seen by a small camera, cleaned, divided and measured.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map.h"
#include "palpate/sensing/frame.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

constexpr double kRadius = 30;  // [mm]
const Eigen::Vector3d kCentre(5, -4, 400);
constexpr double kWall = 500;  // [mm]
/// [mm] steps of depths of 500 mm in float, seen under an angle.
constexpr double kDepthRounding = 1e-4;

class Cloud : public ::testing::Test {
 protected:
  void SetUp() override {
    write_text(scratch / "rig.yaml",
               "%YAML:1.0\n---\ncamera_size: [80, 60]\ncamera_matrix: !!opencv-matrix\n"
               "   rows: 3\n   cols: 3\n   dt: d\n"
               "   data: [200., 0., 39.5, 0., 200., 29.5, 0., 0., 1.]\ncamera_distortion: []\n");
    z.resize(60, 80);
    for (int v = 0; v < 60; ++v) {
      for (int u = 0; u < 80; ++u) {
        const Eigen::Vector3d ray =
            Eigen::Vector3d((u - 39.5) / 200, (v - 29.5) / 200, 1).normalized();
        const double along = ray.dot(kCentre);
        const double inside = kRadius * kRadius - kCentre.squaredNorm() + along * along;
        z(v, u) = static_cast<float>(inside > 0 ? (along - std::sqrt(inside)) * ray.z() : kWall);
        on_ball += inside > 0 ? 1 : 0;
      }
    }
    z(3, 4) = std::numeric_limits<float>::quiet_NaN();
    geometry::write_depth_tiff(scratch / "scene.tiff", z);
  }

  /// The figures of a call that works.
  json figures(std::vector<std::string> call) const {
    call.insert(call.begin(), "cloud");
    call.emplace_back("--json");
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kDone) << result.err;
    return result.out.empty() ? json::object() : json::parse(result.out);
  }
  /// The message of a call that is wrong.
  std::string wrong(std::vector<std::string> call) const {
    call.insert(call.begin(), "cloud");
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kWrongCall);
    return result.err;
  }

  ScratchFolder scratch;
  geometry::ImageF z;
  int on_ball = 0;
};

TEST_F(Cloud, OfARangeMapIsOrganisedWithColoursAndDeviations) {
  geometry::write_depth_tiff(scratch / "scene_sigma.tiff", z * 1e-4F);
  cv::Mat picture(60, 80, CV_8UC3);
  for (int v = 0; v < 60; ++v)
    for (int u = 0; u < 80; ++u) picture.at<cv::Vec3b>(v, u) = cv::Vec3i(3, v, u);
  sensing::write_png(scratch / "scene_color.png", picture);
  const json said = figures({scratch / "scene.tiff", "--color", "-o", scratch / "scene.pcd"});
  EXPECT_EQ(said["width"], 80);
  EXPECT_EQ(said["height"], 60);
  EXPECT_EQ(said["known"], 4799);
  const geometry::PointCloud cloud = geometry::read_point_cloud(scratch / "scene.pcd");
  ASSERT_EQ(cloud.points.cols(), 4800);
  EXPECT_EQ(cloud.width, 80);
  EXPECT_TRUE(std::isnan(cloud.points(2, 3 * 80 + 4)));
  const Eigen::Matrix4Xd colors = *geometry::colors(cloud.attributes);
  const Eigen::VectorXd sigma = *geometry::scalars(cloud.attributes, "sigma");
  for (const int pixel : {0, 80 * 31 + 42, 4799}) {
    EXPECT_EQ(cloud.points(2, pixel), static_cast<double>(z.data()[pixel]));
    EXPECT_DOUBLE_EQ(colors(0, pixel) * 255, pixel % 80);
    EXPECT_DOUBLE_EQ(colors(1, pixel) * 255, pixel / 80);
    EXPECT_EQ(sigma[pixel], static_cast<double>(z.data()[pixel] * 1e-4F));
  }
}

TEST_F(Cloud, ThatIsOrganisedBecomesARangeMapWithItsCameraAndColours) {
  const cv::Mat picture(60, 80, CV_8UC3, cv::Scalar(3, 20, 100));
  sensing::write_png(scratch / "scene_color.png", picture);
  // As depth cameras write it: float, in metres.
  geometry::PointCloud cloud;
  (void)figures({scratch / "scene.tiff", "--color", "-o", scratch / "scene.pcd"});
  cloud = geometry::read_point_cloud(scratch / "scene.pcd");
  cloud.points /= 1000;
  geometry::write_point_cloud(scratch / "metres.pcd", cloud, {.single_precision = true});
  EXPECT_THAT(run_palpate({"mesh", scratch / "metres.pcd", "-o", scratch / "mesh.ply"}).err,
              HasSubstr("make a range map of them first: palpate cloud "));
  std::filesystem::create_directory(scratch / "range");
  const std::string map = scratch / "range/scene.tiff";
  const CommandResult made =
      run_palpate({"cloud", scratch / "metres.pcd", "--unit", "m", "-o", map});
  ASSERT_EQ(made.status, kDone) << made.err;
  EXPECT_THAT(made.out, HasSubstr("fx 200.00, fy 200.00, cx 39.50, cy 29.50 px"));
  const geometry::ImageF back = geometry::read_depth_tiff(map);
  ASSERT_EQ(back.size(), z.size());
  for (Eigen::Index i = 0; i < z.size(); ++i)
    EXPECT_TRUE(std::isnan(z.data()[i]) ||
                std::abs(double{back.data()[i]} - double{z.data()[i]}) < kDepthRounding);
  EXPECT_TRUE(std::isnan(back(3, 4)));
  const cv::Mat colors = sensing::read_frame(scratch / "range/scene_color.png");
  EXPECT_EQ(colors.at<cv::Vec3b>(30, 40), picture.at<cv::Vec3b>(30, 40));
  // It is a range map as any other, and the next one of its camera lies beside it.
  EXPECT_EQ(run_palpate({"mesh", map, "--color", "-o", scratch / "mesh.ply"}).status, kDone);
  const CommandResult next = run_palpate({"cloud", scratch / "scene.pcd", "--plane", "0.01",
                                          "--remove", "-o", scratch / "range/1.tiff"});
  EXPECT_EQ(next.status, kDone) << next.err;
  EXPECT_EQ((geometry::read_depth_tiff(scratch / "range/1.tiff") > 0).count(), on_ball);
}

TEST_F(Cloud, BecomesARangeMapOfItsOwnCameraOnly) {
  const std::string map = scratch / "map.tiff";
  (void)figures({scratch / "scene.tiff", "-o", scratch / "scene.pcd"});
  std::filesystem::rename(scratch / "scene.tiff", scratch / "before.tiff");
  write_text(scratch / "other.yaml",
             "%YAML:1.0\n---\ncamera_size: [80, 60]\ncamera_matrix: !!opencv-matrix\n"
             "   rows: 3\n   cols: 3\n   dt: d\n"
             "   data: [203., 0., 39.5, 0., 200., 29.5, 0., 0., 1.]\ncamera_distortion: []\n");
  const std::string cloud = scratch / "scene.pcd";
  EXPECT_THAT(wrong({cloud, "--camera", scratch / "other.yaml", "-o", map}),
              HasSubstr("rig.yaml: is of another camera than the points"));
  std::filesystem::create_directory(scratch / "new");
  EXPECT_THAT(
      wrong({cloud, "--camera", scratch / "other.yaml", "-o", scratch / "new/map.tiff"}),
      HasSubstr("the point of column 0, row 0 is not where this pixel of the camera sees it"));
  EXPECT_THAT(wrong({cloud, "--voxel", "1", "-o", map}), HasSubstr("have no rows and columns"));
  EXPECT_THAT(wrong({cloud, "--single", "-o", map}), HasSubstr("range maps are always float"));
  EXPECT_FALSE(std::filesystem::exists(map));
  EXPECT_TRUE(std::filesystem::is_empty(scratch / "new"));
  // Its picture would replace the one that is read.
  sensing::write_png(scratch / "before_color.png",
                     cv::Mat(60, 80, CV_8UC3, cv::Scalar(3, 20, 100)));
  EXPECT_THAT(wrong({scratch / "before.tiff", "--color", "-o", scratch / "before.tif"}),
              HasSubstr("before_color.png"));
  EXPECT_FALSE(std::filesystem::exists(scratch / "before.tif"));
}

TEST_F(Cloud, FindsTheWallAndTheBallAndDividesThem) {
  const json said = figures({scratch / "scene.tiff", "--plane", "0.01", "--remove", "--sphere",
                             "0.01", "--cluster", "20", "--keep", "-o", scratch / "ball.pcd"});
  const json& steps = said["steps"];
  ASSERT_EQ(steps.size(), 5U);
  EXPECT_NEAR(std::abs(steps[0]["normal"][2].get<double>()), 1, 1e-9);
  EXPECT_NEAR(steps[0]["point"][2].get<double>(), kWall, kDepthRounding);
  EXPECT_EQ(steps[0]["on_it"], 4799 - on_ball);
  EXPECT_EQ(steps[1]["removed"], 4799 - on_ball);
  EXPECT_NEAR(steps[2]["radius"].get<double>(), kRadius, kDepthRounding);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(steps[2]["centre"][static_cast<std::size_t>(axis)].get<double>(), kCentre[axis],
                kDepthRounding);
  EXPECT_EQ(steps[3]["sizes"], json({on_ball}));
  EXPECT_EQ(steps[4]["known"], on_ball);
  const geometry::PointCloud ball = geometry::read_point_cloud(scratch / "ball.pcd");
  EXPECT_EQ(ball.width, 80);  // still the grid of the camera
  EXPECT_EQ(geometry::scalars(ball.attributes, "cluster")->maxCoeff(), 0);
}

TEST_F(Cloud, DoesStepsInTheirOrderAndMayRepeatThem) {
  const std::string scene = scratch / "scene.tiff";
  const json said = figures({scene, "--poisson", "10", "--crop", "-30,-30,300,30,30,450",
                             "--poisson", "15", "-o", scratch / "few.ply"});
  ASSERT_EQ(said["steps"].size(), 3U);
  EXPECT_EQ(said["steps"][0]["step"], "poisson");
  EXPECT_EQ(said["steps"][1]["step"], "crop");
  EXPECT_EQ(said["steps"][2]["step"], "poisson");
  const geometry::PointCloud few = geometry::read_point_cloud(scratch / "few.ply");
  EXPECT_EQ(few.points.cols(), said["known"].get<int>());
  EXPECT_GE(said["nearest"]["median"].get<double>(), 15);
  for (const auto& point : few.points.colwise())
    EXPECT_NEAR((point - kCentre).norm(), kRadius, kDepthRounding);
}

TEST_F(Cloud, GivesNormalsTowardsTheCamera) {
  (void)figures({scratch / "scene.tiff", "--crop", "-90,-90,300,90,90,450", "--normals", "9", "-o",
                 scratch / "n.ply"});
  const geometry::PointCloud ball = geometry::read_point_cloud(scratch / "n.ply");
  const Eigen::Matrix3Xd normals = *geometry::normals(ball.attributes);
  ASSERT_EQ(ball.points.cols(), on_ball);
  for (Eigen::Index i = 0; i < on_ball; ++i) {
    EXPECT_LE(normals.col(i).dot(ball.points.col(i)), 0);
    const Eigen::Vector3d out = (ball.points.col(i) - kCentre) / kRadius;
    if (out.z() < -0.5) {
      EXPECT_GT(normals.col(i).dot(out), 0.98);
    }
  }
}

TEST_F(Cloud, MeasuresDistancesFromMeshesAndClouds) {
  geometry::TriangleMesh wall;
  wall.vertices.resize(3, 4);
  wall.vertices << -900, 900, 900, -900, -900, -900, 900, 900, 450, 450, 450, 450;
  wall.triangles.resize(3, 2);
  wall.triangles << 0, 0, 1, 2, 2, 3;
  geometry::write_mesh(scratch / "wall.ply", wall);
  const json said = figures(
      {scratch / "scene.tiff", "--from-mesh", scratch / "wall.ply", "-o", scratch / "d.ply"});
  EXPECT_NEAR(said["steps"][0]["median"].get<double>(), 50, kDepthRounding);
  const geometry::PointCloud measured = geometry::read_point_cloud(scratch / "d.ply");
  const Eigen::VectorXd distance = *geometry::scalars(measured.attributes, "distance");
  for (Eigen::Index i = 0; i < distance.size(); ++i)
    EXPECT_NEAR(distance[i], measured.points(2, i) - 450, 1e-9);
  const json same =
      figures({scratch / "scene.tiff", "--from-cloud", scratch / "d.ply", "-o", scratch / "e.ply"});
  EXPECT_EQ(same["steps"][0]["max"], 0);
}

TEST_F(Cloud, JoinsFilesAndRemovesStrays) {
  geometry::PointCloud strays;
  strays.points.resize(3, 2);
  strays.points << 0, 0, 0, 0, 3000, 9000;
  strays.width = 2;
  geometry::write_point_cloud(scratch / "strays.pcd", strays);
  const std::vector<std::string> inputs = {scratch / "scene.tiff", scratch / "strays.pcd"};
  const json by_share = figures({inputs[0], inputs[1], "--outliers", "5", "-o", scratch / "a.pcd"});
  const json by_radius =
      figures({inputs[0], inputs[1], "--isolated", "100,3", "-o", scratch / "b.pcd"});
  EXPECT_EQ(by_share["read"], 4801);
  EXPECT_EQ(by_share["steps"][0]["removed"], 2);
  EXPECT_EQ(by_radius["steps"][0]["removed"], 2);
  EXPECT_EQ(by_share["height"], 1);
}

TEST_F(Cloud, OfVoxelsHasMeans) {
  const json said = figures({scratch / "scene.tiff", "--voxel", "1000", "-o", scratch / "one.ply"});
  EXPECT_EQ(said["known"], 4);  // of the four quadrants around the axis
}

TEST_F(Cloud, IsDescribedByInfo) {
  (void)figures({scratch / "scene.tiff", "--normals", "9", "-o", scratch / "s.pcd"});
  const CommandResult result = run_palpate({"info", scratch / "s.pcd", "--json"});
  const json said = json::parse(result.out);
  EXPECT_EQ(said["height"], 60);
  EXPECT_EQ(said["known"], 4799);
  EXPECT_NEAR(said["max"][2].get<double>(), kWall, kDepthRounding);
  EXPECT_NEAR(said["nearest"]["median"].get<double>(), 2.5, kDepthRounding);  // a pixel of the wall
  EXPECT_THAT(run_palpate({"info", scratch / "s.pcd"}).out,
              ::testing::AllOf(HasSubstr("(organised)"), HasSubstr("with normals")));
}

TEST_F(Cloud, InAMeshFormatIsDescribedByInfo) {
  (void)figures({scratch / "scene.tiff", "-o", scratch / "s.ply"});
  const json said = json::parse(run_palpate({"info", scratch / "s.ply", "--json"}).out);
  EXPECT_EQ(said["kind"], "points");
  EXPECT_EQ(said["known"], 4799);
  write_text(scratch / "face.obj", "v 0 0 0\nv 1 0 0\nf 1 2 x\n");  // a mesh, but a bad one
  EXPECT_EQ(run_palpate({"info", scratch / "face.obj"}).status, kWrongCall);
}

TEST_F(Cloud, NamesTheFileAndPointThatIsTooFarAway) {
  write_text(scratch / "far.obj", "v 0 0 0\nv 1e200 0 0\n");
  const std::string expected =
      "far.obj: point 1 has a coordinate beyond 1e100 mm; correct it, or state the unit (--unit)";
  EXPECT_THAT(wrong({scratch / "far.obj", "-o", scratch / "x.pcd"}), HasSubstr(expected));
  EXPECT_THAT(run_palpate({"info", scratch / "far.obj"}).err, HasSubstr(expected));
}

TEST_F(Cloud, WritesNothingWhereAStepFails) {
  const std::string out = scratch / "out.pcd";
  EXPECT_THAT(wrong({scratch / "scene.tiff", "--crop", "0,0,0,1,1,1", "-o", out}),
              HasSubstr("--crop: none of the 4799 points is inside the box"));
  EXPECT_THAT(wrong({scratch / "scene.tiff", "--keep", "-o", out}),
              HasSubstr("--keep: nothing is found before it"));
  EXPECT_THAT(wrong({scratch / "scene.tiff", "--voxel", "1e-12", "-o", out}),
              HasSubstr("take a larger one"));
  const CommandResult none = run_palpate(
      {"cloud", scratch / "scene.tiff", "--sphere", "0.001", "--min-share", "0.9", "-o", out});
  EXPECT_EQ(none.status, kWorkFailed);
  EXPECT_THAT(none.err, HasSubstr("--sphere: no sphere has 90 % of the points within 0.001 mm"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(Cloud, RefusesWrongCalls) {
  const std::string scene = scratch / "scene.tiff", out = scratch / "out.pcd";
  EXPECT_THAT(wrong({scene, "-o", scratch / "out.obj"}), HasSubstr("as .pcd or .ply"));
  EXPECT_THAT(wrong({scene, "-o", scene}), HasSubstr("scene.tiff"));
  EXPECT_THAT(wrong({scene, "--crop", "1,2,3", "-o", out}), HasSubstr("must be six numbers"));
  EXPECT_THAT(wrong({scene, "--crop", "1,2,3,0,9,9", "-o", out}), HasSubstr("X0 <= X1"));
  EXPECT_THAT(wrong({scene, "--normals", "2", "-o", out}), HasSubstr("whole number in [3, 1000]"));
  EXPECT_THAT(wrong({scene, "--isolated", "nan,3", "-o", out}), HasSubstr("MM,COUNT with MM > 0"));
  EXPECT_THAT(wrong({scene, "--voxel", "-1", "-o", out}), HasSubstr("must be > 0 and finite"));
  EXPECT_THAT(wrong({scene, "--plane", "0", "-o", out}),
              HasSubstr("--plane: is \"0\"; it must be a number > 0 and finite"));
  EXPECT_THAT(wrong({scene, "--plane", "1", "--max-radius", "9", "-o", out}),
              HasSubstr("--max-radius: does nothing without --sphere or --cylinder"));
  EXPECT_THAT(wrong({scene, "--normals", "16", "--min-points", "9", "-o", out}),
              HasSubstr("--min-points: does nothing without --cluster"));
  std::filesystem::create_directory(scratch / "range");
  EXPECT_THAT(wrong({scratch / "range", "-o", out}), HasSubstr("is a folder"));
  EXPECT_THAT(wrong({scene, "--unit", "m", "-o", out}), HasSubstr("range maps are in mm"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(Cloud, NeverOverwritesItsReference) {
  (void)figures({scratch / "scene.tiff", "-o", scratch / "r.pcd"});
  EXPECT_THAT(
      wrong({scratch / "scene.tiff", "--from-cloud", scratch / "r.pcd", "-o", scratch / "r.pcd"}),
      HasSubstr("r.pcd"));
}

}  // namespace
}  // namespace palpate::apps
