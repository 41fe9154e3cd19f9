// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/reason.h"

#include <gtest/gtest.h>

#include <set>

namespace palpate::sensing {
namespace {

TEST(Reason, NamesAreThoseOfTheEnumerators) {
  EXPECT_EQ(name(Reason::reconstructed), "reconstructed");
  EXPECT_EQ(name(Reason::uneven_phase), "uneven_phase");
  EXPECT_EQ(name(Reason::color_mismatch), "color_mismatch");
  std::set<std::string_view> names;
  for (int code = 0; code < kReasonCount; ++code) names.insert(name(static_cast<Reason>(code)));
  EXPECT_EQ(names.size(), static_cast<std::size_t>(kReasonCount));
}

TEST(Reason, CountsThePixelsOfOneReason) {
  ReasonImage reasons = ReasonImage::Zero(3, 4);
  reasons.row(1) = static_cast<std::uint8_t>(Reason::grazing);
  EXPECT_EQ(count(reasons, Reason::grazing), 4);
  EXPECT_EQ(count(reasons, Reason::reconstructed), 8);
  EXPECT_EQ(count(reasons, Reason::unlit), 0);
}

}  // namespace
}  // namespace palpate::sensing
