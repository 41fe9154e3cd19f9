// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "decode/workspace.h"
#include "palpate/sensing/decode.h"

namespace palpate::sensing {

/// Unwraps the phase of a pattern without stripes, and makes it absolute where an anchor tells how.
///
/// Nothing but the phase and the looks of a surface tells where another one begins. Each region is
/// therefore only as large as it is one surface for sure (`find_surface_doubt`), connected by ways
/// that are wide everywhere. A pixel that belongs with an anchor only if no depth step hides in
/// between gets a reason of its own (`possible_step`).
///
/// Reads the signal of the workspace; writes its regions, offsets and reasons.
/// \throws InvalidInput if two anchors on one surface contradict each other.
void find_anchored_regions(const DecoderGeometry& whole, const DemodulationFilter& filter,
                           const DecodeOptions& options, Workspace& work);

}  // namespace palpate::sensing
