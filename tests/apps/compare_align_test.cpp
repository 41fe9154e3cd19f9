// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate compare --align` finds a known pose by each of its methods.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mesh_corpus.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/registration.h"
#include "run_palpate.h"
#include "test_surfaces.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

Eigen::Isometry3d to_pose(const json& rows) {
  Eigen::Isometry3d pose;
  for (int row = 0; row < 4; ++row) {
    for (int col = 0; col < 4; ++col) pose.matrix()(row, col) = rows[row][col];
  }
  return pose;
}

class CompareAlign : public ::testing::Test {
 protected:
  void SetUp() override {
    // The same surface, sampled by other vertices, 0.2 rad and 20 mm away.
    target = geometry::test::bumpy(20000);
    true_pose = Eigen::Translation3d(12.3, -9.1, 713.7) *
                Eigen::AngleAxisd(0.2, Eigen::Vector3d(0.2, 0.9, -0.3).normalized()) *
                Eigen::Translation3d(0, 0, -700);
    source = geometry::test::moved(geometry::test::bumpy(12000), true_pose.inverse());
    geometry::write_mesh(scratch / "a.ply", source);
    geometry::write_mesh(scratch / "b.ply", target);
  }

  CommandResult compare(const std::vector<std::string>& more) const {
    std::vector<std::string> call = {"compare", scratch / "a.ply", scratch / "b.ply", "--json"};
    call.insert(call.end(), more.begin(), more.end());
    return run_palpate(call);
  }

  /// [mm] Mean distance of A's vertices from their positions under the true pose.
  double error(const Eigen::Isometry3d& pose) const {
    return (pose * source.vertices - true_pose * source.vertices).colwise().norm().mean();
  }

  ScratchFolder scratch;
  geometry::TriangleMesh source, target;
  Eigen::Isometry3d true_pose;
};

TEST_F(CompareAlign, EachMethodFindsAKnownPoseAsItsLibraryFunctionDoes) {
  // [mm] Vertices of B are 5 mm apart, and its triangles leave the surface by up to 0.1 mm.
  struct Method {
    const char* name;
    geometry::RegistrationMethod method;
    double largest_error;
  };
  using enum geometry::RegistrationMethod;
  for (const auto& [name, method, largest_error] :
       {Method{"point_to_triangle", point_to_triangle, 0.05},
        Method{"point_to_plane", point_to_plane, 0.1},
        Method{"point_to_point", point_to_point, 1.0}}) {
    const CommandResult result = compare({"--align", "--method", name});
    ASSERT_EQ(result.status, kDone) << name << result.err;
    const Eigen::Isometry3d found = to_pose(json::parse(result.out)["aligned"]["pose"]);
    EXPECT_LT(error(found), largest_error) << name;
    const geometry::Registration expected =
        geometry::register_points(source.vertices, target, {.method = method});
    EXPECT_EQ(found.matrix(), expected.T_target_source.matrix()) << name;
  }
}

TEST_F(CompareAlign, TheAlignedSurfaceIsWrittenWhereItLies) {
  const CommandResult result = compare({"--align", "-o", scratch / "aligned.ply"});
  ASSERT_EQ(result.status, kDone) << result.err;
  const json figures = json::parse(result.out);
  const geometry::TriangleMesh aligned = geometry::read_mesh(scratch / "aligned.ply");
  EXPECT_EQ(aligned.triangles, source.triangles);
  EXPECT_EQ(aligned.vertices, to_pose(figures["aligned"]["pose"]) * source.vertices);
  // A surface that already lies there needs no motion.
  const json again = json::parse(
      run_palpate({"compare", scratch / "aligned.ply", scratch / "b.ply", "--align", "--json"})
          .out);
  EXPECT_LT(again["aligned"]["translation"], 1e-3);
}

TEST_F(CompareAlign, RefusesAnotherMethodAndMethodsWithoutAlign) {
  for (const std::vector<std::string>& call :
       {std::vector<std::string>{"--align", "--method", "icp"},
        {"--method", "point_to_plane"},
        {"-o", scratch / "aligned.ply"},
        {"--align", "-o", scratch / "a.ply"}}) {
    const CommandResult result = compare(call);
    EXPECT_EQ(result.status, kWrongCall) << call.front();
    EXPECT_FALSE(fs::exists(scratch / "aligned.ply"));
  }
  EXPECT_EQ(geometry::read_mesh(scratch / "a.ply").vertices, source.vertices);
}

}  // namespace
}  // namespace palpate::apps
