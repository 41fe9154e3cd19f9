// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "strip_chart.h"

namespace palpate::view {

/// Draws a chart in the panel, in its whole width. \param height [px]
void draw_chart(const StripChart& chart, float height);

}  // namespace palpate::view
