// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "apart.h"
#include "operations.h"
#include "result.h"

namespace palpate::extremes {

enum class Verdict { exact, within_rounding, finite, said, refused, wrong };

/// The result of a case of a theme for an operation.
struct Finding {
  std::string name;  ///< of the case
  Verdict verdict = Verdict::exact;
  std::string text = {};   ///< the error, or the message
  double difference = 0;   ///< [1] relative, if within rounding
  std::string shown = {};  ///< in the table, in place of a summary of all cases
};

/// The text of an agreement that a task returns: read again by `finding_of`.
[[nodiscard]] std::string report_of(const Agreement& agreement, bool must_be_exact);
/// The same for results that need only be finite.
[[nodiscard]] std::string report_of_finite(const Results& results);
/// A result that is off, and says so.
[[nodiscard]] std::string report_of_said();
/// Results that are off by this, relative to their size.
[[nodiscard]] std::string report_of_difference(double difference);
[[nodiscard]] std::string report_of_wrong(std::string_view what);

/// A finding of the outcome of a task. A refusal must say something that can be read.
[[nodiscard]] Finding finding_of(std::string name, const Outcome& outcome);

/// A deviation that is known, and not mended yet.
struct KnownDeviation {
  std::string_view operation, theme;
  std::string_view cases;  ///< how their names begin; empty: all
  std::string_view reason;
  bool only_large = false;  ///< the small size does not try it
};

[[nodiscard]] const std::vector<KnownDeviation>& known_deviations();

/// Returns true if a case is known to deviate.
[[nodiscard]] bool is_known(std::string_view operation, std::string_view theme,
                            std::string_view name);

/// Fails the test where something is wrong that is not known, and where something that is known to
/// be wrong is wrong no more. Adds a row to the table, if one is asked for.
void judge(const Operation& operation, std::string_view theme,
           const std::vector<Finding>& findings);

/// The names of tests: letters and digits only.
[[nodiscard]] std::string test_name(const Operation& operation);

}  // namespace palpate::extremes
