// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/specimen_trials.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/probing/adaptive_trials.h"
#include "palpate/probing/probing_program.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

constexpr int kNoDrag = -1;  // the direction of the normal force alone
/// Of the tangential force at which the tip slips: one that holds and one that does not.
constexpr double kInside = 0.98, kOutside = 1.02;
/// Of the largest tangential force that holds, what every second direction has: forces all at the
/// edge of the cone leave its inside to guesses (docs/trade-probing.md).
constexpr double kSmallerDrag = 0.55;
/// Of the tangential force at which the tip slips, relative to the largest that is tried.
constexpr double kDragStep = 1e-6;

// The trials at one level of the normal force.
struct LevelOfTrials {
  TrialOrder press;
  struct Drag {
    TrialOrder order;
    bool on_boundary = false;
  };
  std::vector<Drag> drags;  // that hold
  std::vector<TrialOrder> slips;
};

// [N] The tangential force along a unit vector at which the tip slips, at most `most`.
double slipping_force(const FrictionCone& cone, const Vector3d& normal_force, const Vector3d& along,
                      double most) {
  const auto holds = [&](double size) {
    const Vector3d force = normal_force + size * along;
    const double inwards = force.dot(cone.axis);
    return (force - inwards * cone.axis).norm() <= cone.coefficient * inwards;
  };
  if (holds(most)) return most;
  double low = 0, high = most;
  while (high - low > kDragStep * most) {
    const double middle = (low + high) / 2;
    (holds(middle) ? low : high) = middle;
  }
  return low;
}

std::vector<LevelOfTrials> trials_at(const Specimen& specimen, const ContactPlan& plan,
                                     const std::vector<double>& forces, std::size_t index) {
  const Contact& contact = plan.contacts[index];
  const FrictionCone cone = specimen.friction_cone(contact.position);
  const Eigen::Matrix3d frame = tangent_frame(contact);
  const int slots = 1 + 2 * plan.options.directions;  // numbers for the trials of a level
  std::vector<LevelOfTrials> levels;
  for (int l = 0; l < static_cast<int>(forces.size()); ++l) {
    const double normal = forces[static_cast<std::size_t>(l)];
    const long long first =
        (static_cast<long long>(index) * static_cast<long long>(forces.size()) + l) * slots;
    const TrialOrder press{.trial = first,
                           .contact = contact,
                           .level = l,
                           .direction = kNoDrag,
                           .normal_force = normal * frame.col(2)};
    LevelOfTrials level{press, {}, {}};
    const double most =
        std::sqrt(std::max(std::pow(plan.options.max_force, 2) - normal * normal, 0.0));
    for (int k = 0; k < plan.options.directions; ++k) {
      const double angle = direction_angle(plan.options, l, k);
      const Vector3d along = std::cos(angle) * frame.col(0) + std::sin(angle) * frame.col(1);
      // One that slips may exceed the most force of the plan by what is outside of the cone.
      const double limit = slipping_force(cone, press.normal_force, along, most / kInside);
      const bool slips = limit < most / kInside;
      const double largest = kInside * limit;
      if (!(largest > kDragStep * most)) continue;
      const bool smaller = (l + k) % 2 != 0;
      TrialOrder order = press;
      order.trial = first + 1 + 2 * k;
      order.direction = k;
      order.tangential_force = (smaller ? kSmallerDrag : 1) * largest * along;
      level.drags.push_back({order, slips && !smaller});
      if (!slips || smaller) continue;
      order.trial += 1;
      order.tangential_force = kOutside * limit * along;
      level.slips.push_back(order);
    }
    levels.push_back(std::move(level));
  }
  return levels;
}

int equilibria_of(const LevelOfTrials& level) { return 1 + static_cast<int>(level.drags.size()); }

// The results of the trials at one contact.
struct ContactTrials {
  std::vector<Sample> samples;
  std::vector<FailedTrial> failed;
  int equilibria = 0;
};

class ContactWorker {
 public:
  ContactWorker(std::unique_ptr<SpecimenContact> contact, const std::function<void(int)>& done)
      : contact_(std::move(contact)), done_(done) {}

  ContactTrials perform(const std::vector<LevelOfTrials>& levels) {
    for (std::size_t l = 0; l < levels.size(); ++l) {
      const LevelOfTrials& level = levels[l];
      const std::optional<Vector3d> a = respond(level.press);
      if (!a) {
        int left = equilibria_of(level) - 1;
        for (std::size_t above = l + 1; above < levels.size(); ++above)
          left += equilibria_of(levels[above]);
        result_.failed.back().not_tried = left;
        done_(left);
        break;
      }
      bool held = false;
      for (const LevelOfTrials::Drag& drag : level.drags) {
        const std::optional<Vector3d> b = respond(drag.order);
        if (!b) continue;
        add(drag.order, TrialOutcome::held, *a, *b);
        result_.samples.back().on_friction_boundary = drag.on_boundary;
        held = true;
      }
      if (!held) add(level.press, TrialOutcome::held, *a, *a);
      for (const TrialOrder& slip : level.slips) add(slip, TrialOutcome::slipped, *a, *a);
    }
    return std::move(result_);
  }

 private:
  // [mm] where the tip rests.
  std::optional<Vector3d> respond(const TrialOrder& order) {
    const Vector3d force = order.normal_force + order.tangential_force;
    std::string reason;
    const Vector3d& place = order.contact.position;
    const std::optional<Vector3d> moved = response_of(*contact_, force, reason);
    ++result_.equilibria;
    done_(1);
    if (moved) return place + *moved;
    result_.failed.push_back({order.contact.id, {place, force, std::move(reason)}, 0});
    return std::nullopt;
  }

  void add(const TrialOrder& order, TrialOutcome outcome, const Vector3d& a, const Vector3d& b) {
    const TrialResult result{
        .outcome = outcome, .touch = order.contact.position, .a = a, .b = b, .a_again = a};
    result_.samples.push_back(sample_of(order, result, 0).value());
  }

  std::unique_ptr<SpecimenContact> contact_;
  const std::function<void(int)>& done_;
  ContactTrials result_;
};

}  // namespace

SpecimenTrials try_specimen(const Specimen& specimen, const ContactPlan& plan,
                            const SpecimenTrialOptions& options) {
  if (plan.contacts.empty())
    throw InvalidInput("try_specimen(): the plan has no contact; plan at least one");
  std::vector<double> forces = base_forces(plan);
  forces.erase(std::unique(forces.begin(), forces.end()), forces.end());
  std::vector<std::vector<LevelOfTrials>> programme;
  int total = 0;
  for (std::size_t i = 0; i < plan.contacts.size(); ++i) {
    programme.push_back(trials_at(specimen, plan, forces, i));
    for (const LevelOfTrials& level : programme.back()) total += equilibria_of(level);
  }

  std::mutex reporting;
  int so_far = 0;
  const std::function<void(int)> done = [&](int more) {
    const std::scoped_lock lock(reporting);
    so_far += more;
    if (options.progress) options.progress(so_far, total);
  };
  std::vector<ContactTrials> performed(programme.size());
  parallel_for(programme.size(), [&](std::size_t i) {
    performed[i] =
        ContactWorker(specimen.at(plan.contacts[i].position), done).perform(programme[i]);
  });

  SpecimenTrials result;
  for (std::size_t i = 0; i < performed.size(); ++i) {
    ContactTrials& one = performed[i];
    result.equilibria += one.equilibria;
    result.failed.insert(result.failed.end(), one.failed.begin(), one.failed.end());
    if (one.samples.empty()) continue;
    result.acquisition.contacts.push_back(plan.contacts[i]);
    result.acquisition.samples.insert(result.acquisition.samples.end(), one.samples.begin(),
                                      one.samples.end());
  }
  result.acquisition.probe_radius = specimen.tip_radius();
  if (result.acquisition.contacts.empty()) {
    throw SolverError("no contact has an equilibrium; at the first, " +
                      result.failed.front().trial.reason);
  }
  return result;
}

}  // namespace palpate::probing
