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

constexpr double kMean = 0.5;
constexpr double kAmplitude = 0.3;

/// Change of the light down the image.
enum class Shading { none, added, multiplied };
/// [1/px] Slope of the light relative to its mean; it is even over all rows, and never dark.
constexpr double kShading = 0.01;

Demodulation demodulated(double frequency, double carrier, Shading shading = Shading::none) {
  Plane image(kSlopeRows, kSlopeColumns);
  for (long row = 0; row < kSlopeRows; ++row) {
    const auto place = static_cast<double>(row);
    const double shade = 1 + kShading * (place - kSlopeRows / 2.0);
    const double mean = kMean * (shading == Shading::none ? 1 : shade);
    const double amplitude = kAmplitude * (shading == Shading::multiplied ? shade : 1);
    image.row(row) = static_cast<float>(mean + amplitude * std::cos(frequency * place + kPhase));
  }
  Demodulation out;
  demodulate({image}, Mask::Ones(kSlopeRows, kSlopeColumns), make_filter(carrier), out);
  return out;
}

/// Largest error of the phase away from the borders.
double phase_error(const Demodulation& signal, double frequency, double carrier, long column = 3) {
  double largest = 0;
  for (long row = 20; row < kSlopeRows - 20; ++row) {
    const std::complex<double> found(static_cast<double>(signal.channels[0].re(row, column)),
                                     static_cast<double>(signal.channels[0].im(row, column)));
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

TEST(LocalFrequency, LightAddedEvenlyLeavesNoRipple) {
  // Without the correction, the ripple is kMean kShading period / (3 pi kAmplitude) = 0.013 rad.
  for (const double ratio : {0.8, 0.9, 1.0, 1.1, 1.2}) {
    const double frequency = ratio * kCarrier;
    EXPECT_LT(phase_error(demodulated(frequency, kCarrier, Shading::added), frequency, kCarrier),
              1e-3)
        << ratio;
  }
  EXPECT_LT(phase_error(demodulated(-kCarrier, -kCarrier, Shading::added), -kCarrier, -kCarrier),
            1e-3);
}

TEST(LocalFrequency, EvenShadingOfASurfaceLeavesNoRipple) {
  // The remaining error comes from the amplitude, whose slope mixes in the mirror image.
  EXPECT_LT(phase_error(demodulated(kCarrier, kCarrier, Shading::multiplied), kCarrier, kCarrier),
            1e-3);
}

TEST(LocalFrequency, ShadingIsAveragedAsTheSinusoidIs) {
  // One column has another slope: the amount subtracted from its neighbours follows the binomial
  // weights, as their phasors do.
  Plane image(kSlopeRows, kSlopeColumns);
  for (long row = 0; row < kSlopeRows; ++row) {
    const auto place = static_cast<double>(row);
    image.row(row) = static_cast<float>(kMean + kAmplitude * std::cos(kCarrier * place + kPhase));
    image(row, 3) += static_cast<float>(kMean * kShading * (place - kSlopeRows / 2.0));
  }
  Demodulation signal;
  demodulate({image}, Mask::Ones(kSlopeRows, kSlopeColumns), make_filter(kCarrier), signal);
  for (const long column : {2, 3, 4}) {
    EXPECT_LT(phase_error(signal, kCarrier, kCarrier, column), 1e-3) << column;
  }
}

TEST(LocalFrequency, NothingChangesAtTheCarrier) {
  EXPECT_LT(phase_error(demodulated(kCarrier, kCarrier), kCarrier, kCarrier), 1e-5);
}

}  // namespace
}  // namespace palpate::sensing
