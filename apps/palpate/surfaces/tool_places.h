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

  /// Finds the places by the name of a range map, without its folder. Warns, once, of a range map
  /// with other content than the one that the campaign recorded under this name.
  [[nodiscard]] std::span<const geometry::KnownVertex> in(const fs::path& range_map);

 private:
  void check_is_recorded(const fs::path& range_map);

  fs::path acquisition_;
  // By the name of the file.
  std::map<std::string, std::vector<geometry::KnownVertex>> known_;
  std::map<std::string, std::string> fingerprints_;
  bool has_warned_ = false;
};

}  // namespace palpate::apps
