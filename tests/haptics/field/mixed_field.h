// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>

#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

/// Isotropic bases and ridges with weights of both signs, mostly positive; some such fields are
/// passive within 10 mm, others not.
inline ForceField mixed_field(int bases, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&]() -> Eigen::Vector3d {
    return {uniform(random), uniform(random), uniform(random)};
  };
  ForceField field;
  for (int k = 0; k < bases; ++k) {
    Multiquadric base{0.7 + uniform(random), 3 + 2 * uniform(random), 6 * vector()};
    if (k % 2 == 1) base.ridge = vector().normalized();
    field.bases.push_back(base);
  }
  return field;
}

/// All numbers changed as CertificateOptions::number_tolerance allows.
inline ForceField with_changed_numbers(ForceField field, double tolerance, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (Multiquadric& base : field.bases) {
    const Eigen::Vector3d direction =
        Eigen::Vector3d{uniform(random), uniform(random), uniform(random)}.normalized();
    base.center += tolerance * (base.center.norm() + base.epsilon) * direction;
    base.weight *= 1 + tolerance * uniform(random);
    base.epsilon *= 1 + tolerance * uniform(random);
    if (base.ridge.norm() > 0) {
      base.ridge = (base.ridge + 0.9 * tolerance * direction.reverse()).normalized();
    }
  }
  return field;
}

}  // namespace palpate::haptics
