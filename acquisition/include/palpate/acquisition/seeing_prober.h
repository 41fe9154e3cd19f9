// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "palpate/acquisition/rest_camera.h"
#include "palpate/acquisition/tool_shape.h"
#include "palpate/core/fields.h"
#include "palpate/probing/prober.h"
#include "palpate/sensing/decode.h"

namespace palpate::acquisition {

/// What of a picture becomes a range map. The meaning, unit and range of each field stand in its
/// list, `visit`.
struct SeeingOptions {
  int frames = 1;
  double shaft = ToolShape{}.shaft;
  double tool_margin = 3;
  double least_depths = 0.005;
};

void visit(SeeingOptions& options, FieldVisitor& visitor);

/// Where the files of a campaign go.
struct SeeingFolders {
  std::filesystem::path base;   ///< of the store, to which the names of range maps are relative
  std::string range = "range";  ///< beside it: NNNNNN.tiff, by the number of the trial
  std::string truth = {};       ///< the same of true depths; empty: they are not written
};

/// An arm with a camera: it looks when the tip rests in a sample, decodes what it sees, takes out
/// the pixels in which the tool is, and writes the range map before it reports the action. Its file
/// is named by the trial, so that a campaign that is killed and resumed writes the same again. A
/// picture that is of no use leaves `ProbeReport::range_map` empty and says why; the trial is as
/// good as without a camera. Reference probes are not looked at.
///
/// A camera that fails does not stop an arm that presses: its trial ends without a range map, and
/// the next action that would begin a trial is refused.
///
/// One picture is in memory at a time. The arm waits until the range map is written.
class SeeingProber final : public probing::Prober {
 public:
  /// The arm, camera and decoder must outlive it.
  /// \param radius [mm] of the tip. \throws InvalidInput if an option is outside its range.
  SeeingProber(probing::Prober& arm, RestCamera& camera, const sensing::Decoder& decoder,
               double radius, SeeingFolders folders, const SeeingOptions& options = {});
  ~SeeingProber() override;

  /// \throws OutputError if a range map cannot be written; DeviceError at the beginning of a trial
  /// if the camera failed in the one before; whatever the arm throws.
  [[nodiscard]] probing::ProbeReport perform(const probing::ProbeAction& action) override;
  [[nodiscard]] std::string memory() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::acquisition
