// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "input.h"

namespace palpate::extremes {

/// The kind of number of a result: the powers of length and force in its unit.
struct Kind {
  int length = 0;
  int force = 0;
};

inline constexpr Kind kNumber{}, kLength{1, 0}, kArea{2, 0}, kVolume{3, 0}, kPerLength{-1, 0},
    kPerArea{-2, 0}, kForce{0, 1}, kStiffness{-1, 1}, kEnergy{1, 1}, kCompliance{1, -1};

/// Transformation of a result with the object.
enum class Motion {
  none,    ///< it stays: a number
  place,   ///< columns are positions, which move and turn
  vector,  ///< columns are vectors, which turn
};

/// A result of an operation: numbers of one kind.
struct Result {
  std::string name;
  Eigen::MatrixXd values;  ///< columns are positions or vectors, or belong to elements
  Kind kind = kNumber;
  Motion motion = Motion::none;
  /// To which elements of the input columns belong: a member of Order; none: to none
  std::vector<int> Order::*elements = nullptr;
  /// Relative to the largest value (of positions: to the size of the object): how far it may be
  /// from what it must be in another frame, at another place or in another order.
  double tolerance = 1e-9;
  /// NaN and infinity are documented: "unknown", "none".
  bool may_be_unknown = false;
  /// What the operation states that the result may be off, in its unit; 0: it states nothing.
  double stated = 0;
  /// What the operation says against relying on the result; empty: nothing.
  std::string words = {};
};

using Results = std::vector<Result>;

/// [mm] to which errors of positions are relative: the diagonal of the sheet of the input.
[[nodiscard]] double size_of(const Input& input);

/// Agreement of two results.
struct Agreement {
  bool exact = true;
  /// Largest difference over what is allowed; at most 1 where they agree.
  double over_allowed = 0;
  /// [1] Largest relative difference.
  double difference = 0;
  std::string worst;  ///< the name of the result where it is
};

/// Compares results of a scaled input with those of the standard input, times the powers of two.
[[nodiscard]] Agreement compare_scaled(const Results& standard, const Results& scaled,
                                       const Input& input);

/// Compares results of a moved or reordered input with those of the standard input.
/// \param rounding relative to the size of the object, what coordinates of the moved object can
/// show, times its share in the results.
[[nodiscard]] Agreement compare_moved(const Results& standard, const Results& moved,
                                      const Input& input, double rounding);

/// The first result that is not finite, in words; empty if all are, or may be unknown.
[[nodiscard]] std::string not_finite(const Results& results);

}  // namespace palpate::extremes
