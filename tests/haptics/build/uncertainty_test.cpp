// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "build/uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "build/rule_errors.h"
#include "palpate/geometry/contact_triangulation.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/contact_compliance.h"
#include "palpate/haptics/contact_strength.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

// The stiffness along the pressing at a place [N/mm]: waves with random phases.
class Waves {
 public:
  Waves(unsigned seed, double amplitude, double length) : amplitude_(amplitude), length_(length) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> angle(0, 6.28);
    for (Vector3d& wave : waves_) wave = {angle(random), angle(random), angle(random)};
  }
  [[nodiscard]] double at(double x, double y) const {
    double sum = 0;
    for (const Vector3d& wave : waves_) {
      const double along = std::cos(wave.x()) * x + std::sin(wave.x()) * y;
      sum += std::cos(along / length_ + wave.y());
    }
    return std::exp(amplitude_ * sum);
  }

 private:
  double amplitude_, length_;
  std::array<Vector3d, 6> waves_;
};

// Linear springs, half as stiff across.
ForceField spring_of(double stiffness) {
  constexpr double kRounding = 1e3;
  ForceField field;
  for (int axis = 0; axis < 3; ++axis) {
    field.bases.push_back({.weight = stiffness * (axis == 2 ? 1 : 0.5) * kRounding,
                           .epsilon = kRounding,
                           .ridge = Vector3d::Unit(axis)});
  }
  return field;
}

Vector3d true_force(double stiffness, const Vector3d& displacement) {
  return stiffness * Vector3d(0.5, 0.5, 1).cwiseProduct(displacement);
}

struct Made {
  Model model;
  std::vector<ForceSamples> samples;
};

// The triangulation of the contacts, which lie on the surface.
void triangulate(Model& model) {
  const geometry::SurfaceQuery query(model.surface);
  std::vector<geometry::SurfacePoint> points;
  for (const ContactModel& contact : model.contacts)
    points.push_back(query.closest_point(contact.position).at);
  geometry::ContactTriangulation triangulation =
      geometry::triangulate_contacts(model.surface, points);
  model.triangles = triangulation.mesh.triangles;
  model.surface_weights = triangulation.weights;
}

// 36 contacts 14 mm apart, whose own stiffness is known to 2 % and whose samples have some noise.
Made object(const Waves& waves, unsigned seed, const MeasurementNoise& noise) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> shift(-2, 2);
  Made made;
  made.model.surface = flat_surface(50, 20);
  for (int i = 0; i < 36; ++i) {
    ContactModel contact;
    contact.id = i;
    contact.position << 14 * (i % 6) - 35 + shift(random), 14 * (i / 6) - 35 + shift(random), 700;
    const double stiffness = waves.at(contact.position.x(), contact.position.y());
    contact.field = spring_of(stiffness * (1 + 0.02 * normal(random)));
    contact.uncertainty = ContactUncertainty{.force = 0.02 * stiffness * 2};
    ForceSamples samples;
    samples.displacements.resize(3, 6);
    samples.forces.resize(3, 6);
    for (int j = 0; j < 6; ++j) {
      samples.displacements.col(j) = Vector3d(0.3 * (j % 3 - 1), 0.2, 0.5 * (j + 1));
      samples.forces.col(j) =
          true_force(stiffness, samples.displacements.col(j)) +
          noise.force * Vector3d{normal(random), normal(random), normal(random)};
    }
    made.samples.push_back(samples);
    made.model.contacts.push_back(contact);
  }
  triangulate(made.model);
  return made;
}

// Errors at the contacts of each fifth, relative to those stated by the model of the others.
double ratio_left_out(const Made& made, const MeasurementNoise& noise) {
  double sum = 0, count = 0;
  for (std::size_t fold = 0; fold < 5; ++fold) {
    Made rest;
    rest.model.surface = made.model.surface;
    for (std::size_t i = 0; i < made.samples.size(); ++i) {
      if (i % 5 == fold) continue;
      rest.model.contacts.push_back(made.model.contacts[i]);
      rest.samples.push_back(made.samples[i]);
    }
    triangulate(rest.model);
    const BlendedField field(
        with_uncertainty(with_compliances(rest.model, 1), rest.samples, noise));
    for (std::size_t i = fold; i < made.samples.size(); i += 5) {
      const Vector3d& place = made.model.contacts[i].position;
      for (Eigen::Index j = 0; j < made.samples[i].forces.cols(); ++j) {
        const Vector3d displacement = made.samples[i].displacements.col(j);
        const double stated = field.deviation(place, displacement).value();
        sum += (field.force(place, displacement) - made.samples[i].forces.col(j)).squaredNorm() /
               (stated * stated + 3 * noise.force * noise.force);
        ++count;
      }
    }
  }
  return std::sqrt(sum / count);
}

// Root mean square of the errors at places between the contacts, relative to the stated ones.
double ratio_between(const Model& model, const Waves& waves, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-33, 33);
  const BlendedField field(model);
  double sum = 0;
  for (int i = 0; i < 400; ++i) {
    const double x = place(random), y = place(random);
    const Vector3d displacement(0.2, -0.1, 2);
    const Vector3d error =
        field.force(Vector3d(x, y, 700), displacement) - true_force(waves.at(x, y), displacement);
    const double stated = field.deviation(Vector3d(x, y, 700), displacement).value();
    sum += error.squaredNorm() / (stated * stated);
  }
  return std::sqrt(sum / 400);
}

constexpr MeasurementNoise kNoise{.force = 0.02};

TEST(WithUncertainty, StatesTheErrorsBetweenContacts) {
  // From gentle changes of stiffness to ones that the contacts hardly resolve.
  for (const double length : {30.0, 10.0}) {
    double sum = 0;
    for (const unsigned seed : {1U, 2U}) {
      const Waves waves(seed, 0.2, length);
      const Made made = object(waves, seed, kNoise);
      sum += ratio_between(with_uncertainty(with_compliances(made.model, 1), made.samples, kNoise),
                           waves, seed);
    }
    EXPECT_GT(sum / 2, 0.5) << length;  // errors of contacts count as if all were the same
    EXPECT_LT(sum / 2, 1.3) << length;
  }
}

// Many of them lie at the border, where forces are continued.
TEST(WithUncertainty, StatesTheErrorsOfContactsThatAreLeftOut) {
  for (const double length : {30.0, 10.0}) {
    double squares = 0;
    for (const unsigned seed : {1U, 2U, 3U})
      squares +=
          std::pow(ratio_left_out(object(Waves(seed, 0.2, length), seed, kNoise), kNoise), 2) / 3;
    EXPECT_GT(std::sqrt(squares), 0.8) << length;
    EXPECT_LT(std::sqrt(squares), 1.2) << length;
  }
}

TEST(WithUncertainty, StatesMoreWhereTheObjectChangesFaster) {
  const Waves waves(1, 0, 12);
  Made made = object(waves, 1, kNoise);
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  // On one half the stiffness of neighbours has nothing to do with each other.
  for (std::size_t i = 0; i < made.samples.size(); ++i) {
    if (made.model.contacts[i].position.x() < 0) continue;
    const double stiffness = std::exp(0.4 * normal(random));
    made.model.contacts[i].field = spring_of(stiffness);
    for (Eigen::Index j = 0; j < 6; ++j)
      made.samples[i].forces.col(j) = true_force(stiffness, made.samples[i].displacements.col(j));
  }
  const BlendedField field(with_uncertainty(with_compliances(made.model, 1), made.samples, kNoise));
  const Vector3d displacement(0, 0, 2);
  EXPECT_GT(field.deviation(Vector3d(28, 0, 700), displacement).value(),
            3 * field.deviation(Vector3d(-28, 0, 700), displacement).value());
}

TEST(WithUncertainty, StatesErrorsWithoutCompliances) {
  const Waves waves(1, 0.2, 15);
  Made made = object(waves, 1, kNoise);
  made.model = with_compliances(made.model, 1);
  for (ContactModel& contact : made.model.contacts) contact.compliance.reset();
  const double ratio = ratio_between(with_uncertainty(made.model, made.samples, kNoise), waves, 1);
  EXPECT_GT(ratio, 0.5);
  EXPECT_LT(ratio, 1.3);
}

TEST(LeftOutErrorsOfRules, PreferTheRuleThatTheObjectFollows) {
  // Compliances that change linearly are interpolated exactly, and stiffness then is not.
  Made made = object(Waves(1, 0, 12), 1, kNoise);
  for (std::size_t i = 0; i < made.samples.size(); ++i) {
    ContactModel& contact = made.model.contacts[i];
    const double stiffness = 1 / (1 + 0.018 * contact.position.x());
    contact.field = spring_of(stiffness);
    for (Eigen::Index j = 0; j < 6; ++j)
      made.samples[i].forces.col(j) = true_force(stiffness, made.samples[i].displacements.col(j));
  }
  const auto errors = left_out_errors_of_rules(with_compliances(made.model, 1),
                                               with_strengths(made.model, 1), made.samples);
  ASSERT_TRUE(errors);
  EXPECT_LT(errors->compliances, 0.5 * errors->forces);
}

}  // namespace
}  // namespace palpate::haptics
