// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "colors/hue_classifier.h"
#include "decode/plausibility.h"
#include "image/image_plane.h"

namespace palpate::sensing {

/// Marks the patches of depths for which the stripe colours do not speak: a patch, pixels of known
/// depth that hang together, counts iff at least two colours of the pattern are found in it where
/// its depths want them, mostly. A single colour proves nothing: on a saturated red surface every
/// stripe that is seen at all looks red, so wherever its depths want red the colours agree with any
/// of them.
/// \param z      [mm] NaN where unknown.
/// \param stripe_pixel projector pixel across the stripes that the depth implies; NaN if unknown.
void find_unproven_patches(const Plane& z, const Plane& stripe_pixel, const Plane& hue,
                           const StripeColors& stripes, const HueClassifier& classifier,
                           Mask& marked);

}  // namespace palpate::sensing
