// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/scene_requirement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "palpate/geometry/mesh_measures.h"
#include "palpate/haptics/model_io.h"
#include "sheet_model.h"
#include "sphere_model.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::HasSubstr;

class SceneRequirementTest : public ::testing::Test {
 protected:
  SceneRequirementTest() {
    write_model(scratch / "model", sheet_model());
    std::ofstream(scratch / "path.csv") << "t,x,y,z\n0,3,4,695\n0.1,3,4,705\n0.2,8,4,705\n";
  }
  SceneRequirement read(const std::string& require, std::optional<std::string> object = {}) {
    std::ofstream(scratch / "scene.yaml")
        << "objects:\n  - name: sheet\n    model: model\n    require:\n"
        << require;
    return read_scene_requirement(scratch / "scene.yaml", scratch / "model", object);
  }
  std::string refused(const std::string& require, std::optional<std::string> object = {}) {
    return refusal([&] { return read(require, std::move(object)); });
  }

  ScratchFolder scratch;
};

TEST_F(SceneRequirementTest, ReadsQuantitiesWithTheirUnits) {
  const SceneRequirement of = read(R"(
      force_error: 200 mN
      surface_error: 50 um
      picture_size: 640 px
      size: 0.5 MB
      tool_radius: 4 mm
      largest_force: 4N
      largest_depth: 1 cm
      slip: false
      shapes: false
      arm_time: 90 min
)");
  EXPECT_EQ(of.object, "sheet");
  EXPECT_DOUBLE_EQ(*of.options.max_error, 0.2);
  EXPECT_DOUBLE_EQ(*of.options.max_surface_error, 0.05);
  EXPECT_DOUBLE_EQ(*of.options.picture_size, 640);
  EXPECT_DOUBLE_EQ(*of.options.max_size, 5e5);
  EXPECT_DOUBLE_EQ(*of.tool_radius, 4);
  EXPECT_DOUBLE_EQ(*of.options.largest_force, 4);
  EXPECT_DOUBLE_EQ(*of.options.largest_depth, 10);
  EXPECT_FALSE(of.options.slip);
  EXPECT_FALSE(of.options.keep_shapes);
  EXPECT_FALSE(of.region);
  EXPECT_DOUBLE_EQ(*of.arm_time, 5400);
  EXPECT_DOUBLE_EQ(*read("      force_error: 5 %\n").options.max_relative_error, 0.05);
  EXPECT_DOUBLE_EQ(*read("      force_error: jnd\n").options.max_relative_error, 0.07);
}

TEST_F(SceneRequirementTest, RefusesWhatCannotBe) {
  EXPECT_THAT(refused("      force_error: 0.2\n"),
              AllOf(HasSubstr("scene.yaml: line 5, at /objects/0/require/force_error: found 0.2"),
                    HasSubstr("such as \"0.2 N\"")));
  EXPECT_THAT(refused("      force_error: 0.2 mm\n"), HasSubstr("such as \"0.2 N\""));
  EXPECT_THAT(refused("      surface_error: -1 mm\n"), HasSubstr("a number > 0 with its unit"));
  EXPECT_THAT(refused("      size: 1e999 kB\n"),
              HasSubstr("a number > 0 with its unit (kB, B, MB, GB)"));
  EXPECT_THAT(refused("      forces_error: 1 N\n"),
              AllOf(HasSubstr("at /objects/0/require/forces_error: 'forces_error' is unknown"),
                    HasSubstr("force_error")));
  EXPECT_THAT(refused("      slip: true\n    region: {box: [0, 0, 0, 1, 1, 1]}\n"),
              HasSubstr("line 6, at /objects/0/region: 'region' is unknown"));
  EXPECT_THAT(refused("      region: {margin: 2 mm}\n"), HasSubstr("'path' beside it"));
  EXPECT_THAT(refused("      region: {path: path.csv}\n"), HasSubstr("'margin' beside it"));
  EXPECT_THAT(refused("      region: {}\n"), HasSubstr("'box', 'side', 'camera' or 'path'"));
  EXPECT_THAT(refused("      picture_size: 0.5 px\n"), HasSubstr("at least \"1 px\""));
  EXPECT_THAT(refused("      picture_size: 640\n"), HasSubstr("its unit (px)"));
  EXPECT_THAT(refused("      region: {camera: [0, 0]}\n"), HasSubstr("x, y, z of its position"));
  EXPECT_THAT(refused("      region: {box: [0, 0, 0, 1, -1, 1]}\n"),
              HasSubstr("below the upper one"));
}

TEST_F(SceneRequirementTest, FindsTheObjectByItsModelOrItsName) {
  const std::string two =
      "      slip: true\n  - name: other\n    model: ../nowhere\n    require: {slip: false}\n";
  EXPECT_TRUE(read(two).options.slip);
  EXPECT_FALSE(read(two, "other").options.slip);
  EXPECT_THAT(refused(two, "third"), AllOf(HasSubstr("no object with 'require' has the name third"),
                                           HasSubstr("sheet (model), other (../nowhere)")));
  const std::string twin = "      slip: true\n  - name: twin\n    model: model\n";
  EXPECT_EQ(read(twin).object, "sheet");
  EXPECT_THAT(refused(twin + "    require: {slip: true}\n"),
              HasSubstr("several objects have the model"));
  EXPECT_THAT(refused("      slip: true\n  - name: bare\n    model: nowhere\n", "bare"),
              HasSubstr("no object with 'require' has the name bare"));
}

TEST_F(SceneRequirementTest, ReadsTheBudgetOfAllObjects) {
  std::ofstream(scratch / "scene.yaml") << R"(
budget: {arm_time: 2 h}
objects:
  - {name: bare, model: model}
  - {name: sheet, model: model, require: {force_error: 0.2 N, arm_time: 30 s}}
  - {name: other, model: nowhere, require: {slip: false}}
)";
  const SceneRequirements all = read_scene_requirements(scratch / "scene.yaml");
  EXPECT_DOUBLE_EQ(*all.arm_time, 7200);
  ASSERT_EQ(all.objects.size(), 2U);
  EXPECT_DOUBLE_EQ(*all.objects[0].arm_time, 30);
  EXPECT_EQ(all.objects[1].model, scratch / "nowhere");
  EXPECT_THAT(refusal([&] { return read_scene_requirement(scratch / "scene.yaml", {}, {}); }),
              HasSubstr("several objects have a member 'require'"));
  std::ofstream(scratch / "scene.yaml") << "objects: [{name: bare, model: model}]\n";
  EXPECT_THAT(refusal([&] { return read_scene_requirements(scratch / "scene.yaml"); }),
              HasSubstr("an object with 'require'"));
}

TEST_F(SceneRequirementTest, FindsTheVerticesOfARegion) {
  const geometry::TriangleMesh surface = flat_surface();
  const auto of = [&](const std::string& region) {
    return reachable_vertices(surface, *read("      region: " + region + "\n").region);
  };
  const auto expect = [&](const std::vector<bool>& is, auto&& should) {
    for (std::size_t v = 0; v < is.size(); ++v) {
      const Vector3d at = surface.vertices.col(static_cast<Eigen::Index>(v));
      EXPECT_EQ(is[v], should(at)) << at.transpose();
    }
  };
  expect(of("{box: [-15, -100, 600, 25, 5, 800]}"),
         [](const Vector3d& at) { return at.x() > -15 && at.x() < 25 && at.y() < 5; });
  expect(of("{side: [5, 0, 700, -3, 0, 0]}"), [](const Vector3d& at) { return at.x() < 5; });
  expect(of("{side: [5, 0, 700, -3, 0, 0], box: [-100, 1, 0, 100, 100, 1000]}"),
         [](const Vector3d& at) { return at.x() < 5 && at.y() > 1; });
  // The tool presses at (3, 4) and goes to (8, 4).
  expect(of("{path: path.csv, margin: 12 mm}"), [](const Vector3d& at) {
    return (at - Vector3d(3, 4, 700)).norm() <= 12 || (at - Vector3d(8, 4, 700)).norm() <= 12;
  });
}

// A camera at the origin. A plate half way to the sheet throws a shadow twice its size.
TEST_F(SceneRequirementTest, FindsTheVerticesThatACameraSees) {
  const SceneRegion region = *read("      region: {camera: [0, 0, 0]}\n").region;
  geometry::TriangleMesh both = flat_surface();
  const Eigen::Index sheet = both.vertices.cols();
  both.vertices.conservativeResize(3, sheet + 4);
  both.vertices.rightCols<4>() << -17, 17, -17, 17, -17, -17, 17, 17, 350, 350, 350, 350;
  const int first = static_cast<int>(sheet);
  both.triangles.conservativeResize(3, both.triangles.cols() + 2);
  both.triangles.rightCols<2>() << first, first + 1, first + 2, first + 2, first + 1, first + 3;
  const std::vector<bool> seen = reachable_vertices(both, region);
  for (Eigen::Index v = 0; v < both.vertices.cols(); ++v) {
    const Vector3d at = both.vertices.col(v);
    const bool in_shadow = v < sheet && std::abs(at.x()) < 34 && std::abs(at.y()) < 34;
    EXPECT_EQ(seen[static_cast<std::size_t>(v)], !in_shadow) << at.transpose();
  }
}

// Those nearer than the horizon, which is where lines from the camera touch the ball.
TEST_F(SceneRequirementTest, FindsTheNearSideOfABall) {
  const geometry::TriangleMesh ball =
      ball_model([](const Vector3d&) { return true; }, [](int) { return 0.0; }, 20, 4).surface;
  const Eigen::AlignedBox3d box = geometry::bounding_box(ball);
  const double radius = box.sizes().maxCoeff() / 2;
  SceneRegion region;
  region.camera = box.center() + Vector3d(0, 0, 4 * radius);
  const std::vector<bool> seen = reachable_vertices(ball, region);
  for (std::size_t v = 0; v < seen.size(); ++v) {
    const double height = ball.vertices(2, static_cast<Eigen::Index>(v)) - box.center().z();
    if (std::abs(height - radius / 4) > 0.1 * radius)  // about an edge of the mesh
      EXPECT_EQ(seen[v], height > radius / 4) << height;
  }
}

TEST_F(SceneRequirementTest, RefusesARegionThatIsNotOnTheSurface) {
  const auto refused_region = [&](const std::string& region) {
    const SceneRequirement of = read("      region: " + region + "\n");
    return refusal([&] { return reachable_vertices(flat_surface(), *of.region); });
  };
  EXPECT_THAT(refused_region("{box: [0, 0, 0, 1, 1, 1]}"),
              HasSubstr("its surface extends from (-50, -50, 700) to (50, 50, 700) mm"));
  std::ofstream(scratch / "path.csv") << "t,x,y,z\n0,3,4,600\n0.1,3,4,620\n";
  EXPECT_THAT(refused_region("{path: path.csv, margin: 12 mm}"),
              HasSubstr("never touches the surface of the model; it is 80 mm away"));
}

}  // namespace
}  // namespace palpate::haptics
