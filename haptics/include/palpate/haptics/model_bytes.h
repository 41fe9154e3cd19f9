// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// Returns the part of a model that playback needs as one block of bytes, for programs that cannot
/// read a folder, such as a page in a browser. It holds the surface, the weights at its vertices,
/// and the fields, friction, compliances and uncertainties of contacts, and the response of the
/// surface; not how they were fitted. Numbers are little-endian and exact: the model that is read
/// back gives the same forces, bit by bit. The format belongs to one version of Palpate; to keep a
/// model, write its folder (model_io.h).
/// \throws InvalidInput if `check_model` rejects the model.
[[nodiscard]] std::vector<std::byte> to_bytes(const Model& model);

/// \throws InvalidInput if the bytes are of another version, end early, go on after their end, or
/// `check_model` rejects what they say.
[[nodiscard]] Model model_of_bytes(std::span<const std::byte> bytes);

}  // namespace palpate::haptics
