// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/finite_element_specimen.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/probing/probed_solid.h"
#include "specimen/finite_vector.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

std::string numbers_of(const Vector3d& v) {
  return "(" + std::to_string(v.x()) + ", " + std::to_string(v.y()) + ", " + std::to_string(v.z()) +
         ")";
}

// Throws SolverError unless there is an equilibrium.
const ContactState& equilibrium(const ContactResult& found, const Vector3d& place,
                                const Vector3d& force) {
  if (found.stop != ContactStop::converged) {
    throw SolverError("the object has no equilibrium at " + numbers_of(place) +
                      " mm under the force " + numbers_of(force) + " N: " + to_string(found.stop) +
                      " beyond " + std::to_string(found.state.force.norm()) + " N");
  }
  return found.state;
}

class FiniteElementContact : public SpecimenContact {
 public:
  FiniteElementContact(const ContactEquilibrium& solid, const ProbedPlace& place)
      : solid_(solid), place_(place) {}

  Vector3d displacement(const Vector3d& force) override {
    require_finite("force", force, "N");
    // Not before, since a contact that the tip cannot reach has no displacement.
    if (!series_) series_.emplace(solid_, solid_.touch(place_.position, place_.inward));
    const ContactResult found = series_->apply_force(force);
    return equilibrium(found, place_.position, force).tip - series_->from().tip;
  }

 private:
  const ContactEquilibrium& solid_;
  ProbedPlace place_;
  std::optional<ContactSeries> series_;
};

class FiniteElementSpecimen : public Specimen {
 public:
  FiniteElementSpecimen(DeformableBody body, const FiniteElementSpecimenOptions& options)
      : friction_(options.friction),
        tip_radius_(options.contact.tip_radius),
        solid_(std::move(body), options) {}

  const geometry::TriangleMesh& surface() const override { return solid_.surface(); }

  Vector3d displacement(const Vector3d& contact, const Vector3d& force) const override {
    require_finite("force", force, "N");
    const ProbedPlace at = solid_.place(contact);
    const ContactState start = solid_.equilibrium().touch(at.position, at.inward);
    const ContactResult found = solid_.equilibrium().apply_force(start, force);
    return equilibrium(found, at.position, force).tip - start.tip;
  }

  bool knows_shape() const override { return true; }

  Eigen::Matrix3Xd deformed_surface(const Vector3d& contact, const Vector3d& force) const override {
    require_finite("force", force, "N");
    const ProbedPlace at = solid_.place(contact);
    const ContactEquilibrium& solid = solid_.equilibrium();
    const ContactResult found = solid.apply_force(solid.touch(at.position, at.inward), force);
    return equilibrium(found, at.position, force).positions(Eigen::all, solid_.nodes());
  }

  std::unique_ptr<SpecimenContact> at(const Vector3d& contact) const override {
    return std::make_unique<FiniteElementContact>(solid_.equilibrium(), solid_.place(contact));
  }

  FrictionCone friction_cone(const Vector3d& contact) const override {
    return {solid_.place(contact).inward, friction_};
  }

  std::optional<double> tip_radius() const override { return tip_radius_; }

 private:
  double friction_;
  double tip_radius_;  // [mm]
  ProbedSolid solid_;
};

}  // namespace

std::unique_ptr<Specimen> make_specimen(DeformableBody body,
                                        const FiniteElementSpecimenOptions& options) {
  return std::make_unique<FiniteElementSpecimen>(std::move(body), options);
}

}  // namespace palpate::probing
