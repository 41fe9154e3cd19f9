// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
//
// Accuracy of forecasts of the error with more contacts from a model with few, for docs/plan.md.
// Objects with known forces are measured with few contacts, the error with more of them is
// forecast, and then they are measured with more. `error_forecast 1 2 3` does that with the seeds
// 1, 2 and 3.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/build_model.h"
#include "palpate/haptics/error_forecast.h"
#include "palpate/probing/closed_form.h"
#include "strip_acquisition.h"

namespace palpate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// The area of the contacts [mm].
struct Area {
  double x = 42, y = 60;  ///< half of its size
  double middle = 0;      ///< x of its middle
};

// Rows `pitch` apart, shifted by half the distance of their contacts, which is 0.7 times as large.
std::vector<Vector2d> places(const Area& area, double pitch) {
  const auto even = [](double half, double distance) {
    const int count = std::max(1, static_cast<int>(std::lround(2 * half / distance)));
    return std::pair(count, 2 * half / count);
  };
  const auto [rows, row] = even(area.y, pitch);
  const auto [columns, column] = even(area.x, 0.7 * pitch);
  std::vector<Vector2d> result;
  for (int r = 0; r <= rows; ++r) {
    const double y = -area.y + r * row;
    for (int c = 0; c <= columns; ++c)
      if (r % 2 == 0 || c < columns)
        result.emplace_back(area.middle - area.x + (c + (r % 2 == 0 ? 0 : 0.5)) * column, y);
  }
  return result;
}

template <typename Object>
haptics::Model measured(const Object& object, const std::vector<Vector2d>& at, unsigned seed) {
  const support::StripProbing probing{.directions = 4, .seed = seed};
  probing::Acquisition acquisition;
  support::ObjectProbe<Object> probe(object, probing);
  for (const Vector2d& place : at) probe.probe(acquisition, place.x(), place.y());
  return haptics::build_model(probing::CheckedAcquisition(std::move(acquisition)),
                              probing::make_specimen(object)->surface())
      .model;
}

struct Measured {
  double error = 0, force = 0;  // [N] RMS
};

template <typename Object>
Measured true_error(const Object& object, const Area& area, const haptics::Model& model) {
  const haptics::BlendedField field(model);
  std::mt19937 random(1000);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Vector2d> at;
  for (int i = 0; i < 1000; ++i) {
    const double x = area.middle + area.x * uniform(random);
    at.emplace_back(x, area.y * uniform(random));
  }
  double error = 0, force = 0;
  const std::vector<support::StripTruth> truths = support::strip_truths(object, at, 1);
  for (const support::StripTruth& truth : truths) {
    error += (field.force(truth.contact, truth.displacement) - truth.force).squaredNorm();
    force += truth.force.squaredNorm();
  }
  const auto count = static_cast<double>(truths.size());
  return {std::sqrt(error / count), std::sqrt(force / count)};
}

template <typename Object>
void print_forecasts(const std::string& name, const Object& object, const Area& area,
                     const std::vector<unsigned>& seeds) {
  for (const unsigned seed : seeds) {
    std::vector<std::vector<Vector2d>> sets;
    std::vector<haptics::Model> models;
    std::vector<Measured> truths;
    for (const double pitch : {28.0, 20.0, 14.0, 10.0}) {
      sets.push_back(places(area, pitch));
      models.push_back(measured(object, sets.back(), seed));
      truths.push_back(true_error(object, area, models.back()));
    }
    for (std::size_t pilot = 0; pilot < 3; ++pilot) {
      if (models[pilot].contacts.size() < 8) continue;
      std::vector<bool> within;  // the area of the contacts, where errors are measured
      for (const auto& vertex : models[pilot].surface.vertices.colwise())
        within.push_back(std::abs(vertex.x() - area.middle) <= area.x &&
                         std::abs(vertex.y()) <= area.y);
      const haptics::ErrorForecast forecast(models[pilot], {.reachable = within});
      for (std::size_t k = pilot; k < sets.size(); ++k) {
        std::vector<Vector3d> contacts;
        for (const Vector2d& place : sets[k])
          contacts.push_back(surface_at(object, place.x(), place.y()));
        const double relative = forecast.with(contacts) / forecast.force(),
                     truth = truths[k].error / truths[k].force;
        fmt::print("| {} {} | {} | {} | {:.2f} | {:.2f} | {:.2f} |\n", name, seed,
                   sets[pilot].size(), sets[k].size(), 100 * relative, 100 * truth,
                   truth / relative);
        std::fflush(stdout);
      }
    }
  }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  using namespace palpate;
  std::vector<unsigned> seeds;
  for (int i = 1; i < argc; ++i) seeds.push_back(static_cast<unsigned>(std::stoul(argv[i])));
  if (seeds.empty()) seeds = {1, 2, 3};
  fmt::print(
      "| object | contacts | forecast for | error [%] | true [%] | true / forecast |\n"
      "|---|---|---|---|---|---|\n");
  print_forecasts("sheet", probing::Sheet{}, {}, seeds);
  print_forecasts("sheet, other", probing::Sheet{.tension = 0.6, .lateral = 0.06, .taper = 0.5}, {},
                  seeds);
  print_forecasts("sheet with block", probing::Sheet{.block = 1.5}, {}, seeds);
  print_forecasts("sheet with soft block", probing::Sheet{.block = 0.7}, {}, seeds);
  print_forecasts("uneven beam", probing::Beam{.local_variation = 0.15}, {90, 18, 100}, seeds);
}
