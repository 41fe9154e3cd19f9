// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/geometry/mesh_io.h"

namespace palpate::geometry {

/// The unit that our files declare, in a comment or in a header.
inline constexpr std::string_view kUnitComment = "unit mm";

/// [mm] Unit declared by a comment such as "unit mm", "units: in" or "UNIT=metre"; nullopt for
/// other comments.
[[nodiscard]] std::optional<double> declared_unit(std::string_view comment);

/// Determines the unit of a file: from the options, else from the format, else from the first
/// comment that declares one, else 1. Removes the comments that declare a unit from `comments`.
[[nodiscard]] FileUnit take_unit(const ReadOptions& options, std::optional<double> of_format,
                                 std::vector<std::string>& comments);

/// Checks the options.
/// \throws InvalidInput unless `options.unit` is > 0 and finite.
void check_options(const ReadOptions& options);

/// Checks that each comment is a single line and does not declare a unit, which the writer does.
/// \throws InvalidInput naming `what` and the comment.
void check_comments(const std::vector<std::string>& comments, const char* what);

}  // namespace palpate::geometry
