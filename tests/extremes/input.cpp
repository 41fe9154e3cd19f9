// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "input.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <random>

#include "../sensing/synthetic_scene.h"
#include "boards.h"
#include "palpate/haptics/force_field.h"
#include "test_surfaces.h"

namespace palpate::extremes {
namespace {

using Eigen::Vector3d;
using geometry::TriangleMesh;

/// Places of coordinates [mm]: with them, numbers up to 2^36 mm away are exact.
constexpr double kGrid = 0x1p-10;
/// [mm] of the sheet's cells.
constexpr double kCell = 6;
constexpr int kColumns = 14, kRows = 10;

template <typename Matrix>
void snap(Matrix& coordinates) {
  for (double& x : coordinates.reshaped()) x = std::round(x / kGrid) * kGrid;
}

double height(double x, double y) {
  return 6 * std::exp(-((x - 50) * (x - 50) + (y - 36) * (y - 36)) / 400) +
         1.5 * std::sin(x / 9 + 0.3) * std::cos(y / 11);
}

TriangleMesh make_sheet(int extent) {
  const int columns = kColumns * extent;
  TriangleMesh sheet = geometry::test::height_field(columns, kRows * extent, kCell, height);
  snap(sheet.vertices);
  // A hole of two cells beside the middle. All vertices keep a triangle.
  constexpr int kMissing = 4;
  const int hole = 2 * (3 * columns + 3);
  const Eigen::Matrix3Xi triangles = sheet.triangles;
  sheet.triangles.resize(3, triangles.cols() - kMissing);
  sheet.triangles << triangles.leftCols(hole),
      triangles.rightCols(triangles.cols() - hole - kMissing);
  return sheet;
}

TriangleMesh make_ball(int extent) {
  const int levels = 2 + std::countr_zero(static_cast<unsigned>(extent));
  TriangleMesh ball = geometry::test::icosphere(levels, 20 * extent);
  for (auto vertex : ball.vertices.colwise()) {
    const Vector3d d = vertex.normalized();
    vertex *= 1 + 0.15 * d.x() * d.y() + 0.1 * std::sin(3 * d.z() + 1) + 0.08 * d.x();
  }
  snap(ball.vertices);
  return ball;
}

/// Points in the triangles of a mesh, a little off it.
Eigen::Matrix3Xd points_near(const TriangleMesh& mesh, Eigen::Index count, double noise,
                             unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal(0, noise);
  Eigen::Matrix3Xd points(3, count);
  for (auto point : points.colwise()) {
    const auto triangle =
        static_cast<Eigen::Index>(unit(random) * static_cast<double>(mesh.triangles.cols()));
    const double root = std::sqrt(unit(random)), share = unit(random);
    const Vector3d weights(1 - root, root * (1 - share), root * share);
    const Eigen::Matrix3d corners = mesh.vertices(Eigen::all, mesh.triangles.col(triangle));
    point = corners * weights + Vector3d{normal(random), normal(random), normal(random)};
  }
  snap(points);
  return points;
}

/// A contact in the middle of a triangle below each of some cells, in order.
std::vector<geometry::SurfacePoint> make_contacts(const TriangleMesh& sheet, int columns, int rows,
                                                  int extent) {
  std::vector<geometry::SurfacePoint> contacts;
  Eigen::Matrix2Xd middles(2, sheet.triangles.cols());
  for (Eigen::Index t = 0; t < sheet.triangles.cols(); ++t)
    middles.col(t) =
        sheet.vertices(Eigen::all, sheet.triangles.col(t)).rowwise().mean().template head<2>();
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double x = kCell * kColumns * extent * (column + 0.6) / columns;
      const double y = kCell * kRows * extent * (row + 0.55) / rows;
      // The triangle whose middle is nearest: the hole has none.
      Eigen::Index best = 0;
      double least = 1e9;
      for (Eigen::Index t = 0; t < sheet.triangles.cols(); ++t) {
        const double distance = std::hypot(middles(0, t) - x, middles(1, t) - y);
        if (distance >= least) continue;
        least = distance;
        best = t;
      }
      contacts.push_back({static_cast<int>(best), {0.25, 0.5, 0.25}});
    }
  }
  return contacts;
}

/// The object that was measured: stiffens, and gives way more along the surface. [mm] of [N], z
/// along the pressing direction.
Vector3d displacement_of(const Vector3d& force, double stiffness) {
  const Vector3d soft(1.6, 1.4, 1);
  const Vector3d linear = force.cwiseProduct(soft) / stiffness;
  return linear / std::sqrt(1 + 0.15 * linear.squaredNorm());
}

/// Columns are x, y and the direction in which a contact is pressed.
Eigen::Matrix3d pressing_frame(const Vector3d& normal) {
  Eigen::Matrix3d frame;
  frame.col(2) = -normal;
  frame.col(0) = Vector3d::UnitY().cross(frame.col(2)).normalized();
  frame.col(1) = frame.col(2).cross(frame.col(0));
  return frame;
}

constexpr double kFriction = 0.6;
/// As many contacts are of different stiffness; then they begin again.
constexpr std::size_t kStiffnesses = 12;

/// Presses and drags at each contact; the strongest drag of a direction slips.
probing::Acquisition make_acquisition(const TriangleMesh& sheet,
                                      const std::vector<geometry::SurfacePoint>& contacts,
                                      int levels, int directions) {
  probing::Acquisition acquisition;
  long long id = 0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Eigen::Matrix3d corners =
        sheet.vertices(Eigen::all, sheet.triangles.col(contacts[i].triangle));
    const Vector3d normal =
        (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)).normalized();
    const Vector3d position = corners * contacts[i].barycentric;
    const auto contact = static_cast<long long>(i);
    acquisition.contacts.push_back({contact, position, normal});
    const Eigen::Matrix3d frame = pressing_frame(normal);
    const double stiffness = 0.8 + 0.05 * static_cast<double>(i % kStiffnesses);
    long long group = 0;
    for (int level = 1; level <= levels; ++level) {
      for (int k = 0; k < directions; ++k, ++group) {
        const double angle = 2 * std::numbers::pi * (k + 0.3 * level) / directions;
        for (const double ratio : {0.0, 0.3, 0.55, 0.65}) {
          const double press = 3.0 * level / levels;
          const Vector3d force(press * ratio * std::cos(angle), press * ratio * std::sin(angle),
                               press);
          probing::Sample sample{.id = id++, .contact = contact, .group = group};
          sample.force = frame * force;
          sample.a = position + frame * displacement_of({0, 0, press}, stiffness);
          sample.b = position + frame * displacement_of(force, stiffness);
          sample.on_friction_boundary = ratio == 0.55;
          sample.slipped = ratio > kFriction;
          sample.time = static_cast<double>(id);
          acquisition.samples.push_back(sample);
        }
      }
    }
  }
  return acquisition;
}

std::vector<haptics::FrictionTrial> make_trials(int directions) {
  std::vector<haptics::FrictionTrial> trials;
  for (int k = 0; k < directions; ++k) {
    const double angle = 2 * std::numbers::pi * k / directions;
    for (const double press : {0.5, 1.0, 2.0}) {
      for (const double ratio : {0.2, 0.4, 0.56, 0.64, 0.8}) {
        const double drag = ratio * press;
        trials.push_back({{drag * std::cos(angle), drag * std::sin(angle), press},
                          ratio > kFriction + 0.03 * std::cos(angle)});
      }
    }
  }
  return trials;
}

/// Comes down onto the sheet, presses, drags, and leaves it.
std::vector<haptics::TrajectoryPoint> make_trajectory(int count) {
  std::vector<haptics::TrajectoryPoint> trajectory;
  for (int i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / count;
    const double x = 30 + 25 * share, y = 30 - 8 * share;
    const double depth = 3 - 12 * std::abs(share - 0.5);
    Vector3d tool(x, y, height(x, y) - depth);
    snap(tool);
    trajectory.push_back({1e-3 * i, tool});
  }
  return trajectory;
}

Input make_input(int columns, int rows, int levels, int directions, int extent = 1) {
  const int area = extent * extent;
  Input input;
  input.extent = extent;
  input.sheet = make_sheet(extent);
  input.ball = make_ball(extent);
  input.cloud = points_near(input.ball, 400 * area, 0.1, 1);
  input.places.resize(3, 60 * area);
  input.places << points_near(input.ball, 30 * area, 3, 2),
      points_near(input.sheet, 30 * area, 3, 3);
  input.contacts = make_contacts(input.sheet, columns * extent, rows * extent, extent);

  const haptics::ForceField field{
      {{3, 4, {0.3, -0.2, 0.5}}, {2, 6, {-0.4, 0.1, 0.2}, Vector3d(0.2, 0.1, 1).normalized()}}};
  input.displacements.resize(3, 36 * area);
  input.forces.resize(3, 36 * area);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (Eigen::Index i = 0; i < input.displacements.cols(); ++i) {
    Vector3d displacement{uniform(random), uniform(random), 2 + 2 * uniform(random)};
    snap(displacement);
    input.displacements.col(i) = displacement;
    input.forces.col(i) = haptics::force(field, displacement);
  }
  input.trials = make_trials(8 * area);
  input.acquisition = make_acquisition(input.sheet, input.contacts, levels, directions);
  input.trajectory = make_trajectory(200 * area);

  input.rig = sensing::make_rig(false);
  input.rig.camera.width = 160 * extent;
  input.rig.camera.height = 120 * extent;
  input.rig.camera.cx = 80 * extent - 0.5;
  input.rig.camera.cy = 60 * extent - 0.5;
  input.rig.camera.fx *= extent;
  input.rig.camera.fy *= extent;
  input.pattern = sensing::make_pattern(sensing::Axis::y, 10, 1024);
  input.colors = sensing::ideal_colors();
  input.frame = sensing::render(input.rig, input.pattern,
                                sensing::nearer(sensing::sphere({0, 0, 800}, 60),
                                                sensing::plane({0, 0.1, 1}, 860)))
                    .frame;
  constexpr double kTilt = 0.5;  // [rad]
  input.views = views_of_board(5 * extent, kTilt);
  return input;
}

/// A permutation, and its inverse's use: element i of `values` goes to place to[i].
std::vector<int> shuffled_places(std::size_t count, std::mt19937& random) {
  std::vector<int> to(count);
  std::iota(to.begin(), to.end(), 0);
  std::shuffle(to.begin(), to.end(), random);
  return to;
}

template <typename Value>
std::vector<Value> in_order(const std::vector<Value>& values, const std::vector<int>& to) {
  std::vector<Value> placed(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    placed[static_cast<std::size_t>(to[i])] = values[i];
  return placed;
}

template <typename Matrix>
Matrix columns_in_order(const Matrix& columns, const std::vector<int>& to) {
  Matrix placed(columns.rows(), columns.cols());
  for (Eigen::Index i = 0; i < columns.cols(); ++i)
    placed.col(to[static_cast<std::size_t>(i)]) = columns.col(i);
  return placed;
}

void reorder(TriangleMesh& mesh, const std::vector<int>& vertices,
             const std::vector<int>& triangles) {
  mesh.vertices = columns_in_order(mesh.vertices, vertices);
  for (int& corner : mesh.triangles.reshaped()) corner = vertices[static_cast<std::size_t>(corner)];
  mesh.triangles = columns_in_order(mesh.triangles, triangles);
}

}  // namespace

const Input& standard_input() {
  static const Input input = make_input(4, 3, 3, 4);
  return input;
}

const Input& small_input() {
  static const Input input = make_input(3, 2, 2, 3);
  return input;
}

const Input& wide_input(int extent) {
  static std::map<int, Input> made;
  const auto found = made.find(extent);
  if (found != made.end()) return found->second;
  return made.emplace(extent, make_input(4, 3, 3, 4, extent)).first->second;
}

Input scaled(Input input, double length, double force) {
  input.length *= length;
  input.force *= force;
  input.place.translation() *= length;
  for (Eigen::Matrix3Xd* points : {&input.sheet.vertices, &input.ball.vertices, &input.cloud,
                                   &input.places, &input.displacements})
    *points *= length;
  input.forces *= force;
  for (haptics::FrictionTrial& trial : input.trials) trial.force *= force;
  for (probing::Contact& contact : input.acquisition.contacts) contact.position *= length;
  for (probing::Sample& sample : input.acquisition.samples) {
    sample.force *= force;
    sample.a *= length;
    sample.b *= length;
  }
  for (haptics::TrajectoryPoint& point : input.trajectory) point.tool *= length;
  input.rig.T_projector_camera.translation() *= length;
  for (sensing::RigView& view : input.views) view.board *= length;
  return input;
}

Input moved(Input input, const Eigen::Isometry3d& motion) {
  input.place = motion * input.place;
  for (Eigen::Matrix3Xd* points :
       {&input.sheet.vertices, &input.ball.vertices, &input.cloud, &input.places})
    *points = motion * *points;
  for (probing::Contact& contact : input.acquisition.contacts) {
    contact.position = motion * contact.position;
    contact.normal = motion.linear() * contact.normal;
  }
  for (probing::Sample& sample : input.acquisition.samples) {
    sample.force = motion.linear() * sample.force;
    sample.a = motion * sample.a;
    sample.b = motion * sample.b;
  }
  for (haptics::TrajectoryPoint& point : input.trajectory) point.tool = motion * point.tool;
  return input;
}

Input reordered(Input input, unsigned seed) {
  std::mt19937 random(seed);
  const auto count = [](Eigen::Index columns) { return static_cast<std::size_t>(columns); };
  Order& order = input.order;
  order = {.sheet_vertices = shuffled_places(count(input.sheet.vertices.cols()), random),
           .sheet_triangles = shuffled_places(count(input.sheet.triangles.cols()), random),
           .ball_vertices = shuffled_places(count(input.ball.vertices.cols()), random),
           .ball_triangles = shuffled_places(count(input.ball.triangles.cols()), random),
           .cloud = shuffled_places(count(input.cloud.cols()), random),
           .places = shuffled_places(count(input.places.cols()), random),
           .contacts = shuffled_places(input.contacts.size(), random),
           .samples = shuffled_places(count(input.displacements.cols()), random)};
  reorder(input.sheet, order.sheet_vertices, order.sheet_triangles);
  reorder(input.ball, order.ball_vertices, order.ball_triangles);
  input.cloud = columns_in_order(input.cloud, order.cloud);
  input.places = columns_in_order(input.places, order.places);
  for (geometry::SurfacePoint& contact : input.contacts)
    contact.triangle = order.sheet_triangles[static_cast<std::size_t>(contact.triangle)];
  input.contacts = in_order(input.contacts, order.contacts);
  input.displacements = columns_in_order(input.displacements, order.samples);
  input.forces = columns_in_order(input.forces, order.samples);
  std::shuffle(input.trials.begin(), input.trials.end(), random);
  input.acquisition.contacts = in_order(input.acquisition.contacts, order.contacts);
  std::shuffle(input.acquisition.samples.begin(), input.acquisition.samples.end(), random);
  return input;
}

}  // namespace palpate::extremes
