// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/persistence.hpp>
#include <string>

#include "files/storage_file.h"
#include "palpate/geometry/camera.h"

namespace palpate::sensing {

/// Reads NAME_size, NAME_matrix and NAME_distortion, as rigs have them for camera and projector.
/// \throws FileError if one is missing, has another form, or a focal length is not > 0.
[[nodiscard]] geometry::Camera read_lens(const StorageFile& file, const std::string& name);

/// Writes them so that `read_lens` reads every number back exactly.
void write_lens(cv::FileStorage& storage, const std::string& name, const geometry::Camera& camera);

}  // namespace palpate::sensing
