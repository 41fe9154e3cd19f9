// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "palpate/probing/acquisition.h"

namespace palpate::probing {

/// Finds the samples of a contact: in time for these alone, where a search would take that for all,
/// contact by contact. The acquisition must outlive it and stay as it is. Thread-safe.
class SamplesByContact {
 public:
  /// A sample of no contact is left out.
  explicit SamplesByContact(const Acquisition& acquisition);

  /// Of the contact at this place of `acquisition.contacts`.
  [[nodiscard]] std::size_t count(std::size_t contact) const;
  /// In the order of the acquisition.
  [[nodiscard]] std::vector<Sample> of(std::size_t contact) const;

 private:
  std::span<const Sample> samples_;
  std::vector<std::size_t> order_;  ///< of samples, contact by contact
  std::vector<std::size_t> begin_;  ///< where those of a contact begin; one more at the end
};

}  // namespace palpate::probing
