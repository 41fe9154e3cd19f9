// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>

namespace palpate {

/// Writes a file so that a reader sees the old content or the whole new one, never a part:
/// `write` fills a temporary beside `path`, which is then renamed onto it.
/// Missing parent folders are made.
/// \throws OutputError if the disk is full or the folder read-only; `path` is then as it was.
void write_file(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write);

/// The same for libraries that insist on opening the file themselves: `write` gets the path of the
/// temporary (with the extension of `path`) and must have closed it when it returns.
void write_file_by_path(const std::filesystem::path& path,
                        const std::function<void(const std::filesystem::path&)>& write);

/// The same for a folder: `write` fills a temporary folder beside `path`, which then takes its place.
/// A folder that is already there is replaced only if it is empty or holds `marker`, the file by
/// which a folder of this kind is recognised.
/// \throws InvalidInput if `path` is something else; OutputError if it cannot be written.
void write_folder(const std::filesystem::path& path, const std::filesystem::path& marker,
                  const std::function<void(const std::filesystem::path&)>& write);

}  // namespace palpate
