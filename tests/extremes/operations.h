// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "input.h"
#include "palpate/core/fields.h"
#include "palpate/haptics/model.h"
#include "result.h"

namespace palpate::extremes {

/// Changes a field of the options that an operation is about to use.
using Change = std::function<void(const FieldList& options)>;

/// The parts of the input that an operation uses.
enum Part : unsigned {
  kSheet = 1U << 0U,
  kBall = 1U << 1U,
  kCloud = 1U << 2U,
  kPlaces = 1U << 3U,
  kContacts = 1U << 4U,
  kSamples = 1U << 5U,
  kTrials = 1U << 6U,
  kAcquisition = 1U << 7U,
  kTrajectory = 1U << 8U,
  kFrame = 1U << 9U,
  kForces = 1U << 10U,  ///< none of the above, but `Input::force`
  kViews = 1U << 11U,
  kOptions = 1U << 12U  ///< it has options with a list of their fields, which `Change` may change
};

/// An operation of the libraries. All listed operations are in every theme.
struct Operation {
  std::string name;
  unsigned uses = 0;
  std::function<Results(const Input&, const Change&)> run = {};
  /// Largest relative difference when lengths or forces are multiplied by powers of two; 0: none,
  /// to the last bit.
  double scale_tolerance = 0;
  /// Factor of the rounding of the moved coordinates, relative to the object, by which results may
  /// differ; 0: not at all where coordinates are moved exactly.
  double place_sensitivity = 0;
  /// [s] of processor time that a call may take.
  int seconds = 1;
  /// Takes so long that only the large size of the suite has it.
  bool only_large = false;
};

/// Returns true if the sizes that take minutes are requested, by PALPATE_EXTREMES=large.
[[nodiscard]] bool is_large();

/// For messages of tests.
void PrintTo(const Operation& operation, std::ostream* stream);

/// All of them; the one list.
[[nodiscard]] const std::vector<Operation>& all_operations();

/// Those of the size that was asked for (`is_large`).
[[nodiscard]] const std::vector<Operation>& operations();

/// The lists of single libraries, of which it is made.
[[nodiscard]] std::vector<Operation> surface_operations();
[[nodiscard]] std::vector<Operation> cloud_operations();
[[nodiscard]] std::vector<Operation> scan_operations();
[[nodiscard]] std::vector<Operation> sensing_operations();
[[nodiscard]] std::vector<Operation> probing_operations();
[[nodiscard]] std::vector<Operation> haptics_operations();

/// The contacts of the sheet in the order of the standard input; at least one.
[[nodiscard]] std::vector<geometry::SurfacePoint> contacts_in_order(const Input& input);

/// A model of the sheet with its contacts, made by hand.
[[nodiscard]] haptics::Model model_of(const Input& input);

/// Leaves all options as they are.
[[nodiscard]] const Change& no_change();

// Results in short.
[[nodiscard]] Result number(std::string name, double value, Kind kind = kNumber,
                            double tolerance = 1e-9);
[[nodiscard]] Result numbers(std::string name, const Eigen::Ref<const Eigen::VectorXd>& values,
                             Kind kind = kNumber, std::vector<int> Order::*elements = nullptr,
                             double tolerance = 1e-9);
[[nodiscard]] Result places(std::string name, const Eigen::Ref<const Eigen::Matrix3Xd>& values,
                            std::vector<int> Order::*elements = nullptr, double tolerance = 1e-9);
[[nodiscard]] Result vectors(std::string name, const Eigen::Ref<const Eigen::Matrix3Xd>& values,
                             Kind kind = kNumber, std::vector<int> Order::*elements = nullptr,
                             double tolerance = 1e-9);
/// The same result, where NaN and infinity say "unknown" or "none".
[[nodiscard]] Result unknown_allowed(Result result);

/// The same result of an operation that states how far it may be off, in the result's unit.
[[nodiscard]] Result stating(Result result, double error);
/// The same result of an operation that says that it is not to be relied on.
/// \param words empty: it does not say so
[[nodiscard]] Result saying(Result result, std::string_view words);

/// A tolerance for what depends on the frame or the order in more than rounding, such as where a
/// grid lies or which of two equal edges goes first.
inline constexpr double kRoughly = 0.2;
/// The same for what cannot be compared at all.
inline constexpr double kAnything = 1e300;

}  // namespace palpate::extremes
