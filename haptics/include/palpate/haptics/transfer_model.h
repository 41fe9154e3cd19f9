// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/geometry/surface_map.h"
#include "palpate/haptics/model.h"
#include "palpate/haptics/scale_model.h"

namespace palpate::haptics {

struct TransferModelOptions {
  /// How forces change if the whole surface becomes larger by `SurfaceMap::scale`.
  ForceScaling forces = ForceScaling::feel;
};

struct TransferredModel {
  Model model;
  std::vector<long long> distorted;  ///< ids of contacts where the map is distorted or folded
  std::vector<long long> isolated;   ///< ids of contacts in no triangle of contacts
};

/// Transfers the feel of a model to another object (thesis 6.2.4.2).
///
/// Each contact moves to its image under a map of the surfaces, its frame and friction axis are
/// rotated as the map rotates the surface there, and the contacts are triangulated again on the
/// target, whose long edges are split as by `build_model`. Fields are scaled uniformly, and so
/// exactly, according to `forces`, and so is the reference force of compliances, which are
/// recomputed. Friction coefficients stay. Everything is `rounded`. Properties of the acquisition
/// are dropped: its registration, noise, fingerprint and offsets.
///
/// Force fields also depend on the inside of an object, about which a map of surfaces contains
/// nothing. Between objects of one kind and similar shape the result is probably reasonable, but it
/// is never a measurement.
/// \param map  of `model.surface` onto `target`, by `geometry::map_surface`
/// \throws InvalidInput if `check_model` rejects the model, `check_mesh` or triangulation rejects
/// the target, the map belongs to other surfaces or is not sensible, or two contacts have the same
/// image.
/// \throws SolverError as triangulation does.
[[nodiscard]] TransferredModel transfer_model(const Model& model,
                                              const geometry::TriangleMesh& target,
                                              const geometry::SurfaceMap& map,
                                              const TransferModelOptions& options = {});

}  // namespace palpate::haptics
