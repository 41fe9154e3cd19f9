// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

namespace palpate::probing {

inline constexpr std::array<std::string_view, 7> kContactColumns = {"id", "x",  "y", "z",
                                                                    "nx", "ny", "nz"};
inline constexpr std::array<std::string_view, 16> kSampleColumns = {"id",
                                                                    "contact",
                                                                    "group_id",
                                                                    "px",
                                                                    "py",
                                                                    "pz",
                                                                    "ax",
                                                                    "ay",
                                                                    "az",
                                                                    "bx",
                                                                    "by",
                                                                    "bz",
                                                                    "on_friction_boundary",
                                                                    "slipped",
                                                                    "range_map",
                                                                    "time"};
/// In place of ax,...,bz, and of px,py,pz.
inline constexpr std::string_view kDepthColumn = "depth", kNormalForceColumn = "normal_force";
/// Before `id`, to name that of one table.
inline constexpr std::string_view kContactsPrefix = "contacts.", kSamplesPrefix = "samples.";
/// The number of the file in place of the content of a column.
inline constexpr std::string_view kFileNumber = "file_number";

}  // namespace palpate::probing
