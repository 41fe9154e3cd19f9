// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/press_series.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "import/series_fields.h"
#include "import/surface_touch.h"
#include "import/tip_slides.h"
#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "palpate/probing/csv.h"

namespace palpate::probing {
namespace {

/// One moment with the force that acted then.
struct Moment {
  std::size_t index = 0;  ///< in the series
  double time = 0;
  Eigen::Vector3d tip, force;
  bool saturated = false;
};

void check_series(const TipSeries& series, const SeriesOptions& options) {
  for (const SeriesField& field : kSeriesFields)
    require(std::string("SeriesOptions::") + field.name, options.*field.field, field.range,
            field.unit);
  const std::size_t count = series.time.size();
  const auto columns = static_cast<Eigen::Index>(count);
  if (series.tip.cols() != columns || series.force.cols() != columns ||
      (!series.saturated.empty() && series.saturated.size() != count))
    throw InvalidInput("find_presses(): times, positions and forces differ in their number");
  for (std::size_t i = 0; i < count; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (!std::isfinite(series.time[i]) || !series.tip.col(k).allFinite() ||
        !series.force.col(k).allFinite())
      throw InvalidInput("moment " + std::to_string(i + 1) + ": is not finite; leave it out");
    if (i > 0 && !(series.time[i] > series.time[i - 1])) {
      throw InvalidInput(
          "moment " + std::to_string(i + 1) + ": its time " + to_text(series.time[i]) +
          " s is not after that of the one before (" + to_text(series.time[i - 1]) +
          " s); times must ascend, and another recording is another file or contact");
    }
  }
}

/// The moments for which there is a force, which was recorded `force_delay` later.
std::vector<Moment> moments_of(const TipSeries& series, const SeriesOptions& options) {
  std::vector<Moment> moments;
  moments.reserve(series.time.size());
  const auto is_saturated = [&](std::size_t i) {
    return !series.saturated.empty() && series.saturated[i];
  };
  std::size_t after = 0;  // first moment whose time is at least that of the force
  for (std::size_t i = 0; i < series.time.size(); ++i) {
    Moment moment{i, series.time[i], series.tip.col(static_cast<Eigen::Index>(i)), {}, false};
    if (options.force_delay == 0) {
      moment.force = series.force.col(static_cast<Eigen::Index>(i));
      moment.saturated = is_saturated(i);
      moments.push_back(moment);
      continue;
    }
    const double recorded = series.time[i] + options.force_delay;
    while (after < series.time.size() && series.time[after] < recorded) ++after;
    if (after == series.time.size() || recorded < series.time.front()) continue;
    const std::size_t before = after == 0 ? 0 : after - 1;
    const double gap = series.time[after] - series.time[before];
    const double share = gap > 0 ? (recorded - series.time[before]) / gap : 0;
    moment.force = (1 - share) * series.force.col(static_cast<Eigen::Index>(before)) +
                   share * series.force.col(static_cast<Eigen::Index>(after));
    moment.saturated = is_saturated(before) || is_saturated(after);
    moments.push_back(moment);
  }
  return moments;
}

/// [mm/s] Speed at each moment, by a line through the positions in a window around it.
std::vector<double> speeds_of(const std::vector<Moment>& moments, double window) {
  std::vector<double> speeds(moments.size(), 0);
  std::size_t low = 0, high = 0;
  for (std::size_t i = 0; i < moments.size(); ++i) {
    while (moments[low].time < moments[i].time - window / 2) ++low;
    while (high < moments.size() && moments[high].time <= moments[i].time + window / 2) ++high;
    // A slow recording has no neighbour within the window.
    const std::size_t first = std::min(low, i == 0 ? 0 : i - 1);
    const std::size_t end = std::min(std::max(high, i + 2), moments.size());
    const auto count = static_cast<double>(end - first);
    double time = 0;
    Eigen::Vector3d tip = Eigen::Vector3d::Zero();
    for (std::size_t k = first; k < end; ++k) {
      time += (moments[k].time - moments[i].time) / count;
      tip += (moments[k].tip - moments[i].tip) / count;
    }
    double squares = 0;
    Eigen::Vector3d products = Eigen::Vector3d::Zero();
    for (std::size_t k = first; k < end; ++k) {
      const double dt = moments[k].time - moments[i].time - time;
      squares += dt * dt;
      products += dt * (moments[k].tip - moments[i].tip - tip);
    }
    speeds[i] = squares > 0 ? products.norm() / squares : 0;
  }
  return speeds;
}

/// The median of each component of the force from one moment to another. A touch begins before its
/// force exceeds the threshold; that and what follows a release is less than half of the time.
Eigen::Vector3d median_force(std::span<const Moment> moments) {
  Eigen::Vector3d force;
  std::vector<double> values(moments.size());
  for (Eigen::Index k = 0; k < 3; ++k) {
    std::ranges::transform(moments, values.begin(), [k](const Moment& m) { return m.force[k]; });
    force[k] = median(values);
  }
  return force;
}

/// The force of a tip that is free, from the last release on.
class Tare {
 public:
  Tare(const std::vector<Moment>& moments, const SeriesOptions& options)
      : moments_(moments), options_(options) {
    if (!options.tare || moments.empty()) return;
    const auto end = std::ranges::find_if(moments, [&](const Moment& moment) {
      return moment.time > moments.front().time + options.tare_time;
    });
    value_ = median_force({moments.begin(), end});
  }

  [[nodiscard]] const Eigen::Vector3d& value() const { return value_; }
  [[nodiscard]] std::size_t release() const { return release_; }

  /// Contact ends before this moment.
  void release(std::size_t moment) { release_ = known_ = moment; }

  /// Finds the force again before this moment, unless the tip was free too briefly, or not twice as
  /// long as when it was last found. Returns true if it was found again.
  bool update(std::size_t moment) {
    const bool brief = moments_[moment].time - moments_[release_].time < options_.tare_time;
    if (!options_.tare || brief || moment - release_ < 2 * (known_ - release_)) return false;
    value_ = median_force(std::span(moments_).subspan(release_, moment - release_));
    known_ = moment;
    return true;
  }

 private:
  const std::vector<Moment>& moments_;
  const SeriesOptions& options_;
  Eigen::Vector3d value_ = Eigen::Vector3d::Zero();
  std::size_t release_ = 0, known_ = 0;
};

/// Collects the quasi-static pieces of a press.
class HeldPieces {
 public:
  HeldPieces(const SeriesOptions& options, SeriesPress& press, SeriesPresses& result)
      : options_(options), press_(press), result_(result) {}

  /// \param number of the moment, among those with a force
  void add(const Moment& moment, std::size_t number, double speed) {
    if (moment.saturated) {
      finish();
      return;
    }
    if (!(speed < options_.highest_speed)) {
      ++result_.fast;
      finish();
      return;
    }
    if (count_ > 0 && (moment.tip - first_).norm() > options_.sample_length) finish();
    if (count_ == 0) {
      first_ = moment.tip;
      begin_ = moment.time;
    }
    ++count_;
    last_ = number;
    end_ = moment.time;
    time_ += moment.time - begin_;
    way_ += moment.tip - first_;
    force_ += moment.force - press_.tare;
  }

  void finish() {
    if (count_ > 0) {
      if (end_ - begin_ >= options_.sample_time) {
        press_.held.push_back({begin_ + time_ / count_, first_ + way_ / count_, force_ / count_});
        ends_.push_back(last_);
      } else {
        ++result_.brief;
      }
    }
    count_ = time_ = 0;
    way_.setZero();
    force_.setZero();
  }

  /// Leaves out the pieces that end after this moment.
  void keep_until(std::size_t number) {
    while (!ends_.empty() && ends_.back() > number) {
      ends_.pop_back();
      press_.held.pop_back();
    }
  }

 private:
  const SeriesOptions& options_;
  SeriesPress& press_;
  SeriesPresses& result_;
  std::vector<std::size_t> ends_;  // last moment of each piece of the press
  std::size_t last_ = 0;
  double count_ = 0, begin_ = 0, end_ = 0, time_ = 0;
  Eigen::Vector3d first_ = Eigen::Vector3d::Zero(), way_ = Eigen::Vector3d::Zero(),
                  force_ = Eigen::Vector3d::Zero();
};

SeriesPress touch_between(const Moment& before, const Moment& after, const Eigen::Vector3d& tare,
                          double touch_force) {
  const double low = (before.force - tare).norm(), high = (after.force - tare).norm();
  const double share = std::clamp((touch_force - low) / (high - low), 0.0, 1.0);
  return {.begin = after.index,
          .time = before.time + share * (after.time - before.time),
          .touch = before.tip + share * (after.tip - before.tip),
          .tare = tare,
          .held = {}};
}

/// Moves the touch to where the force was zero, by the moments in which the force first rises.
void move_to_surface(SeriesPress& press, std::span<const Moment> moments, double touch_force) {
  constexpr double kFirstPart = 5;  // largest force, relative to touch_force
  constexpr double kFalling = 0.5;  // of touch_force below the largest force so far
  std::vector<Eigen::Vector3d> tips;
  std::vector<double> forces;
  double highest = 0;
  for (const Moment& moment : moments) {
    const double force = (moment.force - press.tare).norm();
    if (moment.saturated || force < highest - kFalling * touch_force) break;
    highest = std::max(highest, force);
    tips.push_back(moment.tip);
    forces.push_back(force);
    if (force > kFirstPart * touch_force) break;
  }
  const std::optional<TouchDepth> found = touch_depth(tips, forces, press.touch, touch_force);
  if (!found) return;
  press.touch -= found->depth * found->along;
  press.depth = found->depth;
  press.depth_deviation = found->deviation;
}

}  // namespace

SeriesPresses find_presses(const TipSeries& series, const SeriesOptions& options) {
  check_series(series, options);
  constexpr double kReleaseShare = 0.5;  // of touch_force
  SeriesPresses result;
  const std::vector<Moment> moments = moments_of(series, options);
  result.unpaired = series.time.size() - moments.size();
  result.saturated = static_cast<std::size_t>(std::ranges::count_if(moments, &Moment::saturated));
  const std::vector<double> speeds = speeds_of(moments, options.speed_window);
  Tare tare(moments, options);
  const auto force_of = [&](const Moment& moment) { return (moment.force - tare.value()).norm(); };
  for (std::size_t i = 0; i < moments.size();) {
    if (force_of(moments[i]) <= options.touch_force) {
      ++i;
      continue;
    }
    if (i == 0) {
      throw InvalidInput("the tip is in contact from the beginning: the first force is " +
                         to_text(force_of(moments[0])) + " N away from that of the first " +
                         to_text(options.tare_time) +
                         " s; let the recording begin before the touch, and see touch_force and "
                         "tare_time");
    }
    if (tare.update(i)) continue;
    // By its last update, the touch may have been earlier.
    while (i > tare.release() + 1 && force_of(moments[i - 1]) > options.touch_force) --i;
    SeriesPress press =
        touch_between(moments[i - 1], moments[i], tare.value(), options.touch_force);
    const std::size_t begin = i;
    HeldPieces pieces(options, press, result);
    TipSlides slides(begin, press.touch, moments[begin].force - press.tare, options.touch_force,
                     options.slide_length);
    std::optional<TipSlide> slide;
    while (i < moments.size() && force_of(moments[i]) >= kReleaseShare * options.touch_force) {
      const Moment& moment = moments[i];
      if (!slide && !moment.saturated) slide = slides.add(i, moment.tip, moment.force - press.tare);
      if (!slide) pieces.add(moment, i, speeds[i]);
      ++i;
    }
    pieces.finish();
    if (!slide && i < moments.size())
      slide = slides.release(moments[i].tip, moments[i].force - press.tare);
    if (slide) {
      press.slid = true;
      pieces.keep_until(slide->last_held);
      if (slide->last_held > begin)
        press.slip = HeldPress{moments[slide->last_held].time, slide->tip, slide->force};
    }
    move_to_surface(press, std::span(moments).subspan(begin, i - begin), options.touch_force);
    result.presses.push_back(std::move(press));
    tare.release(i);
  }
  return result;
}

}  // namespace palpate::probing
