// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "specimen/finite_element_file.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/probing/finite_element_specimen.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;
using nlohmann::json;

constexpr double kTop = 700;         // [mm] from the camera to a block's upper side, a ball's top
constexpr double kOnSide = 1e-6;     // [of the extent] within which a node is on a side
constexpr int kMostCells = 200'000;  // of a grid: more do not fit into the memory of a computer

// The members of one JSON object. Each must be asked for; what is left is unknown.
class Members {
 public:
  Members(const json& object, std::string place) : object_(object), place_(std::move(place)) {
    if (!object.is_object())
      throw FileError(place_ + " is " + object.dump() + "; it must be an object");
  }

  bool has(const char* name) {
    know(name);
    return object_.contains(name);
  }
  void number(const char* name, double& value, const Interval& range, const char* unit) {
    if (!has(name)) return;
    const json& member = object_[name];
    if (!member.is_number()) wrong(name, std::string("a number") + in(unit));
    value = member.get<double>();
    checked([&] { require(std::string("'") + name + "'", value, range, unit); });
  }
  void vector(const char* name, Vector3d& value, const char* unit) {
    if (!has(name)) return;
    const json& member = object_[name];
    const bool fits = member.is_array() && member.size() == 3 &&
                      std::all_of(member.begin(), member.end(),
                                  [](const json& each) { return each.is_number(); });
    if (!fits) wrong(name, std::string("three numbers such as [60, 60, 20]") + in(unit));
    for (int k = 0; k < 3; ++k) value[k] = member[static_cast<std::size_t>(k)].get<double>();
  }
  std::string text(const char* name) {
    if (!has(name)) throw FileError(place_ + " has no '" + name + "'");
    if (!object_[name].is_string()) wrong(name, "text");
    return object_[name].get<std::string>();
  }
  bool truth(const char* name, bool otherwise) {
    if (!has(name)) return otherwise;
    if (!object_[name].is_boolean()) wrong(name, "true or false");
    return object_[name].get<bool>();
  }
  std::vector<Members> list(const char* name) {
    std::vector<Members> result;
    if (!has(name)) return result;
    if (!object_[name].is_array()) wrong(name, "a list of objects");
    for (std::size_t i = 0; i < object_[name].size(); ++i)
      result.emplace_back(object_[name][i], place_ + ": " + name + "[" + std::to_string(i) + "]");
    return result;
  }
  template <typename Work>
  void checked(const Work& work) const {
    try {
      work();
    } catch (const FileError&) {
      throw;
    } catch (const InvalidInput& error) {
      throw FileError(place_ + ": " + error.what());
    }
  }
  [[noreturn]] void wrong(const char* name, const std::string& right) const {
    throw FileError(place_ + ": '" + name + "' is " + object_[name].dump() + "; it must be " +
                    right);
  }
  [[noreturn]] void fail(const std::string& what) const { throw FileError(place_ + ": " + what); }
  [[noreturn]] void refuse(const std::string& name) const {
    std::string list;
    for (const std::string& each : known_) list.append(list.empty() ? "" : ", ").append(each);
    fail("'" + name + "' is unknown; here are allowed " + list);
  }
  void refuse_others() const {
    for (const auto& [name, value] : object_.items()) {
      if (std::find(known_.begin(), known_.end(), name) == known_.end()) refuse(name);
    }
  }

 private:
  static std::string in(const char* unit) { return *unit ? std::string(" [") + unit + "]" : ""; }
  void know(const char* name) {
    if (std::find(known_.begin(), known_.end(), name) == known_.end()) known_.emplace_back(name);
  }

  const json& object_;
  std::string place_;
  std::vector<std::string> known_;
};

struct Extent {
  Vector3d low = Vector3d::Zero(), high = Vector3d::Zero();
  bool contains(const Vector3d& point) const {
    return (point.array() >= low.array()).all() && (point.array() <= high.array()).all();
  }
};

void read_extent(Members& members, Extent& extent) {
  if (!members.has("low") || !members.has("high"))
    members.fail("must have 'low' and 'high', corners of a box [mm]");
  members.vector("low", extent.low, "mm");
  members.vector("high", extent.high, "mm");
  if (!((extent.high - extent.low).array() > 0).all()) members.fail("'high' must be above 'low'");
}

void read_material(Members& members, Hyperelastic& material) {
  constexpr double kBulkRatio = 20;  // of bulk to shear modulus, if only the latter is stated
  members.number("shear_modulus", material.shear_modulus, above(0).finite(), "N/mm^2");
  if (members.has("shear_modulus")) material.bulk_modulus = kBulkRatio * material.shear_modulus;
  members.number("bulk_modulus", material.bulk_modulus, above(0).finite(), "N/mm^2");
  members.number("mooney_share", material.mooney_share, at_least(0).at_most(1), "");
  members.checked([&] { check_hyperelastic(material); });
}

std::vector<double> divided(double from, double to, double cells) {
  std::vector<double> result;
  for (int i = 0; i <= static_cast<int>(cells); ++i)
    result.push_back(from + (to - from) * i / cells);
  return result;
}

FiniteElementMesh read_block(Members& members) {
  Vector3d size(60, 60, 20), cells(10, 10, 3);
  members.vector("size", size, "mm");
  members.vector("cells", cells, "");
  const bool whole = (cells.array() >= 1).all() && (cells.array() == cells.array().floor()).all();
  if (!(size.array() > 0).all() || !size.allFinite())
    members.wrong("size", "three lengths above 0 [mm]");
  if (!whole || !(cells.prod() <= kMostCells))
    members.wrong("cells", "three whole numbers above 0, their product at most " +
                               std::to_string(kMostCells));
  return box_mesh(divided(-size.x() / 2, size.x() / 2, cells.x()),
                  divided(-size.y() / 2, size.y() / 2, cells.y()),
                  divided(kTop, kTop + size.z(), cells.z()));
}

FiniteElementMesh read_ball(Members& members) {
  double radius = 30, cells = 8;
  members.number("radius", radius, above(0).finite(), "mm");
  members.number("cells", cells, at_least(2).at_most(std::cbrt(double{kMostCells})), "");
  if (std::fmod(cells, 2) != 0) members.wrong("cells", "an even number");
  return ball_mesh({0, 0, kTop + radius}, radius, static_cast<int>(cells));
}

FiniteElementMesh read_mesh_file(Members& members) {
  FiniteElementMesh mesh = read_gmsh(members.text("file"));
  Vector3d offset = Vector3d::Zero();
  members.vector("offset", offset, "mm");
  mesh.nodes.colwise() += offset;
  return mesh;
}

Vector3d centre_of(const FiniteElementMesh& mesh, Eigen::Index element) {
  Vector3d sum = Vector3d::Zero();
  for (int a = 0; a < 4; ++a) sum += mesh.nodes.col(mesh.elements(a, element));
  return sum / 4;
}

// Regions in the order of the list; later ones take elements from earlier ones.
void read_regions(Members& members, DeformableBody& body, const Hyperelastic& common) {
  const std::vector<int> groups = body.mesh.regions;
  std::fill(body.mesh.regions.begin(), body.mesh.regions.end(), 0);
  body.materials = {common};
  for (Members& region : members.list("regions")) {
    Hyperelastic material = common;
    read_material(region, material);
    const bool ball = region.has("radius"), group = region.has("group");
    Extent extent;
    Vector3d centre = Vector3d::Zero();
    double radius = 0, number = 0;
    if (group) {
      region.number("group", number, at_least(0).finite(), "");
    } else if (ball) {
      region.vector("centre", centre, "mm");
      region.number("radius", radius, above(0).finite(), "mm");
    } else {
      read_extent(region, extent);
    }
    region.refuse_others();
    const int index = static_cast<int>(body.materials.size());
    int taken = 0;
    for (Eigen::Index e = 0; e < body.mesh.elements.cols(); ++e) {
      const Vector3d at = centre_of(body.mesh, e);
      const bool inside = group  ? groups[static_cast<std::size_t>(e)] == number
                          : ball ? (at - centre).norm() <= radius
                                 : extent.contains(at);
      if (!inside) continue;
      body.mesh.regions[static_cast<std::size_t>(e)] = index;
      ++taken;
    }
    if (taken == 0) region.fail("holds the middle of no element; enlarge it, or refine the mesh");
    body.materials.push_back(material);
  }
}

Extent side_extent(Members& members, const std::string& side, const Extent& whole) {
  Extent extent = whole;
  const Vector3d slack = kOnSide * (whole.high - whole.low);
  extent.low -= slack;
  extent.high += slack;
  const std::vector<std::string> low{"left", "back", "top"}, high{"right", "front", "bottom"};
  for (int axis = 0; axis < 3; ++axis) {
    if (side == low[static_cast<std::size_t>(axis)]) {
      extent.high[axis] = whole.low[axis] + slack[axis];
      return extent;
    }
    if (side == high[static_cast<std::size_t>(axis)]) {
      extent.low[axis] = whole.high[axis] - slack[axis];
      return extent;
    }
  }
  members.wrong("side", "left, right, back, front, top or bottom");
}

void read_supports(Members& members, const std::string& shape, DeformableBody& body) {
  const Extent whole{body.mesh.nodes.rowwise().minCoeff(), body.mesh.nodes.rowwise().maxCoeff()};
  std::vector<std::pair<Extent, Vector3d>> supports;
  const bool stated = members.has("supports");
  std::vector<Members> listed = members.list("supports");
  for (Members& support : listed) {
    Extent extent;
    Vector3d move = Vector3d::Zero();
    support.vector("move", move, "mm");
    if (support.has("side")) {
      extent = side_extent(support, support.text("side"), whole);
    } else {
      read_extent(support, extent);
    }
    support.refuse_others();
    bool holds = false;
    for (Eigen::Index n = 0; n < body.mesh.nodes.cols(); ++n)
      holds |= extent.contains(body.mesh.nodes.col(n));
    if (!holds) support.fail("holds no node; enlarge it");
    supports.emplace_back(extent, move);
  }
  if (!stated && shape == "block")
    supports.emplace_back(side_extent(members, "bottom", whole), Vector3d::Zero());
  if (!stated && shape == "ball") {
    constexpr double kHeld = 0.75;  // of the height, from above, is free
    Extent extent = whole;
    extent.low.z() += kHeld * (whole.high.z() - whole.low.z());
    supports.emplace_back(extent, Vector3d::Zero());
  }
  if (supports.empty())
    members.fail(R"(has no 'supports'; they must be such as [{"side": "bottom"}])");
  std::vector<Vector3d> moves;
  for (int n = 0; n < body.mesh.nodes.cols(); ++n) {
    for (const auto& [extent, move] : supports) {
      if (!extent.contains(body.mesh.nodes.col(n))) continue;
      body.supported.push_back(n);
      moves.push_back(move);
      break;
    }
  }
  body.support_moves.resize(3, static_cast<Eigen::Index>(moves.size()));
  for (std::size_t k = 0; k < moves.size(); ++k)
    body.support_moves.col(static_cast<Eigen::Index>(k)) = moves[k];
  if (body.support_moves.isZero(0)) body.support_moves.resize(3, 0);
}

}  // namespace

FiniteElementObject finite_elements_of(const json& object, const std::string& source) {
  Members members(object, source);
  (void)members.text("type");
  const std::string shape = members.has("shape") ? members.text("shape") : "block";
  FiniteElementObject result;
  DeformableBody& body = result.body;
  members.checked([&] {
    if (shape == "block") {
      body.mesh = read_block(members);
    } else if (shape == "ball") {
      body.mesh = read_ball(members);
    } else if (shape == "mesh") {
      body.mesh = read_mesh_file(members);
      result.mesh_file = members.text("file");
    } else {
      members.wrong("shape", "block, ball or mesh");
    }
    check_finite_element_mesh(body.mesh);
  });
  Hyperelastic common;
  read_material(members, common);
  read_regions(members, body, common);
  read_supports(members, shape, body);
  for (Members& listed : members.list("obstacles")) {
    Extent extent;
    read_extent(listed, extent);
    RigidBlock block{extent.low, extent.high};
    listed.number("rounding", block.rounding,
                  above(0).at_most((extent.high - extent.low).minCoeff() / 2), "mm");
    listed.refuse_others();
    body.obstacles.push_back(block);
  }
  FiniteElementSpecimenOptions& options = result.options;
  members.number("friction", options.friction, at_least(0).finite(), "");
  options.microslip = members.truth("microslip", options.microslip);
  members.number("tip_radius", options.contact.tip_radius, above(0).finite(), "mm");
  double load_steps = options.contact.load_steps;
  members.number("load_steps", load_steps, at_least(1).at_most(1000), "");
  options.contact.load_steps = static_cast<int>(load_steps);
  (void)members.has("identified");  // of `identify`: where the material comes from
  members.refuse_others();
  return result;
}

}  // namespace palpate::probing
