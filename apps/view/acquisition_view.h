// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "palpate/geometry/triangle_mesh.h"
#include "palpate/haptics/model.h"
#include "palpate/probing/acquisition.h"
#include "view.h"

namespace palpate::view {

/// Measurements that were loaded, and what they are shown with.
struct AcquisitionScene {
  std::string name;
  probing::CheckedAcquisition acquisition;
  std::optional<geometry::TriangleMesh> surface;  ///< in the frame of the acquisition
  std::optional<haptics::Model> model;            ///< whose forces are compared
};

/// Contacts, samples as arrows, and how they differ from a model.
[[nodiscard]] std::unique_ptr<View> make_acquisition_view(AcquisitionScene scene);

}  // namespace palpate::view
