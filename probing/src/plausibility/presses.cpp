// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "plausibility/presses.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>

namespace palpate::probing {

double tangential_over_normal(const Press& press) {
  return press.tangential / std::abs(press.normal);
}

std::vector<ProbedContact> probed_contacts(const CheckedAcquisition& acquisition) {
  std::vector<ProbedContact> result;
  for (std::size_t i = 0; i < acquisition.contacts().size(); ++i) {
    const std::span<const Sample> samples = acquisition.samples_of(i);
    if (samples.empty()) continue;
    ProbedContact& probed = result.emplace_back();
    probed.contact = &acquisition.contacts()[i];
    const Eigen::Vector3d n = probed.contact->normal.normalized();
    for (const Sample& sample : samples) {
      const double along = n.dot(sample.force);
      probed.presses.push_back({&sample, along, (sample.force - along * n).norm(),
                                n.dot(sample.a - probed.contact->position)});
    }
    const auto least = std::ranges::min_element(
        probed.presses, {}, [](const Press& press) { return std::abs(press.normal); });
    probed.lightest = least->sample->a;
  }
  return result;
}

std::string figure(double value) {
  std::array<char, 32> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 4);
  return {text.data(), end.ptr};
}

std::string percent(double share) { return figure(std::round(100 * share)) + " %"; }

std::string named(const std::string& noun, const std::vector<long long>& ids) {
  constexpr std::size_t kNamed = 10;
  std::string text = noun + (ids.size() == 1 ? " " : "s ");
  for (std::size_t i = 0; i < std::min(ids.size(), kNamed); ++i)
    text += (i == 0 ? "" : ", ") + std::to_string(ids[i]);
  return ids.size() > kNamed ? text + " and " + std::to_string(ids.size() - kNamed) + " more"
                             : text;
}

std::string count_of(std::size_t part, std::size_t all) {
  return std::to_string(part) + " of " + std::to_string(all);
}

}  // namespace palpate::probing
