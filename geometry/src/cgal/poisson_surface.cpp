// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "scans/poisson_surface.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Random.h>
#include <CGAL/poisson_surface_reconstruction.h>
#include <CGAL/property_map.h>

#include <string>
#include <utility>
#include <vector>

#include "palpate/error.h"
#include "palpate/geometry/cgal_mesh.h"

namespace palpate::geometry {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Sample = std::pair<Kernel::Point_3, Kernel::Vector_3>;

constexpr double kLeastAngle = 20;  // [deg] of a triangle: the mesher terminates only up to 30
/// Largest circumradius of a triangle and distance from the surface, in spacings.
constexpr double kRadius = 1.5;
constexpr double kDistance = 0.25;

}  // namespace

TriangleMesh poisson_surface(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& normals,
                             double spacing) {
  std::vector<Sample> samples;
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    samples.emplace_back(Kernel::Point_3(points(0, i), points(1, i), points(2, i)),
                         Kernel::Vector_3(normals(0, i), normals(1, i), normals(2, i)));
  }
  // Fix the seed: the mesher starts at random points, so the surface would differ each time.
  CGAL::get_default_random() = CGAL::Random(0);
  CGAL::Surface_mesh<Kernel::Point_3> surface;
  bool found = false;
  try {
    found = CGAL::poisson_surface_reconstruction_delaunay(
        samples.begin(), samples.end(), CGAL::First_of_pair_property_map<Sample>(),
        CGAL::Second_of_pair_property_map<Sample>(), surface, spacing, kLeastAngle, kRadius,
        kDistance, CGAL::Manifold_tag());
  } catch (const CGAL::Failure_exception& failure) {
    throw SolverError(std::string("merge_scans: the surface could not be found: ") +
                      failure.what());
  }
  if (!found || surface.number_of_faces() == 0) {
    throw SolverError("merge_scans: there is no surface through these " +
                      std::to_string(points.cols()) +
                      " points; check that the front sides of all scans face outwards");
  }
  return from_surface_mesh(surface);
}

}  // namespace palpate::geometry
