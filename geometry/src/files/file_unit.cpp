// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/file_unit.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "palpate/core/error.h"
#include "palpate/core/input_file.h"
#include "palpate/core/require.h"

namespace palpate::geometry {
namespace {

std::optional<double> find_unit(std::string_view name) {
  struct Unit {
    std::string_view sign, american, british;
    double length;  ///< [mm]
  };
  static constexpr std::array<Unit, 5> kUnits{{{"um", "micrometer", "micrometre", 1e-3},
                                               {"mm", "millimeter", "millimetre", 1},
                                               {"cm", "centimeter", "centimetre", 10},
                                               {"m", "meter", "metre", 1000},
                                               {"in", "inch", "inches", 25.4}}};
  const std::string_view singular =
      name.size() > 3 && name.ends_with('s') ? name.substr(0, name.size() - 1) : name;
  for (const Unit& unit : kUnits)
    if (name == unit.sign || singular == unit.american || singular == unit.british ||
        name == unit.british)
      return unit.length;
  return std::nullopt;
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

}  // namespace

double unit_length(std::string_view name) {
  const std::optional<double> length = find_unit(lower(name));
  if (!length)
    throw InvalidInput("unit " + quoted(name) + " is not known; use um, mm, cm, m or in");
  return *length;
}

std::optional<double> declared_unit(std::string_view comment) {
  std::string words = lower(comment);
  std::replace_if(
      words.begin(), words.end(), [](char c) { return c == ':' || c == '='; }, ' ');
  std::string_view rest = words;
  const std::string_view keyword = next_word(rest);
  if (keyword != "unit" && keyword != "units") return std::nullopt;
  const std::optional<double> length = find_unit(next_word(rest));
  // More words follow, so this is a sentence that happens to begin like a declaration.
  return next_word(rest).empty() ? length : std::nullopt;
}

FileUnit take_unit(const ReadOptions& options, std::optional<double> of_format,
                   std::vector<std::string>& comments) {
  std::optional<double> declared = of_format;
  std::erase_if(comments, [&](const std::string& comment) {
    const std::optional<double> unit = declared_unit(comment);
    if (!declared) declared = unit;
    return unit.has_value();
  });
  if (options.unit) return {*options.unit, UnitSource::stated};
  if (declared) return {*declared, UnitSource::declared};
  return {};
}

void check_options(const ReadOptions& options) {
  require("ReadOptions::unit", options.unit, above(0).finite(), "mm");
}

void check_comments(const std::vector<std::string>& comments, const char* what) {
  for (std::size_t i = 0; i < comments.size(); ++i) {
    const std::string place = std::string(what) + ": comment " + std::to_string(i);
    if (comments[i].find_first_of("\r\n") != std::string::npos)
      throw InvalidInput(place + " has several lines; make one comment of each");
    if (declared_unit(comments[i]))
      throw InvalidInput(place + " declares a unit: " + quoted(std::string_view(comments[i])) +
                         "; files are written in mm, and say so themselves");
  }
}

}  // namespace palpate::geometry
