// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>

#include "geodesic/flat_triangles.h"
#include "mesh/triangle_fans.h"
#include "palpate/geometry/geodesic_surface.h"

namespace palpate::geometry {

/// A value that is made when it is first needed. Threads that need it at once may each make it; the
/// first one is kept.
template <class Value>
class MadeOnce {
 public:
  MadeOnce() = default;
  MadeOnce(const MadeOnce&) = delete;
  MadeOnce& operator=(const MadeOnce&) = delete;
  ~MadeOnce() { delete made_.load(); }

  /// \param make if it throws, this call throws the same, and the next call tries again
  template <class Make>
  const Value& get(const Make& make) const {
    const Value* made = made_.load();
    if (made == nullptr) {
      auto own = std::make_unique<const Value>(make());
      if (made_.compare_exchange_strong(made, own.get())) made = own.release();
    }
    return *made;
  }

 private:
  mutable std::atomic<const Value*> made_ = nullptr;
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
