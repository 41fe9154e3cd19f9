// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/arm_setup.h"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/documents/document.h"
#include "palpate/documents/document_node.h"

namespace palpate::probing {
namespace {

using documents::DocumentMembers;
using documents::DocumentNode;

void take_box(DocumentMembers& members, const char* name, Eigen::AlignedBox3d& box) {
  const auto found = members.find(name);
  if (!found) return;
  if (found->value().size() != 2)
    found->refuse("two corners such as [[-100, -300, 100], [100, 0, 300]]");
  const std::vector<DocumentNode> corners = found->items();
  box = {corners[0].vector(), corners[1].vector()};
}

Eigen::Isometry3d pose_of(const DocumentNode& node) {
  constexpr const char* kRight =
      "three rows of four numbers, a rotation and a place [mm] such as [[1, 0, 0, 0], [0, 0, 1, "
      "-195], [0, -1, 0, 485]]";
  if (node.value().size() != 3) node.refuse(kRight);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (Eigen::Index i = 0; const DocumentNode& row : node.items()) {
    std::array<double, 4> numbers{};
    row.read(numbers, "four numbers");
    pose.matrix().row(i++) = Eigen::RowVector4d(numbers.data());
  }
  constexpr double kOrthogonal = 1e-6;  // of the products of the rotation's columns
  const Eigen::Matrix3d rotation = pose.linear();
  if (!(rotation.transpose() * rotation).isIdentity(kOrthogonal) || rotation.determinant() < 0)
    node.refuse(kRight);
  return pose;
}

template <typename Take>
void inside(DocumentMembers& members, const char* name, const Take& take) {
  const auto found = members.find(name);
  if (!found) return;
  DocumentMembers inner(*found);
  take(inner);
  inner.end();
}

void take_limits(DocumentMembers& m, devices::SafetyLimits& limits) {
  m.take("max_force", limits.max_force, above(0).finite(), "N");
  m.take("slew", limits.slew, above(0).finite(), "N/s");
  m.take("speed", limits.speed, above(0).finite(), "mm/s");
  m.take("depth", limits.depth, above(0).finite(), "mm");
  m.take("quantum", limits.quantum, above(0).finite(), "mm");
  m.take("force_tolerance", limits.force_tolerance, above(0).finite(), "N");
  take_box(m, "workspace", limits.workspace);
}

void take_calibration(DocumentMembers& m, GravityCalibration& calibration) {
  m.take("low", calibration.low);
  m.take("high", calibration.high);
  m.take("angles", calibration.angles, at_least(3));
  m.take("speed", calibration.speed, above(0).finite(), "rad/s");
  m.take("settling", calibration.settling, at_least(0).finite(), "s");
  m.take("recording", calibration.recording, above(0).finite(), "s");
}

void take_gains(DocumentMembers& m, JointGains& gains) {
  m.take("stiffness", gains.stiffness, at_least(0).finite(), "N mm/rad");
  m.take("damping", gains.damping, at_least(0).finite(), "N mm s/rad");
  m.take("integral", gains.integral, at_least(0).finite(), "N mm/(rad s)");
  m.take("dead_band", gains.dead_band, at_least(0).finite(), "rad");
}

void take_prober(DocumentMembers& m, ArmProberOptions& o) {
  const Interval positive = above(0).finite();
  inside(m, "geometry", [&](DocumentMembers& inner) {
    inner.take("upper", o.geometry.upper, positive, "mm");
    inner.take("lower", o.geometry.lower, positive, "mm");
  });
  inside(m, "limits", [&](DocumentMembers& inner) { take_limits(inner, o.limits); });
  inside(m, "calibration", [&](DocumentMembers& inner) { take_calibration(inner, o.calibration); });
  inside(m, "gains", [&](DocumentMembers& inner) { take_gains(inner, o.gains); });
  m.take("mass", o.contact.model.mass, positive, "kg");
  m.take("structure", o.structure, positive, "N/mm");
  m.take("travel_speed", o.travel_speed, positive, "mm/s");
  m.take("start_distance", o.start_distance, positive, "mm");
  m.take("beyond", o.beyond, positive, "mm");
  m.take("push", o.push, positive, "N");
  m.take("approach_speed", o.approach_speed, positive, "mm/s");
  m.take("hunting", o.hunting, positive, "N");
  m.take("attempts", o.attempts, at_least(1));
  m.take("ramp", o.ramp, positive, "N/s");
  m.take("damping", o.damping, at_least(0).finite(), "N s/mm");
  m.take("presliding", o.presliding, above(0).finite(), "rad");
  m.take("sliding_friction", o.sliding_friction, at_least(1).finite(), "");
  m.take("dither", o.dither, at_least(0).finite(), "N mm");
  m.take("dither_frequency", o.dither_frequency, above(0).finite(), "Hz");
  m.take("settled_speed", o.settled_speed, positive, "mm/s");
  m.take("longest_slide", o.longest_slide, positive, "mm");
  m.take("heating_time", o.heating_time, positive, "s");
}

// Position of the middle of the surface in the frame of the base, so that it is below the sweeps.
constexpr double kOutwards = 195;  // [mm]
constexpr double kHeight = -215;   // [mm]

}  // namespace

ArmSetup parse_arm_setup(const std::string& text, const std::string& source) {
  const documents::Document document = documents::parse_json(text, source);
  return documents::in_file(source, [&] {
    ArmSetup setup;
    setup.prober.calibration = sweeps_above_surface();
    DocumentMembers members{DocumentNode(document)};
    if (const auto pose = members.find("pose")) {
      setup.prober.T_world_base = pose_of(*pose);
      setup.knows_pose = true;
    }
    if (const auto driver = members.find("driver")) {
      driver->for_each_member([&](const std::string& name, const DocumentNode& option) {
        setup.driver[name] = option.word();
      });
    }
    take_prober(members, setup.prober);
    inside(members, "links", [&](DocumentMembers& inner) {
      inner.take("distance", setup.links.distance, at_least(0).finite(), "mm");
      inner.take("free_end", setup.links.free_end, at_least(0).finite(), "mm");
      inner.take("approach", setup.links.approach, at_least(0).finite(), "mm");
    });
    members.end();
    return setup;
  });
}

std::string with_pose(const std::string& text, const std::string& source,
                      const Eigen::Isometry3d& T_world_base) {
  static_cast<void>(parse_arm_setup(text, source));
  auto setup = documents::Json::parse(text);
  auto rows = documents::Json::array();
  for (const auto& row : T_world_base.matrix().topRows<3>().rowwise())
    rows.push_back({row[0], row[1], row[2], row[3]});
  setup["pose"] = rows;
  std::string result;
  for (const auto& [name, value] : setup.items()) {
    result += result.empty() ? "{" : ",\n ";
    result.append(documents::Json(name).dump()).append(": ").append(value.dump());
  }
  return result + "}\n";
}

Eigen::Isometry3d mount_over(const geometry::TriangleMesh& surface, const ArmGeometry& geometry) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < surface.triangles.cols(); ++i) {
    const auto corner = [&](int k) {
      return Eigen::Vector3d(surface.vertices.col(surface.triangles(k, i)));
    };
    normal += (corner(1) - corner(0)).cross(corner(2) - corner(0));
  }
  if (!(normal.norm() > 0)) throw InvalidInput("mount_over: the surface has no mean normal");
  normal.normalize();
  const Eigen::Vector3d first = normal.unitOrthogonal(), second = normal.cross(first);
  // Use the sides of the smallest of a few rectangles around the surface.
  constexpr int kTurns = 90;
  constexpr double kTurn = 1.5707963267948966 / kTurns;  // [rad]
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double smallest = std::numeric_limits<double>::infinity();
  for (int turn = 0; turn < kTurns; ++turn) {
    const Eigen::Vector3d u = std::cos(turn * kTurn) * first + std::sin(turn * kTurn) * second;
    Eigen::Matrix3d axes;
    axes << u, normal, u.cross(normal);
    const Eigen::Matrix3Xd inside = axes.transpose() * surface.vertices;
    const Eigen::Vector3d low = inside.rowwise().minCoeff(), high = inside.rowwise().maxCoeff();
    const Eigen::Vector3d size = high - low;
    if (!(size.x() * size.z() < smallest)) continue;
    smallest = size.x() * size.z();
    Eigen::Vector3d place = (low + high) / 2;
    place.y() = high.y();
    middle = axes * place;
    rotation = axes;
    if (size.z() > size.x()) rotation << axes.col(2), axes.col(1), -axes.col(0);
  }
  const double scale =
      (geometry.upper + geometry.lower) / (ArmGeometry{}.upper + ArmGeometry{}.lower);
  Eigen::Isometry3d T_world_base = Eigen::Isometry3d::Identity();
  T_world_base.linear() = rotation;
  T_world_base.translation() = middle - rotation * (scale * Eigen::Vector3d(0, kHeight, kOutwards));
  return T_world_base;
}

GravityCalibration sweeps_above_surface() {
  GravityCalibration calibration;
  calibration.low = {-0.5, -0.05, -0.4};
  calibration.high = {0.5, 0.5, 0.4};
  return calibration;
}

}  // namespace palpate::probing
