// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "whole/version.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <opencv2/core/version.hpp>

#include "commit.h"
#include "shared/aliases.h"

namespace palpate::apps {

std::string version_text(bool json) {
  const std::string eigen =
      fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION);
  if (json) {
    const Json figures = {
        {"version", PALPATE_VERSION},   {"commit", PALPATE_COMMIT}, {"licence", PALPATE_LICENCE},
        {"compiler", PALPATE_COMPILER}, {"eigen", eigen},           {"opencv", CV_VERSION}};
    return figures.dump(2);
  }
  return fmt::format(
      "palpate {}\ncommit: {}\nlicence: {}\ncompiler: {}\nlibraries: Eigen {}, OpenCV {}",
      PALPATE_VERSION, PALPATE_COMMIT, PALPATE_LICENCE, PALPATE_COMPILER, eigen, CV_VERSION);
}

}  // namespace palpate::apps
