// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"
#include "query/distance_bound.h"
#include "query/texture_seams.h"

namespace palpate::geometry {

/// Connections between the triangles of a mesh.
struct Gluing {
  /// For each triangle: nonzero if one of its edges has more than two triangles or two of opposite
  /// orientation.
  std::vector<char> bad_edge;
  /// For each vertex, the number of fans its triangles form; 1 where the mesh is manifold.
  std::vector<int> fans;
};

/// \param joined of each vertex: the one whose place and neighbours it shares; itself if it is no
/// seam.
[[nodiscard]] Gluing gluing(const TriangleMesh& mesh, const std::vector<int>& joined);

/// Removes almost degenerate triangles as far as this moves the surface by no more than their
/// height: at the border they are dropped, elsewhere their longest edge is flipped. Since the
/// height may exceed the tolerance, triangles with three `fixed` vertices stay. So do those whose
/// longest edge is between vertices at a seam, which would open.
void mend_slivers(TriangleMesh& mesh, const std::vector<char>& fixed,
                  const std::vector<char>& at_seam);

/// The reference for checking a decimated mesh.
struct DecimationStandard {
  DistanceTarget input;
  std::vector<int> joined;  ///< see `gluing`
  Gluing input_gluing;
  bool manifold_edges;        ///< true if the input's edges are manifold
  Eigen::Matrix3Xd normals;   ///< of the input's triangles
  std::vector<char> at_seam;  ///< of each vertex: nonzero if another one is at exactly its place
  std::optional<TextureStandard> texture;

  /// \param seamed the mesh that is decimated if it has a texture, or null.
  explicit DecimationStandard(const TriangleMesh& mesh, const SeamedMesh* seamed);
};

/// A decimated mesh to be checked. Its vertices are a subset of the input's.
class Candidate {
 public:
  explicit Candidate(TriangleMesh mesh) : mesh_(std::move(mesh)) {}
  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }
  /// Its search tree, built at the first call. Triangle indices are the same.
  [[nodiscard]] const DistanceTarget& target();

 private:
  TriangleMesh mesh_;
  std::optional<DistanceTarget> target_;
};

/// Results of the checks of earlier candidates with the same tolerance. Most triangles of a
/// candidate were in an earlier one, so that little is left to check.
class KnownTriangles {
 public:
  enum class Lie { unknown, right, wrong };
  struct Facts {
    Lie lie = Lie::unknown;  ///< wrong: turned over, or the texture slips
    bool near = false;       ///< within the tolerance of the input
  };

  /// The input's triangles lie right and are near.
  explicit KnownTriangles(const TriangleMesh& input);

  /// Sets the current candidate, whose triangle indices `facts` refers to.
  void enter(const TriangleMesh& candidate);
  [[nodiscard]] Facts& facts(std::size_t triangle) {
    return facts_[static_cast<std::size_t>(present_[triangle])];
  }

  /// Returns true if the points of a triangle of the input are within the tolerance of the present
  /// candidate, because it has the triangles that were witnesses of this for an earlier one.
  [[nodiscard]] bool is_covered(std::size_t input_triangle) const;
  /// The witnesses are triangles of the present candidate.
  void set_covered(std::size_t input_triangle, const Witnesses& witnesses);

 private:
  /// A triangle by its corners, rotated so that the lowest comes first.
  struct Entry {
    std::array<int, 2> others;
    int next;  ///< another one with the same lowest corner, or -1
  };
  int enter(const Eigen::Vector3i& corners);

  std::vector<int> newest_;  ///< of each lowest corner, or -1
  std::vector<Entry> entries_;
  std::vector<Facts> facts_;      ///< of each entry
  std::vector<int> last_seen_;    ///< of each entry: the last candidate that has it
  int candidate_ = 0;             ///< the number of the present one
  std::vector<int> present_;      ///< entry of each of its triangles
  std::vector<Witnesses> cover_;  ///< entries, of each triangle of the input
};

/// Violations of the guarantees of `Decimation`. Cheaper checks come first, and the others run only
/// if these find nothing.
struct Unfit {
  /// Triangles that are badly connected, or flipped without being slivers, or on which the texture
  /// slips.
  std::vector<int> shapes;
  /// Triangles whose distance from the input exceeds the tolerance, or those nearest to `lost`.
  std::vector<int> far;
  std::vector<Eigen::Vector3d> lost;  ///< input points whose distance exceeds the tolerance

  [[nodiscard]] std::size_t count() const { return far.size() + shapes.size(); }
  /// The check that found them. A candidate is not checked further.
  enum class Check { shape, lost, far };
  [[nodiscard]] Check check() const {
    if (!shapes.empty()) return Check::shape;
    return lost.empty() ? Check::far : Check::lost;
  }
};

/// Finds the violations of `candidate`. An infinite `tolerance` skips the distance check. `known`
/// is used and extended.
[[nodiscard]] Unfit find_unfit(Candidate& candidate, const DecimationStandard& standard,
                               double tolerance, KnownTriangles& known);

}  // namespace palpate::geometry
