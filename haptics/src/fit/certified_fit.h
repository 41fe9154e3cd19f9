// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fit/local_fit.h"
#include "palpate/haptics/passivity_certificate.h"

namespace palpate::haptics {

struct CertifiedFit {
  LocalFit fit;
  PassivityCertificate certificate;  ///< of the field in `fit`: read this before you use it
  int repairs = 0;                   ///< refits with one more place where energy must not be lost
};

/// A local fit that is passive over the reachable volume, in units of the data: it is certified,
/// and where the certificate finds a place with too little energy, that place becomes a constraint
/// and all bases move again, up to a number of times. If it is not passive then, the certificate
/// says so and the field is the last one.
[[nodiscard]] CertifiedFit fit_certified(const FieldObjective& objective,
                                         const LocalFitOptions& options,
                                         const ReachableVolume& volume);

}  // namespace palpate::haptics
