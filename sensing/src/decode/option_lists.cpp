// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/option_lists.h"

#include "palpate/sensing/decode.h"

namespace palpate::sensing {

void visit_options(FieldVisitor& visitor) {
  DecodeOptions decode;
  visit(decode, visitor);
}

}  // namespace palpate::sensing
