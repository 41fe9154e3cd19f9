// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/option_lists.h"

#include "palpate/haptics/build_model.h"
#include "palpate/haptics/playback.h"

namespace palpate::haptics {

void visit_options(FieldVisitor& visitor) {
  BuildOptions build;
  visit(build, visitor);
  PlaybackOptions playback;
  visit(playback, visitor);
}

}  // namespace palpate::haptics
