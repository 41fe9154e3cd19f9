// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>

#include "geodesic/flat_triangles.h"
#include "mesh/triangle_fans.h"
#include "palpate/geometry/geodesic_surface.h"

namespace palpate::geometry {

/// A value that is made when it is first needed, by any thread.
template <class Value>
class MadeOnce {
 public:
  /// \param make  what it throws is thrown, and the next call tries again
  template <class Make>
  const Value& get(const Make& make) const {
    std::call_once(made_, [&] { value_ = make(); });
    return value_;
  }

 private:
  mutable std::once_flag made_;
  mutable Value value_;
};

struct GeodesicSurface::Impl {
  TriangleMesh mesh;

  [[nodiscard]] const TriangleFans& fans() const {
    return fans_.get([this] { return triangle_fans(mesh); });
  }
  /// \throws InvalidInput as `flat_triangles`.
  [[nodiscard]] const FlatTriangles& flat() const {
    return flat_.get([this] { return flat_triangles(mesh); });
  }

  MadeOnce<TriangleFans> fans_;
  MadeOnce<FlatTriangles> flat_;
};

}  // namespace palpate::geometry
