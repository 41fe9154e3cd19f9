// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "palpate/haptics/build_model.h"
#include "shared/aliases.h"

// Reports of `palpate fit` about a model that it made.
namespace palpate::apps {

/// Returns the numbers of contacts; the first fifty if there are more.
[[nodiscard]] std::string contacts_in_words(const std::vector<long long>& contacts);

/// Logs the parts that were left out or are not determined.
void tell_build(const haptics::BuildResult& built);

/// States whether contacts share a local part, or why not. The fit must have tried that.
[[nodiscard]] std::string sharing_in_words(const haptics::BuildResult& built);

/// Returns the offsets that were subtracted from the samples, for --json.
[[nodiscard]] Json offsets_in_figures(const haptics::PressingOffsets& offsets);

/// One line for each contact.
[[nodiscard]] std::string per_contact_in_words(const haptics::BuildResult& built);
/// All contacts in one clause.
[[nodiscard]] std::string fit_in_words(const haptics::BuildResult& built);
/// The same for --json.
[[nodiscard]] Json fit_figures(const haptics::BuildResult& built, bool with_contacts);

}  // namespace palpate::apps
