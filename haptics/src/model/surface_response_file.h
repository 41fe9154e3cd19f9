// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "palpate/haptics/surface_response.h"

namespace palpate::haptics {

/// `deformed/response.bin` of a model folder, as docs/model-file.md describes it.
/// \throws FileError if it cannot be read, is truncated, or is of another version.
[[nodiscard]] SurfaceResponse read_surface_response(const std::filesystem::path& path);
/// \throws OutputError.
void write_surface_response(const std::filesystem::path& path, const SurfaceResponse& response);

/// [bytes] of that file.
[[nodiscard]] std::uint64_t surface_response_size(const SurfaceResponse& response);

}  // namespace palpate::haptics
