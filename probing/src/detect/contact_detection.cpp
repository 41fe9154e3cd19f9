// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/contact_detection.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "palpate/core/error.h"
#include "palpate/core/require.h"

// Free motion: s = s_0 + v_0 t + (1000 / m) (travel(t) + e t^2 / 2) with travel the double integral
// of the commanded force, and 1000 mm/s^2 = 1 N/kg. The unknowns (s_0, v_0, 1/m, e/m) have Gaussian
// priors. A spring that acts from t_c on subtracts kappa D(t), where kappa = k / m, and D is the
// double integral of the distance from the position at t_c; a damper subtracts eta times the single
// integral, eta = b / m. The model is linear in all unknowns except t_c.
namespace palpate::probing {
namespace {

constexpr double kAcceleration = 1000;  // [mm/s^2] of 1 kg by 1 N
constexpr int kLeastSamples = 20;

void check_options(const ContactOptions& options) {
  require("ApproachModel::mass", options.model.mass, above(0).finite(), "kg");
  require("ApproachModel::mass_deviation", options.model.mass_deviation, above(0).below(1));
  require("ApproachModel::force_deviation", options.model.force_deviation, above(0).finite(), "N");
  require("ApproachModel::speed_deviation", options.model.speed_deviation, above(0).finite(),
          "mm/s");
  require("ContactOptions::threshold", options.threshold, above(0).finite());
  require("ContactOptions::softest", options.softest, above(0).finite(), "N/mm");
  require("ContactOptions::least_deviation", options.least_deviation, above(0).finite());
  require("ContactOptions::longest_approach", options.longest_approach, above(0).at_most(60), "s");
}

/// [mm] Standard deviation of a position due to quantisation.
double position_deviation(const ContactOptions& options) {
  return options.signal.quantum / std::sqrt(12.0);
}

/// Information of the priors, in units of the quantisation.
Eigen::Matrix4d prior_information(const ContactOptions& options) {
  constexpr double kPlaceQuanta = 100;  // wide: s_0 follows from the samples
  const ApproachModel& model = options.model;
  const double per_newton = kAcceleration / model.mass;
  const Eigen::Vector4d deviations(kPlaceQuanta * options.signal.quantum, model.speed_deviation,
                                   per_newton * model.mass_deviation,
                                   per_newton * model.force_deviation);
  return Eigen::Vector4d((position_deviation(options) / deviations.array()).square()).asDiagonal();
}

Eigen::Vector4d free_row(double time, double travel) { return {1, time, travel, time * time / 2}; }

/// Double integral of the distance from a start, sample by sample.
struct SpringTravel {
  double start = 0;     // [mm]
  double distance = 0;  // [mm]
  double integral = 0;
  double value = 0;

  void add(double position, double period) {
    const double next = position - start;
    value += period * integral + period * period * (2 * distance + next) / 6;
    integral += period * (distance + next) / 2;
    distance = next;
  }
};

}  // namespace

ContactDetector::ContactDetector(const ContactOptions& options)
    : options_(options), check_(options.signal) {
  check_options(options);
  constexpr double kRate = 1000;  // [1/s]
  samples_.reserve(static_cast<std::size_t>(options.longest_approach * kRate));
  travel_.reserve(samples_.capacity());
  information_ = prior_information(options);
}

double ContactDetector::speed() const noexcept {
  constexpr std::size_t kWindow = 10;
  if (samples_.size() < kWindow) return 0;
  const std::span<const ApproachSample> latest = std::span(samples_).last(kWindow);
  double mean_time = 0, mean_position = 0;
  for (const ApproachSample& sample : latest) {
    mean_time += (sample.time - latest[0].time) / kWindow;
    mean_position += (sample.position - latest[0].position) / kWindow;
  }
  double product = 0, square = 0;
  for (const ApproachSample& sample : latest) {
    const double time = sample.time - latest[0].time - mean_time;
    product += time * (sample.position - latest[0].position - mean_position);
    square += time * time;
  }
  return product / square;
}

bool ContactDetector::step(const ApproachSample& sample) noexcept {
  if (touched_ || fault_ != SignalFault::none) return touched_;
  fault_ = check_.check(sample);
  if (fault_ == SignalFault::none && samples_.size() == samples_.capacity()) {
    fault_ = SignalFault::too_long;
  }
  if (fault_ != SignalFault::none) return false;

  double travel = 0;
  if (!samples_.empty()) {  // the force of a sample acts until the next one
    const ApproachSample& last = samples_.back();
    const double period = sample.time - last.time;
    travel = travel_.back() + period * impulse_ + period * period * last.force / 2;
    impulse_ += period * last.force;
  }
  samples_.push_back(sample);
  travel_.push_back(travel);
  const ApproachSample& first = samples_.front();
  const Eigen::Vector4d row = free_row(sample.time - first.time, travel);
  information_ += row * row.transpose();
  moment_ +=
      row * (sample.position - first.position - kAcceleration / options_.model.mass * travel);

  constexpr int kShortest = 8, kTestsPerLag = 8;
  const int count = static_cast<int>(samples_.size());
  if (count < kLeastSamples) return false;
  for (int i = 0; i < kLags; ++i) {
    const int lag = kShortest << i;
    if (lag + kShortest > count) break;
    if (count % std::max(1, lag / kTestsPerLag) != 0) continue;
    int& passed = passed_[static_cast<std::size_t>(i)];
    passed = test(lag) ? passed + 1 : 0;
    if (passed == 2) touched_ = true;
  }
  return touched_;
}

bool ContactDetector::test(int lag) const noexcept {
  const auto begin = samples_.size() - static_cast<std::size_t>(lag) - 1;
  const ApproachSample& first = samples_.front();
  const Eigen::LLT<Eigen::Matrix4d> factor(information_);
  const Eigen::Vector4d free = factor.solve(moment_);
  SpringTravel spring;
  spring.start =
      (samples_[begin - 1].position + samples_[begin].position + samples_[begin + 1].position) / 3;
  spring.distance = samples_[begin].position - spring.start;
  Eigen::Vector4d common = Eigen::Vector4d::Zero();  // of the spring with the free motion
  double square = 0, product = 0;
  for (auto i = begin + 1; i < samples_.size(); ++i) {
    const ApproachSample& sample = samples_[i];
    spring.add(sample.position, sample.time - samples_[i - 1].time);
    const Eigen::Vector4d row = free_row(sample.time - first.time, travel_[i]);
    const double residual = sample.position - first.position -
                            kAcceleration / options_.model.mass * travel_[i] - row.dot(free);
    common += spring.value * row;
    square += spring.value * spring.value;
    product -= spring.value * residual;
  }
  const double information = square - common.dot(factor.solve(common));
  if (!(information > 0) || !(product > 0)) return false;
  const double kappa = product / information;  // [1/s^2]
  const double deviation = position_deviation(options_) / std::sqrt(information);
  const double softest = kAcceleration / options_.model.mass * options_.softest;
  return kappa > options_.threshold * deviation && kappa > softest &&
         kappa * spring.value > options_.least_deviation * options_.signal.quantum;
}

namespace {

constexpr std::size_t kMargin = 3;  // samples before and after the change
constexpr std::size_t kCoarse = 4;  // samples between two changes that are tried first
constexpr double kRoughDamper = 1;  // [1/s] in the first search: nearly none

using Unknowns = Eigen::Matrix<double, 6, 1>;

/// Least squares with a spring and a damper that act from a given time on.
struct ChangePointFit {
  double cost = std::numeric_limits<double>::infinity();  // in variances of a position
  Unknowns unknowns = Unknowns::Zero();                   // free motion, kappa, eta
};

/// The samples of an approach, and what is computed from them independently of the change point.
class ChangePoint {
 public:
  ChangePoint(std::span<const ApproachSample> samples, const ContactOptions& options)
      : samples_(samples), options_(options) {
    double travel = 0, impulse = 0;
    travel_.push_back(0);
    for (std::size_t i = 1; i < samples.size(); ++i) {
      const double period = samples[i].time - samples[i - 1].time;
      travel += period * impulse + period * period * samples[i - 1].force / 2;
      impulse += period * samples[i - 1].force;
      travel_.push_back(travel);
    }
    Eigen::Matrix4d information = prior_information(options);
    Eigen::Vector4d moment = Eigen::Vector4d::Zero();
    double square = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Eigen::Vector4d r = row(i);
      information += r * r.transpose();
      moment += r * measured(i);
      square += measured(i) * measured(i);
    }
    information_ = information;
    moment_ = moment;
    square_ = square;
  }

  /// \param time [s] since the first sample, after the second sample and before the last.
  /// \param damper [1/s] standard deviation of the prior of eta, whose mean is 0; > 0
  [[nodiscard]] ChangePointFit fit(double time, double damper) const {
    std::size_t next = 1;  // first sample after the change
    while (samples_[next].time - samples_[0].time <= time) ++next;
    SpringTravel spring;
    spring.start = position(time);
    spring.distance = 0;
    const double variance = position_deviation(options_) * position_deviation(options_);
    Eigen::Matrix<double, 4, 2> common = Eigen::Matrix<double, 4, 2>::Zero();
    Eigen::Matrix2d square = Eigen::Vector2d(0, variance / (damper * damper)).asDiagonal();
    Eigen::Vector2d product = Eigen::Vector2d::Zero();
    double before = samples_[0].time + time;
    for (std::size_t i = next; i < samples_.size(); ++i) {
      spring.add(samples_[i].position, samples_[i].time - before);
      before = samples_[i].time;
      const Eigen::Vector2d held_back(-spring.value, -spring.integral);
      common += row(i) * held_back.transpose();
      square += held_back * held_back.transpose();
      product += held_back * measured(i);
    }
    Eigen::Matrix<double, 6, 6> information;
    information << information_, common, common.transpose(), square;
    Unknowns moment;
    moment << moment_, product;
    ChangePointFit fit;
    fit.unknowns = information.ldlt().solve(moment);
    if (fit.unknowns[5] < 0) {  // a damper never pushes
      fit.unknowns << information.topLeftCorner<5, 5>().ldlt().solve(moment.head<5>()), 0.0;
    }
    if (fit.unknowns[4] <= 0) fit.unknowns = without_spring();
    fit.cost = (square_ - fit.unknowns.dot(moment)) / variance;
    return fit;
  }

  /// [mm] Position of the tip at a time since the first sample, by a local parabola.
  [[nodiscard]] double position(double time) const { return around(time)[0]; }
  /// [mm/s]
  [[nodiscard]] double speed(double time) const { return around(time)[1]; }
  /// [s] of a sample since the first.
  [[nodiscard]] double time(std::size_t i) const { return samples_[i].time - samples_[0].time; }
  /// The sample at which the change explains the motion best.
  [[nodiscard]] std::size_t search(double damper) const {
    std::size_t best = kMargin;
    double lowest = std::numeric_limits<double>::infinity();
    const auto scan = [&](std::size_t low, std::size_t high, std::size_t step) {
      for (std::size_t i = low; i <= high; i += step) {
        if (const double cost = fit(time(i), damper).cost; cost < lowest) {
          lowest = cost;
          best = i;
        }
      }
    };
    const std::size_t last = samples_.size() - 1 - kMargin;
    scan(kMargin, last, kCoarse);
    scan(std::max(best, kMargin + kCoarse) - kCoarse, std::min(best + kCoarse, last), 1);
    return best;
  }
  [[nodiscard]] double free_cost() const {
    const double variance = position_deviation(options_) * position_deviation(options_);
    return (square_ - without_spring().head<4>().dot(moment_)) / variance;
  }

 private:
  [[nodiscard]] Eigen::Vector4d row(std::size_t i) const {
    return free_row(samples_[i].time - samples_[0].time, travel_[i]);
  }
  /// [mm] Position relative to what the priors expect.
  [[nodiscard]] double measured(std::size_t i) const {
    return samples_[i].position - samples_[0].position -
           kAcceleration / options_.model.mass * travel_[i];
  }
  [[nodiscard]] Unknowns without_spring() const {
    Unknowns unknowns;
    unknowns << Eigen::Vector4d(information_.ldlt().solve(moment_)), 0.0, 0.0;
    return unknowns;
  }
  /// Position, speed and half the acceleration at a time.
  [[nodiscard]] Eigen::Vector3d around(double time) const {
    constexpr std::ptrdiff_t kHalf = 6;  // samples on each side
    const double at = samples_[0].time + time;
    const auto middle = std::lower_bound(
        samples_.begin(), samples_.end(), at,
        [](const ApproachSample& sample, double value) { return sample.time < value; });
    const auto begin = middle - std::min(kHalf, middle - samples_.begin());
    const auto end = middle + std::min(kHalf, samples_.end() - middle);
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();
    for (auto sample = begin; sample != end; ++sample) {
      const double t = sample->time - at;
      const Eigen::Vector3d r(1, t, t * t);
      information += r * r.transpose();
      moment += r * sample->position;
    }
    return information.ldlt().solve(moment);
  }

  std::span<const ApproachSample> samples_;
  const ContactOptions& options_;
  std::vector<double> travel_;
  Eigen::Matrix4d information_;
  Eigen::Vector4d moment_;
  double square_ = 0;
};

void check_samples(std::span<const ApproachSample> samples, const ContactOptions& options) {
  if (samples.size() < kLeastSamples) {
    throw InvalidInput("estimate_contact: got " + std::to_string(samples.size()) +
                       " samples; it needs at least " + std::to_string(kLeastSamples) +
                       " from the start of the approach to the touch");
  }
  SignalCheck check(options.signal);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (const SignalFault fault = check.check(samples[i]); fault != SignalFault::none) {
      throw InvalidInput("estimate_contact: sample " + std::to_string(i) + " of the approach: " +
                         std::string(to_string(fault)) + "; repeat the approach");
    }
  }
}

}  // namespace

std::optional<ContactEstimate> estimate_contact(std::span<const ApproachSample> samples,
                                                const ContactOptions& options) {
  check_options(options);
  check_samples(samples, options);
  const ChangePoint change(samples, options);
  constexpr double kDampingRatio = 0.25;  // standard deviation of the prior
  // The damping is not known before the stiffness is, so first search with almost none.
  double damper = kRoughDamper;
  std::size_t best = change.search(damper);
  const double undamped = change.position(change.time(best));
  const double kappa = change.fit(change.time(best), damper).unknowns[4];
  if (!(kappa > 0)) return std::nullopt;
  damper = 2 * kDampingRatio * std::sqrt(kappa);
  best = change.search(damper);

  // Fit a parabola to the costs of nearby samples, because quantisation makes them scatter.
  const std::size_t around =
      std::min({best - kMargin + 1, samples.size() - kMargin - best, kCoarse});
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  const double best_cost = change.fit(change.time(best), damper).cost;
  for (std::size_t i = best - around; i <= best + around; ++i) {
    const double t = change.time(i) - change.time(best);
    const Eigen::Vector3d r(1, t, t * t);
    information += r * r.transpose();
    moment += r * (change.fit(change.time(i), damper).cost - best_cost);
  }
  const Eigen::Vector3d parabola = information.ldlt().solve(moment);
  const double reach = change.time(best + around) - change.time(best);
  const double curvature = std::max(2 * parabola[2], 0.0);
  const double shift = curvature > 0 ? std::clamp(-parabola[1] / curvature, -reach, reach) : 0.0;

  const double time = change.time(best) + shift;
  const ChangePointFit fit = change.fit(time, damper);
  const double per_newton = kAcceleration / options.model.mass + fit.unknowns[2];
  if (!(fit.unknowns[4] > options.softest * per_newton) ||
      !(change.free_cost() - fit.cost > options.threshold * options.threshold)) {
    return std::nullopt;
  }
  ContactEstimate estimate;
  estimate.time = samples[0].time + time;
  estimate.position = change.position(time);
  estimate.speed = change.speed(time);
  // The cost rises by 1 at one standard deviation. The damping of the object is uncertain as well.
  const double time_deviation = curvature > 0 ? std::sqrt(2 / curvature) : reach;
  estimate.position_deviation =
      Eigen::Vector3d(time_deviation * estimate.speed, position_deviation(options),
                      estimate.position - undamped)
          .norm();
  estimate.stiffness = fit.unknowns[4] / per_newton;
  return estimate;
}

}  // namespace palpate::probing
