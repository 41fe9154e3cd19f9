// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace palpate::view {

/// The kind of data at a path, for the window.
enum class PathKind { model, mesh, range_maps, acquisition };

/// Finds out by names, without reading what is in files: a folder with a field document or a
/// surface is a model, one with images a sequence of range maps; files are known by their endings.
/// \throws FileError if there is nothing at the path, or nothing of these four kinds; the message
/// says what would be right.
[[nodiscard]] PathKind kind_of(const std::filesystem::path& path);

}  // namespace palpate::view
