// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/geodesic_surface.h"

#include <memory>
#include <utility>

#include "geodesic/geodesic_surface_data.h"

namespace palpate::geometry {

GeodesicSurface::GeodesicSurface(const TriangleMesh& mesh) {
  check_mesh(mesh, "mesh");
  auto impl = std::make_shared<Impl>();
  impl->mesh = mesh;
  impl_ = std::move(impl);
}

const TriangleMesh& GeodesicSurface::mesh() const { return impl_->mesh; }

}  // namespace palpate::geometry
