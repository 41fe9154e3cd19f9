// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bit>
#include <string>
#include <vector>

#include "full_disk.h"
#include "scratch_folder.h"
#include "throws_message.h"

namespace palpate::geometry {

/// Appends a number as a file of the given byte order holds it.
template <typename Number>
void put(std::string& bytes, Number value, std::endian order = std::endian::little) {
  auto raw = std::bit_cast<std::array<char, sizeof(Number)>>(value);
  if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

/// A unit tetrahedron's faces, counter-clockwise from outside.
inline const std::vector<Eigen::Vector3d> kTetrahedronCorners{
    {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
inline const std::vector<Eigen::Vector3i> kTetrahedronFaces{
    {0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

}  // namespace palpate::geometry
