// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/quasi_static_arm.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "palpate/core/require.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/probing/specimen_response.h"
#include "records/record_hash.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr double kSlideStep = 0.1;    // [mm]
constexpr double kTouchReach = 5;     // [mm] beyond its target an approach ends without a touch
constexpr double kRestingTime = 0.5;  // [s] over which the tip's speed is judged

void check_arm_options(const QuasiStaticArmOptions& o) {
  require("QuasiStaticArmOptions::position_noise", o.position_noise, at_least(0).finite(), "mm");
  require("QuasiStaticArmOptions::position_quantum", o.position_quantum, at_least(0).finite(),
          "mm");
  require("QuasiStaticArmOptions::force_noise", o.force_noise, at_least(0).finite(), "N");
  require("QuasiStaticArmOptions::location_noise", o.location_noise, at_least(0).finite(), "mm");
  require("QuasiStaticArmOptions::touch_noise", o.touch_noise, at_least(0).finite(), "mm");
  require("QuasiStaticArmOptions::kinetic_friction", o.kinetic_friction, above(0).at_most(1));
  require("QuasiStaticArmOptions::tip_compliance", o.tip_compliance, at_least(0).finite(), "mm/N");
  require("QuasiStaticArmOptions::longest_slide", o.longest_slide, above(0).finite(), "mm");
  require("QuasiStaticArmOptions::time_constant", o.time_constant, above(0).finite(), "s");
  require("QuasiStaticArmOptions::settled_speed", o.settled_speed, above(0).finite(), "mm/s");
  require("QuasiStaticArmOptions::speed", o.speed, above(0).finite(), "mm/s");
  require("QuasiStaticArmOptions::touch_seconds", o.touch_seconds, at_least(0).finite(), "s");
  for (const double coordinate : o.start)
    require("QuasiStaticArmOptions::start", coordinate, finite(), "mm");
}

class QuasiStaticArm : public Prober {
 public:
  QuasiStaticArm(std::shared_ptr<const Specimen> specimen, const QuasiStaticArmOptions& options)
      : specimen_(std::move(specimen)),
        options_(options),
        query_(specimen_->surface()),
        normals_(geometry::triangle_normals(specimen_->surface())),
        retardation_(specimen_->retardation()),
        tip_(options.start) {}

  ProbeReport perform(const ProbeAction& action) override {
    switch (action.kind) {
      case ProbeActionKind::travel:
      case ProbeActionKind::lift:
        return move(action);
      case ProbeActionKind::touch:
        return touch(action);
      case ProbeActionKind::press:
      case ProbeActionKind::drag:
      case ProbeActionKind::release:
        return apply(action);
    }
    return {};
  }

 private:
  /// Standard normal numbers that belong to one action.
  Vector3d noise(const ProbeAction& action, int which) const {
    Vector3d result;
    for (int i = 0; i < 3; ++i) {
      RecordHash hash(options_.seed);
      hash.add(action.trial);
      hash.add(static_cast<std::uint64_t>(action.kind));
      hash.add(static_cast<std::uint64_t>(3 * which + i));
      const double radius = std::sqrt(-2 * std::log(hash.uniform()));
      hash.add(std::uint64_t{1});
      result[i] = radius * std::cos(2 * std::numbers::pi * hash.uniform());
    }
    return result;
  }

  Vector3d measured(const ProbeAction& action, const Vector3d& position) const {
    Vector3d noisy = position + options_.position_noise * noise(action, 0);
    if (options_.position_quantum == 0) return noisy;
    return options_.position_quantum * (noisy / options_.position_quantum).array().round();
  }

  ProbeReport move(const ProbeAction& action) {
    const double seconds = (action.target - tip_).norm() / options_.speed;
    tip_ = action.target;
    return {ProbeOutcome::done, measured(action, tip_), seconds};
  }

  ProbeReport touch(const ProbeAction& action) {
    const geometry::ClosestPoint aimed = query_.closest_point(action.target);
    if (!(aimed.distance <= kTouchReach)) {
      tip_ = action.target;
      return {ProbeOutcome::no_contact, measured(action, tip_), options_.touch_seconds};
    }
    const Vector3d normal = normals_.col(aimed.at.triangle);
    Vector3d beside = options_.location_noise * noise(action, 1);
    beside -= normal * normal.dot(beside);
    place_ = query_.closest_point(aimed.position + beside).position;
    steady_error_ = options_.force_noise / std::numbers::sqrt2 * noise(action, 2);
    microslip_.setZero();
    late_.setZero();
    tip_ = place_;
    const Vector3d noticed = place_ + options_.touch_noise * noise(action, 3).x() * normal;
    return {ProbeOutcome::done, measured(action, noticed), options_.touch_seconds};
  }

  ProbeReport apply(const ProbeAction& action) {
    const Vector3d force = action.force + steady_error_ +
                           options_.force_noise / std::numbers::sqrt2 * noise(action, 1);
    const bool slid = !sticks(specimen_->friction_cone(place_), force, 1);
    if (slid) {
      microslip_.setZero();
      if (!slide(force)) return {ProbeOutcome::fell_off, measured(action, tip_), kRestingTime};
    } else if (action.kind == ProbeActionKind::drag) {
      microslip_ = microslip_after(force);
    }
    std::string reason;
    const std::optional<Vector3d> displacement = response_of(*specimen_, place_, force, reason);
    if (!displacement) {
      ProbeReport report{ProbeOutcome::unsettled, measured(action, tip_), action.time_limit};
      report.reason = std::move(reason);
      return report;
    }
    Vector3d rest = place_ + *displacement;
    if (action.kind == ProbeActionKind::release) rest += microslip_;
    ProbeReport report = settle(action, rest, retardation_.share * *displacement - late_);
    report.truth = {.contact = place_, .force = force, .tip = tip_};
    return report;
  }

  static bool sticks(const FrictionCone& cone, const Vector3d& force, double part) {
    const double along = force.dot(cone.axis);
    return (force - along * cone.axis).norm() <= part * cone.coefficient * along;
  }

  /// Slides until kinetic friction holds the tip. False if it does not.
  bool slide(const Vector3d& force) {
    for (double slid = 0; slid < options_.longest_slide; slid += kSlideStep) {
      const FrictionCone cone = specimen_->friction_cone(place_);
      const Vector3d across = force - force.dot(cone.axis) * cone.axis;
      const Vector3d next =
          query_.closest_point(place_ + kSlideStep * across.normalized()).position;
      const bool at_edge = (next - place_).norm() < kSlideStep / 2;
      place_ = next;
      tip_ = place_;
      if (at_edge || force.dot(cone.axis) <= 0) return false;
      if (sticks(specimen_->friction_cone(place_), force, options_.kinetic_friction)) return true;
    }
    return false;
  }

  /// Motion of the contact that remains after the tangential part of `force` is released.
  Vector3d microslip_after(const Vector3d& force) const {
    const FrictionCone cone = specimen_->friction_cone(place_);
    const double normal = force.dot(cone.axis);
    const Vector3d across = force - normal * cone.axis;
    const double limit = cone.coefficient * normal;
    if (!(limit > 0) || across.norm() == 0) return Vector3d::Zero();
    const double part = std::min(across.norm() / limit, 1.0);
    const double share = 2 * std::pow(1 - part / 2, 2.0 / 3) - std::pow(1 - part, 2.0 / 3) - 1;
    return 1.5 * options_.tip_compliance * limit * share * across.normalized();
  }

  /// \param lagging [mm] motion of the object's retarded part.
  ProbeReport settle(const ProbeAction& action, const Vector3d& rest, const Vector3d& lagging) {
    const Vector3d from = tip_, way = tip_ - (rest - lagging);
    double moving = std::max(time_to_settle(way.norm(), options_.time_constant),
                             time_to_settle(lagging.norm(), retardation_.time));
    const bool unsettled = kRestingTime + moving > action.time_limit;
    if (unsettled) moving = std::max(action.time_limit - kRestingTime, 0.0);
    const Vector3d left = std::exp(-moving / retardation_.time) * lagging;
    late_ += lagging - left;
    tip_ = rest - left + std::exp(-moving / options_.time_constant) * way;
    ProbeReport report{unsettled ? ProbeOutcome::unsettled : ProbeOutcome::done,
                       measured(action, tip_),
                       unsettled ? action.time_limit : kRestingTime + moving};
    if (tip_ != from) report.creep = (lagging - left).norm() / (tip_ - from).norm();
    return report;
  }

  /// [s] until what is `left` [mm] moves at the speed of rest.
  double time_to_settle(double left, double time_constant) const {
    const double slowest = time_constant * options_.settled_speed;
    return left > slowest ? time_constant * std::log(left / slowest) : 0;
  }

  std::shared_ptr<const Specimen> specimen_;
  QuasiStaticArmOptions options_;
  geometry::SurfaceQuery query_;
  Eigen::Matrix3Xd normals_;
  Retardation retardation_;
  Vector3d tip_;                              // [mm]
  Vector3d place_ = Vector3d::Zero();         // [mm] of the contact on the undeformed surface
  Vector3d steady_error_ = Vector3d::Zero();  // [N] of this trial
  Vector3d microslip_ = Vector3d::Zero();     // [mm]
  Vector3d late_ = Vector3d::Zero();          // [mm] the object's retarded displacement
};

}  // namespace

std::unique_ptr<Prober> make_quasi_static_arm(std::shared_ptr<const Specimen> specimen,
                                              const QuasiStaticArmOptions& options) {
  check_arm_options(options);
  return std::make_unique<QuasiStaticArm>(std::move(specimen), options);
}

}  // namespace palpate::probing
