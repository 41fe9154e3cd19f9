// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "bindings.h"
#include "fields.h"
#include "frames.h"
#include "palpate/sensing/decodable.h"
#include "palpate/sensing/live_camera.h"

namespace palpate::python {
namespace {

using sensing::CameraSettings;
using sensing::LiveCamera;

std::unique_ptr<LiveCamera> opened(const std::string& name,
                                   const std::optional<std::pair<int, int>>& size,
                                   const std::string& pixel_format, const py::kwargs& keywords) {
  auto settings = options_from<CameraSettings>(keywords);
  if (size) settings.size = {size->first, size->second};
  settings.pixel_format = pixel_format;
  const Unlocked unlocked;
  std::unique_ptr<LiveCamera> camera = sensing::open_camera(name, settings);
  camera->start();
  return camera;
}

py::object next_frame(LiveCamera& camera, double wait) {
  std::optional<sensing::CameraFrame> frame;
  cv::Mat image;
  {
    const Unlocked unlocked;
    require("next(): wait", wait, at_least(0).finite(), "s");
    frame = camera.next(std::chrono::milliseconds(static_cast<long long>(1e3 * wait)));
    if (frame) image = sensing::decodable(frame->image, camera.state().bayer, camera.state().bits);
  }
  if (!frame) return py::none();
  if (image.data == frame->image.data) image = image.clone();  // the array may be written to
  return py::make_tuple(pixels_of(std::move(image)), frame->number, frame->time);
}

}  // namespace

void add_cameras(py::module_& module) {
  CameraSettings usual;
  py::class_<LiveCamera> camera(module, "LiveCamera", R"(A camera that sends frames at its own pace.

Frames that are not taken in time are lost: then their numbers have gaps. Use it in one thread.)");
  def_described(
      camera,
      described("__init__(self: LiveCamera, name: str, *, size: tuple[int, int] | None = None, "
                "pixel_format: str = ''",
                "None",
                R"(Opens a camera and starts it. What is not given stays as the camera is set.

name: 'aravis:NAME' (GenICam), 'v4l2:NUMBER', or 'simulated:PATH', which plays a folder of images or
a video in a loop. size: (width, height) [px]. pixel_format: as GenICam names it, such as 'Mono8'.
Raises InvalidInput for what the camera does not offer, Error if it cannot be opened.)",
                fields_of(usual)),
      py::init(&opened), arg("name"), kw_only(), arg("size") = py::none(),
      arg("pixel_format") = std::string());
  camera
      .def("next", &next_frame, arg("wait") = 5.0,
           R"((frame, number, time [s]) of the oldest frame that was not taken; None if none comes.

wait: [s] at the longest. The frame is what Decoder.decode() takes: mosaics become colours, and
values of more than 8 bits fill 16. Raises Error if the camera is gone. Ctrl-C is not heard.)")
      .def_property_readonly(
          "warnings", [](const LiveCamera& self) { return self.state().warnings; },
          "What is wrong with its frames, such as compression with losses.");
}

}  // namespace palpate::python
