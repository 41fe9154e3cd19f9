// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "palpate/haptics/model.h"
#include "palpate/haptics/trajectory_csv.h"
#include "palpate/probing/acquisition.h"

namespace palpate::haptics {

/// Lengths |model - query| of the force errors [N].
struct QueryErrors {
  int count = 0;
  double rms = 0;     ///< sqrt(mean |error|^2)
  double median = 0;  ///< of the lengths; quantiles are linear between neighbours
  double p90 = 0;
};

/// Compares a model with forces known at places of its surface.
/// \throws InvalidInput if there is no query, one is not finite (naming its index), or
/// `check_model` refuses.
[[nodiscard]] QueryErrors evaluate_queries(const Model& model, std::span<const Query> queries);

struct ContactError {
  long long contact = 0;  ///< id
  double rms = 0;         ///< [N] sqrt(mean |error|^2) over its samples
  int samples = 0;
};

struct LeaveOneOut {
  double rms = 0;  ///< [N] sqrt(mean |error|^2) over all samples of all contacts
  std::vector<ContactError> per_contact;  ///< in the order of the model's contacts
};

/// Predicts each contact's samples from the others (thesis 5.3.3): the model without that contact,
/// its triangulation made anew on the surface, against the contact's realigned samples.
/// \throws InvalidInput if a contact of the model has no samples in the acquisition, the model has
/// fewer than four contacts, or `check_model` refuses.
[[nodiscard]] LeaveOneOut leave_one_out(const Model& model,
                                        const probing::Acquisition& acquisition);

}  // namespace palpate::haptics
