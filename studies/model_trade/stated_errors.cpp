// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "stated_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <vector>

#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/build_model.h"
#include "palpate/haptics/evaluate.h"
#include "palpate/haptics/realignment.h"
#include "palpate/probing/closed_form.h"
#include "strip_acquisition.h"

namespace palpate::bench {
namespace {

constexpr std::size_t kStatedFolds = 5;
constexpr int kStatedQueries = 400;
constexpr unsigned kStatedSeed = 1;

struct Measured {
  std::string name;
  probing::Acquisition acquisition;
  geometry::TriangleMesh surface;
  std::vector<haptics::Query> truth;
};

template <typename Object>
std::vector<haptics::Query> queries(const Object& object, double x, double y) {
  std::mt19937 random(kStatedSeed);
  std::uniform_real_distribution<double> along(-x, x), across(-y, y);
  std::vector<Eigen::Vector2d> places;
  for (int i = 0; i < kStatedQueries; ++i) {
    const double at = along(random);
    places.emplace_back(at, across(random));
  }
  std::vector<haptics::Query> result;
  for (const auto& truth : support::strip_truths(object, places, 1, kStatedSeed))
    result.push_back({truth.contact, truth.displacement, truth.force});
  return result;
}

Measured sheet(const std::string& name, const support::Strip& strip,
               const support::StripProbing& probing) {
  return {name, support::strip_acquisition(strip, probing),
          probing::make_specimen(strip)->surface(), queries(strip, 40, 58)};
}

template <typename Object>
Measured sparse(const std::string& name, const Object& object, const support::StripProbing& probing,
                const std::vector<Eigen::Vector2d>& places, double ratio, double x, double y) {
  Measured result{name, {}, probing::make_specimen(object)->surface(), queries(object, x, y)};
  support::ObjectProbe<Object> probe(object, probing);
  for (const Eigen::Vector2d& at : places)
    probe.probe_sparsely(result.acquisition, at.x(), at.y(), ratio);
  return result;
}

class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {}
  double operator()(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random_);
  }

 private:
  std::mt19937 random_;
};

support::Strip drawn_sheet(unsigned seed, bool with_block) {
  Draw draw(seed);
  support::Strip sheet;
  sheet.tension = draw(0.6, 1.1);
  sheet.axial = draw(30, 60);
  sheet.compliance = draw(0.15, 0.4);
  sheet.lateral = draw(0.03, 0.06);
  sheet.taper = draw(0.1, 0.5);
  if (!with_block) return sheet;
  sheet.block = draw(0.8, 3);
  sheet.depth = draw(10, 17);
  sheet.softness = draw(0.3, 0.8);
  sheet.edge = draw(1.5, 4);
  const double x = draw(-30, 5), y = draw(-40, 0), length = draw(20, 35);
  sheet.block_low = {x, y};
  sheet.block_high = {x + length, y + draw(25, 45)};
  return sheet;
}

probing::Beam drawn_beam(unsigned seed) {
  Draw draw(seed);
  probing::Beam beam;
  beam.shear = draw(0.25, 0.5);
  beam.pressed = draw(1, 2.2);
  beam.bending = draw(2, 5);
  beam.local_variation = draw(0, 0.35);
  beam.twisting = draw(0.001, 0.004);
  beam.pressed_force = draw(0.5, 1.2);
  return beam;
}

Measured measured_beam(const std::string& name, const probing::Beam& beam,
                       const support::StripProbing& probing) {
  Measured made{name, {}, probing::make_specimen(beam)->surface(), {}};
  support::ObjectProbe<probing::Beam> probe(beam, probing);
  for (double x = 20; x <= 180; x += 20)
    for (const double y : {-14.0, 0.0, 14.0}) probe.probe_sparsely(made.acquisition, x, y, 0.5);
  std::mt19937 random(kStatedSeed);
  std::uniform_real_distribution<double> x(20, 180), y(-14, 14);
  std::vector<Eigen::Vector2d> places;
  for (int i = 0; i < kStatedQueries; ++i) {
    const double there = x(random);
    places.emplace_back(there, y(random));
  }
  for (const auto& truth : support::strip_truths(beam, places, 1, kStatedSeed))
    made.truth.push_back({truth.contact, truth.displacement, truth.force});
  return made;
}

std::vector<std::pair<std::string, std::function<Measured(const std::string&)>>> kinds(
    unsigned seed) {
  const support::Strip plain;
  support::Strip block;
  block.block = 1.5;
  support::Strip deep = block;
  deep.block = 3;
  deep.depth = 10;
  const support::StripProbing rich, few{.normal_forces = {0.5, 1.5, 3}, .directions = 3};
  support::StripProbing wide;
  wide.spacing_x = 28;
  wide.spacing_y = 28;
  const probing::Beam beam{.local_variation = 0.3};
  support::StripProbing noisy = few;
  noisy.force_noise = 0.04;
  noisy.position_noise = noisy.location_noise = 0.08;
  const auto few_at = [](const std::string& name, const support::Strip& strip,
                         const support::StripProbing& probing) {
    return sparse(name, strip, probing, support::strip_places(probing), 0.5, 40, 58);
  };
  return {
      {"sheet", [=](const auto& name) { return sheet(name, plain, rich); }},
      {"sheet with block", [=](const auto& name) { return sheet(name, block, rich); }},
      {"sheet with stiff block", [=](const auto& name) { return sheet(name, deep, rich); }},
      {"sheet, pitch 28 mm", [=](const auto& name) { return sheet(name, plain, wide); }},
      {"sheet with block, pitch 28 mm", [=](const auto& name) { return sheet(name, block, wide); }},
      {"sheet, 12 samples", [=](const auto& name) { return few_at(name, plain, few); }},
      {"sheet with block, 12 samples", [=](const auto& name) { return few_at(name, block, few); }},
      {"beam, 12 samples", [=](const auto& name) { return measured_beam(name, beam, few); }},
      {"drawn sheet",
       [=](const auto& name) { return sheet(name, drawn_sheet(seed, false), rich); }},
      {"drawn sheet with block",
       [=](const auto& name) { return sheet(name, drawn_sheet(seed, true), rich); }},
      {"drawn sheet with block 2",
       [=](const auto& name) { return sheet(name, drawn_sheet(seed + 1, true), rich); }},
      {"drawn sheet with block, pitch 28 mm",
       [=](const auto& name) { return sheet(name, drawn_sheet(seed, true), wide); }},
      {"drawn sheet with block, 12 samples",
       [=](const auto& name) { return few_at(name, drawn_sheet(seed, true), few); }},
      {"drawn sheet, 12 samples, noise 4 times as large",
       [=](const auto& name) { return few_at(name, drawn_sheet(seed, false), noisy); }},
      {"drawn sheet with block, 12 samples, noise 4 times as large",
       [=](const auto& name) { return few_at(name, drawn_sheet(seed, true), noisy); }},
      {"drawn beam, 12 samples",
       [=](const auto& name) { return measured_beam(name, drawn_beam(seed), few); }},
      {"drawn beam, 12 samples, noise 4 times as large",
       [=](const auto& name) { return measured_beam(name, drawn_beam(seed), noisy); }}};
}

struct Ratio {
  double squares = 0, stated = 0, relative = 0, count = 0;
  void add(double error, double deviation) {
    squares += error * error;
    stated += deviation * deviation;
    relative += error * error / (deviation * deviation);
    ++count;
  }
};

// Contacts that are left out, predicted from the model of the others.
Ratio left_out(const Measured& set) {
  std::vector<std::size_t> order(set.acquisition.contacts.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::mt19937 random(kStatedSeed);
  std::shuffle(order.begin(), order.end(), random);
  Ratio ratio;
  for (std::size_t fold = 0; fold < kStatedFolds; ++fold) {
    probing::Acquisition rest;
    std::vector<probing::Contact> left;
    for (std::size_t k = 0; k < order.size(); ++k) {
      const probing::Contact& contact = set.acquisition.contacts[order[k]];
      if (k % kStatedFolds == fold) {
        left.push_back(contact);
        continue;
      }
      rest.contacts.push_back(contact);
      for (const probing::Sample& sample : set.acquisition.samples)
        if (sample.contact == contact.id) rest.samples.push_back(sample);
    }
    const haptics::Model model = haptics::build_model(rest, set.surface).model;
    const haptics::BlendedField field(model);
    const Eigen::Isometry3d& there = model.T_surface_acquisition;
    for (const probing::Contact& contact : left) {
      const haptics::ForceSamples samples = haptics::realign(contact, set.acquisition.samples);
      const Eigen::Vector3d place = there * contact.position;
      const haptics::Blend at = field.blend(place);
      for (Eigen::Index j = 0; j < samples.forces.cols(); ++j) {
        const Eigen::Vector3d displacement = there.linear() * samples.displacements.col(j);
        const auto deviation = field.deviation(place, displacement);
        if (!deviation) continue;
        const Eigen::Vector3d error =
            field.force(at, displacement) - there.linear() * samples.forces.col(j);
        const double noise = 3 * std::pow(model.noise->force, 2) +
                             std::pow(model.noise->displacement, 2) *
                                 field.stiffness(at, displacement).squaredNorm();
        ratio.add(error.norm(), std::sqrt(*deviation * *deviation + noise));
      }
    }
  }
  return ratio;
}

}  // namespace

void measure_stated_errors(const std::string& only, unsigned seed) {
  fmt::print(
      "| object | left out: RMS [N] | stated [N] | ratio | queries: RMS [N] | stated [N] | ratio "
      "|\n"
      "|---|---|---|---|---|---|---|\n");
  for (const auto& [name, make] : kinds(seed)) {
    if (name.find(only) == std::string::npos) continue;
    const Measured set = make(name);
    const haptics::QueryErrors queries = haptics::evaluate_queries(
        haptics::build_model(set.acquisition, set.surface).model, set.truth);
    const Ratio left = left_out(set);
    fmt::print("| {} | {:.3f} | {:.3f} | {:.2f} | {:.3f} | {:.3f} | {:.2f} |\n", name,
               std::sqrt(left.squares / left.count), std::sqrt(left.stated / left.count),
               std::sqrt(left.relative / left.count), queries.rms, queries.stated->rms,
               queries.stated->ratio);
    std::fflush(stdout);
  }
}

}  // namespace palpate::bench
