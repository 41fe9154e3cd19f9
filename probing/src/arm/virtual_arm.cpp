// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/virtual_arm.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "palpate/error.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/require.h"

// Units: mm, N, s, and so masses in N s^2/mm (1000 kg) and inertias in N mm s^2 (1000 kg mm^2).
namespace palpate::probing {
namespace {

constexpr double kPeriod = 1e-3;    // [s] of the states
constexpr int kSteps = 10;          // of the dynamics in a period
constexpr double kKilogram = 1e-3;  // [N s^2/mm]

std::uint64_t mix(std::uint64_t value) {  // splitmix64 (Steele, Lea and Flood 2014)
  value += 0x9E3779B97F4A7C15u;
  value = (value ^ (value >> 30)) * 0xBF58476D1CE4E5B9u;
  value = (value ^ (value >> 27)) * 0x94D049BB133111EBu;
  return value ^ (value >> 31);
}

/// Three normally distributed numbers, a function of the arguments alone.
Eigen::Vector3d normal_numbers(std::uint64_t seed, std::uint64_t sample, std::uint64_t tick,
                               std::uint64_t channel) {
  std::uint64_t state = mix(mix(mix(mix(seed) ^ sample) ^ tick) ^ channel);
  const auto uniform = [&] {
    state = mix(state);
    return (static_cast<double>(state >> 11) + 0.5) * 0x1p-53;
  };
  const auto pair = [&] {
    const double radius = std::sqrt(-2 * std::log(uniform()));
    const double angle = 2 * std::numbers::pi * uniform();
    return Eigen::Vector2d(radius * std::cos(angle), radius * std::sin(angle));
  };
  const Eigen::Vector2d first = pair(), second = pair();
  return {first.x(), first.y(), second.x()};
}

/// Deflection of a joint's friction after a motion. Dahl's model, but elastic below a breakaway
/// deflection and for motion against the deflection, so that vibrations do not make a joint at rest
/// creep (Dupont, Hayward, Armstrong and Altpeter 2002).
double bristle_after(double bristle, double way, double presliding) {
  constexpr double kBreakaway = 0.8;  // of the deflection when sliding
  const double share = std::abs(bristle) / presliding;
  const double plastic =
      way * bristle > 0 ? std::clamp((share - kBreakaway) / (1 - kBreakaway), 0.0, 1.0) : 0.0;
  const double after = bristle + way * (1 - plastic * share);
  return std::clamp(after, -presliding, presliding);
}

/// Inertia and torques of the links that do not depend on the command.
struct LinkDynamics {
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();  // [N mm s^2]
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();     // [N mm] inertial and gravity torques
};

/// Lagrange's equations of two point masses and three rotors. The mass of the lower link turns
/// about the elbow.
LinkDynamics link_dynamics(const VirtualArmOptions& o, const Eigen::Vector3d& q,
                           const Eigen::Vector3d& v) {
  const double m1 = o.upper_mass * kKilogram, m2 = o.lower_mass * kKilogram;
  const double l1 = o.geometry.upper, a1 = l1 / 2, a2 = o.geometry.lower / 2;
  const double s0 = std::sin(q[0]), c0 = std::cos(q[0]), s1 = std::sin(q[1]), c1 = std::cos(q[1]);
  const double s1u = std::sin(q[1] + o.upper_angle), c1u = std::cos(q[1] + o.upper_angle);
  const double s2 = std::sin(q[2] + o.lower_angle), c2 = std::cos(q[2] + o.lower_angle);
  const double r1 = a1 * c1u, r2 = l1 * c1 + a2 * s2;  // [mm] radii of the masses
  const double m12 = m2 * l1 * a2 * (c1 * s2 - s1 * c2);
  const double m12_q1 = -m2 * l1 * a2 * (s1 * s2 + c1 * c2), m12_q2 = -m12_q1;
  const double m00_q1 = 2 * (m1 * r1 * -a1 * s1u + m2 * r2 * -l1 * s1);
  const double m00_q2 = 2 * m2 * r2 * a2 * c2;
  LinkDynamics d;
  d.inertia.diagonal() = o.rotor * kKilogram;
  d.inertia(0, 0) += m1 * r1 * r1 + m2 * r2 * r2;
  d.inertia(1, 1) += m1 * a1 * a1 + m2 * l1 * l1;
  d.inertia(2, 2) += m2 * a2 * a2;
  d.inertia(1, 2) = d.inertia(2, 1) = m12;
  d.bias << (m00_q1 * v[1] + m00_q2 * v[2]) * v[0], m12_q2 * v[2] * v[2] - m00_q1 * v[0] * v[0] / 2,
      m12_q1 * v[1] * v[1] - m00_q2 * v[0] * v[0] / 2;
  const Eigen::Vector3d& g = o.gravity;
  const double outwards = g.x() * s0 + g.z() * c0;
  d.bias -= Eigen::Vector3d(
      (m1 * r1 + m2 * r2) * (g.x() * c0 - g.z() * s0),
      m1 * (-outwards * a1 * s1u + g.y() * a1 * c1u) + m2 * (-outwards * l1 * s1 + g.y() * l1 * c1),
      m2 * (outwards * a2 * c2 + g.y() * a2 * s2));
  return d;
}

}  // namespace

/// The arm with its tip on the object. The object's displacement is linearised about the latest
/// force at which it was computed; its slope is updated by Powell's symmetric formula.
struct VirtualArm::Simulation {
  Simulation(const Specimen* object, const VirtualArmOptions& o) : options(o), specimen(object) {
    require("VirtualArmOptions::upper_mass", o.upper_mass, above(0).finite(), "kg");
    require("VirtualArmOptions::lower_mass", o.lower_mass, above(0).finite(), "kg");
    require("VirtualArmOptions::rotor", o.rotor.minCoeff(), above(0).finite(), "kg mm^2");
    require("VirtualArmOptions::friction", o.friction.minCoeff(), at_least(0).finite(), "N mm");
    require("VirtualArmOptions::presliding", o.presliding, above(0).finite(), "rad");
    require("VirtualArmOptions::encoder_step", o.encoder_step, above(0).finite(), "rad");
    require("VirtualArmOptions::structure", o.structure, above(0).finite(), "N/mm");
    require("VirtualArmOptions::highest_torque", o.highest_torque, above(0).finite(), "N mm");
    require("VirtualArmOptions::continuous_torque", o.continuous_torque, above(0).finite(), "N mm");
    require("VirtualArmOptions::heating_time", o.heating_time, above(0).finite(), "s");
    q = o.joints;
    T_base_world = o.T_world_base.inverse();
    gain = Eigen::Vector3d::Ones() + o.torque_gain_error * normal_numbers(o.seed, 0, 0, 2);
    if (object != nullptr) {
      query.emplace(object->surface());
      normals = geometry::vertex_normals(object->surface());
      retardation = object->retardation();
      prompt = 1 - retardation.share;
    }
    const double reach = std::max(o.geometry.upper, o.geometry.lower);
    description = {.name = "virtual arm",
                   .period = kPeriod,
                   .highest_force = o.highest_torque / reach,
                   .continuous_force = o.continuous_torque / reach,
                   .measures_joints = true,
                   .measures_force = true,
                   .measures_heat = true,
                   .measures_reference = true,
                   .real_time = false};
    truth.tip = tip_position(o.geometry, q);
  }

  /// The measured joints.
  [[nodiscard]] Eigen::Vector3d encoders() const {
    return options.encoder_step * (q / options.encoder_step).array().round();
  }

  void tick() {
    time = static_cast<double>(++ticks) * kPeriod;
    const bool leased = active && time <= lease_end;
    const Eigen::Matrix3d jacobian = arm_jacobian(options.geometry, encoders());
    torque = leased ? Eigen::Vector3d(jacobian.transpose() * force)
                    : Eigen::Vector3d(Eigen::Vector3d::Zero());
    for (int i = 0; i < 3; ++i) {
      if (resting[static_cast<std::size_t>(i)]) torque[i] = 0;
      torque[i] = std::clamp(torque[i], -options.highest_torque, options.highest_torque);
      const double load = torque[i] / options.continuous_torque;
      heat[i] += kPeriod / options.heating_time * (load * load - heat[i]);
      if (heat[i] >= 1) resting[static_cast<std::size_t>(i)] = true;
      if (heat[i] < 0.5) resting[static_cast<std::size_t>(i)] = false;
    }
    const std::uint64_t sample_tick = ticks - sample_begin;
    Eigen::Vector3d motor = gain.cwiseProduct(torque);
    if (active) {
      motor += options.torque_noise * normal_numbers(options.seed, sample, sample_tick, 0);
    }
    if (query) find_surface();
    for (int step = 0; step < kSteps; ++step) move(motor, kPeriod / kSteps);
    if (truth.in_contact) {
      refresh();
      creep();
    }
    delivered = arm_jacobian(options.geometry, q).transpose().lu().solve(torque) +
                options.force_noise * normal_numbers(options.seed, sample, sample_tick, 1);
  }

  void move(const Eigen::Vector3d& motor, double dt) {
    const LinkDynamics links = link_dynamics(options, q, v);
    const Eigen::Matrix3d jacobian = arm_jacobian(options.geometry, q);
    const Eigen::Vector3d tip = tip_position(options.geometry, q);
    const Eigen::Vector3d on_object = contact_force(tip, jacobian * v);
    Eigen::Vector3d friction;
    for (int i = 0; i < 3; ++i) {
      const double level =
          options.friction[i] * (1 + options.friction_variation * std::sin(9 * q[i] + i));
      bristle[i] = bristle_after(bristle[i], dt * v[i], options.presliding);
      friction[i] = level * bristle[i] / options.presliding + options.viscosity * v[i];
    }
    v += dt * links.inertia.llt().solve(motor - links.bias - friction -
                                        jacobian.transpose() * on_object);
    q += dt * v;
  }

  /// [N] on the object, base frame; `tip` by the encoders.
  Eigen::Vector3d contact_force(const Eigen::Vector3d& tip, const Eigen::Vector3d& speed) {
    truth.tip = tip;
    truth.force.setZero();
    if (!query) return truth.force;
    const Eigen::Vector3d p_world_tip = options.T_world_base * tip;
    if (!truth.in_contact) {
      if (!near || (p_world_tip - surface_point).dot(surface_normal) > 0) return truth.force;
      touch(p_world_tip);
    }
    Eigen::Vector3d pressed = softness_inverse * strain(p_world_tip);
    const double along = pressed.dot(cone.axis);
    if (along <= 0) {
      // What is retarded keeps the surface below its place for a while; the tip may leave it, and
      // be met again.
      const bool inside = (p_world_tip - surface_point).dot(surface_normal) < 0;
      truth.in_contact = inside && !late.isZero(0);
      if (!truth.in_contact) near = false;
      elastic.setZero();
      return truth.force;
    }
    const Eigen::Vector3d tangential = pressed - along * cone.axis;
    if (tangential.norm() > cone.coefficient * along) pressed = slide(p_world_tip, tangential);
    if (!truth.in_contact) return truth.force;
    elastic = pressed;
    truth.force = T_base_world.linear() * pressed + options.contact_damping * speed;
    truth.tip = tip - T_base_world.linear() * pressed / options.structure;
    return truth.force;
  }

  /// [mm] What the tip's place asks of the force: `softness` times it.
  [[nodiscard]] Eigen::Vector3d strain(const Eigen::Vector3d& p_world_tip) const {
    return p_world_tip - truth.contact - late - prompt * displacement + prompt * slope * reference;
  }

  /// The retarded part of the displacement approaches its share of the equilibrium.
  void creep() {
    if (retardation.share == 0) return;
    const Eigen::Vector3d equilibrium = displacement + slope * (elastic - reference);
    late += (1 - std::exp(-kPeriod / retardation.time)) * (retardation.share * equilibrium - late);
  }

  /// Moves the contact along the surface until the force is on the cone.
  Eigen::Vector3d slide(const Eigen::Vector3d& p_world_tip, const Eigen::Vector3d& tangential) {
    const Eigen::Vector3d on_cone = cone.axis + cone.coefficient * tangential.normalized();
    const Eigen::Vector3d first = surface_normal.unitOrthogonal();
    Eigen::Matrix3d system;
    system << softness * on_cone, first, surface_normal.cross(first);
    const Eigen::Vector3d solution = system.lu().solve(strain(p_world_tip));
    if (!(solution[0] > 0)) {
      truth.in_contact = near = false;
      return Eigen::Vector3d::Zero();
    }
    const Eigen::Vector3d way = system.rightCols<2>() * solution.tail<2>();
    truth.contact += way;
    truth.slid += way.norm();
    return solution[0] * on_cone;
  }

  void find_surface() {
    const Eigen::Vector3d p =
        truth.in_contact ? truth.contact : options.T_world_base * tip_position(options.geometry, q);
    constexpr double kNear = 3;  // [mm] the tip moves less than this in one period
    const geometry::ClosestPoint closest = query->closest_point(p);
    const geometry::TriangleMesh& mesh = specimen->surface();
    surface_normal.setZero();
    for (int corner = 0; corner < 3; ++corner) {
      surface_normal +=
          closest.at.barycentric[corner] * normals.col(mesh.triangles(corner, closest.at.triangle));
    }
    surface_normal.normalize();
    surface_point = closest.position;
    const Eigen::Vector3d offset = p - surface_point;
    // Beyond the border the closest point is not below the tip.
    const double beside = (offset - offset.dot(surface_normal) * surface_normal).norm();
    if (!truth.in_contact) {
      near = closest.distance < kNear && beside < 0.5;
    } else if (beside > 0.5) {
      truth.in_contact = near = false;
    } else if ((surface_point - cone_place).norm() > 0.05) {
      truth.contact = surface_point;
      cone = specimen->friction_cone(truth.contact);
      cone_place = truth.contact;
      refresh_at(reference);
    }
  }

  void touch(const Eigen::Vector3d& p_world_tip) {
    constexpr double kForce = 0.05;  // [N] of the differences
    truth.in_contact = true;
    truth.slid = 0;
    truth.contact =
        p_world_tip - (p_world_tip - surface_point).dot(surface_normal) * surface_normal;
    cone = specimen->friction_cone(truth.contact);
    cone_place = truth.contact;
    Eigen::Matrix3d forces, places;
    const Eigen::Vector3d side = cone.axis.unitOrthogonal();
    forces << kForce * cone.axis, kForce * (cone.axis + 0.3 * side),
        kForce * (cone.axis + 0.3 * cone.axis.cross(side));
    for (int i = 0; i < 3; ++i) {
      places.col(i) = specimen->displacement(truth.contact, forces.col(i));
    }
    slope = places * forces.inverse();
    reference.setZero();
    displacement.setZero();
    elastic.setZero();
    late.setZero();
    ticks_of_reference = ticks;
    soften();
  }

  void refresh() {
    constexpr double kLeast = 0.03, kRelative = 0.05;  // [N], relative to the force
    constexpr std::uint64_t kLongest = 50;             // ticks
    constexpr double kUnchanged = 1e-4;                // [N]
    const double change = (elastic - reference).norm();
    const bool old = ticks - ticks_of_reference > kLongest && change > kUnchanged;
    if (change > kLeast + kRelative * reference.norm() || old) refresh_at(elastic);
  }

  void refresh_at(const Eigen::Vector3d& at) {
    const Eigen::Vector3d computed = specimen->displacement(truth.contact, at);
    const Eigen::Vector3d change = at - reference;
    constexpr double kShowsSlope = 1e-3;  // [N]
    if (change.norm() > kShowsSlope) {
      // Powell's symmetric update: an elastic object's compliance is symmetric.
      const double square = change.squaredNorm();
      const Eigen::Vector3d error = computed - displacement - slope * change;
      slope += (error * change.transpose() + change * error.transpose()) / square -
               change.dot(error) / (square * square) * change * change.transpose();
    }
    reference = at;
    displacement = computed;
    ticks_of_reference = ticks;
    soften();
  }

  void soften() {
    // Remove negative compliances. Updates along a few directions can cause them in others where
    // the object stiffens quickly, as beside a support; the forces would then grow without bound.
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen((slope + slope.transpose()) / 2);
    slope = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() *
            eigen.eigenvectors().transpose();
    softness = prompt * slope + Eigen::Matrix3d::Identity() / options.structure;
    softness_inverse = softness.inverse();
  }

  VirtualArmOptions options;
  const Specimen* specimen;
  std::optional<geometry::SurfaceQuery> query;
  Eigen::Matrix3Xd normals;
  Eigen::Isometry3d T_base_world;
  ArmDescription description;
  VirtualArmTruth truth;
  Eigen::Vector3d gain;

  // the arm
  double time = 0;
  double lease_end = 0;
  std::uint64_t ticks = 0, sample = 0, sample_begin = 0;
  std::array<bool, 3> resting{};
  bool active = false;
  std::string refusal;  // why the specimen gave no displacement
  bool near = false;    // the surface is within a period's motion
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();
  Eigen::Vector3d delivered = Eigen::Vector3d::Zero();
  Eigen::Vector3d heat = Eigen::Vector3d::Zero();
  Eigen::Vector3d q, v = Eigen::Vector3d::Zero(), bristle = Eigen::Vector3d::Zero();

  // the surface below the tip, and the contact; world frame
  Eigen::Vector3d surface_point = Eigen::Vector3d::Zero();
  Eigen::Vector3d surface_normal = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d cone_place = Eigen::Vector3d::Zero();
  FrictionCone cone;
  Eigen::Vector3d elastic = Eigen::Vector3d::Zero();    // [N] force without damping
  Eigen::Vector3d reference = Eigen::Vector3d::Zero();  // [N] force of the linearisation
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
  Eigen::Vector3d late = Eigen::Vector3d::Zero();  // [mm] retarded part of the displacement
  Retardation retardation;
  double prompt = 1;  // share that is not retarded
  Eigen::Matrix3d slope = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d softness = Eigen::Matrix3d::Zero();  // [mm/N] with the arm's structure
  Eigen::Matrix3d softness_inverse = Eigen::Matrix3d::Zero();
  std::uint64_t ticks_of_reference = 0;
};

VirtualArm::VirtualArm(const Specimen* specimen, const VirtualArmOptions& options)
    : simulation_(std::make_unique<Simulation>(specimen, options)) {}

VirtualArm::~VirtualArm() = default;

const ArmDescription& VirtualArm::description() const noexcept { return simulation_->description; }

double VirtualArm::now() const noexcept { return simulation_->time; }

void VirtualArm::activate() {
  simulation_->active = true;
  simulation_->refusal.clear();
  simulation_->force.setZero();
}

bool VirtualArm::read(ArmState& state) noexcept {
  Simulation& s = *simulation_;
  try {
    s.tick();
  } catch (const Error& none) {  // the specimen has no equilibrium
    s.refusal = none.what();
    return false;
  }
  state.time = s.time;
  state.joints = s.encoders();
  state.tip = tip_position(s.options.geometry, state.joints);
  state.delivered_force = s.delivered;
  state.heat = s.heat;
  state.reference_force = s.truth.force;
  return state.tip.allFinite();
}

bool VirtualArm::write(const ArmCommand& command) noexcept {
  if (!simulation_->active || !command.force.allFinite()) return false;
  simulation_->force = command.force;
  simulation_->lease_end = simulation_->time + command.lease;
  return true;
}

void VirtualArm::stop() noexcept { simulation_->active = false; }

std::string VirtualArm::last_error() const { return simulation_->refusal; }

void VirtualArm::begin_sample(std::uint64_t sample) noexcept {
  simulation_->sample = sample;
  simulation_->sample_begin = simulation_->ticks;
}

VirtualArmMemory VirtualArm::memory() const noexcept {
  const Simulation& s = *simulation_;
  VirtualArmMemory memory{.ticks = s.ticks,
                          .sample = s.sample,
                          .sample_begin = s.sample_begin,
                          .joints = s.q,
                          .speed = s.v,
                          .bristle = s.bristle,
                          .heat = s.heat};
  for (int i = 0; i < 3; ++i) memory.resting[i] = s.resting[static_cast<std::size_t>(i)] ? 1 : 0;
  return memory;
}

void VirtualArm::restore(const VirtualArmMemory& memory) noexcept {
  Simulation& s = *simulation_;
  s.ticks = memory.ticks;
  s.time = static_cast<double>(s.ticks) * kPeriod;
  s.sample = memory.sample;
  s.sample_begin = memory.sample_begin;
  s.q = memory.joints;
  s.v = memory.speed;
  s.bristle = memory.bristle;
  s.heat = memory.heat;
  for (int i = 0; i < 3; ++i) s.resting[static_cast<std::size_t>(i)] = memory.resting[i] != 0;
  s.truth.in_contact = s.near = false;
  s.truth.tip = tip_position(s.options.geometry, s.q);
}

const VirtualArmTruth& VirtualArm::truth() const noexcept { return simulation_->truth; }

}  // namespace palpate::probing
