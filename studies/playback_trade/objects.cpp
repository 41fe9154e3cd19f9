// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "objects.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hand_model.h"
#include "height_field_model.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/haptics/build_model.h"
#include "palpate/probing/acquisition_csv.h"
#include "repository.h"
#include "sphere_model.h"

namespace palpate::bench {
namespace {

using Eigen::Vector3d;

haptics::Model with_friction(haptics::Model model, double friction) {
  for (haptics::ContactModel& contact : model.contacts) contact.friction = friction;
  return model;
}

/// Fitted once: that takes seconds.
const haptics::Model& fitted(bool block) {
  const auto fit = [](const char* name) {
    const std::filesystem::path folder = repository("demo") / name;
    return haptics::build_model(
               probing::read_acquisition_csv(folder / "contacts.csv", folder / "samples.csv"),
               geometry::read_mesh(folder / "surface.ply"))
        .model;
  };
  static const haptics::Model plain = fit("sheet"), with_block = fit("sheet_block");
  return block ? with_block : plain;
}

TouchedObject ball(double friction) {
  const auto whole = [](const Vector3d&) { return true; };
  return {"ball",
          haptics::with_compliances(
              with_friction(haptics::ball_model(whole, haptics::uneven_twist), friction), 1)};
}

}  // namespace

TouchedObject::TouchedObject(std::string n, haptics::Model m)
    : name(std::move(n)),
      model(std::move(m)),
      query(model.surface),
      normals_(geometry::triangle_normals(model.surface)) {
  for (const std::vector<int>& loop : geometry::boundary_loops(model.surface)) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      border_.emplace_back(model.surface.vertices.col(loop[i]),
                           model.surface.vertices.col(loop[(i + 1) % loop.size()]));
    }
  }
}

double TouchedObject::to_border(const Vector3d& place) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& [a, b] : border_) {
    const double along = std::clamp((place - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (a + along * (b - a) - place).norm());
  }
  return nearest;
}

Vector3d TouchedObject::some_vertex(std::mt19937& random) const {
  return model.surface.vertices.col(
      static_cast<Eigen::Index>(random() % static_cast<unsigned>(model.surface.vertices.cols())));
}

TouchedObject hills(double friction) {
  const auto height = [](double x, double y) {
    return 6 * std::sin(x / 12.7) * std::cos(y / 9.5) + std::sin((x + 0.6 * y) / 4);
  };
  return {"hills", haptics::height_field_model({.height = height,
                                                .friction = friction,
                                                .uneven = true,
                                                .half_size = 100,
                                                .cells = 100,
                                                .grid = 10})};
}

TouchedObject waves(double friction) {
  return {"waves", haptics::height_field_model(
                       {.height = haptics::waves, .friction = friction, .uneven = true})};
}

TouchedObject sheet(bool block, double friction) {
  return {block ? "sheet with block" : "sheet", with_friction(fitted(block), friction)};
}

TouchedObject hand(double friction) {
  return {"hand", haptics::hand_model([&](int) { return friction; })};
}

std::vector<TouchedObject> touched_objects(double friction) {
  std::vector<TouchedObject> all;
  all.push_back(hills(friction));
  all.push_back(sheet(false, friction));
  all.push_back(sheet(true, friction));
  all.push_back(ball(friction));
  all.push_back(hand(friction));
  return all;
}

std::vector<Vector3d> wander(const TouchedObject& object, int ticks, unsigned seed,
                             double (*depth)(double time)) {
  constexpr double kFoot = 0.1, kTool = 0.15;  // [mm] in a tick
  constexpr int kGoal = 700;                   // ticks until another goal
  constexpr double kReached = 2;               // [mm]
  std::mt19937 random(seed);
  Vector3d goal = object.some_vertex(random);
  geometry::ClosestPoint foot = object.query.closest_point(object.some_vertex(random));
  std::vector<Vector3d> path = {foot.position + 2 * object.normal(foot.at.triangle)};
  for (int tick = 1; tick < ticks; ++tick) {
    if ((foot.position - goal).norm() < kReached || tick % kGoal == 0) {
      goal = object.some_vertex(random);
    }
    foot = object.query.closest_point(foot.position + kFoot * (goal - foot.position).normalized());
    const Vector3d to =
        foot.position - depth(1e-3 * tick) * object.normal(foot.at.triangle) - path.back();
    path.push_back(path.back() + std::min(1.0, kTool / to.norm()) * to);
  }
  return path;
}

}  // namespace palpate::bench
