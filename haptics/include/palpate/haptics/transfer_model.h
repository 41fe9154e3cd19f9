// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/geometry/surface_map.h"
#include "palpate/haptics/model.h"
#include "palpate/haptics/scale_model.h"

namespace palpate::haptics {

struct TransferModelOptions {
  /// What becomes of forces where the whole surface becomes larger by `SurfaceMap::scale`.
  ForceScaling forces = ForceScaling::feel;
};

struct TransferredModel {
  Model model;
  std::vector<long long> distorted;  ///< ids of contacts where the map is distorted or folded
  std::vector<long long> isolated;   ///< ids of contacts in no triangle of contacts
};

/// Gives another object the feel of a model (thesis 6.2.4.2): each contact goes to its image under
/// a map of the surfaces, its frame and axis of friction turned as the map turns the surface there,
/// and the contacts are triangulated anew on the target. Fields are scaled, uniformly and so
/// exactly, as `forces` says, and so is the reference force of compliances, which are learnt anew;
/// all but places is `rounded`. Coefficients of friction stay. Force fields depend on the inside of
/// an object too, of which a map of surfaces knows nothing: between objects of one kind and similar
/// shape the result is likely to be reasonable, and no measurement in any case. The registration of
/// the acquisition is dropped.
/// \param map  of `model.surface` onto `target`, by `geometry::map_surface`
/// \throws InvalidInput if the model is refused by `check_model`, the target by `check_mesh` or
/// triangulation, the map is of other surfaces or is not sensible, or two contacts have one image;
/// SolverError as triangulating does.
[[nodiscard]] TransferredModel transfer_model(const Model& model,
                                              const geometry::TriangleMesh& target,
                                              const geometry::SurfaceMap& map,
                                              const TransferModelOptions& options = {});

}  // namespace palpate::haptics
