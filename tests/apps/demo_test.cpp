// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The demo, and its results in docs/results.md and the picture there.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "palpate/sensing/frame.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

/// One run of the demo, for all tests.
class Demo : public ::testing::Test {
 protected:
  struct Run {
    ScratchFolder folder;
    CommandResult result = run_palpate({"demo", "-o", folder / "out", "--json"});
  };
  static const Run& run() {
    static const Run made;
    return made;
  }
  static nlohmann::json seeing() {
    EXPECT_EQ(run().result.status, 0) << run().result.err;
    return nlohmann::json::parse(run().result.out)["seeing"];
  }
  /// The files of a frame's truth, without their endings.
  static std::string truth_of(const std::string& frame) {
    return (demo_data() / (frame == "duck_verging" ? "verging/truth" : "truth/" + frame)).string();
  }
  static std::vector<std::string> compare_call(const std::string& frame) {
    return {"compare", run().folder / ("out/range/" + frame + ".tiff"), truth_of(frame) + ".tiff",
            "--mask", truth_of(frame) + "_lit.png"};
  }
};

TEST_F(Demo, GivesTheFiguresThatCompareGives) {
  for (const nlohmann::json& frame : seeing()) {
    std::vector<std::string> call = compare_call(frame["frame"]);
    const std::string prose = run_palpate(call).out;
    call.emplace_back("--json");
    const nlohmann::json compared = nlohmann::json::parse(run_palpate(call).out);
    EXPECT_GT(compared.size(), 10u);
    for (const auto& [key, value] : compared.items())
      EXPECT_EQ(frame.at(key), value) << frame["frame"] << ": " << key;
    // To the digit that the demo prints.
    for (const std::string& figure :
         {fmt::format("{:.1f} % of the", 100 * frame["coverage"].get<double>()),
          fmt::format("Wrong: {:.2f} %", 100 * frame["wrong_share"].get<double>()),
          fmt::format("median {:.3f} mm = {:.4f} %", frame["median"].get<double>(),
                      100 * frame["relative_median"].get<double>())})
      EXPECT_NE(prose.find(figure), std::string::npos) << figure << "\n" << prose;
  }
}

TEST_F(Demo, GivesTheFiguresOfThePageOfResults) {
  const std::string page = read_text(demo_data().parent_path() / "docs/results.md");
  for (const nlohmann::json& frame : seeing()) {
    const std::string row = fmt::format(
        "| {:.0f} mm | {:.3f} mm = {:.4f} % | {:.1f} % | {:.2f} % |",
        frame["distance"].get<double>(), frame["median"].get<double>(),
        100 * frame["relative_median"].get<double>(), 100 * frame["coverage"].get<double>(),
        100 * frame["wrong_share"].get<double>());
    EXPECT_NE(page.find(row), std::string::npos)
        << "docs/results.md, table of the frames, " << frame["frame"] << ": " << row;
  }
}

TEST_F(Demo, ProbesWhatACampaignProbesThatIsNotStopped) {
  ASSERT_EQ(run().result.status, 0) << run().result.err;
  const nlohmann::json probing = nlohmann::json::parse(run().result.out)["probing"];
  EXPECT_GT(probing["trials_before"], 100);
  EXPECT_LT(probing["trials_before"], probing["trials"]);
  const std::string folder = run().folder / "out/probing/", whole = run().folder / "whole.db";
  const CommandResult campaign =
      run_palpate({"probe", "run", folder + "plan.json", "--specimen",
                   (demo_data() / "probing/sheet_block.json").string(), "-o", whole, "--json"});
  ASSERT_EQ(campaign.status, 0) << campaign.err;
  EXPECT_EQ(nlohmann::json::parse(campaign.out)["trials"], probing["trials"]);
  for (const std::string& store : {whole, folder + "acquisition.db"})
    ASSERT_EQ(run_palpate({"probe", "export", store, "-o", store + ".csv"}).status, 0);
  EXPECT_EQ(read_text(whole + ".csv/samples.csv"),
            read_text(folder + "acquisition.db.csv/samples.csv"));
}

TEST_F(Demo, EndsWithAModelAPictureAndAReportToOpen) {
  ASSERT_EQ(run().result.status, 0) << run().result.err;
  const nlohmann::json open = nlohmann::json::parse(run().result.out)["open"];
  ASSERT_EQ(open.size(), 3U);
  const std::string page = read_text(open[0].get<std::string>());
  EXPECT_NE(page.find("<title>sheet"), std::string::npos) << page.substr(0, 500);
  EXPECT_FALSE(sensing::read_frame(open[1].get<std::string>()).empty());
  // On a telephone as wide as the telephone.
  EXPECT_NE(read_text(open[2].get<std::string>()).find("name=\"viewport\""), std::string::npos);
}

TEST_F(Demo, MakesTheOverviewOfThePageOfResults) {
  ASSERT_EQ(run().result.status, 0) << run().result.err;
  const auto small = [](const fs::path& png) {
    cv::Mat image = sensing::read_frame(png);
    EXPECT_EQ(image.size(), cv::Size(1280, 960)) << png;
    cv::resize(image, image, {320, 240}, 0, 0, cv::INTER_AREA);
    return image;
  };
  cv::Mat difference;
  cv::absdiff(small(run().folder / "out/pictures/overview.png"),
              small(demo_data().parent_path() / "docs/overview.png"), difference);
  const cv::Scalar mean = cv::mean(difference);
  // Levels of 255: another version of the renderer may shade edges differently.
  EXPECT_LT((mean[0] + mean[1] + mean[2]) / 3, 0.5)
      << "docs/overview.png is stale: copy pictures/overview.png of palpate demo there";
}

}  // namespace
}  // namespace palpate::apps
