// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/register_scans.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "palpate/core/error.h"
#include "test_surfaces.h"
#include "told_progress.h"

namespace palpate::geometry {
namespace {

TriangleMesh hilly_object() {
  return test::height_field(60, 30, 1.0, [](double x, double y) {
    return 5 * std::sin(0.21 * x) * std::cos(0.17 * y + 0.3) + 2 * std::sin(0.09 * x * y / 10);
  });
}

TriangleMesh part(const TriangleMesh& mesh, const std::function<bool(double x)>& covers) {
  TriangleMesh result{.vertices = {}, .triangles = Eigen::Matrix3Xi(3, mesh.triangles.cols())};
  Eigen::VectorXi index = Eigen::VectorXi::Constant(mesh.vertices.cols(), -1);
  std::vector<int> kept;
  Eigen::Index count = 0;
  for (const auto& t : mesh.triangles.colwise()) {
    if (!covers(mesh.vertices(0, t).mean())) continue;
    for (int k = 0; k < 3; ++k) {
      if (index[t[k]] < 0) {
        index[t[k]] = static_cast<int>(kept.size());
        kept.push_back(t[k]);
      }
      result.triangles(k, count) = index[t[k]];
    }
    ++count;
  }
  result.triangles.conservativeResize(3, count);
  result.vertices = mesh.vertices(Eigen::all, kept);
  return result;
}

Eigen::Isometry3d small_motion(double amount) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() =
      Eigen::AngleAxisd(0.1 * amount, Eigen::Vector3d(0.3, -0.5, 0.8).normalized()).matrix();
  motion.translation() = amount * Eigen::Vector3d(1.1, -0.7, 1.3);
  return motion;
}

TEST(RegisterScans, PutsEachScanOntoThoseBeforeIt) {
  const TriangleMesh object = hilly_object();
  const std::vector<std::function<bool(double)>> covers = {
      [](double x) { return x < 30; }, [](double x) { return x > 12 && x < 46; },
      [](double x) { return x > 28; }};
  std::vector<Scan> scans;
  for (std::size_t i = 0; i < covers.size(); ++i) {
    const Eigen::Isometry3d away = small_motion(static_cast<double>(i));
    scans.push_back({.mesh = test::moved(part(object, covers[i]), away)});
  }
  const auto moves = register_scans(scans, {.min_overlap = 0.4});
  ASSERT_EQ(moves.size(), 2u);
  for (std::size_t i = 0; i < moves.size(); ++i) {
    ASSERT_EQ(moves[i].verdict, RegistrationVerdict::accepted) << moves[i].reason;
    const Eigen::Isometry3d truth = small_motion(static_cast<double>(i + 1)).inverse();
    EXPECT_LT((moves[i].T_target_source.matrix() - truth.matrix()).norm(), 1e-5);
  }
}

TEST(RegisterScans, BeginsAtThePoses) {
  const TriangleMesh object = hilly_object();
  const TriangleMesh right = part(object, [](double x) { return x > 20; });
  const Eigen::Isometry3d away = small_motion(40);  // too far to be found without a start
  const Eigen::Isometry3d start = away.inverse() * small_motion(0.5);
  const auto moves =
      register_scans(std::vector<Scan>{{.mesh = part(object, [](double x) { return x < 45; })},
                                       {.mesh = test::moved(right, away), .T_object_scan = start}},
                     {.search_rotation = 0.2, .search_translation = 5});
  ASSERT_EQ(moves.size(), 1u);
  ASSERT_EQ(moves[0].verdict, RegistrationVerdict::accepted) << moves[0].reason;
  EXPECT_LT((moves[0].T_target_source.matrix() - away.inverse().matrix()).norm(), 1e-5);
}

TEST(RegisterScans, EndsWithTheFirstThatIsNotAccepted) {
  // Other vertices each, or the facets would fix the pose.
  const auto slid = register_scans(
      std::vector<Scan>{{.mesh = test::icosphere(4, 20)},
                        {.mesh = test::moved(test::icosphere(3, 20), small_motion(1))},
                        {.mesh = test::icosphere(4, 20)}});
  ASSERT_EQ(slid.size(), 1u);
  EXPECT_EQ(slid[0].verdict, RegistrationVerdict::slides);
  EXPECT_FALSE(slid[0].free_motions.empty());
  const TriangleMesh object = hilly_object();
  const auto apart =
      register_scans(std::vector<Scan>{{.mesh = part(object, [](double x) { return x < 20; })},
                                       {.mesh = part(object, [](double x) { return x > 40; })}},
                     {.search_rotation = 0.1, .search_translation = 1});
  ASSERT_EQ(apart.size(), 1u);
  EXPECT_NE(apart[0].verdict, RegistrationVerdict::accepted);
}

TEST(RegisterScans, TellsTheProgressOfAllScans) {
  const TriangleMesh object = hilly_object();
  const std::vector<Scan> scans(3, {.mesh = object});
  check_progress([&](const auto& progress) { (void)register_scans(scans, {.progress = progress}); },
                 14);
}

TEST(RegisterScans, RefusesNoScanAndBadPoses) {
  EXPECT_THROW(static_cast<void>(register_scans({})), InvalidInput);
  Scan scan{.mesh = hilly_object()};
  EXPECT_TRUE(register_scans(std::vector<Scan>{scan}).empty());
  scan.T_object_scan.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(static_cast<void>(register_scans(std::vector<Scan>{scan, scan})), InvalidInput);
}

}  // namespace
}  // namespace palpate::geometry
