// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/documents/document_node.h"
#include "palpate/probing/finite_element_specimen.h"

namespace palpate::probing {

// The solid of an object with "type": "finite_elements".
// Throws InvalidInput as DocumentNode.
[[nodiscard]] FiniteElementObject finite_elements_of(const documents::DocumentNode& object);

}  // namespace palpate::probing
