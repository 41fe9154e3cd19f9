// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "reduce/thinning.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/haptics/blended_field.h"
#include "reduce/contact_losses.h"
#include "reduce/contact_subset.h"

namespace palpate::haptics {
namespace {

constexpr std::size_t kFirstContacts = 6;
// A triangle of contacts.
constexpr std::size_t kTriangle = 3;
// Contacts that are added at once, relative to those there are.
constexpr double kAdded = 0.25;
// Number of evenly spread contacts that is tried, relative to the one before.
constexpr double kFewer = 0.85;

std::vector<std::size_t> with_first(std::vector<std::size_t> kept,
                                    const std::vector<std::size_t>& added, std::size_t count) {
  kept.insert(kept.end(), added.begin(), added.begin() + static_cast<std::ptrdiff_t>(count));
  std::ranges::sort(kept);
  return kept;
}

// Candidates in the order of farthest points, by their distance in space; the first is the one
// farthest from the mean.
std::vector<std::size_t> spread_out(const Model& model, std::span<const std::size_t> candidates) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const std::size_t i : candidates) mean += model.contacts[i].position;
  mean /= static_cast<double>(candidates.size());
  std::vector<double> distance(candidates.size());
  for (std::size_t c = 0; c < candidates.size(); ++c)
    distance[c] = (model.contacts[candidates[c]].position - mean).norm();
  std::vector<std::size_t> chosen;
  while (chosen.size() < candidates.size()) {
    const auto next =
        static_cast<std::size_t>(std::ranges::max_element(distance) - distance.begin());
    chosen.push_back(candidates[next]);
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      const double to_next =
          (model.contacts[candidates[c]].position - model.contacts[candidates[next]].position)
              .norm();
      distance[c] = chosen.size() == 1 ? to_next : std::min(distance[c], to_next);
    }
    distance[next] = -std::numeric_limits<double>::infinity();
  }
  return chosen;
}

std::vector<std::size_t> sorted(std::vector<std::size_t> values) {
  std::ranges::sort(values);
  return values;
}

std::vector<std::size_t> first_of(const std::vector<std::size_t>& order, std::size_t count) {
  return with_first({}, order, std::min(count, order.size()));
}

// For each contact, those that share a triangle of contacts with it.
std::vector<std::vector<int>> neighbours_of(const Model& model) {
  std::vector<std::vector<int>> result(model.contacts.size());
  for (const auto& t : model.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      std::vector<int>& of = result[static_cast<std::size_t>(t[k])];
      of.insert(of.end(), {t[(k + 1) % 3], t[(k + 2) % 3]});
    }
  }
  return result;
}

// Those that share a triangle of contacts with a candidate come after the candidates.
std::vector<std::size_t> with_neighbours(const std::vector<std::vector<int>>& neighbours,
                                         std::span<const std::size_t> candidates) {
  std::vector<bool> known(neighbours.size(), false);
  for (const std::size_t i : candidates) known[i] = true;
  std::vector<std::size_t> result(candidates.begin(), candidates.end());
  for (const std::size_t i : candidates) {
    for (const int other : neighbours[i]) {
      const auto index = static_cast<std::size_t>(other);
      if (!known[index]) result.push_back(index);
      known[index] = true;
    }
  }
  return result;
}

}  // namespace

ContactThinning::ContactThinning(const Model& model, std::span<const std::size_t> candidates,
                                 std::span<const Stroke> strokes, std::span<const StrokeEnd> ends)
    : model_(model),
      strokes_(strokes),
      ends_(ends),
      neighbours_(neighbours_of(model)),
      candidates_(with_neighbours(neighbours_, candidates)),
      spread_(spread_out(model, candidates)) {
  const BlendedField field(model);
  for (const StrokeEnd& end : ends)
    weights_.push_back(field.weights(field.surface().closest_point(end.contact).at));
}

ThinnedContacts ContactThinning::within(double error, const std::function<void()>& tried) {
  std::vector<std::size_t> kept = added_up(error, tried);
  if (played(kept, tried).error <= error)
    kept = pruned(fewest_spread(std::move(kept), error, tried), error, tried);
  return {.kept = kept, .model = with_contacts(model_, kept), .error = played(kept, tried).error};
}

std::vector<std::size_t> ContactThinning::added_up(double error,
                                                   const std::function<void()>& tried) {
  std::vector<std::size_t> kept = first_of(spread_, kFirstContacts), before, added;
  std::span<const double> differences;  // of the last choice that has a triangulation
  while (played(kept, tried).error > error) {
    const Choice& choice = played(kept, tried);
    if (!choice.differences.empty()) differences = choice.differences;
    before = kept;
    added = missing(before, differences);
    if (added.empty()) break;
    kept = with_first(before, added, added.size());
  }
  // The last ones were added together; fewer may do.
  std::size_t too_few = 0, enough = added.size();
  while (enough - too_few > 1) {
    const std::size_t middle = (too_few + enough) / 2;
    std::vector<std::size_t> fewer = with_first(before, added, middle);
    if (played(fewer, tried).error <= error) {
      kept = std::move(fewer);
      enough = middle;
    } else {
      too_few = middle;
    }
  }
  return kept;
}

// Fewer contacts than those that are kept, evenly spread, if they do as well.
std::vector<std::size_t> ContactThinning::fewest_spread(std::vector<std::size_t> kept, double error,
                                                        const std::function<void()>& tried) {
  // Errors do not always fall with the number of contacts, so smaller numbers are tried as well.
  std::size_t count = std::min(kept.size(), spread_.size() + 1) - 1;
  while (count >= kTriangle) {
    std::vector<std::size_t> fewer = first_of(spread_, count);
    if (played(fewer, tried).error <= error) kept = std::move(fewer);
    count = static_cast<std::size_t>(kFewer * static_cast<double>(count));
  }
  return kept;
}

// Without the contacts that are missed least.
std::vector<std::size_t> ContactThinning::pruned(std::vector<std::size_t> kept, double error,
                                                 const std::function<void()>& tried) {
  while (kept.size() > kTriangle) {
    std::vector<std::size_t> leaving = dispensable(kept, error, tried), rest;
    do {
      rest.clear();
      std::ranges::set_difference(kept, sorted(leaving), std::back_inserter(rest));
      leaving.resize(leaving.size() / 2);
    } while (rest.size() < kept.size() && played(rest, tried).error > error);
    if (rest.size() == kept.size()) break;
    kept = std::move(rest);
  }
  return kept;
}

// Contacts that may leave, if the losses add up; no two of them are neighbours. The one that is
// missed least comes first.
std::vector<std::size_t> ContactThinning::dispensable(const std::vector<std::size_t>& kept,
                                                      double error,
                                                      const std::function<void()>& tried) {
  const std::vector<double>& differences = played(kept, tried).differences;
  if (!losses_.contains(kept)) {
    const Model model = with_contacts(model_, kept);
    losses_[kept] = {contact_losses(model, strokes_, ends_, differences), neighbours_of(model)};
  }
  const Losses& losses = losses_.at(kept);
  std::vector<std::size_t> order(kept.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return losses.values[k]; });
  double room = error * error * static_cast<double>(differences.size());
  for (const double difference : differences) room -= difference * difference;
  std::vector<bool> stays(kept.size(), false);
  std::vector<std::size_t> result;
  for (const std::size_t k : order) {
    if (stays[k]) continue;
    room -= losses.values[k];
    if (room < 0 || kept.size() - result.size() == kTriangle) break;
    result.push_back(kept[k]);
    for (const int other : losses.neighbours[k]) stays[static_cast<std::size_t>(other)] = true;
  }
  return result;
}

const ContactThinning::Choice& ContactThinning::played(const std::vector<std::size_t>& kept,
                                                       const std::function<void()>& tried) {
  const auto known = choices_.find(kept);
  if (known != choices_.end()) return known->second;
  const Choice& choice = choices_[kept] = play(kept);
  tried();
  return choice;
}

ContactThinning::Choice ContactThinning::play(const std::vector<std::size_t>& kept) const {
  Model model;
  try {
    model = with_contacts(model_, kept);
  } catch (const Error&) {
    // More contacts may have a triangulation where a few have none.
    if (kept.size() == candidates_.size()) throw;
    return {.error = std::numeric_limits<double>::infinity(), .differences = {}};
  }
  Choice choice{.error = 0, .differences = force_differences(ends_, play_strokes(model, strokes_))};
  double sum = 0;
  for (const double difference : choice.differences) sum += difference * difference;
  choice.error = std::sqrt(sum / static_cast<double>(choice.differences.size()));
  return choice;
}

// Candidates to add, the one that a choice misses most first; no two of them are neighbours.
std::vector<std::size_t> ContactThinning::missing(const std::vector<std::size_t>& kept,
                                                  std::span<const double> differences) const {
  std::vector<double> missed(model_.contacts.size(), 0);
  for (std::size_t j = 0; j < differences.size(); ++j) {
    for (std::size_t k = 0; k < static_cast<std::size_t>(weights_[j].count); ++k) {
      missed[static_cast<std::size_t>(weights_[j].contacts[k])] +=
          weights_[j].weights[k] * differences[j] * differences[j];
    }
  }
  std::vector<bool> blocked(model_.contacts.size(), true);
  for (const std::size_t i : candidates_) blocked[i] = false;
  for (const std::size_t i : kept) blocked[i] = true;
  std::vector<std::size_t> order = candidates_;
  std::ranges::stable_sort(order, std::greater(), [&](std::size_t i) { return missed[i]; });
  const auto most =
      static_cast<std::size_t>(std::max(1.0, kAdded * static_cast<double>(kept.size())));
  std::vector<std::size_t> result;
  for (const std::size_t i : order) {
    if (result.size() == most) break;
    if (blocked[i]) continue;
    result.push_back(i);
    blocked[i] = true;
    for (const int other : neighbours_[i]) blocked[static_cast<std::size_t>(other)] = true;
  }
  return result;
}

}  // namespace palpate::haptics
