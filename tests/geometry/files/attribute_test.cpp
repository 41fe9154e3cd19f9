// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/attribute.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>

#include "file_testing.h"
#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

TEST(Attribute, ColorsOfEveryTypeGoFromZeroToOne) {
  const Attributes bytes{{"red", std::vector<std::uint8_t>{0, 255}, {}},
                         {"green", std::vector<std::uint16_t>{65535, 0}, {}},
                         {"blue", std::vector<float>{0.25F, 1}, {}}};
  const auto color = colors(bytes);
  ASSERT_TRUE(color);
  EXPECT_EQ(color->col(0), Eigen::Vector4d(0, 1, 0.25, 1));
  EXPECT_EQ(color->col(1), Eigen::Vector4d(1, 0, 1, 1));
}

TEST(Attribute, WhatIsSetComesBack) {
  Attributes attributes{{"quality", std::vector<double>{1, 2}, {}}};
  Eigen::MatrixXd color(4, 2);
  color << 0, 1, 51.0 / 255, 0.2, 1, 0, 0.4, 1;
  set_colors(attributes, color);
  EXPECT_LE((*colors(attributes) - color).cwiseAbs().maxCoeff(), 0.5 / 255);
  EXPECT_EQ((*colors(attributes))(1, 0), 51.0 / 255);
  Eigen::Matrix3Xd normal(3, 2);
  normal << 0, 0.6, 0, 0.8, 1, 0;
  set_normals(attributes, normal);
  EXPECT_EQ(*normals(attributes), normal);
  set_normals(attributes, -normal);  // replaces
  EXPECT_EQ(*normals(attributes), -normal);
  EXPECT_EQ(*scalars(attributes, "quality"), Eigen::Vector2d(1, 2));
  EXPECT_EQ(attributes.size(), 8U);
  EXPECT_NO_THROW(check_attributes(attributes, 2, "the test"));
}

TEST(Attribute, WhatIsNotThereOrOfListsIsNone) {
  const Attributes attributes{
      {"nx", std::vector<double>{1}, {}},     {"ny", std::vector<double>{1}, {}},
      {"red", std::vector<double>{1, 2}, {}}, {"green", std::vector<double>{1, 2}, {}},
      {"blue", std::vector<double>{1}, {}},   {"tags", std::vector<double>{1, 2}, {2}}};
  EXPECT_FALSE(normals(attributes));
  EXPECT_FALSE(colors(attributes));  // of different lengths
  EXPECT_FALSE(scalars(attributes, "tags"));
  EXPECT_FALSE(scalars(attributes, "none"));
  EXPECT_EQ(find_attribute(attributes, "none"), nullptr);
  EXPECT_EQ(element_count(attributes.back()), 1);
}

TEST(Attribute, ColorsBecomeBytesAlsoWhereTheyAreOutOfRange) {
  Attributes attributes;
  const std::vector<double> values = {0.2, -3, 1.5, std::numeric_limits<double>::quiet_NaN()};
  for (const char* name : {"red", "green", "blue"})
    set_attribute(attributes, {.name = name, .values = values, .list_sizes = {}});
  const auto bytes = color_bytes(attributes);
  ASSERT_TRUE(bytes);
  EXPECT_EQ(bytes->row(1).cast<int>(), Eigen::RowVector4i(51, 0, 255, 0));
  EXPECT_EQ(bytes->row(3).cast<int>(), Eigen::RowVector4i(255, 255, 255, 255));
  EXPECT_FALSE(color_bytes({}));
}

TEST(Attribute, RefusesColorsOutOfRange) {
  Attributes attributes;
  Eigen::MatrixXd color = Eigen::MatrixXd::Constant(3, 2, 0.5);
  for (const double wrong : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()}) {
    color(1, 1) = wrong;
    EXPECT_THROWS_MESSAGE(set_colors(attributes, color), InvalidInput, "a colour of column 1 is");
  }
  EXPECT_THROWS_MESSAGE(set_colors(attributes, Eigen::MatrixXd::Zero(2, 2)), InvalidInput,
                        "2 rows");
}

TEST(Attribute, TheCheckNamesWhatIsWrong) {
  const auto refuse = [](const Attributes& attributes, const std::string& words) {
    EXPECT_THROWS_MESSAGE(check_attributes(attributes, 2, "here"), InvalidInput, words);
  };
  refuse({{"", std::vector<double>(2), {}}}, "here: attribute \"\" needs a name");
  refuse({{"a b", std::vector<double>(2), {}}}, "one word");
  refuse({{"a", std::vector<double>(2), {}}, {"a", std::vector<float>(2), {}}}, "is there twice");
  refuse({{"a", std::vector<double>(3), {}}}, "values of 3 elements; there are 2");
  refuse({{"a", std::vector<double>(3), {1, 1}}}, "has 3 numbers, but its lists are of 2");
  refuse({{"a", std::vector<double>(3), {4, -1}}}, "a list of size -1");
}

}  // namespace
}  // namespace palpate::geometry
