// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "geodesic/bucket_queue.h"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

namespace palpate::geometry {
namespace {

struct Event {
  double distance;
};

std::vector<double> popped(BucketQueue<Event>& queue) {
  std::vector<double> distances;
  while (const std::optional<Event> event = queue.pop()) distances.push_back(event->distance);
  return distances;
}

TEST(BucketQueue, TakesTheNearestBucketFirst) {
  BucketQueue<Event> queue(0.5);
  for (const double distance : {3.0, 0.7, 0.6, 1e4}) queue.push({distance});
  EXPECT_EQ(popped(queue), (std::vector<double>{0.7, 0.6, 3, 1e4}));
  for (const double distance : {3.0, 1e4}) EXPECT_TRUE(queue.is_in_order(distance));
}

TEST(BucketQueue, SaysFromWhereOnThereIsNoOrder) {
  BucketQueue<Event> queue(0.5);
  const double first = 1e7, second = 1e6;  // both beyond the last bucket
  for (const double distance : {first, second}) {
    EXPECT_FALSE(queue.is_in_order(distance));
    queue.push({distance});
  }
  EXPECT_EQ(popped(queue), (std::vector<double>{first, second}));
}

}  // namespace
}  // namespace palpate::geometry
