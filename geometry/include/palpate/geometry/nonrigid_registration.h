// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "palpate/geometry/deformation_graph.h"
#include "palpate/geometry/range_map.h"

namespace palpate::geometry {

/// A known position of a vertex of the deformed surface, whether or not the map shows the vertex.
struct KnownVertex {
  int vertex = 0;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< [mm] camera frame
};

/// Number of blurs of an image, of different standard deviations, to follow a surface from far and
/// then exactly.
inline constexpr int kIntensityBlurs = 3;

/// Intensities of the vertices of a surface, for each blur of an image; NaN where unknown.
using VertexIntensities = Eigen::Matrix<float, kIntensityBlurs, Eigen::Dynamic>;

/// Intensities that the camera of a range map sees, in addition to depths.
struct SeenIntensities {
  /// Intensity of each pixel of the range map in any unit; NaN where unknown. Empty if there is
  /// none.
  ImageF image;
  VertexIntensities vertices;  ///< V columns, of an earlier frame (see `vertex_intensities`)
};

struct NonRigidOptions {
  int max_iterations = 60;  ///< >= 1
  /// Initial gate: a vertex is attracted to the measured surface if its distance from it is at most
  /// this fraction of the mesh's diagonal. It must cover the deformation; > 0.
  double max_correspondence = 0.06;
  /// Final gate. It must exclude points beside the surface; in (0, max_correspondence].
  double min_correspondence = 0.01;
  double max_normal_angle = 1.0;  ///< [rad] between the two surfaces; in (0, pi/2)
  /// Resistance of a node to moving differently from its neighbours, relative to the measured
  /// points around it; > 0. A low value follows small dents and noise, a high one bridges holes
  /// smoothly.
  double stiffness = 0.02;
  /// Strength with which each node is held at its undeformed place, relative to the measured points
  /// around it; >= 0. For an object that is held and only pressed: motion that the map does not
  /// show, such as that of a plane in itself, then stays as small as possible.
  double hold = 0;
  /// `stop` is `poor_match` if the surface converged and less than this fraction of the vertices
  /// whose pixels have a measurement are on the measured surface; in [0, 1].
  double min_matched = 0.3;
  /// Called in the calling thread after each iteration, of which there are often fewer than
  /// `total`; the last call has done == total. If it throws, the registration ends.
  std::function<void(int done, int total)> progress = {};
};

/// Visibility of a vertex of the deformed surface in the range map.
enum class VertexSight : std::uint8_t {
  seen,         ///< on the measured surface
  occluded,     ///< behind a measured surface
  hole,         ///< its pixel has no depth, or too few neighbours with a depth
  outside,      ///< not in the image
  turned_away,  ///< faces away from the camera
  unmatched     ///< its pixel shows a surface behind it, or one with another normal
};

enum class NonRigidStop {
  converged,       ///< the nodes stopped moving, and the visible vertices fit
  max_iterations,  ///< not converged yet
  no_overlap,      ///< fewer than six of the sampled vertices found a correspondence
  poor_match       ///< converged, but less than `min_matched` fits: another object, or a bad start
};

struct DeformedSurface {
  Eigen::Matrix3Xd vertices;                    ///< [mm] 3 x V, deformed, all finite; camera frame
  std::vector<Eigen::Isometry3d> node_motions;  ///< N, from the undeformed mesh
  std::vector<VertexSight> sight;               ///< V
  /// [mm] 3 x V, where the ray to a vertex meets the measured surface; NaN unless seen.
  Eigen::Matrix3Xd measured;
  std::vector<int> pixel;  ///< V, row * cols + col of a vertex that is seen, otherwise -1
  /// [mm] V, signed distance from the plane of the measured point, positive on the camera's side of
  /// it; NaN unless seen.
  Eigen::VectorXd distance;
  /// [mm] V, standard deviation of the error along the normal of a vertex; NaN in pieces of surface
  /// of which nothing is measured, and for vertices without triangles.
  Eigen::VectorXd sigma_across;
  /// [mm] V, the same along the surface: the root mean square length of the error in the tangent
  /// plane. Large where neither relief nor texture shows this motion.
  Eigen::VectorXd sigma_along;
  double rms = 0;      ///< [mm] root mean square of `distance` where seen; NaN if no vertex is
  double matched = 0;  ///< fraction seen of the vertices whose pixels have a measurement
  int iterations = 0;
  /// Check this before you use the vertices.
  NonRigidStop stop = NonRigidStop::max_iterations;
};

/// Deforms a surface so that it lies on a range map in the same camera frame, by embedded
/// deformation: Gauss-Newton steps that minimise
///
///     sum_v  rho(n . (v' - p))  +  stiffness  sum_jk  | s l_jk R_j (g_k - g_j) - (g'_k - g'_j) |^2
///
/// where p and n are point and normal of the pixel that shows v' (projective association, with lens
/// distortion), rho is Tukey's biweight at the correspondence gate, g are nodes, R_j their
/// rotations, and l_jk >= 1 makes up for the angle between R_j and R_k, so that bending does not
/// shrink the surface. s is the scale of the whole surface, at which the links are stretched least:
/// uniform growth costs little. Stiffness and gate start high and decrease, so that the surface
/// first moves as a whole. Where nothing is measured, the surface follows its neighbours as rigidly
/// as possible; parts without any constraint stay. There is no point-to-point term: along a pixel's
/// ray it would repeat the plane term, and it would slow sliding, which the damping of the steps
/// already limits. With `hold`, hold sum_j |g'_j - g_j|^2 is added; known vertices add |v' -
/// place|^2, with ten times the weight of the measured points around a node.
///
/// With intensities, rho_I(I(v') - a T_v - b) (s_n / s_I)^2 is added, where I is the image at v',
/// T_v the intensity of the vertex in the earlier frame, s_n and s_I are the deviations of both
/// kinds of residuals, and the gain a and the offset b are fitted around each node, as light
/// changes. The image is blurred less from level to level.
///
/// Motion along the surface is visible only in its relief and its texture: on a plane or a sphere
/// the result is the motion of least distortion, not the true one. `DeformedSurface::sigma_along`
/// tells where. The deviations contain the noise of the measurements, which they assume to be
/// independent from pixel to pixel; the strain that the links between nodes resist; the pull of the
/// scale towards 1; and a motion of the whole surface by `max_correspondence` where nothing shows
/// it. They do not contain a wrong correspondence, such as a ridge that is taken for the next one.
/// \param start node motions of an earlier frame. The surface continues from there without initial
/// stiffness, and can move by up to max_correspondence (min_correspondence /
/// max_correspondence)^0.6, a third of `max_correspondence` by default. Without `start` the search
/// starts undeformed.
/// \throws InvalidInput if the camera or an option is not valid, a known vertex does not exist or is
/// not at a finite place, the start or the intensities of the vertices belong to another graph, or
/// the image has not the size of the map.
/// \throws SolverError if the equations of a step cannot be solved.
[[nodiscard]] DeformedSurface register_deformed(const DeformationGraph& graph, const RangeMap& map,
                                                const NonRigidOptions& options = {},
                                                std::span<const Eigen::Isometry3d> start = {},
                                                std::span<const KnownVertex> known = {},
                                                const SeenIntensities& intensities = {});

/// Intensities of the vertices that an image shows, for the next frames.
/// \param surface as it was found in this frame
/// \throws InvalidInput unless the camera is valid and the image of its size.
[[nodiscard]] VertexIntensities vertex_intensities(const Camera& camera, const ImageF& image,
                                                   const DeformedSurface& surface);

}  // namespace palpate::geometry
