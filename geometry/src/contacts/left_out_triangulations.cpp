// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/left_out_triangulations.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "contacts/coarse_triangulation.h"
#include "palpate/core/error.h"

namespace palpate::geometry {

struct LeftOutTriangulations::Impl {
  const TriangleMesh& surface;
  ContactTriangulationMethod method;
  std::vector<SurfacePoint> contacts;
  std::optional<CoarsenedSurface> coarsened;  ///< with `delaunay`
};

LeftOutTriangulations::LeftOutTriangulations(const TriangleMesh& surface,
                                             std::span<const SurfacePoint> contacts,
                                             const ContactTriangulationOptions& options) {
  if (contacts.size() < 4) {
    throw InvalidInput("LeftOutTriangulations: got " + std::to_string(contacts.size()) +
                       " contacts; without one, at least three must be left");
  }
  const Eigen::Matrix3Xd places = places_of_contacts(surface, contacts);
  auto impl =
      std::make_unique<Impl>(Impl{surface, options.method, {contacts.begin(), contacts.end()}, {}});
  if (options.method == ContactTriangulationMethod::delaunay) {
    WorkSteps steps(options.progress, static_cast<int>(surface.vertices.cols()) + 1);
    impl->coarsened.emplace(surface, contacts, places, steps);
    steps.end();
  }
  impl_ = std::move(impl);
}

LeftOutTriangulations::~LeftOutTriangulations() = default;
LeftOutTriangulations::LeftOutTriangulations(LeftOutTriangulations&&) noexcept = default;
LeftOutTriangulations& LeftOutTriangulations::operator=(LeftOutTriangulations&&) noexcept = default;

ContactTriangulation LeftOutTriangulations::without(std::size_t contact) const {
  if (contact >= impl_->contacts.size()) {
    throw InvalidInput("LeftOutTriangulations: there are " +
                       std::to_string(impl_->contacts.size()) + " contacts, but contact " +
                       std::to_string(contact) + " was to be left out");
  }
  if (impl_->coarsened) {
    CoarsenedSurface rest = *impl_->coarsened;
    if (rest.leave_out(static_cast<int>(contact)))
      return with_manifold_vertices(rest.triangles(), rest.places());
  }
  std::vector<SurfacePoint> others = impl_->contacts;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(contact));
  return triangulate_contacts(impl_->surface, others, {.method = impl_->method});
}

}  // namespace palpate::geometry
