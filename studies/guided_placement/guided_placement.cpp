// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
//
// Whether contacts are better placed where the recorded surface moves differently from what the
// contacts so far let expect (thesis 6.2.1.1): prints the tables of docs/trade-probing.md. Each
// contact gets the same trials, so that equal numbers of contacts are equal hours of the arm.
// `guided_placement NAME...`: only these objects.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <iostream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "guidance.h"
#include "palpate/haptics/build_model.h"
#include "palpate/haptics/evaluate.h"
#include "probed_object.h"

namespace palpate::bench {
namespace {

double error_of(const ProbedObject& object, const std::vector<std::size_t>& begun,
                std::size_t count) {
  probing::Acquisition acquisition;
  acquisition.probe_radius = object.specimen->tip_radius();
  for (std::size_t k = 0; k < count; ++k) {
    acquisition.contacts.push_back(object.plan.contacts[begun[k]]);
    for (const probing::Sample& sample : object.samples[begun[k]])
      acquisition.samples.push_back(sample);
  }
  const haptics::BuildResult built = haptics::build_model(acquisition, object.specimen->surface());
  return haptics::evaluate_queries(built.model, object.queries).rms;
}

// [RMS of logarithms] of the stiffness of candidates that are not begun.
double stiffness_error(const ProbedObject& object, const std::vector<std::size_t>& begun,
                       const Eigen::VectorXd& expected) {
  double sum = 0;
  for (std::size_t j = 0; j < object.plan.contacts.size(); ++j) {
    const auto at = static_cast<Eigen::Index>(j);
    if (nearest_begun(object, begun, j) > 0)
      sum += std::pow(expected(at) - object.stiffness(at), 2);
  }
  return std::sqrt(sum / static_cast<double>(object.plan.contacts.size() - begun.size()));
}

constexpr std::array<std::size_t, 4> kCounts{8, 12, 16, 24};
constexpr std::size_t kStarts = 8;

// [N] of the models of the first contacts of an order, by the counts above.
using Errors = Eigen::Vector4d;

void run(const PlacementObject& given) {
  const ProbedObject object = probe(given);
  const std::size_t candidates = object.plan.contacts.size();
  std::vector<std::size_t> starts;
  for (std::size_t k = 0; k < kStarts; ++k) starts.push_back(k * candidates / kStarts);
  fmt::print("{}: {} candidates, {:.0f} % of the places seen\n", object.name, candidates,
             100 * object.seen.array().isFinite().cast<double>().mean());
  for (const std::size_t count : {12, 24}) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const std::size_t start : starts) {
      const std::vector<std::size_t> begun = order_of(object, Guide::none, start, count);
      sum += Eigen::Vector3d(
          stiffness_error(object, begun, felt_stiffness(object, begun)),
          stiffness_error(object, begun, seen_stiffness(object, begun, object.seen)),
          stiffness_error(object, begun, seen_stiffness(object, begun, object.exactly)));
    }
    sum /= kStarts;
    fmt::print(
        "{} contacts: RMS of the logarithm of stiffness elsewhere: {:.3f} by forces, {:.3f} "
        "with shapes, {:.3f} with exact shapes\n",
        count, sum(0), sum(1), sum(2));
  }
  std::map<std::vector<std::size_t>, Errors> known;  // orders are often the same
  std::vector<Errors> plain;
  for (const auto& [name, guide] :
       {std::pair{"forces alone", Guide::none}, std::pair{"shapes", Guide::shapes},
        std::pair{"exact shapes", Guide::exact_shapes},
        std::pair{"told stiffness", Guide::truth}}) {
    std::vector<Errors> found;
    for (const std::size_t start : starts) {
      const std::vector<std::size_t> begun = order_of(object, guide, start, kCounts.back());
      const auto [place, is_new] = known.try_emplace(begun);
      for (std::size_t c = 0; c < kCounts.size() && is_new; ++c)
        place->second(static_cast<Eigen::Index>(c)) = error_of(object, begun, kCounts[c]);
      found.push_back(place->second);
    }
    if (guide == Guide::none) plain = found;
    fmt::print("| {} | {} |", object.name, name);
    for (Eigen::Index c = 0; c < static_cast<Eigen::Index>(kCounts.size()); ++c) {
      // Mean, and that of the logarithm of the ratio to forces alone with its standard error.
      double sum = 0, ratio = 0, square = 0;
      for (std::size_t k = 0; k < kStarts; ++k) {
        const double change = std::log(found[k](c) / plain[k](c));
        sum += found[k](c);
        ratio += change / kStarts;
        square += change * change / kStarts;
      }
      fmt::print(" {:.3f}, {:.2f} +- {:.2f} |", sum / kStarts, std::exp(ratio),
                 std::sqrt((square - ratio * ratio) / (kStarts - 1)));
    }
    fmt::print("\n");
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace palpate::bench

int main(int count, char** arguments) try {
  constexpr std::size_t kThreads = 2;
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, kThreads);
  const std::vector<std::string> names(arguments + 1, arguments + count);
  for (const auto& object : palpate::bench::placement_objects()) {
    if (names.empty() || std::find(names.begin(), names.end(), object.name) != names.end())
      palpate::bench::run(object);
  }
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
