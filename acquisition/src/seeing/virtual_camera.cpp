// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/acquisition/virtual_camera.h"

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/sensing/bayer.h"
#include "seeing/frame_mean.h"

namespace palpate::acquisition {
namespace {

class VirtualCamera final : public RestCamera {
 public:
  VirtualCamera(std::shared_ptr<const probing::Specimen> specimen, VirtualCameraSetup setup)
      : specimen_(std::move(specimen)), setup_(std::move(setup)) {
    require("VirtualCameraSetup::object_reflectance", setup_.object_reflectance,
            at_least(0).at_most(1));
    require("VirtualCameraSetup::tool_reflectance", setup_.tool_reflectance,
            at_least(0).at_most(1));
    if (!specimen_->knows_shape())
      static_cast<void>(specimen_->deformed_surface(specimen_->surface().vertices.col(0),
                                                    Eigen::Vector3d::Zero()));  // refuses
  }

  RestPicture look(const Rest& rest) override {
    if (!rest.truth) {
      throw InvalidInput(
          "a virtual camera needs the true force and position of a simulated arm; this arm does "
          "not "
          "report them");
    }
    std::array<sensing::Body, 2> bodies;
    bodies[0].mesh = {
        .vertices = specimen_->deformed_surface(rest.truth->contact, rest.truth->force),
        .triangles = specimen_->surface().triangles};
    bodies[0].reflectance.setConstant(setup_.object_reflectance);
    bodies[1].mesh = tool_mesh(setup_.tool, {rest.truth->tip, rest.tool.inward});
    bodies[1].reflectance.setConstant(setup_.tool_reflectance);
    const std::vector<cv::Mat> panels(static_cast<std::size_t>(rest.frames), setup_.panel);
    sensing::Simulation seen = sensing::simulate(
        setup_.rig, bodies, panels, setup_.sensor, setup_.pattern.axis,
        static_cast<std::uint64_t>(rest.trial) * static_cast<std::uint64_t>(rest.frames));
    constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
    seen.truth.range.z = (seen.truth.body == 0).select(seen.truth.range.z, kUnknown);
    const bool raw = setup_.sensor.readout == sensing::Readout::mosaic;
    FrameMean mean;
    for (const cv::Mat& frame : seen.frames)
      mean.add(raw ? sensing::demosaic(frame, sensing::BayerPattern::rggb) : frame);
    return {mean.frame(), std::move(seen.truth.range)};
  }

 private:
  std::shared_ptr<const probing::Specimen> specimen_;
  VirtualCameraSetup setup_;
};

}  // namespace

std::unique_ptr<RestCamera> make_virtual_camera(std::shared_ptr<const probing::Specimen> specimen,
                                                VirtualCameraSetup setup) {
  return std::make_unique<VirtualCamera>(std::move(specimen), std::move(setup));
}

}  // namespace palpate::acquisition
