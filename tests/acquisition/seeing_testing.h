// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "palpate/acquisition/virtual_camera.h"
#include "palpate/probing/closed_form.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/rig_assessment.h"
#include "palpate/sensing/trained_colors.h"
#include "repository.h"

// Shared by the tests of cameras: the bundled rig before an elastic body.
namespace palpate::acquisition::support {

inline std::shared_ptr<const probing::Specimen> soft_body() {
  static const std::shared_ptr<const probing::Specimen> body = probing::make_specimen(
      probing::ElasticBody{.young_modulus = 0.1, .poisson_ratio = 0.5, .size = 80});
  return body;
}

inline VirtualCameraSetup bundled_setup() {
  return {.rig = sensing::read_rig(repository("demo/rig.yaml")),
          .pattern = sensing::read_pattern(repository("demo/pattern.yaml")),
          .panel = sensing::read_frame(repository("demo/pattern.png")),
          .sensor = {},
          .tool = {}};
}

/// Trained on the body at rest.
inline const sensing::TrainedColors& bundled_colors() {
  static const sensing::TrainedColors colors = [] {
    const VirtualCameraSetup setup = bundled_setup();
    const sensing::Body body{.mesh = soft_body()->surface()};
    return sensing::train_colors(sensing::simulate_shot(setup.rig, setup.pattern, setup.panel,
                                                        std::span(&body, 1), setup.sensor,
                                                        {.training = true})
                                     .training);
  }();
  return colors;
}

}  // namespace palpate::acquisition::support
