// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// A mesh with the data that distances and paths on it need: its triangles by vertex and, for exact
/// ones, each triangle laid in a plane. Each is made when a call first needs it, and then kept.
/// Copies share this data. Const use is thread-safe.
///
/// Functions of geodesics take a `GeodesicSurface`. For a single call, pass a `TriangleMesh`.
class GeodesicSurface {
 public:
  /// \throws InvalidInput if the mesh is not valid.
  // NOLINTNEXTLINE(google-explicit-constructor): so that a mesh can be passed, see above
  GeodesicSurface(const TriangleMesh& mesh);

  [[nodiscard]] const TriangleMesh& mesh() const;

  struct Impl;
  [[nodiscard]] const Impl& impl() const { return *impl_; }  ///< for the library itself

 private:
  std::shared_ptr<const Impl> impl_;
};

}  // namespace palpate::geometry
