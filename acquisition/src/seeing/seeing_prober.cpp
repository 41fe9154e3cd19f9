// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/acquisition/seeing_prober.h"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/probing/reference_probe.h"
#include "palpate/sensing/decode_verdict.h"

namespace palpate::acquisition {
namespace {

namespace fs = std::filesystem;

/// More frames would only wait: what is left of the noise is then far below other errors.
constexpr int kMostFrames = 256;

bool is_seen(const probing::ProbeAction& action, const probing::ProbeReport& report) {
  return action.measures_sample && action.trial < probing::kFirstReferenceTrial &&
         report.outcome == probing::ProbeOutcome::done;
}

/// Why most of the pixels without a depth have none, and how many these are.
std::pair<sensing::Reason, long> main_loss(const sensing::ReasonImage& reasons) {
  std::pair<sensing::Reason, long> most{sensing::Reason::unlit, 0};
  for (int code = 1; code < sensing::kReasonCount; ++code) {
    const auto reason = static_cast<sensing::Reason>(code);
    if (const long count = sensing::count(reasons, reason); count > most.second)
      most = {reason, count};
  }
  return most;
}

}  // namespace

void visit(SeeingOptions& options, FieldVisitor& visitor) {
  visitor.begin("SeeingOptions");
  visitor.whole({"frames",
                 "Frames of each sample, taken while the tip rests. Their average is decoded, so "
                 "the noise of the depths is smaller"},
                options.frames, at_least(1).at_most(kMostFrames));
  visitor.real({"shaft",
                "Length of the tool's shaft, a cylinder with the radius of the tip. Pixels that "
                "show it get no depth",
                "mm"},
               options.shaft, above(0).finite());
  visitor.real({"tool_margin",
                "Pixels within this distance of the tip and the shaft get no depth either, because "
                "edges of the tool disturb the decoding",
                "mm"},
               options.tool_margin, at_least(0).finite());
  visitor.real({"least_depths",
                "Smallest share of pixels with a depth. With fewer, the sample gets no range map, "
                "and the store gets an event"},
               options.least_depths, above(0).at_most(1));
}

struct SeeingProber::Impl {
  probing::Prober& arm;
  RestCamera& camera;
  const sensing::Decoder& decoder;
  ToolShape tool;
  SeeingFolders folders;
  SeeingOptions options;
  Eigen::Matrix2Xd rays;
  Eigen::Vector3d inward = Eigen::Vector3d::UnitZ();  // of the latest approach
  sensing::DecodeResult decoded = {};                 // its memory is used again
  std::string failure = {};                           // of the camera; empty: it works

  /// Fills in the name of the range map, or why there is none.
  void see(const probing::ProbeAction& action, probing::ProbeReport& report) {
    const ToolPose pose{report.position, inward};
    RestPicture picture;
    try {
      picture = camera.look({action.trial, pose, report.truth, options.frames});
    } catch (const SolverError& none) {
      report.no_range_map = none.what();
      return;
    } catch (const DeviceError& broken) {
      report.no_range_map = failure = broken.what();
      return;
    }
    decoder.decode(picture.frame, decoded);
    geometry::ImageF& depths = decoded.range.z;
    constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
    depths = hidden_by_tool(rays, depths.rows(), tool, pose, options.tool_margin)
                 .select(kUnknown, depths);
    report.no_range_map = reason_against(depths);
    if (!report.no_range_map.empty()) return;
    const std::string name = fmt::format("{:06}.tiff", action.trial);
    if (!folders.truth.empty() && picture.truth)
      geometry::write_depth_tiff(folders.base / folders.truth / name, picture.truth->z);
    geometry::write_depth_tiff(folders.base / folders.range / name, depths);
    report.range_map = folders.range + "/" + name;
  }

  /// Empty if the depths are of use.
  [[nodiscard]] std::string reason_against(const geometry::ImageF& depths) const {
    const sensing::DecodeJudgement judgement = sensing::judge(decoded.evidence);
    if (!judgement.usable()) return judgement.reason;
    const auto pixels = static_cast<double>(depths.size());
    const double share = static_cast<double>(depths.isFinite().count()) / pixels;
    if (share >= options.least_depths) return {};
    const auto [reason, count] = main_loss(decoded.reasons);
    return fmt::format(
        "{:.2g} % of the picture have a depth, less than {:.2g} %; the most frequent reason is "
        "'{}', in {:.0f} %",
        100 * share, 100 * options.least_depths, sensing::name(reason),
        100 * static_cast<double>(count) / pixels);
  }
};

SeeingProber::SeeingProber(probing::Prober& arm, RestCamera& camera,
                           const sensing::Decoder& decoder, double radius, SeeingFolders folders,
                           const SeeingOptions& options)
    : impl_(new Impl{.arm = arm,
                     .camera = camera,
                     .decoder = decoder,
                     .tool = {.radius = radius, .shaft = options.shaft},
                     .folders = std::move(folders),
                     .options = in_range(options),
                     .rays = geometry::pixel_rays(decoder.rig().camera)}) {}
SeeingProber::~SeeingProber() = default;

probing::ProbeReport SeeingProber::perform(const probing::ProbeAction& action) {
  if (action.kind == probing::ProbeActionKind::travel && !impl_->failure.empty())
    throw DeviceError("the camera failed: " + impl_->failure);
  if (action.kind == probing::ProbeActionKind::touch) impl_->inward = action.force.normalized();
  probing::ProbeReport report = impl_->arm.perform(action);
  if (is_seen(action, report)) impl_->see(action, report);
  return report;
}

std::string SeeingProber::memory() const { return impl_->arm.memory(); }

}  // namespace palpate::acquisition
