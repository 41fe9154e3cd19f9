// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <vector>

namespace palpate {

/// Writes a file so that a reader sees the old content or the whole new one, never a part.
///
/// `write` fills a temporary file beside `path`, which is flushed to the disk and renamed to
/// `path`; then the folder is flushed. When the function returns, the file survives a loss of
/// power. The name of the temporary is unique among hosts and processes that share the folder, and
/// an existing file of that name is never overwritten. It begins with a dot, so that readers of
/// folders do not take it for data. A temporary that a killed process left is removed by the next
/// process that writes into the folder.
///
/// The stream is binary, has the classic locale, and throws when the disk is full, so `write` need
/// not check it. Missing parent folders are created; symbolic links are followed; a file that is
/// replaced keeps its permissions. Exceptions of `write` pass through.
/// \throws InvalidInput if `path` is a folder or a device.
/// \throws OutputError if the disk is full or the folder is read-only. `path` is then unchanged and
/// the temporary is removed.
void write_file(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write);

/// The same for libraries that open the file themselves.
/// \param write gets the path of an empty temporary file with the extension of `path`. It must
/// throw if it cannot write, and must have closed the file when it returns.
/// \throws OutputError also if the file is still empty.
void write_file_by_path(const std::filesystem::path& path,
                        const std::function<void(const std::filesystem::path&)>& write);

/// The same for a folder: `write` fills a temporary folder beside `path`, which then takes its
/// place, in one step if the file system can exchange two folders.
/// \param entries the names that a folder of this kind may hold. An existing folder is replaced
/// only if it holds nothing else, so files of others are never removed.
/// \throws InvalidInput as `check_replaceable`, before `write` is called.
/// \throws OutputError if the folder cannot be written.
void write_folder(const std::filesystem::path& path,
                  const std::vector<std::filesystem::path>& entries,
                  const std::function<void(const std::filesystem::path&)>& write);

/// The check that `write_folder` does first, for callers that compute for long before they write.
/// \throws InvalidInput if `path` is not a folder, or holds something that is not among `entries`.
void check_replaceable(const std::filesystem::path& path,
                       const std::vector<std::filesystem::path>& entries);

/// Removes the temporaries in `folder` that processes of this host left when they were killed. The
/// functions above call it for the folders into which they write; it looks into each folder once in
/// a process.
void remove_left_overs(const std::filesystem::path& folder);

/// Removes the temporaries that this process is writing, for a program that exits at once while
/// other threads write. A thread that then begins or ends a file waits for ever: the program may
/// only call `_exit` afterwards.
void abandon_temporaries();

}  // namespace palpate
