// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "palpate/geometry/contact_triangulation.h"

namespace palpate::geometry {

/// Triangulations of all contacts but one. With `delaunay`, the surface is coarsened once, to all
/// contacts; the one that is left out is then removed like any other vertex, which takes a small
/// part of the time. At the border, whose shape needs it, it stays as a helper, and the helpers
/// stay as far apart as for all contacts. Thread-safe.
class LeftOutTriangulations {
 public:
  /// \param surface must outlive this.
  /// \param options `progress` is that of the triangulation of all contacts.
  /// \throws InvalidInput if there are fewer than four contacts, and as `triangulate_contacts`.
  LeftOutTriangulations(const TriangleMesh& surface, std::span<const SurfacePoint> contacts,
                        const ContactTriangulationOptions& options = {});
  ~LeftOutTriangulations();
  LeftOutTriangulations(LeftOutTriangulations&&) noexcept;
  LeftOutTriangulations& operator=(LeftOutTriangulations&&) noexcept;

  /// The triangulation without one contact; those after it move up.
  /// \throws InvalidInput if there is no such contact, and as `triangulate_contacts`.
  [[nodiscard]] ContactTriangulation without(std::size_t contact) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace palpate::geometry
