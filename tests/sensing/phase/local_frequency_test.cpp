// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/local_frequency.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "phase/phase_testing.h"

namespace palpate::sensing {
namespace {

constexpr long kSlopeRows = 90;
constexpr long kSlopeColumns = 7;

Demodulation demodulated(double frequency, double carrier) {
  Plane image(kSlopeRows, kSlopeColumns);
  for (long row = 0; row < kSlopeRows; ++row) {
    image.row(row) =
        static_cast<float>(0.5 + 0.3 * std::cos(frequency * static_cast<double>(row) + kPhase));
  }
  Demodulation out;
  demodulate({image}, Mask::Ones(kSlopeRows, kSlopeColumns), make_filter(carrier), out);
  return out;
}

/// Largest error of the phase away from the borders.
double phase_error(const Demodulation& signal, double frequency, double carrier) {
  double largest = 0;
  for (long row = 20; row < kSlopeRows - 20; ++row) {
    const std::complex<double> found(static_cast<double>(signal.channels[0].re(row, 3)),
                                     static_cast<double>(signal.channels[0].im(row, 3)));
    const double expected = (frequency - carrier) * static_cast<double>(row) + kPhase;
    largest = std::max(largest, std::abs(std::arg(found * std::polar(1.0, -expected))));
  }
  return largest;
}

TEST(LocalFrequency, ASlopeLeavesNoRipple) {
  // Unadapted, the ripple of a frequency off by 20 % is 0.004 to 0.008 rad.
  for (const double ratio : {0.8, 0.9, 1.05, 1.2}) {
    const double frequency = ratio * kCarrier;
    EXPECT_LT(phase_error(demodulated(frequency, kCarrier), frequency, kCarrier), 5e-4) << ratio;
  }
}

TEST(LocalFrequency, HoldsForACarrierThatRunsUpwards) {
  const double frequency = -1.15 * kCarrier;
  EXPECT_LT(phase_error(demodulated(frequency, -kCarrier), frequency, -kCarrier), 5e-4);
}

TEST(LocalFrequency, ASlopeLeavesNoResidual) {
  // Unadapted, a sinusoid of power 0.045 leaves up to 8e-3 of it, a little more or less with the
  // phase.
  for (const double ratio : {0.8, 0.9, 1.2}) {
    const Demodulation signal = demodulated(ratio * kCarrier, kCarrier);
    EXPECT_LT(signal.residual.middleRows(20, kSlopeRows - 40).maxCoeff(), 1.2e-3F) << ratio;
  }
}

TEST(LocalFrequency, NothingChangesAtTheCarrier) {
  EXPECT_LT(phase_error(demodulated(kCarrier, kCarrier), kCarrier, kCarrier), 1e-5);
}

}  // namespace
}  // namespace palpate::sensing
