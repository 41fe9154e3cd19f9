// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/acquisition.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <unordered_set>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/probing/measurable.h"

namespace palpate::probing {
namespace {

std::string contact_name(const Contact& contact) { return "contact " + std::to_string(contact.id); }
std::string sample_name(const Sample& sample) { return "sample " + std::to_string(sample.id); }

void check_contact(const Contact& contact) {
  if (!is_measurable(contact.position)) {
    throw InvalidInput(contact_name(contact) + ": its position x,y,z is not finite, or beyond " +
                       "1e12 mm; measure it again or leave the contact out");
  }
  if (!contact.normal.allFinite() || std::abs(contact.normal.norm() - 1) > kUnitLengthTolerance) {
    throw InvalidInput(contact_name(contact) + ": its normal nx,ny,nz has length " +
                       std::to_string(contact.normal.norm()) +
                       "; it must be a unit vector that points out of the object");
  }
}

// Sorted along x, two contacts at one place are near each other in the order.
void check_places(const std::vector<Contact>& contacts) {
  Eigen::Vector3d low = contacts.front().position, high = low;
  for (const Contact& contact : contacts) {
    low = low.cwiseMin(contact.position);
    high = high.cwiseMax(contact.position);
  }
  const double tolerance = kSamePlaceTolerance * (high - low).norm();
  std::vector<std::size_t> order(contacts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    return contacts[i].position.x() < contacts[j].position.x();
  });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Contact& first = contacts[order[i]];
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const Contact& second = contacts[order[j]];
      if (second.position.x() - first.position.x() > tolerance) break;
      if ((second.position - first.position).norm() > tolerance) continue;
      throw InvalidInput(
          "contacts " + std::to_string(std::min(first.id, second.id)) + " and " +
          std::to_string(std::max(first.id, second.id)) +
          " are at one place; give their samples to one of them and remove the other");
    }
  }
}

void check_sample(const Sample& sample,
                  const std::unordered_map<long long, std::size_t>& contacts) {
  if (!contacts.contains(sample.contact)) {
    throw InvalidInput(sample_name(sample) + ": there is no contact " +
                       std::to_string(sample.contact) + "; add the contact or remove the sample");
  }
  if (!is_measurable(sample.force) || !is_measurable(sample.a) || !is_measurable(sample.b)) {
    throw InvalidInput(sample_name(sample) + " (contact " + std::to_string(sample.contact) +
                       "): its force p or its positions a, b are not finite, or beyond 1e12 N or " +
                       "mm; remove the sample");
  }
  require([&] { return sample_name(sample) + ": time since the acquisition began"; }, sample.time,
          at_least(0).finite(), "s");
  if (sample.slipped && sample.on_friction_boundary) {
    throw InvalidInput(
        sample_name(sample) +
        ": marked both slipped and on_friction_boundary; a sample on the boundary is "
        "one that still held");
  }
}

// The index of each contact by its id.
std::unordered_map<long long, std::size_t> check_contacts(const std::vector<Contact>& contacts) {
  if (contacts.empty()) {
    throw InvalidInput("the acquisition has no contact; at least one is needed");
  }
  std::unordered_map<long long, std::size_t> index;
  index.reserve(contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (!index.emplace(contacts[i].id, i).second) {
      throw InvalidInput(contact_name(contacts[i]) + " is there twice; ids must be unique");
    }
    check_contact(contacts[i]);
  }
  check_places(contacts);
  return index;
}

void check_samples(const std::vector<Sample>& samples,
                   const std::unordered_map<long long, std::size_t>& contacts) {
  // As they come from a store, ascending, ids need no set, which is a third of the samples' size.
  const bool ascending = std::ranges::adjacent_find(samples, std::ranges::greater_equal{},
                                                    &Sample::id) == samples.end();
  std::unordered_set<long long> ids;
  for (const Sample& sample : samples) {
    if (!ascending && !ids.insert(sample.id).second) {
      throw InvalidInput(sample_name(sample) + " is there twice; ids must be unique");
    }
    check_sample(sample, contacts);
  }
}

}  // namespace

CheckedAcquisition::CheckedAcquisition(Acquisition acquisition)
    : records_(std::move(acquisition)),
      index_(check_contacts(records_.contacts)),
      begin_(records_.contacts.size() + 1, 0) {
  require("Acquisition::probe_radius", records_.probe_radius, above(0).finite(), "mm");
  require("Acquisition::probe_radius", records_.probe_radius,
          Interval{}.at_most(kLargestMeasurement), "mm");
  std::vector<Sample>& samples = records_.samples;
  check_samples(samples, index_);
  const auto contact_of = [this](const Sample& sample) { return index_.at(sample.contact); };
  for (const Sample& sample : samples) ++begin_[contact_of(sample) + 1];
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  // A file that an arm wrote contact by contact is in this order already.
  if (!std::ranges::is_sorted(samples, {}, contact_of))
    std::ranges::stable_sort(samples, {}, contact_of);
}

std::optional<std::size_t> CheckedAcquisition::find(long long id) const {
  const auto found = index_.find(id);
  return found == index_.end() ? std::nullopt : std::optional(found->second);
}

std::span<const Sample> CheckedAcquisition::samples_of(std::size_t contact) const {
  return std::span(records_.samples)
      .subspan(begin_[contact], begin_[contact + 1] - begin_[contact]);
}

}  // namespace palpate::probing
