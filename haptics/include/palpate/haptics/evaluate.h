// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
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

struct QueryOptions {
  double max_distance = 2;  ///< [mm] of each query's contact from the surface; >= 0
};

/// Compares a model with forces known at places of its surface.
/// \throws InvalidInput if there is no query, one is not finite or further than max_distance from
/// the surface (naming its index), or `check_model` refuses.
[[nodiscard]] QueryErrors evaluate_queries(const Model& model, std::span<const Query> queries,
                                           const QueryOptions& options = {});

struct ContactError {
  long long contact = 0;  ///< id
  double rms = 0;         ///< [N] sqrt(mean |error|^2) over its samples
  int samples = 0;
  bool at_border = false;  ///< of the triangulation of all contacts: predicted from one side only
  /// [N] how far the neighbours disagree: sqrt(mean sum_k w_k |f_k - f|^2) over its samples, f_k
  /// what the field of neighbour k, of weight w_k, says there alone
  double spread = 0;
  /// [N] standard deviation of the normal force at the reference displacement, which kriging of the
  /// neighbours' compliances expects; NaN unless compliances are blended
  double expected = 0;
};

/// A place where one more contact would tell most.
struct SuggestedContact {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [mm] a vertex of the surface
  double expected = 0;  ///< [N] as `ContactError::expected`, scaled so that those agree with `rms`
};

struct LeaveOneOut {
  double rms = 0;           ///< [N] sqrt(mean |error|^2) over all samples of all contacts
  double interior_rms = 0;  ///< [N] over the contacts that are not at the border; NaN without any
  double border_rms = 0;    ///< [N] over those that are; NaN without any
  std::vector<ContactError> per_contact;  ///< in the order of the model's contacts
  /// The largest expected errors, at least as far apart and from contacts, and at most as far from
  /// the contacts' triangles, as half the spacing of contacts; empty unless compliances are
  /// blended.
  std::vector<SuggestedContact> suggested;
};

struct LeaveOneOutOptions {
  int suggestions = 5;  ///< at most so many; >= 0
  /// Called after each contact with the number of those done and of all, from one thread at a time.
  std::function<void(int done, int total)> progress = {};
};

/// Predicts each contact's samples from the others (thesis 5.3.3): the model without that contact,
/// its triangulation and all that is learnt of compliances made anew, against what was measured.
/// \throws InvalidInput if a contact of the model is not in the acquisition, is elsewhere there or
/// has no samples there, if the acquisition holds other samples than the model was made of, the
/// model has fewer than four contacts, or `check_model` refuses.
[[nodiscard]] LeaveOneOut leave_one_out(const Model& model, const probing::Acquisition& acquisition,
                                        const LeaveOneOutOptions& options = {});

}  // namespace palpate::haptics
