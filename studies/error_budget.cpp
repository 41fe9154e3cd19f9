// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
//
// From which source which part of a model's error comes, for docs/error-budget.md. Objects with
// known forces are measured as by a camera and an arm; each source of error is switched on alone,
// and all but it. The force is that of a tool at a position of the world, so that errors of the
// surface count as well. `error_budget 1 2 3` takes the means over the seeds 1, 2 and 3.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/build_model.h"
#include "palpate/probing/acquisition.h"
#include "strip_acquisition.h"

namespace palpate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// The sources of error. The sizes are those of the thesis' set-up, or of this library's
/// measurements of it.
struct Sources {
  bool depths = false;        ///< noise of each vertex
  bool calibration = false;   ///< the whole surface is shifted and turned in depth
  bool registration = false;  ///< of the arm and the camera
  bool positions = false;     ///< of the tool
  bool forces = false;        ///< of the force sensor
  bool slips = false;         ///< resolution of the force at which the tool slips
  bool spacing = false;       ///< contacts 14 mm apart instead of 7 mm
};

constexpr double kDepthNoise = 0.05;         // [mm]
constexpr double kDepthOffset = 0.1;         // [mm]
constexpr double kTilt = 0.05, kTurn = 0.1;  // [degrees]
const Vector3d kShift(0.2, -0.2, 0.1);       // [mm]

struct Named {
  const char* name;
  bool Sources::*source;
};
constexpr std::array<Named, 7> kSources{{
    {"depths: noise of 0.05 mm", &Sources::depths},
    {"calibration: 0.1 mm and 0.05 degrees", &Sources::calibration},
    {"registration: 0.3 mm and 0.1 degrees", &Sources::registration},
    {"positions of the tool: 0.02 mm", &Sources::positions},
    {"forces: 0.01 N", &Sources::forces},
    {"slips: found within 0.05 N", &Sources::slips},
    {"contacts: 14 mm apart, not 7", &Sources::spacing},
}};

struct Errors {
  double force = 0;     ///< [N] RMS
  double surface = 0;   ///< [mm] RMS
  double friction = 0;  ///< RMS of the coefficient
};

// A rotation about an axis through the middle of the objects.
Eigen::Isometry3d turned(double degrees, const Vector3d& axis, const Vector3d& shift) {
  const Vector3d middle(0, 0, 700);
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = Eigen::AngleAxisd(degrees * M_PI / 180, axis.normalized()).toRotationMatrix();
  motion.translation() = middle - motion.linear() * middle + shift;
  return motion;
}

template <typename Object>
probing::Acquisition measured(const Object& object, const Sources& with, unsigned seed) {
  support::StripProbing probing{.seed = seed};
  if (!with.positions) probing.position_noise = probing.location_noise = 0;
  if (!with.forces) probing.force_noise = 0;
  if (!with.slips) probing.resolution = 0.005;
  if (!with.spacing) {
    probing.spacing_x = 7;
    probing.spacing_y = 10;
  }
  probing::Acquisition acquisition;
  support::ObjectProbe<Object> probe(object, probing);
  for (const Vector2d& at : support::strip_places(probing)) {
    if (std::abs(at.x()) <= 45 && std::abs(at.y()) <= 45) probe.probe(acquisition, at.x(), at.y());
  }
  if (!with.registration) return acquisition;
  const Eigen::Isometry3d wrong = turned(kTurn, {1, 1, 0}, kShift);
  for (probing::Contact& contact : acquisition.contacts) {
    contact.position = wrong * contact.position;
    contact.normal = wrong.linear() * contact.normal;
  }
  for (probing::Sample& sample : acquisition.samples) {
    sample.force = wrong.linear() * sample.force;
    sample.a = wrong * sample.a;
    sample.b = wrong * sample.b;
  }
  return acquisition;
}

template <typename Object>
geometry::TriangleMesh seen(const Object& object, const Sources& with, unsigned seed) {
  geometry::TriangleMesh surface = probing::make_specimen(object)->surface();
  if (with.depths) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    for (auto vertex : surface.vertices.colwise())
      vertex += kDepthNoise * normal(random) * vertex.normalized();
  }
  if (with.calibration)
    surface.vertices = turned(kTilt, {1, -1, 0}, {0, 0, kDepthOffset}) * surface.vertices;
  return surface;
}

template <typename Object>
Errors errors_of(const Object& object, const Sources& with, unsigned seed) {
  const haptics::Model model =
      haptics::build_model(probing::CheckedAcquisition(measured(object, with, seed)),
                           seen(object, with, seed))
          .model;
  const haptics::BlendedField field(model);
  std::vector<Vector2d> places;
  std::mt19937 random(1000 + seed);
  std::uniform_real_distribution<double> uniform(-34, 34);
  for (int i = 0; i < 300; ++i) {
    const double x = uniform(random);
    places.emplace_back(x, uniform(random));
  }
  Errors sum;
  const std::vector<support::StripTruth> truths = support::strip_truths(object, places, 1);
  for (std::size_t i = 0; i < truths.size(); ++i) {
    const support::StripTruth& truth = truths[i];
    const geometry::ClosestPoint place = field.surface().closest_point(truth.contact);
    const haptics::Blend blend = field.blend(place.at);
    const Vector3d tool = truth.contact + truth.displacement;
    sum.force += (field.force(blend, tool - place.position) - truth.force).squaredNorm();
    sum.surface += place.distance * place.distance;
    sum.friction +=
        std::pow(blend.friction - cone_at(object, places[i].x(), places[i].y()).friction, 2);
  }
  const auto count = static_cast<double>(truths.size());
  return {std::sqrt(sum.force / count), std::sqrt(sum.surface / count),
          std::sqrt(sum.friction / count)};
}

template <typename Object>
Errors mean_errors(const Object& object, const Sources& with, const std::vector<unsigned>& seeds) {
  Errors mean;
  for (const unsigned seed : seeds) {
    const Errors of = errors_of(object, with, seed);
    mean.force += of.force / static_cast<double>(seeds.size());
    mean.surface += of.surface / static_cast<double>(seeds.size());
    mean.friction += of.friction / static_cast<double>(seeds.size());
  }
  return mean;
}

template <typename Object>
void print_budget(const char* name, const Object& object, const std::vector<unsigned>& seeds) {
  fmt::print("| {} | force [N] | surface [mm] | friction | all but this: force [N] |\n", name);
  fmt::print("|---|---|---|---|---|\n");
  const auto row = [](const std::string& source, const Errors& of, const std::string& without) {
    fmt::print("| {} | {:.3f} | {:.3f} | {:.3f} | {} |\n", source, of.force, of.surface,
               of.friction, without);
    std::fflush(stdout);
  };
  Sources all;
  for (const Named& each : kSources) all.*each.source = true;
  row("nothing: fits and blending alone", mean_errors(object, {}, seeds), "");
  for (const Named& each : kSources) {
    Sources alone, without = all;
    alone.*each.source = true;
    without.*each.source = false;
    row(each.name, mean_errors(object, alone, seeds),
        fmt::format("{:.3f}", mean_errors(object, without, seeds).force));
  }
  row("all", mean_errors(object, all, seeds), "");
  fmt::print("\n");
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  std::vector<unsigned> seeds;
  for (int i = 1; i < argc; ++i) seeds.push_back(static_cast<unsigned>(std::stoul(argv[i])));
  if (seeds.empty()) seeds = {1, 2, 3};
  using namespace palpate;
  print_budget("stretched sheet", probing::Sheet{}, seeds);
  print_budget("sheet with a block", probing::Sheet{.block = 1.5}, seeds);
  print_budget("elastic body", probing::ElasticBody{}, seeds);
}
