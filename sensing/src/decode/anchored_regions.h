// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "decode/decoder_geometry.h"
#include "decode/workspace.h"
#include "palpate/sensing/decode.h"
#include "phase/demodulation.h"

namespace palpate::sensing {

/// Gives the regions around the anchors their offsets. Nothing else tells that two surfaces meet
/// where their phases agree, so regions end where the sinusoid fits badly.
/// \param work of a frame whose regions have been grown.
/// \throws InvalidInput if two anchors on one smooth surface imply different periods.
void anchor_regions(const DecoderGeometry& whole, const DemodulationFilter& filter,
                    const DecodeOptions& options, Workspace& work);

}  // namespace palpate::sensing
