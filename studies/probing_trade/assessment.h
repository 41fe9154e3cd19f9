// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

#include "objects.h"
#include "palpate/haptics/build_model.h"
#include "palpate/probing/acquisition.h"

namespace palpate::bench {

/// Comparison of a model with the truth; NaN where it was not compared.
struct Assessment {
  double error = std::numeric_limits<double>::quiet_NaN();  ///< [N] RMS at the known forces
  /// [N] RMS at contacts that are predicted from the others, against true forces: inside the
  /// triangles of the others, and at the border.
  double left_out_inside = std::numeric_limits<double>::quiet_NaN();
  double left_out_border = std::numeric_limits<double>::quiet_NaN();
  double friction_median =
      std::numeric_limits<double>::quiet_NaN();  ///< of the coefficient's error
  double friction_p95 = std::numeric_limits<double>::quiet_NaN();
  std::uintmax_t acquisition_bytes = 0, model_bytes = 0;  ///< on disk
};

/// Fits a model as `palpate fit` does and compares it.
/// \param left_out also predicts each contact from the others, which takes long
[[nodiscard]] Assessment assess(const PreparedObject& object,
                                const probing::Acquisition& acquisition,
                                const haptics::BuildOptions& options, bool left_out);

}  // namespace palpate::bench
