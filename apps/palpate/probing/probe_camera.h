// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "palpate/acquisition/seeing_prober.h"
#include "palpate/probing/contact_plan.h"
#include "palpate/probing/prober.h"
#include "probing/probe_arm.h"
#include "seeing/live_camera_call.h"

namespace palpate::apps {

/// The camera of a campaign, as a call names it.
struct CameraCall {
  LiveCameraCall camera;          ///< its name: "simulated", a live camera, or empty: none
  fs::path rig, pattern, colors;  ///< empty, also in `resume`: not given
  fs::path sensor;                ///< of a simulated camera; may be empty
  bool truth = false;             ///< also write the true depths
  acquisition::SeeingOptions seeing = {};
};

/// Adds `--rig`, `--pattern`, `--colors` and `--sensor`, and returns them.
std::vector<CLI::Option*> add_camera_files(CLI::App& command, CameraCall& call);
/// Adds `--camera`, these and all other options of the camera.
void add_campaign_camera(CLI::App& command, CameraCall& call);

/// The description of a camera that a store keeps (JSON): its files and their content.
/// Empty if there is no camera.
/// \param seed of the noise. \throws InvalidInput, FileError.
[[nodiscard]] std::string describe_camera(const CameraCall& call, std::uint64_t seed);

/// A description with the files of `call` in place of those that it names, if there are any.
/// \throws InvalidInput if a file is not that with which the campaign began.
[[nodiscard]] std::string moved_camera(const std::string& description, const CameraCall& call,
                                       const fs::path& store);

/// An arm and the camera that observes it.
class CampaignCamera {
 public:
  /// Reads all files, and writes nothing.
  /// \param arm must outlive the camera. \param store of the acquisition; need not exist yet.
  /// \throws InvalidInput if the arm or its specimen cannot be seen, or the files do not fit each
  /// other; FileError.
  CampaignCamera(const std::string& description, const fs::path& store,
                 const probing::ContactPlan& plan, CampaignArm& arm);
  ~CampaignCamera();

  /// Prepares the folders of the range maps.
  /// \throws OutputError.
  void begin() const;
  [[nodiscard]] probing::Prober& prober();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Folders beside the store into which a campaign with a camera writes.
/// \throws InvalidInput if one of them holds files already.
void check_camera_folders(const std::string& description, const fs::path& store);

}  // namespace palpate::apps
