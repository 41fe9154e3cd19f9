// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "palpate/geometry/contact_locator.h"
#include "palpate/haptics/model.h"
#include "reduce/strokes.h"

namespace palpate::haptics {

/// Some contacts of a model that predict the others.
struct ThinnedContacts {
  std::vector<std::size_t> kept;  ///< indices, ascending
  Model model;                    ///< `with_contacts` of them
  double error = 0;               ///< [N] RMS difference from the model at the ends of the strokes
};

/// Chooses few contacts with which strokes feel as with all of them. Results for a choice are kept
/// for the next error.
class ContactThinning {
 public:
  /// \param candidates indices, ascending; at least three.
  /// \param ends of the strokes, as the model plays them.
  /// Precondition: the model, the strokes and their ends outlive this.
  ContactThinning(const Model& model, std::span<const std::size_t> candidates,
                  std::span<const Stroke> strokes, std::span<const StrokeEnd> ends);

  /// Begins with a few contacts that cover the object, and adds those at which the difference is
  /// largest, some at a time and never two neighbours, until it is at most `error`, or there are no
  /// more. Contacts around the candidates come last: they keep the triangles of the candidates as
  /// they are. Evenly spread contacts are taken instead if fewer of them do. Then those leave that
  /// are missed least, as long as the error holds.
  /// \param tried is called after each model that was played.
  [[nodiscard]] ThinnedContacts within(double error, const std::function<void()>& tried);

 private:
  struct Choice {
    double error = 0;                 // [N] RMS of the differences
    std::vector<double> differences;  // [N] at each end; empty without a triangulation
  };

  struct Losses {
    std::vector<double> values;                // `contact_losses`
    std::vector<std::vector<int>> neighbours;  // of each contact that is kept, among these
  };

  [[nodiscard]] std::vector<std::size_t> added_up(double error, const std::function<void()>& tried);
  [[nodiscard]] std::vector<std::size_t> fewest_spread(std::vector<std::size_t> kept, double error,
                                                       const std::function<void()>& tried);
  [[nodiscard]] std::vector<std::size_t> pruned(std::vector<std::size_t> kept, double error,
                                                const std::function<void()>& tried);
  [[nodiscard]] std::vector<std::size_t> dispensable(const std::vector<std::size_t>& kept,
                                                     double error,
                                                     const std::function<void()>& tried);
  [[nodiscard]] const Choice& played(const std::vector<std::size_t>& kept,
                                     const std::function<void()>& tried);
  [[nodiscard]] Choice play(const std::vector<std::size_t>& kept) const;
  [[nodiscard]] std::vector<std::size_t> missing(const std::vector<std::size_t>& kept,
                                                 std::span<const double> differences) const;

  const Model& model_;
  std::span<const Stroke> strokes_;
  std::span<const StrokeEnd> ends_;
  std::vector<std::vector<int>> neighbours_;       // of each contact
  std::vector<std::size_t> candidates_;            // those given, then their neighbours
  std::vector<std::size_t> spread_;                // those given, farthest points first
  std::vector<geometry::ContactWeights> weights_;  // of each end
  std::map<std::vector<std::size_t>, Choice> choices_;
  std::map<std::vector<std::size_t>, Losses> losses_;
};

}  // namespace palpate::haptics
