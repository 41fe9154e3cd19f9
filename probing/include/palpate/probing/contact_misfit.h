// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace palpate::probing {

/// [mm] Radius of the tip if `Acquisition::probe_radius` does not give it.
inline constexpr double kUsualTipRadius = 3;
/// Up to one in this number of contacts is left out, and reported, if it does not fit a surface.
/// More are no mishap of single contacts.
inline constexpr std::size_t kContactsPerMisfit = 50;

/// A contact that does not fit a surface.
struct ContactMisfit {
  long long id = 0;
  std::string
      reason;  ///< "is 3.2 mm from the surface", "has a normal that points into the surface"
};

}  // namespace palpate::probing
