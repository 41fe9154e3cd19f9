// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <cmath>
#include <limits>
#include <vector>

#include "surface_query_peers.h"

namespace palpate::bench {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 to_point(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

}  // namespace

struct CgalPeer::Impl {
  Triangles triangles;
  Tree tree;
};

CgalPeer::CgalPeer(const geometry::TriangleMesh& mesh) : impl_(std::make_unique<Impl>()) {
  for (const auto& t : mesh.triangles.colwise()) {
    impl_->triangles.emplace_back(to_point(mesh.vertices.col(t[0])),
                                  to_point(mesh.vertices.col(t[1])),
                                  to_point(mesh.vertices.col(t[2])));
  }
  impl_->tree.insert(impl_->triangles.cbegin(), impl_->triangles.cend());
  impl_->tree.build();
  impl_->tree.accelerate_distance_queries();
}
CgalPeer::~CgalPeer() = default;

double CgalPeer::distance(const Eigen::Vector3d& point) const {
  return std::sqrt(impl_->tree.squared_distance(to_point(point)));
}

double CgalPeer::first_crossing(const Eigen::Vector3d& origin, const Eigen::Vector3d& along,
                                float far) const {
  const Kernel::Point_3 start = to_point(origin), end = to_point(origin + along);
  const auto place = [&](const auto& found) {
    if (!found) return std::numeric_limits<double>::quiet_NaN();
    const auto* p = boost::get<Kernel::Point_3>(&found->first);
    if (p == nullptr) return std::numeric_limits<double>::quiet_NaN();
    return std::sqrt(CGAL::squared_distance(start, *p)) / along.norm();
  };
  // CGAL knows the first hit of a ray only; of a segment it is that, if it comes before the end.
  const double first = place(impl_->tree.first_intersection(Kernel::Ray_3(start, end)));
  return first <= static_cast<double>(far) ? first : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace palpate::bench
