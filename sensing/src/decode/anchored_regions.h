// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "decode/decoder_geometry.h"
#include "decode/workspace.h"
#include "palpate/sensing/decode.h"
#include "phase/demodulation.h"

namespace palpate::sensing {

/// Cuts the image where, without stripes, only the uncertainty of the phase shows that two surfaces
/// meet, so that regions end there.
/// \param steps_show false if the sinusoid hardly shows steps (`shows_steps`).
/// \param work of a frame whose regions have not been grown yet.
void cut_at_steps(const DecoderGeometry& whole, const DemodulationFilter& filter,
                  const DecodeOptions& options, bool steps_show, Workspace& work);

/// Gives the regions around the anchors their offsets. If the sinusoid hardly shows steps, a region
/// may still hold several surfaces, which differ by whole periods: unless the regions with anchors
/// hold most of the phases, as a single surface does, they get none (ambiguous_offset).
/// \param work of a frame whose regions have been grown.
/// \throws InvalidInput if two anchors in one region imply different periods.
void anchor_regions(const DecoderGeometry& whole, const DemodulationFilter& filter,
                    const DecodeOptions& options, bool steps_show, Workspace& work);

}  // namespace palpate::sensing
