// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/object_shift.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "palpate/core/error.h"

namespace palpate::probing {
namespace {

/// Standard deviations of a shift: a touch whose noise is normal exceeds them once in 16,000 times.
constexpr double kBeyondDoubt = 4;

double height_of(const Contact& contact, const Eigen::Vector3d& touch) {
  return (touch - contact.position).dot(contact.normal.normalized());
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// [mm] Distance of a contact from the nearest of some others.
double distance_from(const Contact& contact, const std::vector<ContactTouches>& others) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const ContactTouches& other : others)
    nearest = std::min(nearest, (contact.position - other.contact.position).norm());
  return nearest;
}

}  // namespace

std::vector<ContactTouches> reference_touches(std::span<const TrialRecord> trials, int most) {
  std::map<long long, ContactTouches> touched;
  for (const TrialRecord& record : trials) {
    if (!record.result.touch.allFinite()) continue;
    ContactTouches& touches = touched[record.order.contact.id];
    touches.contact = record.order.contact;
    touches.normal_force = record.order.normal_force;
    touches.heights.push_back(height_of(touches.contact, record.result.touch));
  }
  std::vector<ContactTouches> candidates;
  for (auto& [id, touches] : touched) candidates.push_back(std::move(touches));
  std::stable_sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
    return a.heights.size() > b.heights.size();
  });
  if (candidates.empty()) return {};
  const std::size_t enough = (candidates.front().heights.size() + 1) / 2;
  std::erase_if(candidates, [&](const auto& each) { return each.heights.size() < enough; });
  std::vector<ContactTouches> chosen;
  while (!candidates.empty() && static_cast<int>(chosen.size()) < most) {
    const auto next =
        std::max_element(candidates.begin(), candidates.end(), [&](const auto& a, const auto& b) {
          return distance_from(a.contact, chosen) < distance_from(b.contact, chosen);
        });
    chosen.push_back(std::move(*next));
    candidates.erase(next);
  }
  return chosen;
}

std::vector<ContactTouches> touch_again(Prober& arm, std::span<const ContactTouches> before,
                                        int times, const ProgramOptions& options) {
  std::vector<ContactTouches> now;
  long long trial = kFirstTouchTrial;
  for (const ContactTouches& earlier : before) {
    ContactTouches touches{.contact = earlier.contact, .normal_force = earlier.normal_force};
    const Eigen::Vector3d above =
        earlier.contact.position + options.clearance * earlier.contact.normal;
    for (int i = 0; i < times; ++i, ++trial) {
      ProbeAction action{.kind = ProbeActionKind::travel,
                         .trial = trial,
                         .target = above,
                         .force = earlier.normal_force,
                         .time_limit = options.travel_limit};
      if (arm.perform(action).outcome == ProbeOutcome::done) {
        action.kind = ProbeActionKind::touch;
        action.target = earlier.contact.position;
        action.time_limit = options.touch_limit;
        const ProbeReport found = arm.perform(action);
        if (found.outcome == ProbeOutcome::done && found.position.allFinite())
          touches.heights.push_back(height_of(earlier.contact, found.position));
      }
      action.kind = ProbeActionKind::lift;
      action.target = above;
      action.time_limit = options.lift_limit;
      (void)arm.perform(action);
    }
    now.push_back(std::move(touches));
  }
  return now;
}

std::vector<ObjectShift> object_shift(std::span<const ContactTouches> before,
                                      std::span<const ContactTouches> now,
                                      const ProgramOptions& options) {
  if (before.size() != now.size())
    throw InvalidInput("object_shift: the touches before and now are not of the same contacts");
  double squares = 0;
  std::ptrdiff_t freedom = 0;
  for (const std::span<const ContactTouches> each : {before, now}) {
    for (const ContactTouches& touches : each) {
      if (touches.heights.empty()) continue;
      const double mean = mean_of(touches.heights);
      for (const double height : touches.heights) squares += (height - mean) * (height - mean);
      freedom += static_cast<std::ptrdiff_t>(touches.heights.size()) - 1;
    }
  }
  const double scatter = freedom > 0 ? std::sqrt(squares / static_cast<double>(freedom)) : 0;
  const double deviation = std::max(scatter, options.position_noise);
  std::vector<ObjectShift> shifts;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before[i].contact.id != now[i].contact.id)
      throw InvalidInput("object_shift: the touches before and now are not of the same contacts");
    ObjectShift shift{.contact = now[i].contact.id,
                      .touches = static_cast<int>(now[i].heights.size())};
    if (shift.touches > 0 && !before[i].heights.empty()) {
      shift.shift = mean_of(now[i].heights) - mean_of(before[i].heights);
      shift.error = deviation * std::sqrt(1.0 / static_cast<double>(now[i].heights.size()) +
                                          1.0 / static_cast<double>(before[i].heights.size()));
    }
    shifts.push_back(shift);
  }
  return shifts;
}

bool has_moved(const ObjectShift& shift, double limit) {
  return !(std::abs(shift.shift) <= std::max(limit, kBeyondDoubt * shift.error));
}

}  // namespace palpate::probing
