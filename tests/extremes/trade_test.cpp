// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Each knob that makes a result smaller or a call faster, turned from accurate to cheap: the cost
// falls, the stated error does not, and the error against an independent reference stays within it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <numeric>
#include <random>

#include "findings.h"
#include "operations.h"
#include "palpate/geometry/cloud_sampling.h"
#include "palpate/geometry/decimation.h"
#include "palpate/geometry/farthest_points.h"
#include "palpate/geometry/geodesic_distance.h"
#include "palpate/geometry/mesh_distance.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/geometry/winding_number.h"
#include "palpate/haptics/force_field_fit.h"
#include "palpate/haptics/packed_field.h"
#include "palpate/haptics/playback.h"
#include "palpate/haptics/reduce_model.h"

namespace palpate::extremes {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// What a setting of a knob costs, and how far its result is off.
struct Setting {
  double knob = 0;
  double cost = 0;    ///< counted, not timed; 0: nothing to count
  double stated = 0;  ///< error that the result or the documentation states
  double actual = 0;  ///< error against the reference
};

struct Trade {
  std::string knob;       ///< with the operation
  std::string unit;       ///< of the errors
  std::string cost;       ///< what is counted; empty: nothing
  std::string reference;  ///< what the error is measured against
  std::function<std::vector<Setting>()> turn;
  double over = 1;  ///< largest ratio of actual to stated
};

/// Points on the triangles of a mesh, the same number in each.
Matrix3Xd dense_points(const geometry::TriangleMesh& mesh) {
  constexpr int kSteps = 6;
  Matrix3Xd points(3, mesh.triangles.cols() * (kSteps + 1) * (kSteps + 2) / 2);
  Index count = 0;
  for (Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto corner = [&](int k) -> Vector3d {
      return Vector3d(mesh.vertices.col(mesh.triangles(k, t))) / kSteps;
    };
    for (int i = 0; i <= kSteps; ++i)
      for (int j = 0; i + j <= kSteps; ++j)
        points.col(count++) = i * corner(0) + j * corner(1) + (kSteps - i - j) * corner(2);
  }
  return points;
}

/// [mm] The largest distance of such points of either mesh from the other.
double sampled_distance(const geometry::TriangleMesh& a, const geometry::TriangleMesh& b) {
  const auto one_way = [](const geometry::TriangleMesh& from, const geometry::TriangleMesh& to) {
    const geometry::SurfaceQuery query(to);
    double largest = 0;
    const Matrix3Xd points = dense_points(from);
    for (const auto point : points.colwise())
      largest = std::max(largest, query.closest_point(point).distance);
    return largest;
  };
  return std::max(one_way(a, b), one_way(b, a));
}

std::vector<Setting> decimation(const std::vector<geometry::DecimationOptions>& settings) {
  const geometry::TriangleMesh& ball = standard_input().ball;
  std::vector<Setting> found;
  for (const geometry::DecimationOptions& options : settings) {
    const geometry::Decimation result = geometry::decimate(ball, options);
    found.push_back({.knob = options.tolerance.value_or(options.max_triangles.value_or(0)),
                     .cost = static_cast<double>(result.mesh.triangles.cols()),
                     .stated = result.distance,
                     .actual = sampled_distance(ball, result.mesh)});
    if (options.tolerance) {
      EXPECT_LE(result.distance, *options.tolerance);
    }
    if (options.max_triangles) {
      EXPECT_LE(found.back().cost, *options.max_triangles);
    }
  }
  return found;
}

std::vector<Setting> gap_of_hausdorff_distance() {
  const geometry::TriangleMesh& ball = standard_input().ball;
  const geometry::TriangleMesh coarse = geometry::decimate(ball, {.max_triangles = 30}).mesh;
  const double sampled = sampled_distance(ball, coarse);
  std::vector<Setting> found;
  for (const double gap : {1e-4, 1e-2, 0.3, 1.0}) {
    const geometry::HausdorffDistance bounds =
        geometry::hausdorff_distance(ball, coarse, {.max_gap = gap});
    EXPECT_LE(sampled, bounds.upper);
    // The sampled distance is a lower bound, too.
    found.push_back({.knob = gap,
                     .stated = gap * bounds.lower,
                     .actual = bounds.upper - std::max(bounds.lower, sampled)});
  }
  return found;
}

/// The solid angle of each triangle (van Oosterom and Strackee 1983), added up.
double winding_by_angles(const geometry::TriangleMesh& mesh, const Vector3d& point) {
  double sum = 0;
  for (const auto triangle : mesh.triangles.colwise()) {
    const Vector3d a = mesh.vertices.col(triangle[0]) - point,
                   b = mesh.vertices.col(triangle[1]) - point,
                   c = mesh.vertices.col(triangle[2]) - point;
    sum += 2 * std::atan2(a.dot(b.cross(c)), a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() +
                                                 b.dot(c) * a.norm() + c.dot(a) * b.norm());
  }
  return sum / (4 * std::numbers::pi);
}

std::vector<Setting> tolerance_of_winding() {
  const Input& input = standard_input();
  const geometry::WindingNumber winding(input.ball);
  std::vector<Setting> found;
  for (const double tolerance : {1e-9, 1e-4, 1e-2, 0.2}) {
    double largest = 0;
    for (const auto place : input.places.colwise())
      largest = std::max(
          largest, std::abs(winding.at(place, tolerance) - winding_by_angles(input.ball, place)));
    found.push_back({.knob = tolerance, .stated = tolerance, .actual = largest});
  }
  return found;
}

std::vector<Setting> spacing_of_poisson_samples() {
  const Matrix3Xd& cloud = standard_input().cloud;
  std::vector<Setting> found;
  for (const double spacing : {1.0, 3.0, 9.0}) {
    const std::vector<int> chosen = geometry::poisson_sample(cloud, spacing);
    double largest = 0;
    for (const auto point : cloud.colwise()) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const int each : chosen) nearest = std::min(nearest, (cloud.col(each) - point).norm());
      largest = std::max(largest, nearest);
    }
    found.push_back({spacing, static_cast<double>(chosen.size()), spacing, largest});
  }
  return found;
}

std::vector<Setting> edge_of_voxels() {
  const Matrix3Xd& cloud = standard_input().cloud;
  std::vector<Setting> found;
  for (const double edge : {1.0, 3.0, 9.0}) {
    const geometry::VoxelSample sample = geometry::voxel_sample(cloud, edge);
    double largest = 0;
    for (Index i = 0; i < cloud.cols(); ++i) {
      const int voxel = sample.voxel[static_cast<std::size_t>(i)];
      largest = std::max(largest, (sample.points.col(voxel) - cloud.col(i)).norm());
    }
    const double diagonal = std::numbers::sqrt3 * edge;
    found.push_back({edge, static_cast<double>(sample.points.cols()), diagonal, largest});
  }
  return found;
}

std::vector<Setting> number_of_farthest_points() {
  const geometry::TriangleMesh& sheet = standard_input().sheet;
  std::vector<int> all(static_cast<std::size_t>(sheet.vertices.cols()));
  std::iota(all.begin(), all.end(), 0);
  std::vector<Setting> found;
  for (const int count : {40, 12, 3}) {
    const geometry::FarthestPoints points =
        geometry::farthest_points(sheet, all, {.spacing = 1e-3, .count = count});
    const double largest =
        geometry::geodesic_distance(sheet, geometry::vertex_points(sheet, points.vertices),
                                    {.method = geometry::GeodesicMethod::exact})
            .distance.maxCoeff();
    found.push_back({static_cast<double>(count), static_cast<double>(points.vertices.size()),
                     points.cover.back(), largest});
  }
  return found;
}

std::vector<Setting> bases_of_a_field() {
  const Input& input = standard_input();
  std::vector<Setting> found;
  for (const int bases : {14, 5, 2, 1}) {
    haptics::FitOptions options{.try_certified = false, .max_bases = bases};
    options.noise = {.displacement = 1e-3, .force = 1e-3};
    const haptics::FitResult fit =
        haptics::fit_force_field(input.displacements, input.forces, options);
    double sum = 0;
    for (Index i = 0; i < input.forces.cols(); ++i)
      sum += (haptics::force(fit.field, input.displacements.col(i)) - input.forces.col(i))
                 .squaredNorm();
    found.push_back({static_cast<double>(bases), static_cast<double>(fit.field.bases.size()),
                     fit.rms, std::sqrt(sum / static_cast<double>(input.forces.cols()))});
  }
  return found;
}

/// Vertices of the sheet where a press is far from the border, which a coarser surface moves.
std::vector<Index> inner_vertices() {
  constexpr double kFarEnough = 6;  // [mm]
  const geometry::TriangleMesh& sheet = standard_input().sheet;
  std::vector<Index> inner;
  for (Index v = 0; v < sheet.vertices.cols(); ++v) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const std::vector<int>& loop : geometry::boundary_loops(sheet))
      for (const int on_border : loop)
        nearest = std::min(nearest, (sheet.vertices.col(on_border) - sheet.vertices.col(v)).norm());
    if (nearest > kFarEnough) inner.push_back(v);
  }
  return inner;
}

/// [N] Forces at the ends of presses at random places of the sheet.
Matrix3Xd forces_of_presses(const haptics::Model& model, int presses) {
  const Input& input = standard_input();
  const haptics::Playback playback(model, {});
  const Matrix3Xd normals = geometry::vertex_normals(input.sheet);
  std::mt19937 random(11);
  const std::vector<Index> inner = inner_vertices();
  std::uniform_int_distribution<std::size_t> places(0, inner.size() - 1);
  std::uniform_real_distribution<double> depths(0.5, 2.5);
  Matrix3Xd forces(3, presses);
  for (int i = 0; i < presses; ++i) {
    const Index vertex = inner[places(random)];
    const double depth = depths(random);
    std::vector<haptics::TrajectoryPoint> path;
    constexpr int kTicks = 60;
    for (int tick = 0; tick <= kTicks; ++tick) {
      const double height = 1 - (1 + depth) * tick / kTicks;
      path.push_back(
          {1e-3 * tick, input.sheet.vertices.col(vertex) + height * normals.col(vertex)});
    }
    forces.col(i) = haptics::play(playback, path).back().force;
  }
  return forces;
}

constexpr double kPressed = 2, kSide = 5;  // [mm] of the loops of a tool
constexpr int kTicks = 400;                // on each side

/// What a tool feels that presses the sheet, slides around a triangle and lifts off.
struct Loop {
  double residual = 0;  ///< [N] largest distance from the friction cone at the end of a slip
  double returned = 0;  ///< [N mm] work on the tool
};

Loop go_around(const haptics::Playback& playback, const std::vector<Vector3d>& corners) {
  Loop loop;
  haptics::LoopState state;
  Vector3d force = playback.step(corners.front(), state).force;
  for (std::size_t side = 1; side < corners.size(); ++side) {
    const Vector3d way = (corners[side] - corners[side - 1]) / kTicks;
    for (int tick = 1; tick <= kTicks; ++tick) {
      const haptics::Command command = playback.step(corners[side - 1] + tick * way, state);
      loop.returned += (force + command.force).dot(way) / 2;
      force = command.force;
      if (command.state == haptics::ContactState::slip) {
        loop.residual =
            std::max(loop.residual, std::abs(haptics::friction_parts(state.place, -force).excess));
      }
    }
  }
  return loop;
}

/// The largest figures of such loops at all inner vertices of the sheet.
Loop worst_loop(const haptics::Playback& playback) {
  constexpr double kHeight = 1;  // [mm]
  const geometry::TriangleMesh& sheet = standard_input().sheet;
  const Matrix3Xd normals = geometry::vertex_normals(sheet);
  Loop worst;
  for (const Index vertex : inner_vertices()) {
    const Vector3d normal = normals.col(vertex), place = sheet.vertices.col(vertex);
    const Vector3d along = kSide * normal.cross(Vector3d::UnitY()).normalized();
    const Vector3d across = kSide * normal.cross(along).normalized();
    const Vector3d inside = place - kPressed * normal;
    const Loop loop = go_around(playback, {place + kHeight * normal, inside, inside + along,
                                           inside + across, inside, place + kHeight * normal});
    worst.residual = std::max(worst.residual, loop.residual);
    worst.returned = std::max(worst.returned, loop.returned);
  }
  return worst;
}

std::vector<Setting> tolerance_of_playback() {
  const haptics::Model model = model_of(standard_input());
  std::vector<Setting> found;
  constexpr double kUnlimited = std::numeric_limits<double>::infinity();
  for (const double tolerance : {1e-6, 1e-4, 1e-3, 1e-2}) {
    const haptics::Playback playback(
        model, {.tolerance = tolerance, .energy_credit = kUnlimited, .largest_jump = kUnlimited});
    found.push_back(
        {.knob = tolerance, .stated = tolerance, .actual = worst_loop(playback).residual});
  }
  return found;
}

std::vector<Setting> energy_credit_of_playback() {
  haptics::Model model = model_of(standard_input());
  for (haptics::ContactModel& contact : model.contacts) contact.friction = 0;
  // The object may also return what it stores during the movement of a tick.
  double stiffness = 0;  // [N/mm]
  for (const haptics::ContactModel& contact : model.contacts) {
    double largest = 0;
    for (const haptics::Multiquadric& base : contact.field.bases)
      largest += base.weight / base.epsilon;
    stiffness = std::max(stiffness, largest);
  }
  const double way = std::numbers::sqrt2 * kSide / kTicks;
  const double of_a_tick = stiffness * way * way / 2;
  std::vector<Setting> found;
  for (const double credit : {0.0, 1e-3, 1e-2, 1.0}) {
    const haptics::Playback playback(model, {.energy_credit = credit});
    found.push_back(
        {.knob = credit, .stated = credit + of_a_tick, .actual = worst_loop(playback).returned});
  }
  return found;
}

std::vector<Setting> error_of_a_reduced_model() {
  const haptics::Model model = model_of(standard_input());
  constexpr int kPresses = 150;
  const Matrix3Xd before = forces_of_presses(model, kPresses);
  std::vector<Setting> found;
  for (const double error : {0.01, 0.05, 0.2}) {
    const haptics::ReducedModel reduced = haptics::reduce_model(
        model, {.max_error = error, .max_surface_error = 0.5, .largest_depth = 3, .strokes = 300});
    const Matrix3Xd difference = forces_of_presses(reduced.model, kPresses) - before;
    found.push_back({.knob = error,
                     .cost = reduced.size_after,
                     .stated = reduced.allowed,
                     .actual = std::sqrt(difference.colwise().squaredNorm().mean())});
  }
  return found;
}

const std::vector<Trade>& trades() {
  // Covers are measured by fast marching, with errors of some tenths of a percent.
  constexpr double kFastMarching = 1.01;
  static const std::vector<Trade> all = {
      {"decimate: tolerance", "mm", "triangles", "dense points of both surfaces",
       [] {
         return decimation({{.tolerance = 1}, {.tolerance = 2}, {.tolerance = 4}});
       }},
      {"decimate: max_triangles", "mm", "triangles", "dense points of both surfaces",
       [] {
         return decimation({{.max_triangles = 300}, {.max_triangles = 100}, {.max_triangles = 30}});
       }},
      {"hausdorff_distance: max_gap", "mm", "", "dense points of both surfaces",
       gap_of_hausdorff_distance},
      {"winding_numbers: tolerance", "", "", "the sum of solid angles", tolerance_of_winding},
      {"poisson_sample: min_distance", "mm", "points", "each point of the cloud",
       spacing_of_poisson_samples},
      {"voxel_sample: edge", "mm", "points", "each point of the cloud", edge_of_voxels},
      {"farthest_points: count", "mm", "points", "exact geodesics", number_of_farthest_points,
       kFastMarching},
      {"fit_force_field: max_bases", "N", "bases", "the forces of the field", bases_of_a_field},
      {"reduce_model: max_error", "N", "bytes", "the full model, at random presses",
       error_of_a_reduced_model},
      {"Playback: tolerance", "N", "", "the friction cone, at the ends of slips",
       tolerance_of_playback},
      {"Playback: energy_credit", "N mm", "", "the work on a tool that slides around triangles",
       energy_credit_of_playback}};
  return all;
}

void PrintTo(const Trade& trade, std::ostream* stream) { *stream << trade.knob; }

/// Adds a row to the table of docs/extremes.md, if one is asked for.
void tell(const Trade& trade, const std::vector<Setting>& settings) {
  const char* const table = std::getenv("PALPATE_EXTREMES_TABLE");
  if (table == nullptr) return;
  const auto list = [&](double Setting::*member) {
    std::string text;
    for (const Setting& setting : settings)
      text += fmt::format("{}{:.3g}", text.empty() ? "" : ", ", setting.*member);
    return text;
  };
  const std::string cost =
      trade.cost.empty() ? "" : fmt::format("{} {}", list(&Setting::cost), trade.cost);
  std::ofstream(table, std::ios::app)
      << trade.knob << "\ttrade\t"
      << fmt::format("{} | {} | {}{}{} | {} | {}\n", list(&Setting::knob), cost,
                     list(&Setting::stated), trade.unit.empty() ? "" : " ", trade.unit,
                     list(&Setting::actual), trade.reference);
}

class StatedTrade : public ::testing::TestWithParam<Trade> {};

TEST_P(StatedTrade, ACheaperResultIsNotWorseThanItStates) {
  const Trade& trade = GetParam();
  const std::vector<Setting> settings = trade.turn();
  constexpr double kTradeRounding = 1e-9;
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const Setting& now = settings[i];
    EXPECT_LE(now.actual, trade.over * now.stated * (1 + kTradeRounding) + kTradeRounding)
        << now.knob;
    if (i == 0) continue;
    EXPECT_GE(now.stated, settings[i - 1].stated) << now.knob;
    EXPECT_LE(now.cost, settings[i - 1].cost) << now.knob;
  }
  if (!trade.cost.empty()) {
    EXPECT_LT(settings.back().cost, settings.front().cost);
  }
  tell(trade, settings);
}

INSTANTIATE_TEST_SUITE_P(All, StatedTrade, ::testing::ValuesIn(trades()),
                         [](const auto& one) { return test_name({.name = one.param.knob}); });

}  // namespace
}  // namespace palpate::extremes
