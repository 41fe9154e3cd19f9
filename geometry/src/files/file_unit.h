// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/geometry/mesh_io.h"

namespace palpate::geometry {

/// What our files declare, as a comment or in a header.
inline constexpr std::string_view kUnitComment = "unit mm";

/// [mm] The unit that a comment declares: "unit mm", "units: in", "UNIT=metre"; nullopt if it is
/// about something else.
[[nodiscard]] std::optional<double> declared_unit(std::string_view comment);

/// The unit of a file: that of the options, else what the format declares, else the first that a
/// comment declares, else 1. Takes comments that declare one out of `comments`.
[[nodiscard]] FileUnit take_unit(const ReadOptions& options, std::optional<double> of_format,
                                 std::vector<std::string>& comments);

/// \throws InvalidInput unless `options.unit` is > 0 and finite.
void check_options(const ReadOptions& options);

/// Checks that comments are one line each and leave the unit to the writer.
/// \throws InvalidInput naming `what` and the comment.
void check_comments(const std::vector<std::string>& comments, const char* what);

}  // namespace palpate::geometry
