// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/identify.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "identify/held_forces.h"
#include "identify/parameter_estimation.h"
#include "identify/strip_energy.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::haptics {
namespace {

/// Typical sizes of an acquisition, all > 0.
struct Sizes {
  double force = 0;         ///< [N] root mean square
  double displacement = 0;  ///< [mm] root mean square
};

Sizes sizes_of(const std::vector<Pair>& pairs) {
  Sizes sizes;
  for (const Pair& pair : pairs) {
    sizes.force += pair.force.squaredNorm();
    sizes.displacement += pair.displacement.squaredNorm();
  }
  sizes.force = std::sqrt(sizes.force / static_cast<double>(pairs.size()));
  sizes.displacement = std::sqrt(sizes.displacement / static_cast<double>(pairs.size()));
  if (!(sizes.force > 0 && sizes.displacement > 0 && std::isfinite(sizes.force) &&
        std::isfinite(sizes.displacement))) {
    throw InvalidInput(fmt::format(
        "identify: the {} samples hold no force or no displacement; nothing elastic shows in them.",
        pairs.size()));
  }
  return sizes;
}

/// The frame of the contacts: origin at their mean, Z the mean inward normal, X the direction in
/// which they spread most.
struct Base {
  Eigen::Vector3d origin, spread, side, inward;
};

Base base_of(const std::vector<probing::Contact>& contacts) {
  Base base{Eigen::Vector3d::Zero(), {}, {}, Eigen::Vector3d::Zero()};
  for (const probing::Contact& contact : contacts) {
    base.origin += contact.position / static_cast<double>(contacts.size());
    base.inward -= contact.normal;
  }
  // Normals that cancel belong to an object seen from all sides.
  constexpr double kOneSided = 0.1;
  if (!(base.inward.norm() > kOneSided * static_cast<double>(contacts.size()))) {
    throw InvalidInput("identify: the contacts' normals cancel; a strip has one side.");
  }
  base.inward.normalize();
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const probing::Contact& contact : contacts) {
    Eigen::Vector3d from = contact.position - base.origin;
    from -= from.dot(base.inward) * base.inward;
    moments += from * from.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(moments);
  base.spread =
      eigen.eigenvectors().col(2) - eigen.eigenvectors().col(2).dot(base.inward) * base.inward;
  // Contacts at one place spread in no direction.
  if (!(eigen.eigenvalues()[2] > 0)) base.spread = base.inward.unitOrthogonal();
  base.spread.normalize();
  // The sign of an eigenvector is arbitrary. Choose it so that the first contact by id that is off
  // the middle is on the low side.
  std::vector<const probing::Contact*> by_id;
  by_id.reserve(contacts.size());
  for (const probing::Contact& contact : contacts) by_id.push_back(&contact);
  std::sort(by_id.begin(), by_id.end(), [](const auto* a, const auto* b) { return a->id < b->id; });
  constexpr double kOffMiddle = 0.1;
  for (const probing::Contact* contact : by_id) {
    const double at = base.spread.dot(contact->position - base.origin);
    if (!(std::abs(at) > kOffMiddle * std::sqrt(eigen.eigenvalues()[2]))) continue;
    if (at > 0) base.spread = -base.spread;
    break;
  }
  base.side = base.inward.cross(base.spread);
  return base;
}

enum StripParameter : Eigen::Index {
  kTension,
  kAxial,
  kLow,
  kHigh,
  kLateral,
  kCompliance,
  kSlope,
  kCurvature,
  kAngle,
  kStripParameters
};

StripModel strip_model(const Base& base, const Eigen::VectorXd& p) {
  StripModel model;
  model.origin = base.origin;
  model.axis = std::cos(p[kAngle]) * base.spread + std::sin(p[kAngle]) * base.side;
  model.across = base.inward.cross(model.axis);
  model.low_support = p[kLow];
  model.high_support = p[kHigh];
  model.tension = p[kTension];
  model.axial_stiffness = p[kAxial];
  model.lateral_stiffness = p[kLateral];
  model.compliance = p[kCompliance];
  model.slope = p[kSlope];
  model.curvature = p[kCurvature];
  return model;
}

/// d = e + compliance f with grad U(e; p) = f, so that de/dp = -H^-1 d(grad U)/dp: one equilibrium,
/// found from the last one, gives all derivatives. Only the gradient, which is explicit, is
/// differenced.
std::optional<Prediction> predict_strip(const Base& base, const Eigen::VectorXd& p,
                                        const Eigen::VectorXd& scale,
                                        const probing::Contact& contact, const Pair& pair,
                                        const Prediction* last) {
  constexpr double kDifference = 1e-5;  // of a parameter's scale: (rounding)^(1/3)
  const Strip strip = strip_at(strip_model(base, p), contact);
  if (!is_sound(strip)) return std::nullopt;
  const Eigen::Vector3d near =
      last ? Eigen::Vector3d(last->displacement - p[kCompliance] * pair.force)
           : Eigen::Vector3d::Zero();
  const std::optional<Eigen::Vector3d> found =
      find_equilibrium(strip, strip.frame * pair.force, strip.frame * near);
  if (!found) return std::nullopt;
  const Eigen::LLT<Eigen::Matrix3d> stiffness(hessian(strip, *found));
  if (stiffness.info() != Eigen::Success) return std::nullopt;
  const Eigen::Vector3d e = strip.frame.transpose() * *found;
  const Eigen::Matrix3d sheet = strip.frame.transpose() * stiffness.solve(strip.frame);
  Prediction prediction;
  prediction.displacement = e + p[kCompliance] * pair.force;
  prediction.compliance = sheet + p[kCompliance] * Eigen::Matrix3d::Identity();
  prediction.by_parameters.resize(3, kStripParameters);
  for (Eigen::Index k = 0; k < kStripParameters; ++k) {
    Eigen::Vector3d difference = Eigen::Vector3d::Zero();
    const double step = kDifference * scale[k];
    for (const double sign : {1.0, -1.0}) {
      Eigen::VectorXd moved = p;
      moved[k] += sign * step;
      const Strip other = strip_at(strip_model(base, moved), contact);
      difference += sign * (other.frame.transpose() * gradient(other, other.frame * e));
    }
    prediction.by_parameters.col(k) = -(sheet * difference) / (2 * step);
  }
  prediction.by_parameters.col(kCompliance) = pair.force;
  return prediction;
}

/// The reach of the contacts in a direction.
double reach(const Base& base, const std::vector<probing::Contact>& contacts,
             const Eigen::Vector3d& direction) {
  double most = 0;
  for (const probing::Contact& contact : contacts) {
    most = std::max(most, std::abs(direction.dot(contact.position - base.origin)));
  }
  return most;
}

/// Scales of the parameters, and starts of the search: supports somewhat outside the contacts,
/// along several directions.
void add_scales(ParametricLaw& law, const Base& base, const std::vector<probing::Contact>& contacts,
                const Sizes& sizes) {
  constexpr double kOutside = 1.25;  // supports beyond the contacts
  constexpr double kLeastReach = 3;  // [displacements] where contacts are too close to tell
  constexpr int kDirections = 4;
  const double half = std::max(
      kOutside * std::max(reach(base, contacts, base.spread), reach(base, contacts, base.side)),
      kLeastReach * sizes.displacement);
  // A segment of this length, displaced transversely by this much, takes a third of the force by
  // tension and the rest by strain.
  const double ratio = half / sizes.displacement;
  law.scale.resize(kStripParameters);
  law.scale << sizes.force, sizes.force * ratio * ratio * ratio, half, half,
      sizes.force / sizes.displacement, sizes.displacement / sizes.force, 1 / half,
      1 / (half * half), 1;
  for (int k = 0; k < kDirections; ++k) {
    const double angle = k * std::numbers::pi / kDirections;
    const Eigen::Vector3d axis = std::cos(angle) * base.spread + std::sin(angle) * base.side;
    const double support =
        std::max(kOutside * reach(base, contacts, axis), kLeastReach * sizes.displacement);
    Eigen::VectorXd start(kStripParameters);
    start << sizes.force / 3, sizes.force * std::pow(support / sizes.displacement, 3) / 2, -support,
        support, 0.1 * law.scale[kLateral], 0.02 * law.scale[kCompliance], 0, 0, angle;
    law.starts.push_back(start);
  }
}

/// The same strip with its angle in [0, pi).
void unwrap(Eigen::VectorXd& p) {
  const double turns = std::floor(p[kAngle] / std::numbers::pi);
  p[kAngle] -= turns * std::numbers::pi;
  if (std::fmod(turns, 2) == 0) return;
  p[kSlope] = -p[kSlope];
  const double low = p[kLow];
  p[kLow] = -p[kHigh];
  p[kHigh] = -low;
}

Prediction predict_half_space(const HalfSpaceModel& model, const probing::Contact& contact,
                              const Pair& pair) {
  Prediction prediction;
  prediction.compliance = stiffness(model, contact).inverse();
  prediction.displacement = prediction.compliance * pair.force;
  const double nu = model.poisson_ratio,
               softness = 1 / (4 * model.tool_radius * model.young_modulus);
  const Eigen::Vector3d n = contact.normal.normalized();
  const Eigen::Vector3d along = n.dot(pair.force) * n;
  // 1 / k_n = 2 (1 - nu^2) softness, 1 / k_t = (1 + nu) (2 - nu) softness
  prediction.by_parameters.resize(3, 2);
  prediction.by_parameters.col(0) = -prediction.displacement / model.young_modulus;
  prediction.by_parameters.col(1) =
      softness * ((1 - 2 * nu) * (pair.force - along) - 4 * nu * along);
  return prediction;
}

}  // namespace

void visit(IdentifyOptions& options, FieldVisitor& visitor) {
  visitor.begin("IdentifyOptions");
  visitor.real(
      {"displacement_noise",
       "Standard deviation of each component of a position; give both noises or none. Without "
       "them, both are estimated from positions that were repeated",
       "mm"},
      options.displacement_noise, above(0).finite());
  visitor.real({"force_noise",
                "Standard deviation of each component of a force; give both noises or none", "N"},
               options.force_noise, at_least(0).finite());
  constexpr bool kExpert = true;
  visitor.real({"max_chi2",
                "The parametric model describes the object only if chi^2 per degree of freedom is "
                "at most this",
                "", kExpert},
               options.max_chi2, above(1));
  visitor.real(
      {"min_explained", "And only if it explains at least this share of the squared displacements",
       "", kExpert},
      options.min_explained, above(0).at_most(1));
}

IdentifiedStrip identify_strip(const probing::CheckedAcquisition& acquisition,
                               const IdentifyOptions& options) {
  check_identify_options(options);
  std::vector<Pair> pairs = realigned_pairs(acquisition);
  const Sizes sizes = sizes_of(pairs);
  expect_held(friction_cones(acquisition, options), pairs);
  const Base base = base_of(acquisition.contacts());
  ParametricLaw law;
  law.names = {"tension",    "axial stiffness", "low support", "high support", "lateral stiffness",
               "compliance", "slope",           "curvature",   "axis"};
  law.units = {"N", "N", "mm", "mm", "N/mm", "mm/N", "1/mm", "1/mm^2", "rad"};
  law.lower.setConstant(kStripParameters, -std::numeric_limits<double>::infinity());
  law.upper.setConstant(kStripParameters, std::numeric_limits<double>::infinity());
  for (const Eigen::Index k : {kTension, kAxial, kLateral, kCompliance}) law.lower[k] = 0;
  add_scales(law, base, acquisition.contacts(), sizes);
  law.predict = each_pair([&](const Eigen::VectorXd& p, const Pair& pair, const Prediction* last) {
    return predict_strip(base, p, law.scale, acquisition.contacts()[pair.contact], pair, last);
  });
  LawEstimate found = estimate(law, pairs, acquisition.contacts(), options);
  const Eigen::VectorXd before = found.parameters;
  unwrap(found.parameters);
  auto& parameters = found.report.parameters;
  if (found.parameters[kLow] != before[kLow]) std::swap(parameters[kLow], parameters[kHigh]);
  for (Eigen::Index k = 0; k < kStripParameters; ++k) {
    ParameterEstimate& parameter = parameters[static_cast<std::size_t>(k)];
    parameter.name = law.names[static_cast<std::size_t>(k)];
    if (parameter.value) parameter.value = found.parameters[k];
  }
  return {strip_model(base, found.parameters), std::move(found.report)};
}

IdentifiedHalfSpace identify_half_space(const probing::CheckedAcquisition& acquisition,
                                        double tool_radius, const IdentifyOptions& options) {
  check_identify_options(options);
  require("identify_half_space(): tool_radius", tool_radius, above(0).finite(), "mm");
  std::vector<Pair> pairs = realigned_pairs(acquisition);
  const Sizes sizes = sizes_of(pairs);
  expect_held(friction_cones(acquisition, options), pairs);
  // No known material is outside these bounds; at nu = -1 the stiffness is infinite.
  constexpr double kLeastModulus = 1e-6;  // of the first guess
  constexpr double kLeastPoisson = -0.99, kMostPoisson = 0.5, kUsualPoisson = 0.3;
  const double modulus = sizes.force / (2 * tool_radius * sizes.displacement);
  ParametricLaw law;
  law.names = {"Young's modulus", "Poisson's ratio"};
  law.units = {"N/mm^2", ""};
  law.scale = Eigen::Vector2d(modulus, 1);
  law.lower = Eigen::Vector2d(kLeastModulus * modulus, kLeastPoisson);
  law.upper = Eigen::Vector2d(std::numeric_limits<double>::infinity(), kMostPoisson);
  law.starts = {Eigen::Vector2d(modulus, kUsualPoisson)};
  law.predict = each_pair([&](const Eigen::VectorXd& p, const Pair& pair, const Prediction*) {
    return std::optional(
        predict_half_space({p[0], p[1], tool_radius}, acquisition.contacts()[pair.contact], pair));
  });
  LawEstimate found = estimate(law, pairs, acquisition.contacts(), options);
  return {{found.parameters[0], found.parameters[1], tool_radius}, std::move(found.report)};
}

const char* to_string(ParameterStatus status) {
  switch (status) {
    case ParameterStatus::determined:
      return "determined";
    case ParameterStatus::at_bound:
      return "at_bound";
    case ParameterStatus::undetermined:
      return "undetermined";
  }
  return "";
}

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::describes:
      return "describes";
    case Verdict::does_not_describe:
      return "does_not_describe";
    case Verdict::not_testable:
      return "not_testable";
    case Verdict::not_converged:
      return "not_converged";
  }
  return "";
}

}  // namespace palpate::haptics
