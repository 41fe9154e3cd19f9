// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/pattern.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <ostream>
#include <set>
#include <utility>

#include "files/storage_file.h"
#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/core/require.h"

namespace palpate::sensing {
namespace {

/// mean +- amplitude may leave [0, 1] by this much, the rounding of decimal numbers in a file.
constexpr double kRangeTolerance = 1e-9;

std::string at(const char* list, std::size_t index) {
  return std::string(list) + "[" + std::to_string(index) + "]";
}

void check_colors(const Pattern& pattern, const std::string& what) {
  if (pattern.colors.size() > kMostPatternColors) {
    throw InvalidInput(what + ": colors: there are " + std::to_string(pattern.colors.size()) +
                       "; at most " + std::to_string(kMostPatternColors) + " are possible");
  }
  std::set<std::string> names;
  for (std::size_t i = 0; i < pattern.colors.size(); ++i) {
    const PatternColor& color = pattern.colors[i];
    if (color.name.empty() || !names.insert(color.name).second) {
      throw InvalidInput(what + ": " + at("colors", i) + ": the name is empty or appears twice: '" +
                         color.name + "'");
    }
    if (!((color.rgb.array() >= 0) && (color.rgb.array() <= 1)).all() ||
        color.rgb.minCoeff() == color.rgb.maxCoeff()) {
      throw InvalidInput(what + ": " + at("colors", i) +
                         ": rgb must lie in [0, 1] and not be grey");
    }
  }
}

void check_stripes(const Pattern& pattern, const std::string& what) {
  const auto& stripes = pattern.stripes;
  const auto& edges = pattern.stripe_edges;
  if (pattern.colors.empty() != stripes.empty()) {
    throw InvalidInput(what + ": has " +
                       (stripes.empty() ? "colors but no stripes" : "stripes but no colors") +
                       "; both or neither are expected");
  }
  if (edges.size() + (stripes.empty() ? 0 : 1) != stripes.size()) {
    throw InvalidInput(what + ": stripe_edges_px: " + std::to_string(edges.size()) + " edges for " +
                       std::to_string(stripes.size()) + " stripes; one less is expected");
  }
  std::set<std::pair<int, int>> pairs;
  for (std::size_t i = 0; i < stripes.size(); ++i) {
    if (stripes[i] < 0 || stripes[i] >= static_cast<int>(pattern.colors.size())) {
      throw InvalidInput(what + ": " + at("stripes", i) + ": no colour " +
                         std::to_string(stripes[i]));
    }
    if (i == 0) continue;
    if (stripes[i] == stripes[i - 1]) {
      throw InvalidInput(what + ": " + at("stripes", i) + ": the same colour as its neighbour");
    }
    if (!pairs.insert({stripes[i - 1], stripes[i]}).second) {
      throw InvalidInput(what + ": " + at("stripes", i) +
                         ": this pair of neighbours appears before; a transition must be unique");
    }
    if (!std::isfinite(edges[i - 1]) || (i > 1 && !(edges[i - 1] > edges[i - 2]))) {
      throw InvalidInput(what + ": " + at("stripe_edges_px", i - 1) + ": the edges must rise");
    }
  }
}

/// The shortest decimal number that reads back as this value.
template <typename T>
std::string shortest(T value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  return {digits.data(), end.ptr};
}

constexpr int kMostShifts = 64;
constexpr int kMostCodeBits = 16;
/// Cells of the code that are wider leave too little of a period to notice a misread bit.
constexpr double kWidestCell = 0.75;
/// Shifts determine a sinusoid if the least eigenvalue of their normal matrix is at least this, as
/// a share of that of equal steps (1/2 per image). Below, noise grows more than threefold.
constexpr double kLeastDetermination = 0.1;

double determination(const std::vector<double>& shifts) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  for (const double shift : shifts) {
    const Eigen::Vector3d row(1, std::cos(shift), std::sin(shift));
    normal += row * row.transpose();
  }
  const double least = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(normal).eigenvalues()[0];
  return 2 * least / static_cast<double>(shifts.size());
}

void check_multishot(const Pattern& pattern, const std::string& what) {
  const Multishot& shots = *pattern.multishot;
  const std::string place = what + ": multishot: ";
  if (!pattern.stripes.empty()) {
    throw InvalidInput(place +
                       "the pattern has coloured stripes, which are for single images; "
                       "leave out colors, stripes and stripe_edges_px");
  }
  require(place + "number of shifts", static_cast<double>(shots.shifts.size()),
          at_least(3).at_most(kMostShifts));
  for (std::size_t i = 0; i < shots.shifts.size(); ++i)
    require([&] { return place + at("shifts", i); }, shots.shifts[i], finite(), "rad");
  if (!(determination(shots.shifts) >= kLeastDetermination)) {
    throw InvalidInput(place +
                       "shifts: do not determine a sinusoid; spread them over a whole "
                       "turn, as in [ 0, 2.0944, 4.1888 ]");
  }
  require(place + "code_bits", shots.code_bits, at_least(1).at_most(kMostCodeBits));
  require(place + "code_cell_px", shots.code_cell, above(0).finite(), "px");
  if (!(shots.code_cell <= kWidestCell * pattern.period * (1 + kRangeTolerance))) {
    throw InvalidInput(place + "code_cell_px is " + shortest(shots.code_cell) +
                       "; it must be at most 3/4 of the period of " + shortest(pattern.period) +
                       " px, best half of it. Cells as wide as a period need one finer image of "
                       "the code");
  }
  require(place + "code_start_px", shots.code_start, finite(), "px");
}

std::string pixels(const Eigen::Vector2i& size) {
  return std::to_string(size.x()) + " x " + std::to_string(size.y()) + " px";
}

/// A name as YAML text, without quotes if it consists of letters and digits.
std::string quoted(const std::string& name) {
  const bool plain =
      std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) != 0; }) &&
      std::isalpha(static_cast<unsigned char>(name[0])) != 0;
  if (plain) return name;
  std::string text = "\"";
  for (const char c : name) {
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + '"';
}

}  // namespace

void check_pattern(const Pattern& pattern, const std::string& what) {
  require(what + ": period_px", pattern.period, above(0).finite(), "px");
  require(what + ": phase", pattern.phase, finite(), "rad");
  require(what + ": mean", pattern.mean, finite());
  require(what + ": amplitude", pattern.amplitude, above(0).finite());
  if (pattern.mean - pattern.amplitude < -kRangeTolerance ||
      pattern.mean + pattern.amplitude > 1 + kRangeTolerance) {
    throw InvalidInput(what + ": mean " + shortest(pattern.mean) + " and amplitude " +
                       shortest(pattern.amplitude) +
                       " leave [0, 1]; mean - amplitude must be >= 0, mean + amplitude <= 1");
  }
  if (pattern.projector_size) {
    require(what + ": projector_size: width", pattern.projector_size->x(), at_least(1), "px");
    require(what + ": projector_size: height", pattern.projector_size->y(), at_least(1), "px");
  }
  check_colors(pattern, what);
  check_stripes(pattern, what);
  if (pattern.multishot) check_multishot(pattern, what);
}

void check_pattern_fits(const Pattern& pattern, const geometry::Camera& projector,
                        const std::string& what) {
  if (pattern.projector_size) {
    if (*pattern.projector_size == Eigen::Vector2i(projector.width, projector.height)) return;
    throw InvalidInput(what + ": projector_size: it was made for " +
                       pixels(*pattern.projector_size) + ", but the rig's projector has " +
                       pixels({projector.width, projector.height}) +
                       "; take the rig and the pattern that belong together");
  }
  const int across = pattern.axis == Axis::y ? projector.width : projector.height;
  for (std::size_t i = 0; i < pattern.stripe_edges.size(); ++i) {
    if (pattern.stripe_edges[i] > -0.5 && pattern.stripe_edges[i] < across - 0.5) continue;
    throw InvalidInput(what + ": " + at("stripe_edges_px", i) +
                       ": lies beyond the rig's projector of " +
                       pixels({projector.width, projector.height}) +
                       "; take the rig and the pattern that belong together");
  }
}

namespace {

Multishot read_multishot(const StorageFile& file, const YAML::Node& node) {
  const std::string place = "multishot.";
  const auto number = [&](const char* key) {
    return file.number(file.child(node, key, place), place + key);
  };
  Multishot shots;
  shots.shifts = file.numbers(file.child(node, "shifts", place), place + "shifts");
  shots.code_bits = file.whole_number(file.child(node, "code_bits", place), place + "code_bits");
  shots.code_cell = number("code_cell_px");
  if (file.find(node, "code_start_px").IsDefined()) shots.code_start = number("code_start_px");
  return shots;
}

}  // namespace

Pattern read_pattern(const std::filesystem::path& path) {
  const StorageFile file(path);
  const YAML::Node& root = file.root();
  const auto number = [&](const char* key) { return file.number(file.child(root, key), key); };
  Pattern pattern;
  if (const YAML::Node node = file.find(root, "colors")) {
    for (const YAML::Node& item : file.items(node, "colors")) {
      const std::string key = at("colors", pattern.colors.size());
      const auto rgb = file.numbers(file.child(item, "rgb", key + "."), key + ".rgb");
      if (rgb.size() != 3) file.fail(key + ".rgb", "three values are expected");
      pattern.colors.push_back({file.text(file.child(item, "name", key + "."), key + ".name"),
                                Eigen::Vector3d(rgb[0], rgb[1], rgb[2])});
    }
  }
  if (const YAML::Node node = file.find(root, "stripes")) {
    for (const YAML::Node& item : file.items(node, "stripes")) {
      const std::string key = at("stripes", pattern.stripes.size());
      pattern.stripes.push_back(file.whole_number(item, key));
    }
  }
  if (const YAML::Node node = file.find(root, "stripe_edges_px")) {
    pattern.stripe_edges = file.numbers(node, "stripe_edges_px");
  }
  const std::string axis = file.text(file.child(root, "axis"), "axis");
  if (axis != "x" && axis != "y") file.fail("axis", "x or y is expected, not '" + axis + "'");
  pattern.axis = axis == "x" ? Axis::x : Axis::y;
  pattern.period = number("period_px");
  pattern.phase = number("phase");
  pattern.mean = number("mean");
  pattern.amplitude = number("amplitude");
  if (const YAML::Node node = file.find(root, "projector_size")) {
    const auto sizes = file.items(node, "projector_size");
    if (sizes.size() != 2) file.fail("projector_size", "columns and rows are expected");
    pattern.projector_size = Eigen::Vector2i(file.whole_number(sizes[0], "projector_size[0]"),
                                             file.whole_number(sizes[1], "projector_size[1]"));
  }
  if (const YAML::Node node = file.find(root, "multishot"))
    pattern.multishot = read_multishot(file, node);
  try {
    check_pattern(pattern, path.string());
  } catch (const InvalidInput& error) {
    throw FileError(error.what());
  }
  return pattern;
}

void write_pattern(const std::filesystem::path& path, const Pattern& pattern) {
  check_pattern(pattern, "write_pattern(" + path.string() + ")");
  // Written by hand, because FileStorage's own output ("name:R") is not valid YAML for others.
  write_file(path, [&](std::ostream& out) {
    const auto list = [&](const auto& values) {
      const char* separator = "[ ";
      for (const auto& value : values) {
        out << separator << shortest(value);
        separator = ", ";
      }
      out << (values.size() == 0 ? "[ ]" : " ]");
    };
    out << "%YAML:1.0\n---\n";
    if (!pattern.colors.empty()) {
      out << "colors:\n";
      for (const PatternColor& color : pattern.colors) {
        out << "   - { name: " << quoted(color.name) << ", rgb: ";
        list(color.rgb);
        out << " }\n";
      }
      out << "stripes: ";
      list(pattern.stripes);
      out << "\nstripe_edges_px: ";
      list(pattern.stripe_edges);
      out << '\n';
    }
    out << "axis: " << (pattern.axis == Axis::x ? "x" : "y")
        << "\nperiod_px: " << shortest(pattern.period) << "\nphase: " << shortest(pattern.phase)
        << "\nmean: " << shortest(pattern.mean) << "\namplitude: " << shortest(pattern.amplitude)
        << '\n';
    if (pattern.projector_size) {
      out << "projector_size: ";
      list(*pattern.projector_size);
      out << '\n';
    }
    if (pattern.multishot) {
      out << "multishot:\n   shifts: ";
      list(pattern.multishot->shifts);
      out << "\n   code_bits: " << pattern.multishot->code_bits
          << "\n   code_cell_px: " << shortest(pattern.multishot->code_cell)
          << "\n   code_start_px: " << shortest(pattern.multishot->code_start) << '\n';
    }
  });
}

}  // namespace palpate::sensing
