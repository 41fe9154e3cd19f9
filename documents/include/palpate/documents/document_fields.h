// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/core/fields.h"
#include "palpate/documents/document_node.h"

namespace palpate::documents {

/// Sets the fields that an object of a document has; the others keep their values.
/// \throws InvalidInput with the place in the document, as `DocumentNode`, for a value of the wrong
/// kind or outside its range.
void take_fields(DocumentMembers& members, const FieldList& fields);

/// The same for an object that has no other members than these fields.
/// \throws InvalidInput also for a member that is not in the list.
void read_fields(const DocumentNode& node, const FieldList& fields);

}  // namespace palpate::documents
