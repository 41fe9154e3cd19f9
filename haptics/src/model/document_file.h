// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace palpate::haptics {

/// Reads a document that people write: YAML if the name ends in .yaml or .yml, JSON otherwise. In
/// YAML, words without quotes that JSON reads as a number, true, false or null are these, and all
/// other words are texts.
/// \throws FileError if the file cannot be read, or, with the line in YAML, is not a document or
/// has a member twice.
[[nodiscard]] nlohmann::json read_document_file(const std::filesystem::path& path);

}  // namespace palpate::haptics
