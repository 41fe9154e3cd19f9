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

/// Draws an image of labels as a PNG of 1200 x 900 px, each label in its own colour, with a legend:
/// colour, name (`names`, by label) and share of the pixels. Label 0, the ordinary one, is light
/// grey. The legend contains all names, also of labels without pixels, so that pictures of a
/// sequence can be compared. Works without a display.
/// \throws InvalidInput if the image is empty, there are no names or more than 12, or a label has
/// no name.
/// \throws OutputError if the picture cannot be written.
void draw_labels(const std::filesystem::path& png, const LabelImage& labels,
                 std::span<const std::string> names, const std::string& title);

}  // namespace palpate::pictures
