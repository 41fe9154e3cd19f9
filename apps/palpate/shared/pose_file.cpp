// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/pose_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "shared/inputs.h"

namespace palpate::apps {
namespace {

constexpr double kRotation = 1e-6;  // accepts values rounded to six decimals, as in text files
constexpr std::size_t kWithoutLastRow = 12, kWhole = 16;

std::vector<double> numbers(const fs::path& path) {
  if (is_folder(path)) throw FileError(path.string() + ": is a folder; expected a pose file.");
  std::ifstream in(path);
  std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (!in.good()) throw FileError(path.string() + ": cannot be read.");
  std::ranges::replace(text, ',', ' ');
  std::istringstream words(text);
  std::vector<double> result;
  std::string word;
  while (words >> word) {
    char* end = nullptr;
    result.push_back(std::strtod(word.c_str(), &end));
    if (*end == '\0' && std::isfinite(result.back())) continue;
    throw FileError(fmt::format("{}: number {} is '{}'; expected a finite number.", path.string(),
                                result.size(), word));
  }
  return result;
}

}  // namespace

Eigen::Isometry3d read_pose(const fs::path& path) {
  std::vector<double> entries = numbers(path);
  if (entries.size() == kWithoutLastRow) entries.insert(entries.end(), {0, 0, 0, 1});
  if (entries.size() != kWhole) {
    throw FileError(fmt::format(
        "{}: {} numbers; expected the 12 or 16 of a matrix of rotation and translation [mm].",
        path.string(), entries.size()));
  }
  Eigen::Isometry3d pose;
  pose.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(entries.data());
  if (pose.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    throw FileError(path.string() + ": the last row of the matrix must be 0 0 0 1.");
  }
  if (!pose.linear().isUnitary(kRotation) || !(pose.linear().determinant() > 0)) {
    throw FileError(path.string() +
                    ": the first three columns must be a rotation: orthogonal to 1e-6, "
                    "right-handed, without scale.");
  }
  return pose;
}

}  // namespace palpate::apps
