// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/viewer_names.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

namespace palpate::geometry {
namespace {

std::vector<std::string> names_of(const Attributes& attributes) {
  std::vector<std::string> names;
  for (const Attribute& attribute : attributes) names.push_back(attribute.name);
  return names;
}

TEST(ViewerNames, MarkNumbersForCloudCompareAndGiveMeshLabTheFirstOne) {
  const Attributes attributes{{"nx", std::vector<float>{1, 0}, {}},
                              {"red", std::vector<std::uint8_t>{1, 2}, {}},
                              {"neighbours", std::vector<std::int32_t>{5, 6, 7}, {2, 1}},
                              {"cluster", std::vector<std::int32_t>{3, -4}, {}},
                              {"sigma", std::vector<double>{0.1, 1e-3}, {}}};
  const Attributes named = with_viewer_names(attributes);
  EXPECT_EQ(names_of(named), (std::vector<std::string>{"nx", "red", "neighbours", "scalar_cluster",
                                                       "scalar_sigma", "quality"}));
  EXPECT_EQ(named[4].values, attributes[4].values);  // in all their digits
  EXPECT_EQ(std::get<std::vector<float>>(named[5].values), (std::vector<float>{3, -4}));
  EXPECT_EQ(names_of(with_viewer_names(named)), names_of(named));  // twice is once
}

TEST(ViewerNames, KeepAQualityAndAddNoneWithoutNumbers) {
  const Attributes own{{"sigma", std::vector<float>{7}, {}},
                       {"quality", std::vector<float>{9}, {}}};
  const Attributes named = with_viewer_names(own);
  EXPECT_EQ(names_of(named), (std::vector<std::string>{"scalar_sigma", "quality"}));
  EXPECT_EQ(named[1].values, own[1].values);
  const Attributes none{{"red", std::vector<std::uint8_t>{1}, {}}};
  EXPECT_EQ(names_of(with_viewer_names(none)), names_of(none));
}

}  // namespace
}  // namespace palpate::geometry
