// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/option_lists.h"

#include "palpate/devices/safety_filter.h"
#include "palpate/haptics/build_model.h"
#include "palpate/haptics/evaluate.h"
#include "palpate/haptics/identify.h"
#include "palpate/haptics/identify_solid.h"
#include "palpate/haptics/merge_models.h"
#include "palpate/haptics/playback.h"
#include "palpate/haptics/reduce_model.h"
#include "palpate/haptics/virtual_coupling.h"

namespace palpate::haptics {

void visit_options(FieldVisitor& visitor) {
  BuildOptions build;
  visit(build, visitor);
  QueryOptions queries;
  visit(queries, visitor);
  LeaveOneOutOptions left_out;
  visit(left_out, visitor);
  IdentifyOptions identification;
  visit(identification, visitor);
  SolidOptions solid;
  visit(solid, visitor);
  MergeModelsOptions merging;
  visit(merging, visitor);
  ReduceOptions reduction;
  visit(reduction, visitor);
  PlaybackOptions playback;
  visit(playback, visitor);
  devices::SafetyOptions safety;
  visit(safety, visitor);
  CouplingOptions coupling;
  visit(coupling, visitor);
}

}  // namespace palpate::haptics
