// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::haptics {

/// Response of the surface to the tool, learnt from recorded surfaces; for display (thesis 5.6).
/// V vertices of the surface, N nodes among them, C contacts, S recorded surfaces.
///
/// While the tool has moved the surface at place p by delta [mm], vertex v moves by
///
///     sum_c w_c (k_c(d) delta + sum_n W_vn B_cn delta)
///
/// with the weights w_c of the contacts at p, the distance d of the vertex from p along the
/// surface, and the weights W_vn of its three nodes. The dent k_c moves with the tool; what else a
/// contact moves stays where it is.
///
/// The recorded surfaces themselves are kept as well: while contact c was displaced by delta_s, the
/// vertex moved by k_c(d) delta_s + sum_n W_vn u_sn, with the distance d from the contact.
struct SurfaceResponse {
  /// Number of places of a dent.
  static constexpr int kDentPlaces = 16;

  Eigen::Matrix<std::uint16_t, 3, Eigen::Dynamic> nodes;  ///< 3 x V: nodes that move each vertex
  Eigen::Matrix<Eigen::half, 3, Eigen::Dynamic> weights;  ///< 3 x V, >= 0; columns sum to 1
  /// 9 N x C: the B_cn of a contact one after another, each column by column. All zero at a contact
  /// for which no surface was recorded.
  Eigen::Matrix<Eigen::half, Eigen::Dynamic, Eigen::Dynamic> responses;
  /// Dents of the contacts, kDentPlaces x C: k_c at d = 0, reach / 16, 2 reach / 16, ..., linear
  /// in between; 0 from d = reach on.
  Eigen::Matrix<Eigen::half, kDentPlaces, Eigen::Dynamic> dents;
  double reach = 0;                   ///< [mm] > 0 of dents along the surface
  Eigen::RowVectorXi shape_contacts;  ///< S: contacts that were displaced
  Eigen::Matrix3Xf displacements;     ///< [mm] 3 x S: delta_s
  /// [mm] 3 N x S: the u_sn of a surface one after another
  Eigen::Matrix<Eigen::half, Eigen::Dynamic, Eigen::Dynamic> moves;
  double rms = 0;           ///< [mm] distance of the recorded vertices from the displayed ones
  double largest = 0;       ///< [mm] the largest one
  double kept_rms = 0;      ///< [mm] distance of the recorded vertices from the kept ones
  double kept_largest = 0;  ///< [mm] the largest one

  friend bool operator==(const SurfaceResponse&, const SurfaceResponse&) = default;
};

/// k_c at a distance d >= 0 [mm].
[[nodiscard]] double dent_at(const SurfaceResponse& response, Eigen::Index contact, double d);

/// \throws InvalidInput naming the member, beginning with `subject`, unless all is finite and fits
/// this number of vertices and contacts.
void check_surface_response(const SurfaceResponse& response, Eigen::Index vertices,
                            Eigen::Index contacts, const std::string& subject);

}  // namespace palpate::haptics
