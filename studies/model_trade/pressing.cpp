// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "pressing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <map>
#include <random>
#include <vector>

#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/build_model.h"
#include "palpate/haptics/evaluate.h"
#include "pressing_peers.h"
#include "pressing_sets.h"

namespace palpate::bench {
namespace {

constexpr std::size_t kFolds = 10;
// Left-out places that are predicted in each fold, at most.
constexpr std::size_t kMostPredicted = 60;
constexpr unsigned kFoldSeed = 1;

struct PredictionErrors {
  double squares = 0, largest = 0;
  std::size_t count = 0;
  void add(double predicted, double measured) {
    squares += (predicted - measured) * (predicted - measured);
    largest = std::max(largest, std::abs(predicted));
    ++count;
  }
  [[nodiscard]] double rms() const { return std::sqrt(squares / static_cast<double>(count)); }
};

struct Row {
  PredictionErrors model, linear, process;
  double largest_force = 0;
  double relative = 0, records = 0;  // squared errors relative to those that the model states
};

// The records of one place.
struct Place {
  probing::Contact contact;
  std::vector<probing::Sample> samples;
  PressedPlace normal;
};

std::vector<Place> places_of(const probing::Acquisition& acquisition) {
  std::vector<Place> places;
  std::map<long long, std::size_t> index;
  for (const probing::Contact& contact : acquisition.contacts) {
    index[contact.id] = places.size();
    places.push_back({contact, {}, {contact.position.head<2>(), {}, {}}});
  }
  for (const probing::Sample& sample : acquisition.samples) {
    Place& place = places[index[sample.contact]];
    const Eigen::Vector3d into = -place.contact.normal.normalized();
    place.samples.push_back(sample);
    place.normal.depths.push_back((sample.b - place.contact.position).dot(into));
    place.normal.forces.push_back(sample.force.dot(into));
  }
  return places;
}

// Predicts the record of the arm, from the model of the other places.
void predict(const haptics::BuildResult& built, const haptics::BlendedField& field,
             const Place& place, double way_back, Row& row) {
  const Eigen::Isometry3d& there = built.model.T_surface_acquisition;
  const haptics::PressingOffsets& offsets = built.pressing->offsets;
  const Eigen::Vector3d into = -place.contact.normal.normalized();
  const Eigen::Vector3d touch = there * place.contact.position;
  const Eigen::Vector3d on_surface = field.surface().closest_point(touch).position;
  const double height = (touch - on_surface).dot(there.linear() * into);
  const haptics::Blend at = field.blend(on_surface);
  const double late = haptics::expected_touch(offsets, height);
  const std::size_t count = place.samples.size();
  for (std::size_t i = 0; i < count; ++i) {
    const probing::Sample& sample = place.samples[i];
    const Eigen::Vector3d displacement =
        there.linear() * (sample.b - place.contact.position + late * into);
    Eigen::Vector3d force = there.linear().transpose() * field.force(at, displacement);
    const bool back = way_back > 0 && i >= count / 2;
    if (back) force *= 1 - offsets.hysteresis;
    const double bias = offsets.along_direction ? offsets.force.z() : offsets.force.dot(into);
    row.model.add(force.dot(into) + bias, place.normal.forces[i]);
    const auto stated = field.deviation(on_surface, displacement);
    if (stated && !back) {
      const haptics::MeasurementNoise& noise = *built.model.noise;
      const double variance =
          *stated * *stated + 3 * noise.force * noise.force +
          noise.displacement * noise.displacement * field.stiffness(at, displacement).squaredNorm();
      const Eigen::Vector3d whole =
          force + (offsets.along_direction ? Eigen::Vector3d(bias * into) : offsets.force);
      row.relative += (whole - sample.force).squaredNorm() / variance;
      ++row.records;
    }
    row.largest_force = std::max(row.largest_force, std::abs(place.normal.forces[i]));
  }
}

Row cross_validate(const PressingSet& set, const PressingKind& kind) {
  Row row;
  const std::vector<Place> places = places_of(set.acquisition);
  std::vector<PressedPlace> all;
  for (const Place& place : places) all.push_back(place.normal);
  const ProcessSettings settings = learn_process(all);  // knows the left-out places, too
  std::vector<std::size_t> order(places.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::mt19937 random(kFoldSeed);
  std::shuffle(order.begin(), order.end(), random);
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    probing::Acquisition rest;
    std::vector<PressedPlace> others;
    std::vector<std::size_t> left;
    for (std::size_t k = 0; k < order.size(); ++k) {
      const Place& place = places[order[k]];
      if (k % kFolds == fold) {
        left.push_back(order[k]);
        continue;
      }
      rest.contacts.push_back(place.contact);
      rest.samples.insert(rest.samples.end(), place.samples.begin(), place.samples.end());
      others.push_back(place.normal);
    }
    const haptics::BuildResult built = haptics::build_model(rest, set.surface);
    const haptics::BlendedField field(built.model);
    if (left.size() > kMostPredicted) left.resize(kMostPredicted);
    for (const std::size_t i : left) {
      predict(built, field, places[i], kind.way_back, row);
      const std::vector<double> forces = process_forces(settings, others, all[i]);
      for (std::size_t s = 0; s < forces.size(); ++s) {
        row.linear.add(barycentric_force(others, all[i].at, all[i].depths[s]), all[i].forces[s]);
        row.process.add(forces[s], all[i].forces[s]);
      }
    }
  }
  return row;
}

std::string in_words(const haptics::PressingOffsets& offsets) {
  std::string words;
  if (offsets.force_found) words += fmt::format("{:.3f} N, ", offsets.force.norm());
  if (offsets.touch_found)
    words += fmt::format("{:.2f} +- {:.2f} mm, ", offsets.touch + 0.0, offsets.touch_error);
  if (offsets.height_slope != 0) words += fmt::format("{:.2f} height, ", offsets.height_slope);
  if (offsets.hysteresis > 0) words += fmt::format("{:.0f} %, ", 100 * offsets.hysteresis);
  return words.empty() ? "none" : words.substr(0, words.size() - 2);
}

}  // namespace

void measure_pressing(const std::string& only, unsigned seed) {
  fmt::print(
      "| set | model [N] | / linear | / process | largest / measured | queries [N] | offsets found "
      "| noise [N] | fit [ms a contact] | left out / stated | queries / stated "
      "|\n|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const PressingKind& kind : pressing_kinds()) {
    if (kind.name.find(only) == std::string::npos) continue;
    const PressingSet set = make_pressing_set(kind, seed);
    // Processor time of all threads, since other programs use the machine.
    const std::clock_t start = std::clock();
    const haptics::BuildResult built = haptics::build_model(set.acquisition, set.surface);
    const double took = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    const haptics::QueryErrors queries = haptics::evaluate_queries(built.model, set.truth);
    const Row row = cross_validate(set, kind);
    fmt::print(
        "| {} | {:.3f} | {:.2f} | {:.2f} | {:.2f} | {:.3f} | {} | {:.3f} | {:.1f} | {:.2f} | "
        "{:.2f} |\n",
        kind.name, row.model.rms(), row.model.rms() / row.linear.rms(),
        row.model.rms() / row.process.rms(), row.model.largest / row.largest_force, queries.rms,
        in_words(built.pressing->offsets), built.pressing->force_noise,
        took / static_cast<double>(set.acquisition.contacts.size()),
        std::sqrt(row.relative / row.records), queries.stated->ratio);
    std::fflush(stdout);
  }
}

}  // namespace palpate::bench
