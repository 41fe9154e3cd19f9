// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/documents/document_node.h"
#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// A contact as the field document has it.
/// \throws InvalidInput as `DocumentNode`.
[[nodiscard]] ContactModel to_contact(const documents::DocumentNode& node);

}  // namespace palpate::haptics
