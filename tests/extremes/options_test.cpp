// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Each field of each list of options at the ends of numbers: outside its range it is refused by its
// own name; inside, the operation ends soon, with finite results or a refusal.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include "findings.h"
#include "palpate/core/error.h"
#include "palpate/core/field_text.h"
#include "palpate/geometry/option_lists.h"
#include "palpate/haptics/option_lists.h"
#include "palpate/probing/option_lists.h"
#include "palpate/sensing/option_lists.h"

namespace palpate::extremes {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

/// A trial value of a field: a number, or the place of a word or flag.
struct Trial {
  std::string field;  ///< "DecodeOptions::min_signal"
  double value = 0;
  bool is_allowed = true;
};

/// The numbers that are tried of a field.
std::vector<double> numbers_for(const Interval& range, bool is_whole) {
  std::vector<double> numbers;
  if (is_whole) {
    constexpr double kMost = std::numeric_limits<int>::max();
    numbers = {-kMost - 1, -1, 0, 1, kMost};
    for (const double end : {range.low, range.high})
      if (std::abs(end) < kMost) numbers.insert(numbers.end(), {end - 1, end, end + 1});
  } else {
    numbers = {std::nan(""), -kInf, -1e300, -1e-300, 0, 1e-300, 1e300, kInf};
    for (const double end : {range.low, range.high}) {
      if (std::isfinite(end))
        numbers.insert(numbers.end(), {std::nextafter(end, -kInf), end, std::nextafter(end, kInf)});
    }
  }
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return numbers;
}

/// Lists what can be tried.
class Lister final : public FieldVisitor {
 public:
  std::vector<Trial> trials;

  void begin(std::string_view type) override { type_ = type; }

 private:
  std::string type_;

  void add(const Field& field, double value, bool is_allowed) {
    trials.push_back({fmt::format("{}::{}", type_, field.name), value, is_allowed});
  }
  void on_real(const Field& field, const NumberField<double>& value) override {
    for (const double number : numbers_for(value.range, false))
      add(field, number, value.range.contains(number));
  }
  void on_whole(const Field& field, const NumberField<int>& value) override {
    for (const double number : numbers_for(value.range, true))
      add(field, number, value.range.contains(number));
  }
  void on_flag(const Field& field, bool, const std::function<void(bool)>&) override {
    for (const int place : {0, 1}) add(field, place, true);
  }
  void on_choice(const Field& field, const ChoiceField& value) override {
    for (std::size_t place = 0; place < value.words.size(); ++place)
      add(field, static_cast<double>(place), true);
  }
  void on_table(const Field& field, const TableField& value) override {
    for (std::size_t column = 0; column < value.columns.size(); ++column)
      add(field, static_cast<double>(column), false);  // NaN in this column
  }
};

/// Sets one field.
class Setter final : public FieldVisitor {
 public:
  explicit Setter(const Trial& trial) : trial_(trial) {}

  bool found = false;

  void begin(std::string_view type) override { type_ = type; }

 private:
  const Trial& trial_;
  std::string type_;

  [[nodiscard]] bool is_meant(const Field& field) {
    const bool meant = fmt::format("{}::{}", type_, field.name) == trial_.field;
    found = found || meant;
    return meant;
  }
  void on_real(const Field& field, const NumberField<double>& value) override {
    if (is_meant(field)) value.set(trial_.value);
  }
  void on_whole(const Field& field, const NumberField<int>& value) override {
    if (is_meant(field)) value.set(static_cast<int>(trial_.value));
  }
  void on_flag(const Field& field, bool, const std::function<void(bool)>& set) override {
    if (is_meant(field)) set(trial_.value != 0);
  }
  void on_choice(const Field& field, const ChoiceField& value) override {
    if (is_meant(field)) value.set(static_cast<std::size_t>(trial_.value));
  }
  void on_table(const Field& field, const TableField& value) override {
    if (!is_meant(field)) return;
    std::vector<double> row(value.columns.size(), 1);
    row[static_cast<std::size_t>(trial_.value)] = std::nan("");
    value.set({row});
  }
};

/// The findings of `Lister`, as the text that a task returns.
std::string to_text(const std::vector<Trial>& trials) {
  std::string text;
  for (const Trial& trial : trials)
    text += fmt::format("{} {:a} {}\n", trial.field, trial.value, trial.is_allowed ? 1 : 0);
  return text;
}

std::vector<Trial> trials_of(const std::string& text) {
  std::vector<Trial> trials;
  std::istringstream stream(text);
  std::string field, value;
  int is_allowed = 0;
  while (stream >> field >> value >> is_allowed)
    trials.push_back({field, std::strtod(value.c_str(), nullptr), is_allowed != 0});
  return trials;
}

/// The fields of the options of an operation, which begins, but does not come to its work.
std::vector<Trial> trials_of(const Operation& operation) {
  struct Enough {};
  const std::vector<Outcome> listed = run_apart(1, [&](std::size_t) {
    Lister lister;
    try {
      (void)operation.run(small_input(), [&](const FieldList& list) {
        list(lister);
        throw Enough();
      });
    } catch (const Enough&) {
    }
    return to_text(lister.trials);
  });
  return trials_of(listed.front().text);
}

std::string attempt(const Operation& operation, const Trial& trial) {
  Setter setter(trial);
  std::string report;
  try {
    report = report_of_finite(
        operation.run(small_input(), [&](const FieldList& list) { list(setter); }));
  } catch (const Error& error) {
    if (trial.is_allowed || std::string(error.what()).find(trial.field) != std::string::npos) throw;
    return report_of_wrong(std::string("is refused, but not by its name: ") + error.what());
  }
  if (!setter.found) return report_of_wrong("there is no such field");
  return trial.is_allowed ? report : report_of_wrong("is outside its range, and taken");
}

class OptionFields : public ::testing::TestWithParam<Operation> {};

TEST_P(OptionFields, AreRefusedByNameOrDoneSoon) {
  const Operation& operation = GetParam();
  if ((operation.uses & kOptions) == 0) return;
  std::vector<Trial> trials = trials_of(operation);
  ASSERT_FALSE(trials.empty());
  // Slow operations are done with the allowed values only in the large size.
  constexpr int kLong = 3;
  if (!is_large() && (operation.only_large || operation.seconds >= kLong))
    std::erase_if(trials, [](const Trial& trial) { return trial.is_allowed; });
  const std::vector<Outcome> outcomes =
      run_apart(trials.size(), [&](std::size_t i) { return attempt(operation, trials[i]); },
                {.seconds = operation.seconds});
  std::vector<Finding> findings;
  for (std::size_t i = 0; i < trials.size(); ++i)
    findings.push_back(
        finding_of(fmt::format("{} = {}", trials[i].field, trials[i].value), outcomes[i]));
  judge(operation, "options", findings);
}

INSTANTIATE_TEST_SUITE_P(All, OptionFields, ::testing::ValuesIn(all_operations()),
                         [](const auto& one) { return test_name(one.param); });

TEST(OptionLists, AllAreTriedByAnOperation) {
  std::set<std::string> types;
  const auto all = [](FieldVisitor& visitor) {
    geometry::visit_options(visitor);
    sensing::visit_options(visitor);
    probing::visit_options(visitor);
    haptics::visit_options(visitor);
  };
  for (const FieldText& field : texts_of(all)) types.insert(field.type);
  EXPECT_GT(types.size(), 10U);
  // Equilibria of finite elements take seconds each, cameras and loops need devices, and a mapping
  // is one of files.
  for (const char* type :
       {"SolidOptions", "CameraSettings", "CouplingOptions", "AcquisitionMapping"})
    EXPECT_EQ(types.erase(type), 1U) << type;
  for (const Operation& operation : all_operations()) {
    if ((operation.uses & kOptions) == 0) continue;
    for (const Trial& trial : trials_of(operation))
      types.erase(trial.field.substr(0, trial.field.find(':')));
  }
  for (const std::string& type : types) ADD_FAILURE() << type << " is in no operation";
}

}  // namespace
}  // namespace palpate::extremes
