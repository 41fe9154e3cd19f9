// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>

#include "repository.h"
#include "run_palpate.h"
#include "scratch_folder.h"

namespace palpate::apps {
namespace {

TEST(Version, TellsWhatADefectReportNeeds) {
  const CommandResult text = run_palpate({"--version"});
  EXPECT_EQ(text.status, 0);
  EXPECT_TRUE(text.out.starts_with("palpate ")) << text.out;
  const CommandResult result = run_palpate({"--version", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const nlohmann::json figures = nlohmann::json::parse(result.out);
  const nlohmann::json schema =
      nlohmann::json::parse(read_text(repository("docs/field.schema.json")));
  const std::string eigen = std::to_string(EIGEN_WORLD_VERSION) + "." +
                            std::to_string(EIGEN_MAJOR_VERSION) + "." +
                            std::to_string(EIGEN_MINOR_VERSION);
  EXPECT_EQ(figures.at("libraries").at("Eigen"), eigen);
  for (const char* name : {"CGAL", "Embree", "OpenCV", "PCL", "VTK"}) {
    if (!figures.at("libraries").contains(name)) continue;  // of a build without it
    EXPECT_THAT(figures["libraries"][name].get<std::string>(),
                ::testing::MatchesRegex("[0-9]+[.][0-9.]+[0-9]"));
  }
  EXPECT_THAT(text.out, ::testing::HasSubstr("OpenCV 4."));
  EXPECT_EQ(figures.at("formats").at("field.json"),
            schema.at("properties").at("version").at("const"));
  EXPECT_THAT(figures.at("licence").get<std::string>(), ::testing::StartsWith("Apache-2.0"));
  EXPECT_THAT(figures.at("commit").get<std::string>(),
              ::testing::MatchesRegex("unknown|[0-9a-f]{12}[0-9a-f]*\\+?"));
}

}  // namespace
}  // namespace palpate::apps
