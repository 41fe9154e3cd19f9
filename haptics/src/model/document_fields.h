// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/document_node.h"
#include "palpate/core/fields.h"

namespace palpate::haptics {

/// Sets the fields that an object of a document has; the others keep their values.
/// \throws InvalidInput with the place in the document, as `DocumentNode`, for a value of the wrong
/// kind or outside its range, and for a member that is not in the list.
void read_fields(const DocumentNode& node, const FieldList& fields);

}  // namespace palpate::haptics
