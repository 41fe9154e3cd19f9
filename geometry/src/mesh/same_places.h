// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate::geometry {

/// For each vertex the first one at exactly the same place; itself if it is not finite.
/// \param vertices 3 x V.
[[nodiscard]] std::vector<int> first_at_same_place(const Eigen::Matrix3Xd& vertices);

}  // namespace palpate::geometry
