// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/plan_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/haptics/error_forecast.h"
#include "palpate/haptics/model_io.h"
#include "reduce/asked_error.h"
#include "reduce/contact_subset.h"

namespace palpate::haptics {
namespace {

constexpr int kLeastContacts = 3;
constexpr double kHour = 3600;  // [s]
// Numbers of contacts of the curve, relative to that of the model.
constexpr std::array<double, 7> kCurve{0.25, 0.5, 1, 1.5, 2, 3, 4};
// The factor by which errors are raised is found up to this.
constexpr double kFactorTolerance = 1.001;
// A time for a number of contacts is enough for them, up to this relative to it.
constexpr double kTimeRounding = 1e-9;

// [bytes] that a contact adds to the model folder.
double contact_size(const Model& model) {
  if (model.contacts.size() <= kLeastContacts) return 0;
  std::vector<std::size_t> few(kLeastContacts);
  std::iota(few.begin(), few.end(), 0);
  return (folder_size(model) - folder_size(with_contacts(model, few))) /
         static_cast<double>(model.contacts.size() - kLeastContacts);
}

/// The trade between contacts, errors and time at one object.
class ContactTrade {
 public:
  explicit ContactTrade(const ObjectNeeds& needs)
      : needs_(needs),
        forecast_(*needs.model, needs.options),
        size_(folder_size(*needs.model)),
        contact_size_(contact_size(*needs.model)) {
    if (const auto error = asked_error(needs.options, forecast_.force())) asked_ = *error;
  }

  [[nodiscard]] const ObjectNeeds& needs() const { return needs_; }
  [[nodiscard]] const ErrorForecast& forecast() const { return forecast_; }
  [[nodiscard]] std::optional<double> asked() const { return asked_; }
  [[nodiscard]] int present() const { return static_cast<int>(needs_.model->contacts.size()); }
  [[nodiscard]] int most() const { return static_cast<int>(needs_.places.size()); }

  // [N] that the contacts may cause: a reduction needs the rest.
  [[nodiscard]] double allowed() const { return is_reduced() ? *asked_ / kReductionRoom : *asked_; }
  [[nodiscard]] bool is_reduced() const {
    const ReduceOptions& of = needs_.options;
    return of.max_size || of.max_surface_error || of.picture_size || !of.reachable.empty();
  }

  [[nodiscard]] PlannedContacts with(int contacts) {
    const int count = std::clamp(contacts, kLeastContacts, most());
    auto [known, is_new] = errors_.try_emplace(count, 0);
    if (is_new)
      known->second =
          forecast_.with(std::span(needs_.places).first(static_cast<std::size_t>(count)));
    return planned(count, known->second);
  }

  [[nodiscard]] ErrorBudget budget_with(int contacts) const {
    return forecast_.budget_with(
        std::span(needs_.places).first(static_cast<std::size_t>(contacts)));
  }

  [[nodiscard]] PlannedContacts as_it_is() const {
    return planned(present(), forecast_.at_present());
  }

  // The fewest contacts with at most this error; all places if there are none.
  [[nodiscard]] int contacts_for(double error) {
    int low = kLeastContacts, high = most();
    while (low < high) {
      const int middle = low + (high - low) / 2;
      if (with(middle).error <= error)
        high = middle;
      else
        low = middle + 1;
    }
    return high;
  }

  // Number of contacts for which the arm has time.
  [[nodiscard]] int contacts_in(double time) const {
    return static_cast<int>(
        std::min(std::floor((1 + kTimeRounding) * time / needs_.contact_time), double(most())));
  }

 private:
  [[nodiscard]] PlannedContacts planned(int contacts, double error) const {
    return {contacts, error, contacts * needs_.contact_time,
            size_ + (contacts - present()) * contact_size_};
  }

  const ObjectNeeds& needs_;
  ErrorForecast forecast_;
  double size_, contact_size_;
  std::optional<double> asked_;
  std::map<int, double> errors_;  // by number of contacts
};

/// A number of contacts, and what decides it.
struct Choice {
  int contacts = 0;
  PlanLimit limit = PlanLimit::none;
};

// \param factor by which the allowed error is raised, and numbers of contacts that nothing asks for
// are divided.
Choice choice_of(ContactTrade& trade, double factor) {
  const std::optional<double> time = trade.needs().arm_time;
  const Choice in_time{time ? trade.contacts_in(*time) : trade.most(), PlanLimit::arm_time};
  if (!trade.asked()) {
    const Choice most =
        time ? in_time : Choice{std::min(trade.present(), trade.most()), PlanLimit::none};
    return {std::max(kLeastContacts, static_cast<int>(most.contacts / factor)), most.limit};
  }
  const double error = factor * trade.allowed();
  const Choice enough{trade.contacts_for(error), PlanLimit::force_error};
  if (time && in_time.contacts < enough.contacts) return in_time;
  if (trade.with(enough.contacts).error > error) return {enough.contacts, PlanLimit::places};
  return enough;
}

std::vector<Choice> choices_of(std::vector<ContactTrade>& trades, double factor) {
  std::vector<Choice> choices;
  for (ContactTrade& trade : trades) choices.push_back(choice_of(trade, factor));
  return choices;
}

double time_of(const std::vector<ContactTrade>& trades, const std::vector<Choice>& choices) {
  double time = 0;
  for (std::size_t i = 0; i < trades.size(); ++i)
    time += choices[i].contacts * trades[i].needs().contact_time;
  return time;
}

// The choices with the smallest common factor of the errors for which the arm has time.
std::vector<Choice> choices_within(std::vector<ContactTrade>& trades, double arm_time) {
  std::vector<Choice> choices = choices_of(trades, 1);
  if (time_of(trades, choices) <= arm_time) return choices;
  double low = 1, high = 1;
  do {
    low = high;
    high *= 2;
    choices = choices_of(trades, high);
    if (std::ranges::all_of(
            choices, [](const Choice& choice) { return choice.contacts <= kLeastContacts; }) &&
        time_of(trades, choices) > arm_time) {
      throw InvalidInput(
          fmt::format("arm_time of the scene is {:.3g} h, too little: three contacts of each "
                      "object, the fewest of a model, take {:.3g} h",
                      arm_time / kHour, time_of(trades, choices) / kHour));
    }
  } while (time_of(trades, choices) > arm_time);
  while (high > kFactorTolerance * low) {
    const double middle = std::sqrt(low * high);
    (time_of(trades, choices_of(trades, middle)) <= arm_time ? high : low) = middle;
  }
  choices = choices_of(trades, high);
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (choices[i].limit == PlanLimit::force_error || !trades[i].asked())
      choices[i].limit = PlanLimit::scene_time;
  }
  return choices;
}

ObjectPlan plan_of(ContactTrade& trade, const Choice& choice) {
  ObjectPlan plan{.present = trade.as_it_is(),
                  .planned = trade.with(choice.contacts),
                  .with_more = {},
                  .is_reduced = trade.is_reduced(),
                  .asked = trade.asked(),
                  .allowed = {},
                  .limit = choice.limit,
                  .force = trade.forecast().force(),
                  .of_contacts = trade.forecast().of_contacts(),
                  .budget = {},
                  .curve = {}};
  plan.budget = trade.budget_with(plan.planned.contacts);
  plan.with_more = trade.with(trade.contacts_in(plan.planned.arm_time + kHour));
  if (plan.asked) {
    plan.allowed = trade.allowed();
    plan.raised = std::max(1.0, plan.planned.error / *plan.allowed);
  }
  for (const double share : kCurve) {
    const PlannedContacts point =
        trade.with(static_cast<int>(std::lround(share * trade.present())));
    if (plan.curve.empty() || plan.curve.back().contacts < point.contacts)
      plan.curve.push_back(point);
  }
  return plan;
}

void check_needs(const ObjectNeeds& needs) {
  require("contact_time", needs.contact_time, above(0).finite(), "s");
  if (needs.places.size() < kLeastContacts) {
    throw InvalidInput(fmt::format("there are {} places for contacts; a model needs at least three",
                                   needs.places.size()));
  }
  if (!needs.arm_time) return;
  require("arm_time", *needs.arm_time, above(0).finite(), "s");
  if (*needs.arm_time < kLeastContacts * needs.contact_time) {
    throw InvalidInput(fmt::format(
        "arm_time of {:.3g} h is too little: three contacts, the fewest of a model, take {:.3g} h",
        *needs.arm_time / kHour, kLeastContacts * needs.contact_time / kHour));
  }
}

}  // namespace

const char* to_string(PlanLimit limit) {
  constexpr std::array<const char*, 5> kNames{"none", "force_error", "arm_time", "scene_time",
                                              "places"};
  return kNames[static_cast<std::size_t>(limit)];
}

std::vector<ObjectPlan> plan_scene(std::span<const ObjectNeeds> objects,
                                   std::optional<double> arm_time) {
  if (arm_time) require("arm_time", *arm_time, above(0).finite(), "s");
  std::vector<ContactTrade> trades;
  trades.reserve(objects.size());
  for (const ObjectNeeds& needs : objects) {
    try {
      check_needs(needs);
      trades.emplace_back(needs);
    } catch (const InvalidInput& wrong) {
      throw InvalidInput(fmt::format("object '{}': {}", needs.name, wrong.what()));
    }
  }
  const std::vector<Choice> choices =
      arm_time ? choices_within(trades, *arm_time) : choices_of(trades, 1);
  std::vector<ObjectPlan> plans;
  for (std::size_t i = 0; i < trades.size(); ++i) plans.push_back(plan_of(trades[i], choices[i]));
  return plans;
}

}  // namespace palpate::haptics
