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

/// Places at which a tool held the surface of an object while range maps of it were recorded.
class ToolPlaces {
 public:
  /// No places are known.
  ToolPlaces() = default;
  /// Reads the samples of an acquisition that held and name a range map: in that map, the vertex
  /// nearest to the contact has the displacement of the tool.
  /// \param surface in the frame of the acquisition.
  /// \throws FileError if the acquisition cannot be read, InvalidInput if no sample names a range
  /// map, or a contact is not on the surface.
  ToolPlaces(const fs::path& acquisition, const geometry::TriangleMesh& surface);

  /// \param range_map only its name is used, without its folder.
  [[nodiscard]] std::span<const geometry::KnownVertex> in(const fs::path& range_map) const;

 private:
  std::map<std::string, std::vector<geometry::KnownVertex>> known_;  // by the name of the file
};

}  // namespace palpate::apps
