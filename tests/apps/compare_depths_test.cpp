// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Two range maps of one camera, compared pixel by pixel.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "palpate/geometry/range_map.h"
#include "palpate/sensing/frame.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

class CompareDepths : public ::testing::Test {
 protected:
  /// A wall at 1000 mm; one column has an error of 1 mm, one of 50 mm, one has a depth where there
  /// is nothing, and one has none.
  void SetUp() override {
    geometry::ImageF truth = geometry::ImageF::Constant(10, 8, 1000);
    geometry::ImageF measured = truth;
    measured.col(0).setConstant(1001);
    measured.col(1).setConstant(1050);
    truth.col(2).setConstant(std::nanf(""));
    measured.col(3).setConstant(std::nanf(""));
    geometry::write_depth_tiff(scratch / "measured.tiff", measured);
    geometry::write_depth_tiff(scratch / "truth.tiff", truth);
    // Columns 2 to 5 are lit.
    cv::Mat1b lit(10, 8, static_cast<unsigned char>(0));
    lit.colRange(2, 6) = 1;
    sensing::write_png(scratch / "lit.png", lit);
  }

  nlohmann::json compare(const std::vector<std::string>& more) {
    std::vector<std::string> call = {"compare", scratch / "measured.tiff", scratch / "truth.tiff",
                                     "--json"};
    call.insert(call.end(), more.begin(), more.end());
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, 0) << result.err;
    return nlohmann::json::parse(result.out);
  }

  void expect_refused(std::vector<std::string> call, const std::string& words) {
    call.insert(call.begin(), "compare");
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, 2);
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
  }

  ScratchFolder scratch;
};

TEST_F(CompareDepths, WrongDepthsDoNotCountAsErrors) {
  const nlohmann::json found = compare({});
  EXPECT_EQ(found["wrong"], 20);  // an error of 5 %, and where there is nothing
  EXPECT_EQ(found["measured"], 70);
  EXPECT_EQ(found["wrong_share"], 20.0 / 70);
  EXPECT_EQ(found["count"], 50);
  EXPECT_EQ(found["max"], 1);
  EXPECT_EQ(found["distance"], 1000);
}

TEST_F(CompareDepths, CoverageRefersToTheMask) {
  EXPECT_EQ(compare({})["measurable"], 70);
  EXPECT_EQ(compare({})["coverage"], 60.0 / 70);
  const nlohmann::json found = compare({"--mask", scratch / "lit.png"});
  EXPECT_EQ(found["measurable"], 30);
  EXPECT_EQ(found["coverage"], 20.0 / 30);
  EXPECT_EQ(found["wrong"], 20);  // lit or not
}

TEST_F(CompareDepths, MasksThatDoNotFitAreRefused) {
  const std::string a = scratch / "measured.tiff", b = scratch / "truth.tiff";
  sensing::write_png(scratch / "small.png", cv::Mat1b(5, 8, static_cast<unsigned char>(255)));
  expect_refused({a, b, "--mask", scratch / "small.png"}, "small.png: has 8 x 5 px");
  sensing::write_png(scratch / "dark.png", cv::Mat1b(10, 8, static_cast<unsigned char>(0)));
  expect_refused({a, b, "--mask", scratch / "dark.png"}, "dark.png: none of its non-zero pixels");
  expect_refused({a, b, "--mask", scratch / "nothing.png"}, "nothing.png");
  expect_refused({a, b, "--mask", scratch / "lit.png", "--align"}, "--mask is for two range maps");
  expect_refused({a, b, "--mask", scratch / "lit.png", "--picture", scratch / "lit.png"},
                 "already used");
}

TEST_F(CompareDepths, DepthsThatAreAllWrongAreReportedInWords) {
  geometry::write_depth_tiff(scratch / "measured.tiff", geometry::ImageF::Constant(10, 8, 500));
  const CommandResult result =
      run_palpate({"compare", scratch / "measured.tiff", scratch / "truth.tiff"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("No measured depth is right"), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("nan"), std::string::npos) << result.out;
}

}  // namespace
}  // namespace palpate::apps
