// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "build/align_frames.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numeric>
#include <vector>

#include "palpate/haptics/rotation.h"
#include "sheet_model.h"
#include "sphere_model.h"

namespace palpate::haptics {
namespace {

// [rad] between the frames of neighbours, beyond what the turn of their z axes needs.
std::vector<double> disagreements(const Model& model) {
  std::vector<double> angles;
  for (const auto& t : model.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Matrix3d& a = model.contacts[static_cast<std::size_t>(t[k])].frame;
      const Eigen::Matrix3d& b = model.contacts[static_cast<std::size_t>(t[(k + 1) % 3])].frame;
      const Eigen::Matrix3d turned = rotation_between(a.col(2), b.col(2)) * a;
      angles.push_back(rotation_log(turned.transpose() * b).norm());
    }
  }
  return angles;
}

TEST(AlignFrames, MakesThoseOfAPlaneOne) {
  Model model = sheet_model();
  for (int i = 0; i < 4; ++i)
    model.contacts[static_cast<std::size_t>(i)].frame = rotation_exp({0, 0, uneven_twist(i)});
  align_frames(model);
  for (const double angle : disagreements(model)) EXPECT_LT(angle, 1e-9);
}

TEST(AlignFrames, ChangesNoForceAtAContact) {
  Model model = uneven_model();
  const Model before = model;
  align_frames(model);
  const Eigen::Vector3d displacement(1, -2, 3);
  for (std::size_t i = 0; i < model.contacts.size(); ++i) {
    const ContactModel &now = model.contacts[i], &then = before.contacts[i];
    EXPECT_LT((now.frame.col(2) - then.frame.col(2)).norm(), 1e-14);
    EXPECT_LT((now.frame * force(now.field, now.frame.transpose() * displacement) -
               then.frame * force(then.field, then.frame.transpose() * displacement))
                  .norm(),
              1e-12);
  }
  EXPECT_GT((model.contacts[3].frame - before.contacts[3].frame).norm(), 1e-3);
}

TEST(AlignFrames, LeavesFewTurnsOnAClosedSurface) {
  Model model = ball_model([](const Eigen::Vector3d&) { return true; }, uneven_twist);
  const std::vector<double> before = disagreements(model);
  align_frames(model);
  const std::vector<double> after = disagreements(model);
  const auto mean = [](const std::vector<double>& angles) {
    return std::accumulate(angles.begin(), angles.end(), 0.0) / static_cast<double>(angles.size());
  };
  // By the hairy ball theorem some neighbours cannot agree.
  EXPECT_LT(mean(after), 0.3);
  EXPECT_GT(mean(before), 1);
  EXPECT_NO_THROW(check_model(model));
}

TEST(AlignFrames, LeavesAModelWithoutTrianglesAlone) {
  Model model = sheet_model();
  model.triangles.resize(3, 0);
  const Eigen::Matrix3d before = model.contacts[2].frame;
  align_frames(model);
  EXPECT_EQ(model.contacts[2].frame, before);
}

}  // namespace
}  // namespace palpate::haptics
