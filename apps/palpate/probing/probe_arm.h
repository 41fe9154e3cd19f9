// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "palpate/geometry/triangle_mesh.h"
#include "palpate/probing/arm_prober.h"
#include "palpate/probing/arm_reach.h"
#include "palpate/probing/contact_plan.h"
#include "palpate/probing/prober.h"
#include "palpate/probing/specimen.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// The arm of a campaign, as a call names it.
struct ArmCall {
  std::string arm = "quasi-static";  ///< or "virtual", or the driver of a device
  fs::path specimen, setup;
  fs::path replay;  ///< a record, in place of an arm
  std::uint64_t seed = 1;
};

/// Options while an arm probes; the result does not depend on them.
struct ArmWatch {
  fs::path stop_file;  ///< the arm is stopped when this file exists; empty: none
  fs::path record;     ///< to write; empty: none
};

/// The description of an arm that a store keeps (JSON), with the texts of its files.
/// \throws FileError, or InvalidInput if the options do not suit the arm.
[[nodiscard]] std::string describe_arm(const ArmCall& call);

/// An arm that probes by a plan.
class CampaignArm : public probing::Prober {
 public:
  /// Before the first trial: switches the arm on, and measures gravity unless it is remembered.
  /// \throws ArmStopped
  virtual void start() {}
  /// Writes what is recorded so far, if there is a record.
  virtual void keep_record() {}
  /// Returns true if the arm moves at all: a quasi-static arm does not.
  [[nodiscard]] virtual bool moves() const { return false; }
  /// Returns true if the object is real; it may be moved while the arm rests.
  [[nodiscard]] virtual bool is_device() const { return false; }
  /// The simulated object that it probes; null before a real one.
  [[nodiscard]] virtual std::shared_ptr<const probing::Specimen> specimen() const {
    return nullptr;
  }
  /// Returns true if its reports have `ProbeReport::truth`.
  [[nodiscard]] virtual bool tells_truth() const { return false; }
  /// The prober that moves the arm; null if it does not move.
  [[nodiscard]] virtual const probing::ArmProber* prober() const { return nullptr; }
  /// Determines the contacts that the arm can probe.
  /// \param surface of a real object, that the links must not touch; null if it is not known.
  [[nodiscard]] virtual probing::PlanReach reach(const probing::ContactPlan& plan,
                                                 const geometry::TriangleMesh* surface) const;
};

/// Makes an arm from its description. Ctrl-C stops it like an emergency stop.
/// \param memory of the arm after the trials that are done; empty at the beginning.
/// \param source names the description in messages.
/// \throws FileError, InvalidInput, or DeviceError of a driver.
[[nodiscard]] std::unique_ptr<CampaignArm> make_campaign_arm(const std::string& description,
                                                             const std::string& source,
                                                             const probing::ContactPlan& plan,
                                                             const std::string& memory,
                                                             const ArmWatch& watch);

}  // namespace palpate::apps
