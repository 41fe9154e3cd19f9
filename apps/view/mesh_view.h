// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "palpate/geometry/mesh_io.h"
#include "view.h"

namespace palpate::view {

/// A mesh that was loaded.
struct MeshScene {
  std::string name;
  geometry::MeshFile file;
};

/// A mesh on a turntable, with its figures.
[[nodiscard]] std::unique_ptr<View> make_mesh_view(MeshScene scene);

}  // namespace palpate::view
