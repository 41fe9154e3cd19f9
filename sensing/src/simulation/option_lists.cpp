// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/option_lists.h"

#include "palpate/sensing/decode.h"
#include "palpate/sensing/live_camera.h"
#include "palpate/sensing/multishot.h"
#include "palpate/sensing/pattern_design.h"
#include "palpate/sensing/rig_calibration.h"
#include "palpate/sensing/virtual_sensor.h"

namespace palpate::sensing {

void visit_options(FieldVisitor& visitor) {
  CameraSettings camera;
  visit(camera, visitor);
  RigCalibrationOptions rig;
  visit(rig, visitor);
  PatternOptions pattern;
  visit(pattern, visitor);
  DecodeOptions decode;
  visit(decode, visitor);
  MultishotOptions multishot;
  visit(multishot, visitor);
  VirtualSensor sensor;
  visit(sensor, visitor);
}

}  // namespace palpate::sensing
