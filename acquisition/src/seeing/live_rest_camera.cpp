// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/acquisition/live_rest_camera.h"

#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/sensing/decodable.h"
#include "palpate/sensing/recording.h"
#include "seeing/frame_mean.h"

namespace palpate::acquisition {
namespace {

class LiveRestCamera final : public RestCamera {
 public:
  LiveRestCamera(std::unique_ptr<sensing::LiveCamera> camera, double patience)
      : camera_(std::move(camera)), patience_(patience) {
    require("make_live_rest_camera(): patience", patience_, above(0).finite());
    camera_->start();
  }

  RestPicture look(const Rest& rest) override {
    FrameMean mean;
    mean.add(decodable(sensing::take_fresh(*camera_, patience_)));
    for (int taken = 1; taken < rest.frames; ++taken)
      mean.add(decodable(sensing::take_next(*camera_, patience_)));
    return {mean.frame(), {}};
  }

 private:
  [[nodiscard]] cv::Mat decodable(const sensing::CameraFrame& frame) const {
    const sensing::CameraState& state = camera_->state();
    try {
      return sensing::decodable(frame.image, state.bayer, state.bits);
    } catch (const InvalidInput& wrong) {
      throw DeviceError(state.name + ": a frame " + wrong.what());
    }
  }

  std::unique_ptr<sensing::LiveCamera> camera_;
  double patience_;
};

}  // namespace

std::unique_ptr<RestCamera> make_live_rest_camera(std::unique_ptr<sensing::LiveCamera> camera,
                                                  double patience) {
  return std::make_unique<LiveRestCamera>(std::move(camera), patience);
}

}  // namespace palpate::acquisition
