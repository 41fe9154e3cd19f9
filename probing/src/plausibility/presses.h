// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "palpate/probing/plausibility.h"

namespace palpate::probing {

/// A sample as its contact sees it.
struct Press {
  const Sample* sample = nullptr;
  double normal = 0;      ///< [N] force along the outward normal; < 0: pressed
  double tangential = 0;  ///< [N] >= 0
  double height = 0;      ///< [mm] of `a` over the contact, along the normal; < 0: inside
};

using Presses = std::vector<Press>;

struct ProbedContact {
  const Contact* contact = nullptr;
  Presses presses;
  Eigen::Vector3d lightest = Eigen::Vector3d::Zero();  ///< [mm] `a` under the least normal force
};

/// Contacts without samples are left out.
[[nodiscard]] std::vector<ProbedContact> probed_contacts(const CheckedAcquisition& acquisition);

[[nodiscard]] double tangential_over_normal(const Press& press);

/// Four significant digits without trailing zeros: figures for reading.
[[nodiscard]] std::string figure(double value);
/// "98 %".
[[nodiscard]] std::string percent(double share);
/// "contacts 3, 8 and 12 more", in words that are right for one id too.
[[nodiscard]] std::string named(const std::string& noun, const std::vector<long long>& ids);
/// "3 of 46".
[[nodiscard]] std::string count_of(std::size_t part, std::size_t all);

// The checks of `find_implausible`. Each adds what it finds. Precondition: there are contacts.

void find_signs(const std::vector<ProbedContact>& contacts, std::vector<Finding>& findings);
/// Samples at contacts that are right as a whole.
void find_single_samples(const std::vector<ProbedContact>& contacts,
                         std::vector<Finding>& findings);
/// A tangential force does positive work from `a` to `b`.
void find_exchanged_ends(const std::vector<ProbedContact>& contacts,
                         std::vector<Finding>& findings);
void find_groups(const std::vector<ProbedContact>& contacts, std::vector<Finding>& findings);
void find_length_units(const std::vector<ProbedContact>& contacts, std::vector<Finding>& findings);
void find_scales(const std::vector<ProbedContact>& contacts, std::vector<Finding>& findings);
void find_slips(const std::vector<ProbedContact>& contacts, std::vector<Finding>& findings);

}  // namespace palpate::probing
