// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>

#include "palpate/probing/specimen_trials.h"
#include "plain_process.h"

namespace palpate::bench {
namespace {

constexpr double kShareOfSamples = 1.0 / 5, kShareOfHours = 1.0 / 4;

// The measurements of one object with one seed; each is made when it is first needed.
class Measurements {
 public:
  Measurements(const PreparedObject& object, unsigned seed) : object_(object), seed_(seed) {}

  const Measured& of(const std::string& strategy) {
    const auto found = made_.find(strategy);
    if (found != made_.end()) return found->second;
    return made_.emplace(strategy, make(strategy)).first->second;
  }

 private:
  Measured make(const std::string& strategy) {
    if (strategy == "thesis") return measure_thesis(object_, seed_);
    if (strategy == "static") return measure_static(object_, seed_);
    if (strategy == "searching") return measure_searching(object_, seed_);
    if (strategy == "plain") {
      const int samples = of("static").samples;
      return measure_chosen(object_, seed_, choose_by_variance(object_, samples, seed_));
    }
    if (strategy == "adaptive") {
      const Measured& thesis = of("thesis");
      return measure_adaptive(object_, seed_,
                              {.samples = static_cast<int>(kShareOfSamples * thesis.samples),
                               .hours = kShareOfHours * thesis.hours});
    }
    if (strategy == "adaptive static")
      return measure_adaptive(object_, seed_, {.hours = of("static").hours});
    if (strategy == "adaptive searching")
      return measure_adaptive(object_, seed_, {.hours = of("searching").hours});
    Measured baked;  // needs no arm
    baked.acquisition = probing::try_specimen(*object_.specimen, object_.plan).acquisition;
    baked.samples = static_cast<int>(baked.acquisition.samples.size());
    return baked;
  }

  const PreparedObject& object_;
  unsigned seed_;
  std::map<std::string, Measured> made_;
};

haptics::BuildOptions build_options(const std::string& strategy) {
  haptics::BuildOptions options;
  if (strategy == "baked") {                                 // as `palpate bake` does
    constexpr double kDisplacement = 0.005, kForce = 0.002;  // [mm], [N]
    options.fit.noise = {.displacement = kDisplacement, .force = kForce};
    options.friction.force_noise = kForce;
  }
  return options;
}

// The plain process is its own model: its errors at the known forces.
Assessment assess_plain(const PreparedObject& object, const probing::Acquisition& acquisition) {
  const Eigen::Matrix3Xd forces = predict_plainly(acquisition, object.queries);
  double sum = 0;
  for (std::size_t i = 0; i < object.queries.size(); ++i)
    sum += (forces.col(static_cast<Eigen::Index>(i)) - object.queries[i].force).squaredNorm();
  Assessment result;
  result.error = std::sqrt(sum / static_cast<double>(object.queries.size()));
  return result;
}

}  // namespace

const std::vector<std::string>& strategy_names() {
  static const std::vector<std::string> names = {
      "thesis",   "static",          "searching",          "plain",
      "adaptive", "adaptive static", "adaptive searching", "baked"};
  return names;
}

Runs compare(const PreparedObject& object, const ComparisonOptions& options) {
  using Clock = std::chrono::steady_clock;
  Runs runs;
  for (unsigned seed = 1; seed <= object.of.most_seeds; ++seed) {
    Measurements measurements(object, seed);
    for (const std::string& strategy : strategy_names()) {
      const bool wanted = options.strategies.empty() ||
                          std::find(options.strategies.begin(), options.strategies.end(),
                                    strategy) != options.strategies.end();
      if (!wanted || (strategy == "baked" && seed > 1)) continue;  // it has no chance in it
      const Measured& measured = measurements.of(strategy);
      const auto begin = Clock::now();
      Run run{measured.samples, measured.slipped, measured.hours, measured.stated, {}, 0};
      run.against_truth = strategy == "plain" ? assess_plain(object, measured.acquisition)
                                              : assess(object, measured.acquisition,
                                                       build_options(strategy), options.left_out);
      run.fit_seconds = std::chrono::duration<double>(Clock::now() - begin).count();
      fmt::print(stderr, "{}, seed {}, {}: {} samples, {:.2f} h, {:.4f} N, {:.0f} s\n",
                 object.of.name, seed, strategy, run.samples, run.hours, run.against_truth.error,
                 run.fit_seconds);
      std::fflush(stderr);
      runs[strategy].push_back(run);
    }
  }
  return runs;
}

}  // namespace palpate::bench
