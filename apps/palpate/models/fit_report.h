// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "palpate/haptics/build_model.h"
#include "shared/aliases.h"

// What `palpate fit` says of a model that it made.
namespace palpate::apps {

/// Their numbers; the first fifty if there are more.
[[nodiscard]] std::string contacts_in_words(const std::vector<long long>& contacts);

/// Logs what was left out or is not determined.
void tell_build(const haptics::BuildResult& built);

/// Whether contacts share a local part, or why not. The model must have tried that.
[[nodiscard]] std::string sharing_in_words(const haptics::BuildResult& built);

/// What was taken off the samples, for --json.
[[nodiscard]] Json offsets_in_figures(const haptics::PressingOffsets& offsets);

/// One line for each contact.
[[nodiscard]] std::string per_contact_in_words(const haptics::BuildResult& built);
/// All contacts in one clause.
[[nodiscard]] std::string fit_in_words(const haptics::BuildResult& built);
/// The same for --json.
[[nodiscard]] Json fit_figures(const haptics::BuildResult& built, bool with_contacts);

}  // namespace palpate::apps
