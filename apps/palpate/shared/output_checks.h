// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <regex>
#include <string>
#include <vector>

#include "shared/aliases.h"

namespace palpate::apps {

/// Checks, before anything is computed, that each output can be written and overwrites no input or
/// other output. Empty paths stand for options that were not given.
/// \throws InvalidInput if one of `outputs` equals, or lies in, one of `inputs` or another of
/// `outputs`.
/// \throws OutputError if the folder of an output is a file or may not be written to.
void check_outputs(const std::vector<fs::path>& inputs, const std::vector<fs::path>& outputs);

/// The same for a folder that is replaced completely.
/// \throws InvalidInput also if one of `inputs` lies in `folder`.
void check_output_folder(const std::vector<fs::path>& inputs, const fs::path& folder);

/// The same for a folder of a model, which may replace another model and nothing else.
void check_model_output(const std::vector<fs::path>& inputs, const fs::path& folder);

/// Checks that the names of pictures are those of PNG files.
/// \throws InvalidInput for a name with another ending. Empty paths stand for options that were not
/// given.
void check_pictures(const std::vector<fs::path>& pictures);

/// Lists the entries of `folder` that an earlier run of the same command wrote, and which may be
/// replaced. `own` matches the paths of the files that the command writes, relative to the folder
/// and with slashes; `mark` is a file that it always writes.
/// \throws InvalidInput if `folder` is a file, holds any other file, or holds files but not `mark`.
[[nodiscard]] std::vector<fs::path> own_entries(const fs::path& folder, const std::string& mark,
                                                const std::regex& own);

}  // namespace palpate::apps
