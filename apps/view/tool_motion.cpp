// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "tool_motion.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace palpate::view {
namespace {

// The same as in the page of a model (web/page/tool.js).
constexpr double kGap = 0.006;         // diagonals above the surface where a press begins
constexpr double kFollow = 0.02;       // [s] in which the tool follows the pointer
constexpr double kTurn = 0.1;          // [s] in which its direction follows the surface
constexpr double kSink = 0.28;         // [s] in which it sinks in
constexpr double kLift = 0.05;         // [s] in which it is lifted
constexpr double kFastest = 0.004;     // diagonals a tick: a flick of the pointer stays a motion
constexpr double kFastestStep = 10;    // [mm] a tick: playback takes jumps for faults
constexpr double kSteepest = 0.12;     // cosine at which a ray no longer says where on a plane
constexpr double kReach = 0.12;        // diagonals from its plane in which the surface is followed
constexpr double kShallowest = 0.002;  // diagonals
constexpr double kDeepest = 0.16;
constexpr double kFirstDepth = 0.05;
constexpr double kTick = 1e-3;  // [s]

double fraction(double time) { return 1 - std::exp(-kTick / time); }

}  // namespace

std::optional<PickedPlace> pick(const geometry::SurfaceQuery& query,
                                const geometry::TriangleMesh& surface, const geometry::Ray& ray) {
  const std::optional<geometry::RayHit> hit = query.first_hit(ray);
  if (!hit) return std::nullopt;
  const Eigen::Vector3i corners = surface.triangles.col(hit->at.triangle);
  const Eigen::Vector3d a = surface.vertices.col(corners[0]);
  const Eigen::Vector3d normal =
      (surface.vertices.col(corners[1]) - a).cross(surface.vertices.col(corners[2]) - a);
  if (!(normal.dot(ray.direction) < 0)) return std::nullopt;
  return PickedPlace{.position = hit->position, .normal = normal.normalized()};
}

ToolAim::ToolAim(double diagonal) : diagonal_(diagonal) { wish_.depth = kFirstDepth * diagonal; }

double ToolAim::shallowest() const { return kShallowest * diagonal_; }
double ToolAim::deepest() const { return kDeepest * diagonal_; }

void ToolAim::set_depth(double depth) { wish_.depth = std::clamp(depth, shallowest(), deepest()); }

void ToolAim::press(const PickedPlace& place) {
  ++wish_.presses;
  wish_.pressed = true;
  wish_.at = place;
}

void ToolAim::drag(const geometry::Ray& ray, const geometry::SurfaceQuery& query,
                   const geometry::TriangleMesh& surface) {
  if (!wish_.pressed) return;
  const Eigen::Vector3d normal = wish_.at.normal;
  const double slant = ray.direction.dot(normal);
  if (slant > -kSteepest) return;
  const Eigen::Vector3d on_plane =
      ray.origin + ray.direction * ((wish_.at.position - ray.origin).dot(normal) / slant);
  const double reach = kReach * diagonal_;
  const std::optional<PickedPlace> hit =
      pick(query, surface, {.origin = on_plane + reach * normal, .direction = -normal});
  const bool near = hit && (hit->position - on_plane).norm() < 2 * reach;
  wish_.at = near ? *hit : PickedPlace{on_plane, normal};
}

ToolMotion::ToolMotion(double diagonal, const Eigen::Vector3d& aside)
    : diagonal_(diagonal), gap_(kGap * diagonal), aside_(aside) {}

void ToolMotion::begin(const ToolWish& wish) noexcept {
  presses_ = wish.presses;
  at_ = wish.at;
  sunk_ = -gap_;
  waited_ = 0;
  mode_ = Mode::wait;
}

Eigen::Vector3d ToolMotion::tick(const ToolWish& wish) noexcept {
  // A press that was let go before its first tick is none.
  if (mode_ == Mode::aside && wish.presses != presses_) {
    if (wish.pressed) {
      begin(wish);
    } else {
      presses_ = wish.presses;
    }
  }
  if (mode_ == Mode::wait && ++waited_ > kWaitingTicks) mode_ = Mode::press;
  // A press that began while the last one is lifted waits until it is lifted.
  if (mode_ == Mode::press && (!wish.pressed || wish.presses != presses_)) mode_ = Mode::lift;
  if (mode_ == Mode::press) {
    const Eigen::Vector3d way = (wish.at.position - at_.position) * fraction(kFollow);
    const double most = std::min(kFastest * diagonal_, kFastestStep);
    const double length = way.norm();
    at_.position += length > most ? Eigen::Vector3d(way * (most / length)) : way;
    const Eigen::Vector3d turned = at_.normal + (wish.at.normal - at_.normal) * fraction(kTurn);
    if (turned.squaredNorm() > 0) at_.normal = turned.normalized();
    sunk_ += (wish.depth - sunk_) * fraction(kSink);
  }
  if (mode_ == Mode::lift) {
    sunk_ += (-2 * gap_ - sunk_) * fraction(kLift);
    if (sunk_ < -gap_) mode_ = Mode::aside;
  }
  return mode_ == Mode::aside ? aside_ : Eigen::Vector3d(at_.position - sunk_ * at_.normal);
}

}  // namespace palpate::view
