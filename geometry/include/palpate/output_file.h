// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <vector>

namespace palpate {

/// Writes a file so that a reader sees the old content or the whole new one, never a part:
/// `write` fills a temporary beside `path`, which is then renamed onto it. The stream is binary,
/// in the classic locale, and throws when the disk is full, so `write` need not check it.
/// Missing parent folders are made; a symbolic link is written through; the permissions of a file
/// that is replaced are kept. What `write` throws passes through.
/// \throws InvalidInput if `path` is a folder or a device; OutputError if the disk is full or the
/// folder read-only. `path` is then as it was and the temporary is gone.
void write_file(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write);

/// The same for libraries that insist on opening the file themselves: `write` gets the path of the
/// temporary (with the extension of `path`), must throw if it cannot write, and must have closed
/// the file when it returns.
void write_file_by_path(const std::filesystem::path& path,
                        const std::function<void(const std::filesystem::path&)>& write);

/// The same for a folder: `write` fills a temporary folder beside `path`, which then takes its
/// place. A folder that is already there is replaced only if all it holds is among `entries`, the
/// names in a folder of this kind: nothing that somebody else put there is ever removed.
/// \throws InvalidInput as `check_replaceable`, before `write` is called; OutputError if it cannot
/// be written.
void write_folder(const std::filesystem::path& path,
                  const std::vector<std::filesystem::path>& entries,
                  const std::function<void(const std::filesystem::path&)>& write);

/// What `write_folder` checks first; for those who have much to do before they write.
/// \throws InvalidInput if `path` is no folder, or holds something that is not among `entries`.
void check_replaceable(const std::filesystem::path& path,
                       const std::vector<std::filesystem::path>& entries);

}  // namespace palpate
