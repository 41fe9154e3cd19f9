// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "palpate/geometry/nonrigid_registration.h"
#include "palpate/geometry/triangle_mesh.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// Where a tool held the surface of an object while range maps of it were recorded.
class ToolPlaces {
 public:
  /// Nothing is known.
  ToolPlaces() = default;
  /// The samples of an acquisition that held and name a range map: there, the vertex nearest to the
  /// contact is displaced as the tool is.
  /// \param surface in the frame of the acquisition.
  /// \throws FileError if the acquisition cannot be read, InvalidInput if no sample names a range
  /// map, or a contact is not on the surface.
  ToolPlaces(const fs::path& acquisition, const geometry::TriangleMesh& surface);

  /// \param range_map its name counts, without its folder.
  [[nodiscard]] std::span<const geometry::KnownVertex> in(const fs::path& range_map) const;

 private:
  std::map<std::string, std::vector<geometry::KnownVertex>> known_;  // by the name of the file
};

}  // namespace palpate::apps
