// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/stiffness_process.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "palpate/core/error.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

double wavy(const Vector3d& at) {
  return 0.2 * std::exp(0.3 * std::sin(at.x() / 8) * std::cos(at.y() / 10));
}

// A square grid of 8 mm with relative noise.
template <typename Law>
std::vector<ContactStiffness> on_grid(int side, double noise, unsigned seed, const Law& law) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<ContactStiffness> contacts;
  for (int i = 0; i < side * side; ++i) {
    const Vector3d at(8.0 * (i % side), 8.0 * static_cast<double>(i / side), 700);
    const double stiffness = law(at) * (1 + noise * normal(random));
    contacts.push_back({at, stiffness, noise * stiffness});
  }
  return contacts;
}

TEST(StiffnessProcess, ReproducesItsContactsAndASmoothLawBetweenThem) {
  const StiffnessProcess process(on_grid(6, 1e-4, 1, wavy));
  for (const ContactStiffness& contact : on_grid(6, 1e-4, 1, wavy))
    EXPECT_NEAR(process.predict(contact.position).stiffness / contact.stiffness, 1, 1e-3);
  for (const double x : {12.0, 18.0, 25.0}) {
    const Vector3d between(x, 17, 700);
    EXPECT_NEAR(process.predict(between).stiffness / wavy(between), 1, 0.02);
  }
}

// The deviation covers the errors: their squares relative to it are 1 in the mean.
TEST(StiffnessProcess, StatesTheErrorsThatItMakes) {
  double sum = 0;
  int count = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const StiffnessProcess process(on_grid(6, 0.05, seed, wavy));
    for (double x = 4; x < 40; x += 8) {
      const Vector3d between(x, 20, 700);
      const ContactStiffness there = process.predict(between);
      sum += std::pow((there.stiffness - wavy(between)) / there.deviation, 2);
      ++count;
    }
  }
  EXPECT_GT(sum / count, 0.5);
  EXPECT_LT(sum / count, 1.5);
}

TEST(StiffnessProcess, TakesTheNoiseOfAPlainObjectForNoise) {
  const auto plain = [](const Vector3d&) { return 0.3; };
  const StiffnessProcess process(on_grid(7, 0.04, 3, plain));
  EXPECT_LE(process.amplitude(), 0.04);
  EXPECT_NEAR(process.predict({20, 20, 700}).stiffness, 0.3, 0.3 * 0.02);
}

TEST(StiffnessProcess, IsUncertainFarFromItsContacts) {
  const StiffnessProcess process(on_grid(6, 0.01, 1, wavy));
  const ContactStiffness near = process.predict({20, 20, 700}), far = process.predict({500, 0, 0});
  EXPECT_GT(far.deviation / far.stiffness, 5 * near.deviation / near.stiffness);
  EXPECT_GE(far.deviation / far.stiffness, process.amplitude());
}

TEST(StiffnessProcess, RefusesWhatHasNoMap) {
  std::vector<ContactStiffness> contacts = on_grid(2, 0.01, 1, wavy);
  EXPECT_THROW(StiffnessProcess(std::span(contacts).first(2)), InvalidInput);
  contacts[1].position = contacts[0].position;
  EXPECT_THROW(StiffnessProcess{contacts}, InvalidInput);
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    contacts = on_grid(2, 0.01, 1, wavy);
    contacts[2].stiffness = bad;
    EXPECT_THROW(StiffnessProcess{contacts}, InvalidInput);
    contacts = on_grid(2, 0.01, 1, wavy);
    contacts[2].deviation = bad;
    EXPECT_THROW(StiffnessProcess{contacts}, InvalidInput);
  }
  contacts = on_grid(2, 0.01, 1, wavy);
  contacts[3].position.x() = std::nan("");
  EXPECT_THROW(StiffnessProcess{contacts}, InvalidInput);
}

}  // namespace
}  // namespace palpate::probing
