// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/samples_by_contact.h"

#include <numeric>
#include <unordered_map>

namespace palpate::probing {

SamplesByContact::SamplesByContact(const Acquisition& acquisition)
    : samples_(acquisition.samples), begin_(acquisition.contacts.size() + 1, 0) {
  std::unordered_map<long long, std::size_t> places;
  places.reserve(acquisition.contacts.size());
  for (std::size_t i = 0; i < acquisition.contacts.size(); ++i) {
    places.emplace(acquisition.contacts[i].id, i);
  }
  // A counting sort: how many are before each contact, then each sample to its place.
  for (const Sample& sample : samples_) {
    if (const auto place = places.find(sample.contact); place != places.end())
      ++begin_[place->second + 1];
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  order_.resize(begin_.back());
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t s = 0; s < samples_.size(); ++s) {
    if (const auto place = places.find(samples_[s].contact); place != places.end())
      order_[next[place->second]++] = s;
  }
}

std::size_t SamplesByContact::count(std::size_t contact) const {
  return begin_[contact + 1] - begin_[contact];
}

std::vector<Sample> SamplesByContact::of(std::size_t contact) const {
  std::vector<Sample> result;
  result.reserve(count(contact));
  for (std::size_t i = begin_[contact]; i < begin_[contact + 1]; ++i) {
    result.push_back(samples_[order_[i]]);
  }
  return result;
}

}  // namespace palpate::probing
