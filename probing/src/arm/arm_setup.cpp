// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/arm_setup.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::probing {
namespace {

using nlohmann::json;

/// One JSON object of a setup: its members are taken one by one, and `end` refuses any others.
class Members {
 public:
  Members(const json& object, std::string source, std::string place)
      : object_(object), source_(std::move(source)), place_(std::move(place)) {
    if (!object_.is_object()) wrong("", object_, "a JSON object");
  }

  void take(const char* name, double& value, const Interval& range, const char* unit) {
    const json* found = find(name);
    if (found == nullptr) return;
    if (!found->is_number() || !range.contains(found->get<double>()))
      wrong(name, *found, "a number " + to_string(range) + (*unit ? std::string(" ") + unit : ""));
    value = found->get<double>();
  }
  void take(const char* name, int& value, int least) {
    const json* found = find(name);
    if (found == nullptr) return;
    if (!found->is_number_integer() || found->get<long long>() < least)
      wrong(name, *found, "a whole number >= " + std::to_string(least));
    value = found->get<int>();
  }
  void take(const char* name, Eigen::Vector3d& value) {
    if (const json* found = find(name)) value = vector(name, *found);
  }
  void take_box(const char* name, Eigen::AlignedBox3d& box) {
    const json* found = find(name);
    if (found == nullptr) return;
    if (!found->is_array() || found->size() != 2)
      wrong(name, *found, "two corners such as [[-100, -300, 100], [100, 0, 300]]");
    box = {vector(name, (*found)[0]), vector(name, (*found)[1])};
  }
  bool take_pose(const char* name, Eigen::Isometry3d& pose) {
    const json* found = find(name);
    if (found == nullptr) return false;
    constexpr const char* kRight =
        "three rows of four numbers, a rotation and a place [mm] such as [[1, 0, 0, 0], [0, 0, 1, "
        "-195], [0, -1, 0, 485]]";
    if (!found->is_array() || found->size() != 3) wrong(name, *found, kRight);
    for (std::size_t i = 0; i < 3; ++i) {
      const json& row = (*found)[i];
      if (!row.is_array() || row.size() != 4) wrong(name, *found, kRight);
      for (std::size_t k = 0; k < 4; ++k) {
        if (!row[k].is_number()) wrong(name, *found, kRight);
        pose.matrix()(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
            row[k].get<double>();
      }
    }
    constexpr double kOrthogonal = 1e-6;  // of the products of the rotation's columns
    const Eigen::Matrix3d rotation = pose.linear();
    if (!(rotation.transpose() * rotation).isIdentity(kOrthogonal) || rotation.determinant() < 0)
      wrong(name, *found, kRight);
    return true;
  }
  void take_words(const char* name, std::map<std::string, std::string>& words) {
    const json* found = find(name);
    if (found == nullptr) return;
    if (!found->is_object()) wrong(name, *found, "an object of words");
    for (const auto& [key, value] : found->items())
      words[key] = value.is_string() ? value.get<std::string>() : value.dump();
  }
  template <typename Take>
  void inside(const char* name, const Take& take) {
    const json* found = find(name);
    if (found == nullptr) return;
    Members members(*found, source_, place_ + name + ".");
    take(members);
    members.end();
  }

  /// \throws FileError if a member was not taken.
  void end() const {
    for (const auto& [name, value] : object_.items()) {
      if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
      std::string list;
      for (const std::string& each : known_) {
        if (!list.empty()) list += ", ";
        list += each;
      }
      std::string message = source_;
      message.append(": '").append(place_).append(name);
      throw FileError(message.append("' is unknown; there are ").append(list));
    }
  }

 private:
  const json* find(const char* name) {
    known_.emplace_back(name);
    const auto member = object_.find(name);
    return member == object_.end() ? nullptr : &*member;
  }
  Eigen::Vector3d vector(const char* name, const json& value) const {
    const bool fits =
        value.is_array() && value.size() == 3 &&
        std::all_of(value.begin(), value.end(), [](const json& each) { return each.is_number(); });
    if (!fits) wrong(name, value, "three numbers such as [-0.5, 0, 0.4]");
    return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
  }
  [[noreturn]] void wrong(const char* name, const json& value, const std::string& right) const {
    throw FileError(source_ + ": '" + place_ + name + "' is " + value.dump() + "; it must be " +
                    right);
  }

  const json& object_;
  std::string source_, place_;
  std::vector<std::string> known_;
};

void take_limits(Members& m, devices::SafetyLimits& limits) {
  m.take("max_force", limits.max_force, above(0).finite(), "N");
  m.take("slew", limits.slew, above(0).finite(), "N/s");
  m.take("speed", limits.speed, above(0).finite(), "mm/s");
  m.take("depth", limits.depth, above(0).finite(), "mm");
  m.take("quantum", limits.quantum, above(0).finite(), "mm");
  m.take("force_tolerance", limits.force_tolerance, above(0).finite(), "N");
  m.take_box("workspace", limits.workspace);
}

void take_calibration(Members& m, GravityCalibration& calibration) {
  m.take("low", calibration.low);
  m.take("high", calibration.high);
  m.take("angles", calibration.angles, 3);
  m.take("speed", calibration.speed, above(0).finite(), "rad/s");
  m.take("settling", calibration.settling, at_least(0).finite(), "s");
  m.take("recording", calibration.recording, above(0).finite(), "s");
}

void take_gains(Members& m, JointGains& gains) {
  m.take("stiffness", gains.stiffness, at_least(0).finite(), "N mm/rad");
  m.take("damping", gains.damping, at_least(0).finite(), "N mm s/rad");
  m.take("integral", gains.integral, at_least(0).finite(), "N mm/(rad s)");
  m.take("dead_band", gains.dead_band, at_least(0).finite(), "rad");
}

void take_prober(Members& m, ArmProberOptions& o) {
  const Interval positive = above(0).finite();
  m.inside("geometry", [&](Members& inner) {
    inner.take("upper", o.geometry.upper, positive, "mm");
    inner.take("lower", o.geometry.lower, positive, "mm");
  });
  m.inside("limits", [&](Members& inner) { take_limits(inner, o.limits); });
  m.inside("calibration", [&](Members& inner) { take_calibration(inner, o.calibration); });
  m.inside("gains", [&](Members& inner) { take_gains(inner, o.gains); });
  m.take("mass", o.contact.model.mass, positive, "kg");
  m.take("structure", o.structure, positive, "N/mm");
  m.take("travel_speed", o.travel_speed, positive, "mm/s");
  m.take("start_distance", o.start_distance, positive, "mm");
  m.take("beyond", o.beyond, positive, "mm");
  m.take("push", o.push, positive, "N");
  m.take("approach_speed", o.approach_speed, positive, "mm/s");
  m.take("hunting", o.hunting, positive, "N");
  m.take("attempts", o.attempts, 1);
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
  const json object = json::parse(text, nullptr, false);
  if (!object.is_object()) {
    throw FileError(source +
                    R"(: is not a JSON object; it must be one such as {"structure": 3.5})");
  }
  ArmSetup setup;
  setup.prober.calibration = sweeps_above_surface();
  Members members(object, source, "");
  setup.knows_pose = members.take_pose("pose", setup.prober.T_world_base);
  members.take_words("driver", setup.driver);
  take_prober(members, setup.prober);
  members.inside("links", [&](Members& inner) {
    inner.take("distance", setup.links.distance, at_least(0).finite(), "mm");
    inner.take("free_end", setup.links.free_end, at_least(0).finite(), "mm");
    inner.take("approach", setup.links.approach, at_least(0).finite(), "mm");
  });
  members.end();
  return setup;
}

std::string read_arm_setup_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file.good() && !file.eof()) {
    throw FileError(path.string() + ": cannot be read; pass a setup of an arm (JSON)");
  }
  return text;
}

std::string with_pose(const std::string& text, const std::string& source,
                      const Eigen::Isometry3d& T_world_base) {
  static_cast<void>(parse_arm_setup(text, source));
  auto setup = nlohmann::ordered_json::parse(text);
  auto rows = nlohmann::ordered_json::array();
  for (const auto& row : T_world_base.matrix().topRows<3>().rowwise())
    rows.push_back({row[0], row[1], row[2], row[3]});
  setup["pose"] = rows;
  std::string result;
  for (const auto& [name, value] : setup.items()) {
    result += result.empty() ? "{" : ",\n ";
    result.append(nlohmann::json(name).dump()).append(": ").append(value.dump());
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
