// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/pcd_fields.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

namespace palpate::geometry {
namespace {

constexpr std::array<std::pair<const char*, const char*>, 3> kRenamed{
    {{"normal_x", "nx"}, {"normal_y", "ny"}, {"normal_z", "nz"}}};

struct Channel {
  const char* name;
  int shift;  ///< bits
};
constexpr std::array<Channel, 4> kChannels{{{"red", 16}, {"green", 8}, {"blue", 0}, {"alpha", 24}}};

/// The four bytes of each colour; nullopt unless the field is one number of four bytes.
std::optional<std::vector<std::uint32_t>> packed_colors(const Attribute& field) {
  if (!field.list_sizes.empty()) return std::nullopt;
  if (const auto* whole = std::get_if<std::vector<std::uint32_t>>(&field.values)) return *whole;
  std::vector<std::uint32_t> packed;
  if (const auto* numbers = std::get_if<std::vector<float>>(&field.values))
    for (const float number : *numbers) packed.push_back(std::bit_cast<std::uint32_t>(number));
  else if (const auto* whole = std::get_if<std::vector<std::int32_t>>(&field.values))
    packed.assign(whole->begin(), whole->end());
  else
    return std::nullopt;
  return packed;
}

void unpack_colors(const std::vector<std::uint32_t>& packed, std::size_t channels,
                   Attributes& attributes) {
  for (std::size_t i = 0; i < channels; ++i) {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(packed.size());
    for (const std::uint32_t color : packed)
      bytes.push_back(static_cast<std::uint8_t>(color >> kChannels[i].shift));
    attributes.push_back({kChannels[i].name, std::move(bytes), {}});
  }
}

/// The channel's bytes; null if it is not there or of another type.
const std::vector<std::uint8_t>* channel_bytes(const Attributes& attributes, const char* name) {
  const Attribute* channel = find_attribute(attributes, name);
  return channel == nullptr || !channel->list_sizes.empty()
             ? nullptr
             : std::get_if<std::vector<std::uint8_t>>(&channel->values);
}

void pack_colors(Attributes& attributes) {
  const bool has_alpha = find_attribute(attributes, "alpha") != nullptr;
  const std::size_t channels = has_alpha ? 4 : 3;
  std::vector<std::uint32_t> packed;
  for (std::size_t i = 0; i < channels; ++i) {
    const std::vector<std::uint8_t>* bytes = channel_bytes(attributes, kChannels[i].name);
    if (bytes == nullptr) return;
    packed.resize(bytes->size(), 0);
    for (std::size_t k = 0; k < bytes->size(); ++k)
      packed[k] |= std::uint32_t{(*bytes)[k]} << kChannels[i].shift;
  }
  for (std::size_t i = 0; i < channels; ++i)
    std::erase_if(attributes,
                  [&](const Attribute& attribute) { return attribute.name == kChannels[i].name; });
  attributes.push_back({has_alpha ? "rgba" : "rgb", std::move(packed), {}});
}

}  // namespace

Attributes from_pcd_fields(Attributes fields) {
  Attributes attributes;
  for (Attribute& field : fields) {
    for (const auto& [theirs, ours] : kRenamed)
      if (field.name == theirs) field.name = ours;
    const bool is_color = field.name == "rgb" || field.name == "rgba";
    const auto packed = is_color ? packed_colors(field) : std::nullopt;
    if (packed)
      unpack_colors(*packed, field.name == "rgba" ? 4 : 3, attributes);
    else
      attributes.push_back(std::move(field));
  }
  return attributes;
}

Attributes to_pcd_fields(Attributes attributes) {
  for (Attribute& attribute : attributes)
    for (const auto& [theirs, ours] : kRenamed)
      if (attribute.name == ours) attribute.name = theirs;
  pack_colors(attributes);
  return attributes;
}

}  // namespace palpate::geometry
