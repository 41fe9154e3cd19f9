// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "import/column_units.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "import/import_columns.h"
#include "import/wrong_mapping.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/probing/csv.h"

namespace palpate::probing {
namespace {

/// The text in brackets at the end of a name; empty if there is none.
std::string_view unit_in_name(std::string_view name) {
  while (name.ends_with(' ')) name.remove_suffix(1);
  if (!name.ends_with(')') && !name.ends_with(']')) return {};
  const std::size_t open = name.rfind(name.ends_with(')') ? '(' : '[');
  if (open == std::string_view::npos) return {};
  return name.substr(open + 1, name.size() - open - 2);
}

template <typename SizeOf>
std::optional<double> size_of_unit(std::string_view unit, SizeOf size_of) {
  try {
    return size_of(unit);
  } catch (const InvalidInput&) {  // not a unit of this quantity, such as "raw"
    return std::nullopt;
  }
}

bool is_length(std::string_view column) {
  constexpr std::array<std::string_view, 10> kLengths = {"x",  "y",  "z",  "ax", "ay",
                                                         "az", "bx", "by", "bz", kDepthColumn};
  return std::find(kLengths.begin(), kLengths.end(), column) != kLengths.end();
}

bool is_force(std::string_view column) {
  return column == "px" || column == "py" || column == "pz" || column == kNormalForceColumn;
}

}  // namespace

void check_units_of_names(const AcquisitionMapping& mapping) {
  for (const auto& [column, name] : mapping.columns) {
    const std::string_view unit = unit_in_name(name);
    if (unit.empty()) continue;
    const char* quantity = nullptr;
    double taken = 0;
    std::optional<double> named;
    if (is_length(column)) {
      quantity = "length";
      taken = mapping.length;
      named = size_of_unit(unit, [](std::string_view u) { return geometry::unit_length(u); });
    } else if (is_force(column)) {
      quantity = "force";
      taken = mapping.force;
      named = size_of_unit(unit, [](std::string_view u) { return unit_force(u); });
    } else if (column == "time") {
      quantity = "time";
      taken = mapping.time;
      named = size_of_unit(unit, [](std::string_view u) { return unit_time(u); });
    }
    constexpr double kSame = 1e-9;  // relative difference of the same unit, by rounding
    if (!named || std::abs(*named / taken - 1) <= kSame) continue;
    throw wrong_mapping(
        "columns", "'" + column + "' is the column '" + name + "', in " + std::string(unit) +
                       " by its name, which is " + to_text(*named / taken) +
                       " times the unit of the mapping; give " + quantity + ": " +
                       std::string(unit) + " (units in a mapping, or --" + quantity + "-unit)");
  }
}

}  // namespace palpate::probing
