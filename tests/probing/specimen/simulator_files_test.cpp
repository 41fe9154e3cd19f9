// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/simulator_files.h"

#include <gmock/gmock.h>

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "palpate/probing/specimen_file.h"
#include "refusal.h"
#include "scratch_folder.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

FiniteElementObject object_of(const std::string& members) {
  return parse_finite_elements(R"({"type": "finite_elements", "size": [30, 30, 12],
    "cells": [4, 4, 2], "shear_modulus": 0.04, "bulk_modulus": 0.3, "tip_radius": 4)" +
                                   members + "}",
                               "a.json");
}

boost::property_tree::ptree xml_of(const std::string& text) {
  std::istringstream in(text);
  boost::property_tree::ptree tree;
  read_xml(in, tree);
  return tree;
}

// The last total force that CalculiX printed.
Vector3d printed_total(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::string line;
  Vector3d result = Vector3d::Zero(), value;
  bool totals = false;
  while (std::getline(in, line)) {
    if (line.find("time") != std::string::npos)
      totals = line.find("total force") != std::string::npos;
    std::istringstream words(line);
    if (totals && words >> value.x() >> value.y() >> value.z()) result = value;
  }
  return result;
}

TEST(SimulatorFiles, CalculixFindsTheForceOfThePress) {
  if (std::system("command -v ccx > /dev/null") != 0)
    GTEST_SKIP() << "there is no program ccx (Debian: calculix-ccx)";
  const FiniteElementObject object = object_of(
      R"(, "regions": [{"low": [0, -20, 690], "high": [20, 20, 720], "shear_modulus": 0.08}],
         "supports": [{"side": "bottom"}, {"side": "left", "move": [-1, 0, 0]}])");
  const ContactEquilibrium solid(object.body, object.options.contact);
  const ContactState from = solid.touch({2, -1, 700}, {0, 0, 1});
  const Vector3d force(0.1, 0.05, 1.2);
  const ContactResult pressed = solid.apply_force(from, force);
  ASSERT_EQ(pressed.stop, ContactStop::converged);
  const ScratchFolder folder;
  {
    std::ofstream out(folder / "job.inp");
    write_calculix(out, object,
                   KnownPress{1, {2, -1, 700}, {0, 0, 1}, pressed.state.tip - from.tip, force});
  }
  const std::string command = "cd '" + folder.path().string() + "' && ccx -i job > job.log 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0);
  const Vector3d found = printed_total(folder / "job.dat");
  // C3D10 does not use a mean volume ratio: docs/probing-validation.md has 1 to 4 %.
  EXPECT_LT((found - force).norm(), 0.05 * force.norm()) << found.transpose();
}

TEST(SimulatorFiles, TheLinearMeshIsTheSolid) {
  const FiniteElementObject object = object_of("");
  const ScratchFolder folder;
  {
    std::ofstream out(folder / "solid.msh");
    write_linear_gmsh(out, object.body.mesh, 1);
  }
  const FiniteElementMesh read = read_gmsh(folder / "solid.msh");
  EXPECT_EQ(read.elements.cols(), object.body.mesh.elements.cols());
  EXPECT_NEAR(volume(read), 30 * 30 * 12, 1e-6);
}

TEST(SimulatorFiles, SofaGetsARegionForEachMaterial) {
  std::ostringstream out;
  write_sofa(out, object_of(R"(, "mooney_share": 0.5,
      "regions": [{"low": [0, -20, 690], "high": [20, 20, 720], "shear_modulus": 0.08,
                   "mooney_share": 0}])"),
             "solid.msh");
  const auto tree = xml_of(out.str());
  const auto& solid = tree.get_child("Node.Node");
  EXPECT_EQ(solid.get<std::string>("MeshGmshLoader.<xmlattr>.filename"), "solid.msh");
  std::vector<std::string> materials, parameters;
  std::size_t corners = 0;
  for (const auto& [name, child] : solid) {
    if (name != "Node") continue;
    const auto& law = child.get_child("TetrahedronHyperelasticityFEMForceField.<xmlattr>");
    materials.push_back(law.get<std::string>("materialName"));
    parameters.push_back(law.get<std::string>("ParameterSet"));
    std::istringstream words(
        child.get<std::string>("TetrahedronSetTopologyContainer.<xmlattr>.tetrahedra"));
    for (int corner = 0; words >> corner;) ++corners;
  }
  EXPECT_THAT(materials, ::testing::ElementsAre("MooneyRivlin", "MooneyRivlin"));
  EXPECT_THAT(parameters, ::testing::ElementsAre("0.01 0.01 0.3", "0.04 0 1.6"));
  EXPECT_EQ(corners, 4U * 6 * 4 * 4 * 2);
}

TEST(SimulatorFiles, MujocoGetsYoungsModulusInPascal) {
  std::ostringstream out;
  write_mujoco(out, object_of(""), "solid.msh");
  const auto tree = xml_of(out.str());
  const auto& flex = tree.get_child("mujoco.worldbody.flexcomp");
  const double poisson = flex.get<double>("elasticity.<xmlattr>.poisson");
  EXPECT_NEAR(flex.get<double>("elasticity.<xmlattr>.young"), 1e6 * 2 * 0.04 * (1 + poisson), 1);
  EXPECT_NEAR(poisson, (3 * 0.3 - 2 * 0.04) / (2 * (3 * 0.3 + 0.04)), 1e-6);
  EXPECT_NEAR(flex.get<double>("<xmlattr>.mass"), 1e-6 * 30 * 30 * 12, 1e-9);
}

TEST(SimulatorFiles, RefusesWhatASimulatorCannotDescribe) {
  std::ostringstream out;
  EXPECT_THAT(refusal([&] {
                write_mujoco(out, object_of(R"(, "regions": [{"low": [0, -20, 690],
                                 "high": [20, 20, 720], "shear_modulus": 0.08}])"),
                             "a.msh");
              }),
              HasSubstr("2 regions"));
  EXPECT_THAT(refusal([&] {
                write_mujoco(out, object_of(R"(, "supports": [{"side": "bottom"},
                                 {"side": "left", "move": [-1, 0, 0]}])"),
                             "a.msh");
              }),
              HasSubstr("pre-stretch"));
  EXPECT_THAT(refusal([&] {
                write_sofa(out, object_of(R"(, "obstacles": [{"low": [-5, -5, 715],
                               "high": [5, 5, 725]}])"),
                           "a.msh");
              }),
              HasSubstr("obstacles"));
  EXPECT_TRUE(out.str().empty());
}

}  // namespace
}  // namespace palpate::probing
