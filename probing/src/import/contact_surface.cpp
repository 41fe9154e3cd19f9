// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/contact_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <boost/polygon/voronoi.hpp>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "palpate/geometry/facing_share.h"

namespace palpate::probing {
namespace {

using Triangle = std::array<int, 3>;
using Edge = std::pair<int, int>;  // as the triangle on its left has it

InvalidInput refused(const std::string& problem) {
  return InvalidInput(std::vector<MessagePart>{{"contact_surface()", true}, {": " + problem}});
}

/// The direction from which the surface is seen.
Eigen::Vector3d mean_normal(std::span<const Contact> contacts) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Contact& contact : contacts) sum += contact.normal.normalized();
  return sum.normalized();
}

/// Positions in the plane across `normal`, in the whole numbers from which Voronoi cells are made.
std::vector<std::array<std::int32_t, 2>> in_plane(std::span<const Contact> contacts,
                                                  const Eigen::Vector3d& normal) {
  const Eigen::Vector3d x = normal.unitOrthogonal(), y = normal.cross(x);
  Eigen::Matrix2Xd places(2, static_cast<Eigen::Index>(contacts.size()));
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Eigen::Vector3d p = contacts[i].position - contacts[0].position;
    places.col(static_cast<Eigen::Index>(i)) = Eigen::Vector2d(p.dot(x), p.dot(y));
  }
  constexpr double kLargest = 1 << 30;
  const double scale = kLargest / places.cwiseAbs().maxCoeff();
  std::vector<std::array<std::int32_t, 2>> result;
  std::map<std::array<std::int32_t, 2>, long long> taken;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Eigen::Vector2d p = scale * places.col(static_cast<Eigen::Index>(i));
    result.push_back({static_cast<std::int32_t>(std::lround(p.x())),
                      static_cast<std::int32_t>(std::lround(p.y()))});
    const auto [other, added] = taken.emplace(result.back(), contacts[i].id);
    if (added) continue;
    throw refused("contacts " + std::to_string(other->second) + " and " +
                  std::to_string(contacts[i].id) +
                  " are behind each other, seen along the mean normal; a surface can only be "
                  "made of contacts on one side of an object");
  }
  return result;
}

/// Counter-clockwise triangles; contacts on a common circle are a fan.
std::vector<Triangle> delaunay(const std::vector<std::array<std::int32_t, 2>>& places) {
  std::vector<boost::polygon::point_data<std::int32_t>> points;
  points.reserve(places.size());
  for (const auto& [x, y] : places) points.emplace_back(x, y);
  boost::polygon::voronoi_diagram<double> diagram;
  boost::polygon::construct_voronoi(points.begin(), points.end(), &diagram);
  std::vector<Triangle> triangles;
  for (const auto& vertex : diagram.vertices()) {
    std::vector<int> around;
    const auto* edge = vertex.incident_edge();
    do {
      around.push_back(static_cast<int>(edge->cell()->source_index()));
      edge = edge->rot_next();
    } while (edge != vertex.incident_edge());
    for (std::size_t i = 2; i < around.size(); ++i) {
      Triangle triangle = {around[0], around[i - 1], around[i]};
      const auto at = [&](int k) {
        const auto& place = places[static_cast<std::size_t>(triangle[static_cast<std::size_t>(k)])];
        return Eigen::Vector2d(place[0], place[1]);
      };
      const Eigen::Vector2d u = at(1) - at(0), v = at(2) - at(0);
      const double area = u.x() * v.y() - u.y() * v.x();
      if (area < 0) std::swap(triangle[1], triangle[2]);
      if (area != 0) triangles.push_back(triangle);
    }
  }
  return triangles;
}

/// Left out from the border inwards.
class Trimming {
 public:
  Trimming(std::span<const Contact> contacts, std::vector<Triangle> triangles)
      : contacts_(contacts), triangles_(std::move(triangles)) {}

  /// Triangles that bridge gaps.
  void remove_long(double factor) {
    std::vector<double> lengths;
    for (const Triangle& triangle : triangles_)
      for (std::size_t k = 0; k < 3; ++k) lengths.push_back(length(triangle, k));
    const double longest = factor * median(lengths);
    std::erase_if(triangles_, [&](const Triangle& triangle) {
      return length(triangle, 0) > longest || length(triangle, 1) > longest ||
             length(triangle, 2) > longest;
    });
  }

  /// Flat triangles at the border, such as between nearly collinear contacts of its lines. They
  /// are flat in the plane across the normal: errors of heights make them steep, not wide. The only
  /// triangle of a contact stays.
  void remove_needles(const Eigen::Vector3d& normal) {
    constexpr double kLeastHeight = 0.1;  // of the edge at the border
    for (bool removed = true; removed;) {
      std::map<Edge, int> edges;
      std::vector<int> uses(contacts_.size(), 0);
      for (const Triangle& triangle : triangles_) {
        for (std::size_t k = 0; k < 3; ++k) {
          ++edges[{triangle[k], triangle[(k + 1) % 3]}];
          ++uses[static_cast<std::size_t>(triangle[k])];
        }
      }
      removed =
          std::erase_if(triangles_, [&](const Triangle& triangle) {
            const auto is_last = [&](int c) { return uses[static_cast<std::size_t>(c)] == 1; };
            if (std::ranges::any_of(triangle, is_last)) return false;
            for (std::size_t k = 0; k < 3; ++k) {
              const bool at_border = !edges.contains({triangle[(k + 1) % 3], triangle[k]});
              const Eigen::Vector3d edge = at(triangle[(k + 1) % 3]) - at(triangle[k]);
              const double base = edge.cross(normal).squaredNorm();
              if (!at_border || twice_area(triangle, normal) >= kLeastHeight * base) continue;
              for (const int c : triangle) --uses[static_cast<std::size_t>(c)];
              return true;
            }
            return false;
          }) > 0;
    }
  }

  [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }

 private:
  [[nodiscard]] const Eigen::Vector3d& at(int contact) const {
    return contacts_[static_cast<std::size_t>(contact)].position;
  }
  [[nodiscard]] double length(const Triangle& triangle, std::size_t k) const {
    return (at(triangle[(k + 1) % 3]) - at(triangle[k])).norm();
  }
  /// Seen along the normal.
  [[nodiscard]] double twice_area(const Triangle& t, const Eigen::Vector3d& normal) const {
    return (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).dot(normal);
  }

  std::span<const Contact> contacts_;
  std::vector<Triangle> triangles_;
};

geometry::TriangleMesh mesh_of(std::span<const Contact> contacts,
                               const std::vector<Triangle>& triangles) {
  geometry::TriangleMesh mesh{Eigen::Matrix3Xd(3, static_cast<Eigen::Index>(contacts.size())),
                              Eigen::Matrix3Xi(3, static_cast<Eigen::Index>(triangles.size()))};
  for (std::size_t i = 0; i < contacts.size(); ++i)
    mesh.vertices.col(static_cast<Eigen::Index>(i)) = contacts[i].position;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Triangle& t = triangles[i];
    mesh.triangles.col(static_cast<Eigen::Index>(i)) = Eigen::Vector3i(t[0], t[1], t[2]);
  }
  return mesh;
}

geometry::TriangleMesh triangulated(std::span<const Contact> contacts,
                                    const ContactSurfaceOptions& options) {
  const Eigen::Vector3d normal = mean_normal(contacts);
  Trimming trimming(contacts, delaunay(in_plane(contacts, normal)));
  if (trimming.triangles().empty())
    throw refused("all contacts are in a line; a surface needs contacts on both sides of it");
  trimming.remove_long(options.longest_edge);
  trimming.remove_needles(normal);
  return mesh_of(contacts, trimming.triangles());
}

/// A contact that does not fit, by its index among those kept, and the reason.
struct Misfit {
  std::size_t contact;
  std::string reason, advice;
};

std::vector<Misfit> turned_away(std::span<const Contact> contacts) {
  constexpr double kSteepest = 0.258819;  // cosine of 75 degrees
  const Eigen::Vector3d mean = mean_normal(contacts);
  std::vector<Misfit> misfits;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (contacts[i].normal.normalized().dot(mean) > kSteepest) continue;
    misfits.push_back({i, "has a normal that is more than 75 degrees from the mean of all",
                       "a surface can only be made of contacts on one side of an object. Scan the "
                       "object, or import each side on its own"});
  }
  return misfits;
}

std::vector<Misfit> off_the_surface(std::span<const Contact> contacts,
                                    const geometry::TriangleMesh& mesh, double tip_radius) {
  constexpr double kMost = 0.5;
  Eigen::Matrix3Xd normals(3, mesh.vertices.cols());
  std::vector<geometry::SurfacePoint> places = geometry::vertex_points(mesh);
  std::vector<Misfit> misfits;
  std::vector<std::size_t> used;
  std::vector<geometry::SurfacePoint> seen;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (places[i].triangle < 0) {
      misfits.push_back({i, "is in no triangle",
                         "it is too far from the others, or in a line with them; remove it, or "
                         "probe around it"});
      continue;
    }
    normals.col(static_cast<Eigen::Index>(used.size())) = contacts[i].normal;
    used.push_back(i);
    seen.push_back(places[i]);
  }
  if (used.empty()) return misfits;
  const Eigen::VectorXd shares = geometry::facing_shares(
      mesh, seen, normals.leftCols(static_cast<Eigen::Index>(used.size())), tip_radius);
  for (std::size_t k = 0; k < used.size(); ++k) {
    if (shares[static_cast<Eigen::Index>(k)] >= kMost) continue;
    misfits.push_back({used[k], "has a normal from which the surface around it faces away",
                       "the surface is folded there, or the normal is wrong; probe more densely, "
                       "scan the object, or check the normals"});
  }
  return misfits;
}

/// Takes contacts out of those kept.
class Selection {
 public:
  explicit Selection(std::span<const Contact> contacts)
      : contacts_(contacts), kept_(contacts.size()) {
    std::iota(kept_.begin(), kept_.end(), std::size_t{0});
  }

  [[nodiscard]] std::vector<Contact> contacts() const {
    std::vector<Contact> result;
    result.reserve(kept_.size());
    for (const std::size_t i : kept_) result.push_back(contacts_[i]);
    return result;
  }

  /// \throws InvalidInput if that is more than may be left out.
  void leave_out(const std::vector<Misfit>& misfits) {
    for (const Misfit& misfit : misfits) left_out_.emplace(kept_[misfit.contact], misfit.reason);
    if (left_out_.size() > contacts_.size() / kContactsPerMisfit) {
      const Misfit& first = misfits.front();
      std::string message =
          "contact " + std::to_string(contacts_[kept_[first.contact]].id) + " " + first.reason;
      if (left_out_.size() > 1)
        message += " (and " + std::to_string(left_out_.size()) + " contacts in all do not fit)";
      throw refused(message + ": " + first.advice);
    }
    std::erase_if(kept_, [&](std::size_t i) { return left_out_.contains(i); });
  }

  [[nodiscard]] ContactSurface surface(geometry::TriangleMesh mesh) && {
    ContactSurface result{std::move(mesh), std::move(kept_), {}};
    for (auto& [i, reason] : left_out_) result.left_out.push_back({contacts_[i].id, reason});
    return result;
  }

 private:
  std::span<const Contact> contacts_;
  std::vector<std::size_t> kept_;
  std::map<std::size_t, std::string> left_out_;  // by index, why
};

}  // namespace

void visit(ContactSurfaceOptions& options, FieldVisitor& visitor) {
  visitor.begin("ContactSurfaceOptions");
  visitor.real({"longest_edge",
                "Leave out triangles with an edge longer than this many times the median edge of "
                "the surface that is made of contacts"},
               options.longest_edge, above(1).finite());
  visitor.real(
      {"tip_radius", "Radius of the tip, over which the side of the surface at a contact is found",
       "mm", false, "probe-radius"},
      options.tip_radius, above(0).finite());
}

ContactSurface contact_surface(std::span<const Contact> contacts,
                               const ContactSurfaceOptions& options) {
  static_cast<void>(in_range(options));
  if (contacts.size() < 3) {
    throw refused("there are " + std::to_string(contacts.size()) +
                  " contacts; a surface needs at least three");
  }
  Selection selection(contacts);
  selection.leave_out(turned_away(contacts));
  for (;;) {
    const std::vector<Contact> kept = selection.contacts();
    geometry::TriangleMesh mesh = triangulated(kept, options);
    const std::vector<Misfit> misfits = off_the_surface(kept, mesh, options.tip_radius);
    if (misfits.empty()) return std::move(selection).surface(std::move(mesh));
    selection.leave_out(misfits);
  }
}

}  // namespace palpate::probing
