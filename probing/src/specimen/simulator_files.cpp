// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/simulator_files.h"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/probing/probed_solid.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr double kDensity = 1e-9;  // [t/mm^3] that of water: simulators want one

void refuse_obstacles(const FiniteElementObject& object) {
  if (object.body.obstacles.empty()) return;
  throw InvalidInput(
      "the solid has obstacles, which files of simulators do not describe; remove them from a copy "
      "of the specimen file, and add them to the scene yourself");
}

// New numbers of the corners of elements: -1 for nodes in the middle of edges.
struct Corners {
  std::vector<int> number;  // of each node
  std::vector<int> nodes;
};

Corners corners_of(const FiniteElementMesh& mesh) {
  Corners result;
  result.number.assign(static_cast<std::size_t>(mesh.nodes.cols()), -1);
  for (Eigen::Index e = 0; e < mesh.elements.cols(); ++e)
    for (int a = 0; a < 4; ++a) result.number[static_cast<std::size_t>(mesh.elements(a, e))] = 0;
  for (std::size_t n = 0; n < result.number.size(); ++n) {
    if (result.number[n] < 0) continue;
    result.number[n] = static_cast<int>(result.nodes.size());
    result.nodes.push_back(static_cast<int>(n));
  }
  return result;
}

std::vector<int> supported_corners(const DeformableBody& body, const Corners& corners) {
  std::vector<int> result;
  for (const int node : body.supported)
    if (const int number = corners.number[static_cast<std::size_t>(node)]; number >= 0)
      result.push_back(number);
  return result;
}

bool is_empty(const FiniteElementMesh& mesh, std::size_t region) {
  return std::ranges::find(mesh.regions, static_cast<int>(region)) == mesh.regions.end();
}

struct PrescribedNodes {
  std::vector<int> nodes;
  Eigen::Matrix3Xd moves;  // [mm]
};

void print_set(std::ostream& out, const char* name, const std::vector<int>& nodes) {
  fmt::print(out, "*NSET, NSET={}\n", name);
  for (const int node : nodes) fmt::print(out, "{},\n", node + 1);
}

void print_moves(std::ostream& out, const PrescribedNodes& prescribed) {
  for (std::size_t k = 0; k < prescribed.nodes.size(); ++k)
    for (int i = 0; i < 3; ++i)
      fmt::print(out, "{0}, {1}, {1}, {2:.12g}\n", prescribed.nodes[k] + 1, i + 1,
                 prescribed.moves(i, static_cast<Eigen::Index>(k)));
}

// The nodes that the tip touches after a press, and how far they have moved since there was no
// stress.
PrescribedNodes touched_nodes(const FiniteElementObject& object, const KnownPress& press) {
  const ProbedSolid probed(object.body, object.options);
  const ContactEquilibrium& solid = probed.equilibrium();
  const ContactState from = solid.touch(probed.place(press.position).position, press.inward);
  const ContactResult found = solid.move_tip(from, from.tip + press.displacement);
  if (found.stop != ContactStop::converged)
    throw SolverError(fmt::format("the press of contact {} has no equilibrium: {}", press.contact,
                                  to_string(found.stop)));
  PrescribedNodes result;
  result.nodes = solid.touched_nodes(found.state);
  result.moves.resize(3, std::ssize(result.nodes));
  for (std::size_t k = 0; k < result.nodes.size(); ++k) {
    const int node = result.nodes[k];
    result.moves.col(static_cast<Eigen::Index>(k)) =
        found.state.positions.col(node) - object.body.mesh.nodes.col(node);
  }
  return result;
}

}  // namespace

void write_calculix(std::ostream& out, const FiniteElementObject& object,
                    const std::optional<KnownPress>& press) {
  refuse_obstacles(object);
  const DeformableBody& body = object.body;
  fmt::print(out, "** mm, N, N/mm^2\n*NODE, NSET=ALL\n");
  for (Eigen::Index n = 0; n < body.mesh.nodes.cols(); ++n) {
    const Vector3d at = body.mesh.nodes.col(n);
    fmt::print(out, "{}, {:.12g}, {:.12g}, {:.12g}\n", n + 1, at.x(), at.y(), at.z());
  }
  // CalculiX numbers the nodes of C3D10 as we do. Its volumetric energy is K/2 (J - 1)^2, ours
  // K/4 (J^2 - 1 - 2 ln J): the same to second order in J - 1.
  for (std::size_t region = 0; region < body.materials.size(); ++region) {
    if (is_empty(body.mesh, region)) continue;
    fmt::print(out, "*ELEMENT, TYPE=C3D10, ELSET=REGION{}\n", region);
    for (Eigen::Index e = 0; e < body.mesh.elements.cols(); ++e) {
      if (body.mesh.regions[static_cast<std::size_t>(e)] != static_cast<int>(region)) continue;
      fmt::print(out, "{}", e + 1);
      for (const int node : body.mesh.elements.col(e)) fmt::print(out, ", {}", node + 1);
      fmt::print(out, "\n");
    }
    const Hyperelastic& material = body.materials[region];
    const double half = material.shear_modulus / 2;
    fmt::print(out,
               "*MATERIAL, NAME=MATERIAL{0}\n*HYPERELASTIC, MOONEY-RIVLIN\n{1:.12g}, {2:.12g}, "
               "{3:.12g}\n*SOLID SECTION, ELSET=REGION{0}, MATERIAL=MATERIAL{0}\n",
               region, half * (1 - material.mooney_share), half * material.mooney_share,
               2 / material.bulk_modulus);
  }
  PrescribedNodes held{body.supported, body.support_moves};
  if (held.moves.size() == 0) held.moves.setZero(3, std::ssize(held.nodes));
  print_set(out, "HELD", held.nodes);
  PrescribedNodes touched;
  if (press) {
    touched = touched_nodes(object, *press);
    print_set(out, "TOUCHED", touched.nodes);
  }
  constexpr const char* kStep = "*STEP, NLGEOM, INC=1000\n*STATIC\n0.1, 1., 1e-4, 0.2\n*BOUNDARY\n";
  fmt::print(out, "** Supports\n{}", kStep);
  print_moves(out, held);
  fmt::print(out, "*NODE PRINT, NSET=ALL, FREQUENCY=1000\nU\n*END STEP\n");
  if (!press) return;
  fmt::print(
      out,
      "** Press of contact {}: the measured force is {:.6g}, {:.6g}, {:.6g} N, to be compared "
      "with the sum of RF\n{}",
      press->contact, press->force.x(), press->force.y(), press->force.z(), kStep);
  print_moves(out, held);
  print_moves(out, touched);
  fmt::print(out,
             "*NODE PRINT, NSET=ALL, FREQUENCY=1000\nU\n*NODE PRINT, NSET=TOUCHED, TOTALS=ONLY, "
             "FREQUENCY=1000\nRF\n*END STEP\n");
}

void write_linear_gmsh(std::ostream& out, const FiniteElementMesh& mesh, double scale) {
  const Corners corners = corners_of(mesh);
  fmt::print(out, "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", corners.nodes.size());
  for (std::size_t k = 0; k < corners.nodes.size(); ++k) {
    const Vector3d at = scale * mesh.nodes.col(corners.nodes[k]);
    fmt::print(out, "{} {:.12g} {:.12g} {:.12g}\n", k + 1, at.x(), at.y(), at.z());
  }
  fmt::print(out, "$EndNodes\n$Elements\n{}\n", mesh.elements.cols());
  for (Eigen::Index e = 0; e < mesh.elements.cols(); ++e) {
    const int group = mesh.regions[static_cast<std::size_t>(e)];
    fmt::print(out, "{} 4 2 {} {}", e + 1, group, group + 1);
    for (int a = 0; a < 4; ++a)
      fmt::print(out, " {}", corners.number[static_cast<std::size_t>(mesh.elements(a, e))] + 1);
    fmt::print(out, "\n");
  }
  fmt::print(out, "$EndElements\n");
}

void write_sofa(std::ostream& out, const FiniteElementObject& object,
                const std::string& mesh_file) {
  refuse_obstacles(object);
  const DeformableBody& body = object.body;
  const Corners corners = corners_of(body.mesh);
  const std::vector<int> held = supported_corners(body, corners);
  fmt::print(out,
             R"(<?xml version="1.0"?>
<!-- mm, N, s, tonnes; SOFA 24.06 or later -->
<Node name="root" dt="0.01" gravity="0 0 0">
  <RequiredPlugin pluginName="Sofa.Component.Constraint.Projective Sofa.Component.IO.Mesh Sofa.Component.LinearSolver.Direct Sofa.Component.Mass Sofa.Component.ODESolver.Backward Sofa.Component.SolidMechanics.FEM.HyperElastic Sofa.Component.StateContainer Sofa.Component.Topology.Container.Dynamic Sofa.Component.Visual"/>
  <DefaultAnimationLoop/>
  <VisualStyle displayFlags="showBehaviorModels showForceFields"/>
  <Node name="solid">
    <EulerImplicitSolver rayleighStiffness="0.1" rayleighMass="0.1"/>
    <SparseLDLSolver template="CompressedRowSparseMatrixMat3x3d"/>
    <MeshGmshLoader name="loader" filename="{}"/>
    <TetrahedronSetTopologyContainer name="whole" src="@loader"/>
    <MechanicalObject name="nodes" template="Vec3d"/>
    <MeshMatrixMass massDensity="{:g}" topology="@whole"/>
)",
             mesh_file, kDensity);
  // The law of Mooney and Rivlin is ours to second order in J - 1. SOFA's NeoHookean is not.
  for (std::size_t region = 0; region < body.materials.size(); ++region) {
    if (is_empty(body.mesh, region)) continue;
    fmt::print(out,
               "    <Node name=\"region{}\">\n      <TetrahedronSetTopologyContainer "
               "name=\"elements\" position=\"@../nodes.rest_position\" tetrahedra=\"",
               region);
    for (Eigen::Index e = 0; e < body.mesh.elements.cols(); ++e) {
      if (body.mesh.regions[static_cast<std::size_t>(e)] != static_cast<int>(region)) continue;
      for (int a = 0; a < 4; ++a)
        fmt::print(out, "{} ", corners.number[static_cast<std::size_t>(body.mesh.elements(a, e))]);
    }
    const Hyperelastic& material = body.materials[region];
    const double half = material.shear_modulus / 2;
    fmt::print(out,
               "\"/>\n      <TetrahedronHyperelasticityFEMForceField topology=\"@elements\" "
               "materialName=\"MooneyRivlin\" ParameterSet=\"{:.9g} {:.9g} {:.9g}\"/>\n    "
               "</Node>\n",
               half * (1 - material.mooney_share), half * material.mooney_share,
               material.bulk_modulus);
  }
  if (body.support_moves.size() == 0) {
    fmt::print(out, "    <FixedProjectiveConstraint indices=\"{}\"/>\n", fmt::join(held, " "));
  } else {
    // Each supported node moves to its place within the first second.
    for (std::size_t k = 0; k < body.supported.size(); ++k) {
      const int number = corners.number[static_cast<std::size_t>(body.supported[k])];
      if (number < 0) continue;
      const Vector3d move = body.support_moves.col(static_cast<Eigen::Index>(k));
      fmt::print(out,
                 "    <LinearMovementProjectiveConstraint indices=\"{0}\" keyTimes=\"0 1 1e9\" "
                 "movements=\"0 0 0 {1:.9g} {2:.9g} {3:.9g} {1:.9g} {2:.9g} {3:.9g}\"/>\n",
                 number, move.x(), move.y(), move.z());
    }
  }
  fmt::print(out, "  </Node>\n</Node>\n");
}

void write_mujoco(std::ostream& out, const FiniteElementObject& object,
                  const std::string& mesh_file) {
  refuse_obstacles(object);
  const DeformableBody& body = object.body;
  if (body.materials.size() != 1) {
    throw InvalidInput(fmt::format(
        "the solid has {} regions; a flexcomp of MuJoCo has one material", body.materials.size()));
  }
  if (body.support_moves.size() != 0) {
    throw InvalidInput("supports of the solid move; a flexcomp of MuJoCo has no pre-stretch");
  }
  constexpr double kPascal = 1e6, kCubicMetre = 1e-9;  // of 1 N/mm^2; of 1 mm^3
  constexpr double kWater = 1000;                      // [kg/m^3]
  const Hyperelastic& material = body.materials.front();
  fmt::print(out,
             R"(<mujoco model="palpate">
  <!-- m, kg, s. Stiff solids and fine meshes need a smaller timestep. -->
  <option gravity="0 0 0" timestep="0.001" solver="CG" tolerance="1e-6"/>
  <size memory="1G"/>
  <worldbody>
    <flexcomp name="solid" type="gmsh" file="{}" dim="3" mass="{:.6g}" radius="0.0005">
      <contact selfcollide="none"/>
      <elasticity young="{:.9g}" poisson="{:.9g}" damping="0.01"/>
      <pin id="{}"/>
    </flexcomp>
  </worldbody>
</mujoco>
)",
             mesh_file, kWater * kCubicMetre * volume(body.mesh), kPascal * young_modulus(material),
             poisson_ratio(material),
             fmt::join(supported_corners(body, corners_of(body.mesh)), " "));
}

}  // namespace palpate::probing
