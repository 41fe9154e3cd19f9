// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

namespace palpate::pictures {

/// [mm] Depth between an object and what is far behind it, such as a wall: the middle of an
/// interval that is nearly empty and at least a quarter as long as all depths together. Nothing if
/// there is no such interval.
[[nodiscard]] std::optional<double> background_border(const std::vector<double>& depths);

}  // namespace palpate::pictures
