// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace palpate::pictures {

using LabelImage = Eigen::Array<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Draws an image of labels as a PNG of 1200 x 900 px, each label in a colour of its own, with a
/// legend: the colour, its name (`names`, by label), and the part of the pixels that have it. Label
/// 0, the ordinary one, is light grey; all names are in the legend, also of labels that no pixel
/// has, so that pictures of a sequence can be compared. Works without a display.
/// \throws InvalidInput if the image is empty, there are no names or more than 12, or a label has
/// none; OutputError.
void draw_labels(const std::filesystem::path& png, const LabelImage& labels,
                 std::span<const std::string> names, const std::string& title);

}  // namespace palpate::pictures
