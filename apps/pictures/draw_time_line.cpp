// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/pictures/draw_time_line.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "canvas.h"
#include "chart.h"
#include "input_checks.h"
#include "palpate/core/require.h"
#include "ticks.h"

namespace palpate::pictures {
namespace {

constexpr int kTimeLineHeight = 820;
constexpr double kUpperShare = 0.45;  ///< of the height, for the upper chart
constexpr double kTrialMarkSize = 5;  ///< px

constexpr std::array<TrialKind, 3> kTrialKinds{TrialKind::held, TrialKind::slipped,
                                               TrialKind::failed};
constexpr std::array<Rgb, 3> kTrialColors{kBlue, kVermilion, kBlack};
constexpr std::array<const char*, 3> kTrialNames{"held", "slipped", "failed"};

void check_time_line(const TimeLine& trials) {
  refuse_unless(trials.hours.size() > 0, "hours", "is empty: there is nothing to draw");
  check_count(static_cast<Eigen::Index>(trials.kinds.size()), trials.hours.size(), "kinds");
  check_count(trials.contacts.size(), trials.hours.size(), "contacts");
  for (Eigen::Index i = 0; i < trials.hours.size(); ++i) {
    const std::string place = "trial " + std::to_string(i);
    require([&] { return "hours: " + place; }, trials.hours(i), at_least(0).finite(), "h");
    refuse_unless(i == 0 || trials.hours(i) >= trials.hours(i - 1), "hours",
                  place + " is earlier than the one before");
    refuse_unless(trials.contacts(i) >= 0, "contacts", place + " has a negative number");
  }
}

/// At the beginning and after each trial: the trials of this kind so far.
Eigen::VectorXd counts_so_far(const TimeLine& trials, TrialKind kind) {
  Eigen::VectorXd counts = Eigen::VectorXd::Zero(trials.hours.size() + 1);
  for (Eigen::Index i = 0; i < trials.hours.size(); ++i)
    counts(i + 1) = counts(i) + (trials.kinds[static_cast<std::size_t>(i)] == kind ? 1 : 0);
  return counts;
}

/// The numbers of the contacts at which a trial of this kind ended; NaN for other trials.
Eigen::VectorXd contacts_with(const TimeLine& trials, TrialKind kind) {
  Eigen::VectorXd contacts = trials.contacts.cast<double>();
  for (Eigen::Index i = 0; i < contacts.size(); ++i)
    if (trials.kinds[static_cast<std::size_t>(i)] != kind) contacts(i) = std::nan("");
  return contacts;
}

}  // namespace

void draw_time_line(const std::filesystem::path& png, const TimeLine& trials,
                    const std::string& title) {
  check_time_line(trials);
  const double end = trials.hours(trials.hours.size() - 1);
  Canvas canvas(
      kTimeLineHeight, title,
      std::to_string(trials.hours.size()) + " trials in " + format_value(end, 0.1) + " h");
  std::vector<LegendEntry> legend;
  for (std::size_t i = 0; i < kTrialKinds.size(); ++i)
    legend.push_back({kTrialNames[i], kTrialColors[i]});
  const double width = Canvas::kWidth - 2 * kChartMargin;
  add_legend(canvas, {Canvas::kWidth / 2.0, canvas.top() - kLegendHeight / 2}, width, legend);

  const double height = canvas.top() - kLegendHeight - kChartMargin;
  // A campaign of no duration is drawn as if it had taken a second.
  const Axis time{{0, std::max(end, 1.0 / 3600)}, "time (h)"};
  Axis count{{0, 0}, "trials so far", 1};
  for (const TrialKind kind : kTrialKinds) count.span.include(counts_so_far(trials, kind));
  count.span.pad();
  Chart upper(
      canvas,
      {kChartMargin, kChartMargin + (1 - kUpperShare) * height, width, kUpperShare * height}, time,
      count);
  Axis contact{{0, 1}, "contact, in the order of the plan", 1};
  contact.span.include(trials.contacts.cast<double>());
  contact.span.pad();
  Chart lower(canvas, {kChartMargin, kChartMargin, width, (1 - kUpperShare) * height}, time,
              contact);
  upper.add_axes();
  lower.add_axes();
  Eigen::VectorXd hours(trials.hours.size() + 1);
  hours << 0, trials.hours;
  for (std::size_t i = 0; i < kTrialKinds.size(); ++i) {
    upper.add_line(hours, counts_so_far(trials, kTrialKinds[i]), kTrialColors[i], 3);
    lower.add_markers(trials.hours, contacts_with(trials, kTrialKinds[i]), kTrialColors[i],
                      kTrialMarkSize);
  }
  canvas.write(png);
}

}  // namespace palpate::pictures
