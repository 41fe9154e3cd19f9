// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/playback.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "allocation_counter.h"
#include "palpate/haptics/contact_compliance.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

const Eigen::Vector3d kAbove(3, 4, 695);

// Force of the sheet on a tool at this displacement: minus the spring's.
Eigen::Vector3d reaction(const Eigen::Vector3d& displacement) {
  return -4 * displacement / std::hypot(displacement.norm(), 10);
}

// Presses, drags there and back and beyond the border of the contacts, and lifts off.
std::vector<TrajectoryPoint> some_trajectory() {
  const std::vector<Eigen::Vector3d> corners = {kAbove,         {3, 4, 706}, {20, -10, 705},
                                                {-40, 10, 704}, {5, 5, 708}, {5, 5, 690}};
  std::vector<TrajectoryPoint> trajectory;
  for (std::size_t leg = 1; leg < corners.size(); ++leg) {
    constexpr int kTicks = 400;
    for (int i = 0; i < kTicks; ++i) {
      const double way = static_cast<double>(i) / kTicks;
      trajectory.push_back({1e-3 * static_cast<double>(trajectory.size()),
                            (1 - way) * corners[leg - 1] + way * corners[leg]});
    }
  }
  return trajectory;
}

TEST(Playback, TouchesSticksSlipsAndLiftsOff) {
  const Playback playback(sheet_model(0.5));
  LoopState state;
  Command command = playback.step(kAbove, state);
  EXPECT_EQ(command.state, ContactState::free);
  EXPECT_EQ(command.force, Eigen::Vector3d::Zero());
  EXPECT_EQ(command.contact, kAbove);

  command = playback.step({3, 4, 705}, state);
  EXPECT_EQ(command.state, ContactState::stick);
  EXPECT_LT((command.contact - Eigen::Vector3d(3, 4, 700)).norm(), 1e-9);
  EXPECT_LT((command.force - reaction({0, 0, 5})).norm(), 1e-9);

  command = playback.step({5, 4, 705}, state);  // 2 mm aside at a depth of 5: inside the cone
  EXPECT_EQ(command.state, ContactState::stick);
  EXPECT_LT((command.force - reaction({2, 0, 5})).norm(), 1e-9);

  command = playback.step({9, 4, 705}, state);  // 6 mm aside: the contact trails by 0.5 * 5 mm
  EXPECT_EQ(command.state, ContactState::slip);
  EXPECT_NEAR(command.contact.x(), 6.5, 2e-3);
  EXPECT_LT((command.force - reaction({2.5, 0, 5})).norm(), 2e-3);

  command = playback.step({9, 4, 699.9}, state);
  EXPECT_EQ(command.state, ContactState::free);
  EXPECT_EQ(command.force, Eigen::Vector3d::Zero());
}

TEST(Playback, SlipsBackWithoutJumpingToTheFarSideOfTheCone) {
  const Playback playback(sheet_model(0.5));
  const std::vector<TracePoint> trace = play(playback, some_trajectory());
  int slips = 0;
  for (std::size_t i = 1; i < trace.size(); ++i) {
    // The fastest leg moves 0.15 mm a tick at a stiffness of at most 0.4 N/mm.
    EXPECT_LT((trace[i].force - trace[i - 1].force).norm(), 0.12) << i;
    slips += trace[i].state == ContactState::slip;
  }
  EXPECT_GT(slips, 500);
}

TEST(Playback, IgnoresASurfaceThatIsEnteredFromBehind) {
  const Playback playback(sheet_model());
  LoopState state;
  EXPECT_EQ(playback.step({0, 0, 710}, state).state, ContactState::free);
  EXPECT_EQ(playback.step({0, 0, 690}, state).state, ContactState::free);
  EXPECT_EQ(state.proxy.position.z(),
            690);  // it passed through, and was not stopped at the surface
  EXPECT_EQ(playback.step({0, 0, 701}, state).state, ContactState::stick);
}

TEST(Playback, FirstTickIsFreeEvenBehindTheSurface) {
  const Playback playback(sheet_model());
  LoopState state;
  EXPECT_EQ(playback.step({0, 0, 705}, state).force, Eigen::Vector3d::Zero());
  EXPECT_EQ(playback.step({0, 0, 706}, state).force, Eigen::Vector3d::Zero());
}

TEST(Playback, GivesNoForceAndForgetsTheContactWhenTheToolIsNotFinite) {
  const Playback playback(sheet_model());
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    LoopState state;
    static_cast<void>(playback.step(kAbove, state));
    EXPECT_EQ(playback.step({3, 4, 705}, state).state, ContactState::stick);
    const Command command = playback.step({bad, 4, 705}, state);
    EXPECT_EQ(command.force, Eigen::Vector3d::Zero());
    EXPECT_EQ(command.state, ContactState::free);
    EXPECT_TRUE(command.contact.allFinite());
    EXPECT_EQ(playback.step({3, 4, 705}, state).state, ContactState::free);
  }
}

TEST(Playback, ForcesAreFiniteHoweverFarTheToolGoes) {
  const Playback playback(uneven_model());
  const Eigen::Matrix3Xd places = random_points(500, 1);
  LoopState state;
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    const double reach = std::pow(10.0, static_cast<double>(i % 12));
    const Command command =
        playback.step(Eigen::Vector3d(0, 0, 700) + reach * places.col(i), state);
    EXPECT_TRUE(command.force.allFinite());
    EXPECT_TRUE(command.contact.allFinite());
  }
}

TEST(Playback, LosesAContactThatPullsAndFindsItAgain) {
  Model model = sheet_model(0);
  // Weights below zero push the tool outwards less than nothing: the object pulls.
  for (ContactModel& contact : model.contacts) contact.field = scaled(contact.field, -1);
  const Playback playback(model);
  LoopState state;
  static_cast<void>(playback.step(kAbove, state));
  for (int i = 0; i < 3; ++i) {
    const Command command = playback.step({3, 4, 705}, state);
    EXPECT_EQ(command.state, ContactState::free);
    EXPECT_EQ(command.force, Eigen::Vector3d::Zero());
    EXPECT_TRUE(state.has_proxy);
    EXPECT_NEAR(state.proxy.position.z(), 700, 1e-3);
  }
}

TEST(Playback, IsTheSameOnEveryRunAndMovesWithTheWorld) {
  const std::vector<TrajectoryPoint> trajectory = some_trajectory();
  const std::vector<TracePoint> trace = play(Playback(uneven_model()), trajectory);
  const std::vector<TracePoint> again = play(Playback(uneven_model()), trajectory);
  const Eigen::Isometry3d motion = some_motion();
  std::vector<TrajectoryPoint> moved_trajectory = trajectory;
  for (TrajectoryPoint& point : moved_trajectory) point.tool = motion * point.tool;
  const std::vector<TracePoint> elsewhere =
      play(Playback(moved(uneven_model(), motion)), moved_trajectory);
  for (std::size_t i = 0; i < trace.size(); ++i) {
    EXPECT_EQ(trace[i].force, again[i].force);
    EXPECT_EQ(trace[i].contact, again[i].contact);
    // Brent's method finds contacts to about 1e-3 mm, at a stiffness below 1 N/mm.
    EXPECT_LT((elsewhere[i].force - motion.linear() * trace[i].force).norm(), 1e-2) << i;
  }
}

TEST(Playback, DoesNotAllocateInTheLoop) {
  if (!test::counts_allocations()) GTEST_SKIP() << "the sanitizer's allocator cannot be counted";
  for (const bool by_compliance : {false, true}) {
    const Model model = by_compliance ? with_compliances(uneven_model(), 2) : uneven_model();
    if (by_compliance) {
      ASSERT_TRUE(std::ranges::all_of(model.contacts, [](const ContactModel& contact) {
        return contact.compliance.has_value();
      }));
    }
    const Playback playback(model);
    const std::vector<TrajectoryPoint> trajectory = some_trajectory();
    LoopState state;
    const long before = test::allocations();
    int slips = 0;
    for (const TrajectoryPoint& point : trajectory)
      slips += playback.step(point.tool, state).state == ContactState::slip;
    EXPECT_EQ(test::allocations(), before);
    EXPECT_GT(slips, 100);
  }
}

}  // namespace
}  // namespace palpate::haptics
