// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/viewer_names.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

namespace palpate::geometry {
namespace {

constexpr std::string_view kScalar = "scalar_", kQuality = "quality";

/// Names of vertex properties that viewers know, and that are no plain numbers for them.
constexpr std::array<std::string_view, 12> kKnownToViewers{
    "nx", "ny", "nz", "red", "green", "blue", "alpha", "s", "t", "u", "v", kQuality};

bool is_scalar(const Attribute& attribute) {
  return attribute.list_sizes.empty() &&
         std::ranges::find(kKnownToViewers, attribute.name) == kKnownToViewers.end();
}

}  // namespace

Attributes with_viewer_names(Attributes attributes) {
  const auto first = std::ranges::find_if(attributes, is_scalar);
  if (first == attributes.end()) return attributes;
  std::vector<float> quality;
  std::visit(
      [&](const auto& numbers) {
        for (const auto number : numbers) quality.push_back(static_cast<float>(number));
      },
      first->values);
  for (Attribute& attribute : attributes)
    if (is_scalar(attribute) && !attribute.name.starts_with(kScalar))
      attribute.name.insert(0, kScalar);
  if (find_attribute(attributes, kQuality) == nullptr) {
    attributes.push_back(
        {.name = std::string(kQuality), .values = std::move(quality), .list_sizes = {}});
  }
  return attributes;
}

}  // namespace palpate::geometry
