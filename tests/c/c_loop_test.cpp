// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <string>
#include <thread>

#include "c_testing.h"

namespace palpate::c {
namespace {

/// A hand that holds a tool 4 mm inside the sheet, after a way from outside.
struct Hand {
  std::atomic<int> reads = 0;
  std::atomic<bool> answers = true;
  double largest = 0, last = 0;  // [N]

  static int32_t read(void* user, double tool[3]) {
    auto& hand = *static_cast<Hand*>(user);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const int tick = hand.reads++;
    Eigen::Vector3d::Map(tool) = Eigen::Vector3d(0, 0, 695 + std::min(0.05 * tick, 9.0));
    return hand.answers ? 0 : 1;
  }
  static int32_t write(void* user, const double force[3]) {
    auto& hand = *static_cast<Hand*>(user);
    hand.last = Eigen::Vector3d::Map(force).norm();
    hand.largest = std::max(hand.largest, hand.last);
    return 0;
  }
};

palpate_device_calls calls_of(Hand& hand) {
  palpate_device_calls calls{};
  calls.struct_size = sizeof(calls);
  calls.user = &hand;
  calls.read = Hand::read;
  calls.write = Hand::write;
  calls.period = 1e-3;
  calls.highest_force = 2;
  calls.damping = 0.005;
  return calls;
}

void wait_for(const std::function<bool()>& done) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!done() && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

TEST(CLoop, PressesBackAndTellsHowItRan) {
  const OwnedModel model = opened();
  Hand hand;
  const palpate_device_calls calls = calls_of(hand);
  palpate_loop* loop = nullptr;
  ASSERT_EQ(palpate_loop_start(model.get(), &calls, 0, &loop), PALPATE_OK) << palpate_error_text();
  wait_for([&] { return hand.reads > 1000; });
  palpate_loop_statistics statistics{};
  statistics.struct_size = sizeof(statistics);
  ASSERT_EQ(palpate_loop_finish(loop, &statistics), PALPATE_OK) << palpate_error_text();
  EXPECT_GT(statistics.ticks, 900U);
  EXPECT_GT(statistics.p50, 0);
  EXPECT_GE(statistics.largest, statistics.p999);
  // Spring and coupling in series, 0.4 and 5 N/mm: 1.3 N or so.
  EXPECT_GT(statistics.largest_force, 0.5);
  EXPECT_LE(statistics.largest_force, 2);
  EXPECT_EQ(hand.last, 0) << "the force ends with the loop";
}

TEST(CLoop, EndsWhenTheDeviceDoesNotAnswer) {
  const OwnedModel model = opened();
  Hand hand;
  const palpate_device_calls calls = calls_of(hand);
  palpate_loop* loop = nullptr;
  ASSERT_EQ(palpate_loop_start(model.get(), &calls, 0, &loop), PALPATE_OK);
  wait_for([&] { return hand.reads > 20; });
  hand.answers = false;
  wait_for([&] {  // until nobody asks any more
    const int before = hand.reads;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return hand.reads == before;
  });
  EXPECT_EQ(palpate_loop_finish(loop, nullptr), PALPATE_FAILED);
  EXPECT_NE(std::string(palpate_error_text()).find("does not answer"), std::string::npos);
  EXPECT_EQ(hand.last, 0);
}

TEST(CLoop, RefusesADeviceThatCannotBe) {
  const OwnedModel model = opened();
  Hand hand;
  palpate_loop* loop = nullptr;
  palpate_device_calls calls = calls_of(hand);
  calls.period = 0;
  EXPECT_EQ(palpate_loop_start(model.get(), &calls, 0, &loop), PALPATE_INVALID);
  EXPECT_NE(std::string(palpate_error_text()).find("period is 0"), std::string::npos)
      << palpate_error_text();
  calls = calls_of(hand);
  calls.write = nullptr;
  EXPECT_EQ(palpate_loop_start(model.get(), &calls, 0, &loop), PALPATE_INVALID);
  EXPECT_EQ(loop, nullptr);
  EXPECT_EQ(palpate_loop_finish(nullptr, nullptr), PALPATE_INVALID);
}

}  // namespace
}  // namespace palpate::c
