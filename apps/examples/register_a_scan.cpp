// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
//
// A scan is moved onto a mesh, and the result judged. Needs a mesh: register_a_scan hand.ply. The
// scan is every fifth vertex of it, turned by 20 degrees and shifted. Prints the verdict and how
// far the points come to lie from where they belong.
#include <palpate/core/error.h>
#include <palpate/geometry/mesh_io.h>
#include <palpate/geometry/registration.h>

#include <cstdio>
#include <numbers>

namespace geometry = palpate::geometry;

int main(int count, char** arguments) try {
  if (count != 2) throw palpate::InvalidInput("usage: register_a_scan MESH");
  const geometry::TriangleMesh mesh = geometry::read_mesh(arguments[1]);
  const Eigen::Matrix3Xd truth =
      mesh.vertices(Eigen::all, Eigen::seq(0, Eigen::last, Eigen::fix<5>));
  const Eigen::Vector3d middle = truth.rowwise().mean();
  const Eigen::Isometry3d T_scan_mesh =
      Eigen::Translation3d(middle + Eigen::Vector3d(9, -7, 5)) *
      Eigen::AngleAxisd(std::numbers::pi / 9, Eigen::Vector3d(1, 2, -1).normalized()) *
      Eigen::Translation3d(-middle);
  const Eigen::Matrix3Xd scan = T_scan_mesh * truth;

  const geometry::Registration found = geometry::register_points(scan, mesh);
  std::printf("%s: %s\n", geometry::to_string(found.verdict), found.reason.c_str());
  const Eigen::Matrix3Xd moved = found.T_target_source * scan;
  std::printf("%ld points, largest error %.4f mm\n", static_cast<long>(scan.cols()),
              (moved - truth).colwise().norm().maxCoeff());
  return found.verdict == geometry::RegistrationVerdict::accepted ? 0 : 1;
} catch (const palpate::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
