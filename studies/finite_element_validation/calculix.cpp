// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "report.h"
#include "scratch_folder.h"
#include "solid_meshes.h"
#include "validation.h"

namespace palpate::bench {
namespace {

using Eigen::Vector3d;

// A solid of which some supports move; those give the reaction.
struct OracleCase {
  std::string name;
  probing::DeformableBody body;
  std::vector<bool> moved;  // of each support
};

template <typename Held, typename Moved>
void prescribe(OracleCase& c, const Held& held, const Moved& moved,
               const std::function<Vector3d(const Vector3d&)>& motion) {
  support::support_where(c.body, [&](const Vector3d& at) { return held(at) || moved(at); });
  for (const int node : c.body.supported) c.moved.push_back(moved(c.body.mesh.nodes.col(node)));
  support::move_supports(c.body, [&](const Vector3d& at) -> Vector3d {
    return moved(at) ? motion(at) : Vector3d::Zero();
  });
}

// A block of 20 x 20 x 10 mm whose upper side gets a smooth dent, a fifth of the height deep and
// dragged sideways. With a small bulk modulus, elements that lock answer as elements that do not.
OracleCase dented_block(int cells, double bulk_modulus) {
  OracleCase c{"dented block, Mooney-Rivlin, K = " + short_text(bulk_modulus) +
                   " N/mm^2, cells of " + short_text(20.0 / cells) + " mm",
               {},
               {}};
  c.body.mesh = probing::box_mesh(support::evenly(-10, 10, cells), support::evenly(-10, 10, cells),
                                  support::evenly(0, 10, cells / 2));
  c.body.materials = {{.shear_modulus = 0.05, .bulk_modulus = bulk_modulus, .mooney_share = 0.3}};
  prescribe(
      c, [](const Vector3d& at) { return at.z() == 10; },
      [](const Vector3d& at) { return at.z() == 0; },
      [](const Vector3d& at) -> Vector3d {
        const double shape =
            std::cos(std::numbers::pi / 20 * at.x()) * std::cos(std::numbers::pi / 20 * at.y());
        return shape * shape * Vector3d(1, 0.5, 2);
      });
  return c;
}

// The same with a flat square punch, whose edges are singular: elements differ most there.
OracleCase punched_block(int cells) {
  OracleCase c{"punched block, sharp edges, cells of " + short_text(20.0 / cells) + " mm", {}, {}};
  c.body.mesh = probing::box_mesh(support::evenly(-10, 10, cells), support::evenly(-10, 10, cells),
                                  support::evenly(0, 10, cells / 2));
  c.body.materials = {{.shear_modulus = 0.05, .bulk_modulus = 0.5, .mooney_share = 0.3}};
  prescribe(
      c, [](const Vector3d& at) { return at.z() == 10; },
      [](const Vector3d& at) { return at.z() == 0 && at.head<2>().cwiseAbs().maxCoeff() <= 5; },
      [](const Vector3d&) { return Vector3d(1, 0.5, 2); });
  return c;
}

// A beam of 40 x 4 x 4 mm; one end moves by 14 mm, so far that the beam is stretched as well.
OracleCase bent_beam() {
  OracleCase c{"beam, its end moved by 14 of 40 mm, neo-Hookean", {}, {}};
  c.body.mesh = probing::box_mesh(support::evenly(0, 40, 20), support::evenly(-2, 2, 2),
                                  support::evenly(-2, 2, 2));
  c.body.materials = {{.shear_modulus = 0.3, .bulk_modulus = 3}};
  prescribe(
      c, [](const Vector3d& at) { return at.x() == 0; },
      [](const Vector3d& at) { return at.x() == 40; },
      [](const Vector3d&) { return Vector3d(0, 4, 13.4); });
  return c;
}

// A bar of 30 x 12 x 12 mm with a region ten times as stiff, stretched by 30 % and sheared.
OracleCase stiff_region() {
  OracleCase c{"bar with a stiff region, stretched by 30 %, neo-Hookean", {}, {}};
  c.body.mesh = probing::box_mesh(support::evenly(0, 30, 10), support::evenly(0, 12, 4),
                                  support::evenly(0, 12, 4));
  c.body.materials = {{.shear_modulus = 0.05, .bulk_modulus = 0.5},
                      {.shear_modulus = 0.5, .bulk_modulus = 5}};
  for (Eigen::Index e = 0; e < c.body.mesh.elements.cols(); ++e) {
    Vector3d middle = Vector3d::Zero();
    for (int a = 0; a < 4; ++a) middle += c.body.mesh.nodes.col(c.body.mesh.elements(a, e)) / 4;
    if (middle.x() > 12 && middle.x() < 21 && middle.z() > 6)
      c.body.mesh.regions[static_cast<std::size_t>(e)] = 1;
  }
  prescribe(
      c, [](const Vector3d& at) { return at.x() == 0; },
      [](const Vector3d& at) { return at.x() == 30; },
      [](const Vector3d&) { return Vector3d(9, 0, 3); });
  return c;
}

void print_nodes(std::ostream& out, const OracleCase& c, bool moved) {
  for (std::size_t k = 0; k < c.moved.size(); ++k)
    if (c.moved[k] == moved) out << c.body.supported[k] + 1 << ",\n";
}

// CalculiX numbers the nodes of C3D10 as we do. Its volumetric energy is K/2 (J - 1)^2, ours
// K/4 (J^2 - 1 - 2 ln J): the same to second order in J - 1.
void write_input(const OracleCase& c, const std::filesystem::path& path) {
  std::ofstream out(path);
  out.precision(15);
  out << "*NODE, NSET=ALL\n";
  for (Eigen::Index n = 0; n < c.body.mesh.nodes.cols(); ++n) {
    const Vector3d at = c.body.mesh.nodes.col(n);
    out << n + 1 << ", " << at.x() << ", " << at.y() << ", " << at.z() << '\n';
  }
  for (std::size_t region = 0; region < c.body.materials.size(); ++region) {
    out << "*ELEMENT, TYPE=C3D10, ELSET=REGION" << region << '\n';
    for (Eigen::Index e = 0; e < c.body.mesh.elements.cols(); ++e) {
      if (c.body.mesh.regions[static_cast<std::size_t>(e)] != static_cast<int>(region)) continue;
      out << e + 1;
      for (const int node : c.body.mesh.elements.col(e)) out << ", " << node + 1;
      out << '\n';
    }
    const probing::Hyperelastic& material = c.body.materials[region];
    const double half = material.shear_modulus / 2;
    out << "*MATERIAL, NAME=MATERIAL" << region << "\n*HYPERELASTIC, MOONEY-RIVLIN\n"
        << half * (1 - material.mooney_share) << ", " << half * material.mooney_share << ", "
        << 2 / material.bulk_modulus << "\n*SOLID SECTION, ELSET=REGION" << region
        << ", MATERIAL=MATERIAL" << region << '\n';
  }
  out << "*NSET, NSET=MOVED\n";
  print_nodes(out, c, true);
  out << "*NSET, NSET=HELD\n";
  print_nodes(out, c, false);
  out << "*STEP, NLGEOM, INC=1000\n*STATIC\n0.1, 1., 1e-4, 0.1\n*BOUNDARY\nHELD, 1, 3\n";
  for (std::size_t k = 0; k < c.moved.size(); ++k) {
    if (!c.moved[k]) continue;
    for (int i = 0; i < 3; ++i)
      out << c.body.supported[k] + 1 << ", " << i + 1 << ", " << i + 1 << ", "
          << c.body.support_moves(i, static_cast<Eigen::Index>(k)) << '\n';
  }
  out << "*NODE PRINT, NSET=ALL, FREQUENCY=1000\nU\n"
         "*NODE PRINT, NSET=MOVED, TOTALS=ONLY, FREQUENCY=1000\nRF\n*END STEP\n";
  if (!out.flush()) throw std::runtime_error("cannot write " + path.string());
}

struct OracleResult {
  double time = 0;  // 1 at the end of the step
  Eigen::Matrix3Xd displacements;
  Vector3d reaction = Vector3d::Zero();
};

// The last block of each kind in the printed file.
OracleResult read_result(const std::filesystem::path& path, Eigen::Index nodes) {
  OracleResult result;
  result.displacements.setConstant(3, nodes, std::numeric_limits<double>::quiet_NaN());
  std::ifstream in(path);
  std::string line;
  bool totals = false;
  while (std::getline(in, line)) {
    if (const auto at = line.find("time"); at != std::string::npos) {
      totals = line.find("total force") != std::string::npos;
      result.time = std::stod(line.substr(at + 4));
      continue;
    }
    std::istringstream words(line);
    Eigen::Index node = 0;
    Vector3d value;
    if (totals) {
      if (words >> value.x() >> value.y() >> value.z()) result.reaction = value;
    } else if (words >> node >> value.x() >> value.y() >> value.z() && node >= 1 && node <= nodes) {
      result.displacements.col(node - 1) = value;
    }
  }
  return result;
}

void compare_case(const OracleCase& c, const ScratchFolder& folder) {
  write_input(c, folder / "job.inp");
  const std::string command = "cd '" + folder.path().string() + "' && ccx -i job > job.log 2>&1";
  const int status = std::system(command.c_str());
  const Eigen::Index nodes = c.body.mesh.nodes.cols();
  const OracleResult oracle = read_result(folder / "job.dat", nodes);
  if (status != 0 || oracle.time != 1 || !oracle.displacements.allFinite()) {
    std::printf("%s: ccx found no equilibrium (status %d, time %g of 1)\n", c.name.c_str(), status,
                oracle.time);
    return;
  }
  const probing::ContactEquilibrium solid(c.body);
  const Eigen::Matrix3Xd ours = solid.rest() - c.body.mesh.nodes;
  const Eigen::Matrix3Xd forces = support::node_forces(c.body, solid.rest());
  Vector3d reaction = Vector3d::Zero();
  std::vector<bool> free(static_cast<std::size_t>(nodes), true);
  for (std::size_t k = 0; k < c.moved.size(); ++k) {
    free[static_cast<std::size_t>(c.body.supported[k])] = false;
    if (c.moved[k]) reaction += forces.col(c.body.supported[k]);
  }
  double difference = 0, size = 0, largest = 0;
  for (Eigen::Index n = 0; n < nodes; ++n) {
    if (!free[static_cast<std::size_t>(n)]) continue;
    const double squared = (ours.col(n) - oracle.displacements.col(n)).squaredNorm();
    difference += squared;
    size += oracle.displacements.col(n).squaredNorm();
    largest = std::max(largest, std::sqrt(squared));
  }
  print_line(c.name + ": reaction [N]", reaction.norm(), oracle.reaction.norm());
  print_line("  difference of the reactions as vectors, relative",
             (reaction - oracle.reaction).norm() / oracle.reaction.norm());
  print_line("  RMS difference of displacements of free nodes, relative",
             std::sqrt(difference / size));
  print_line("  largest difference [mm]", largest);
}

}  // namespace

void compare_with_calculix() {
  print_title("CalculiX, prescribed displacements, the same meshes of C3D10");
  if (std::system("command -v ccx > /dev/null") != 0) {
    std::printf("skipped: there is no program 'ccx' (Debian: calculix-ccx)\n");
    return;
  }
  const ScratchFolder folder;
  for (const OracleCase& c : {dented_block(8, 0.5), dented_block(12, 0.5), dented_block(8, 0.1),
                              bent_beam(), stiff_region(), punched_block(8), punched_block(12)})
    compare_case(c, folder);
}

}  // namespace palpate::bench
