// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "fields.h"
#include "frames.h"
#include "output_path.h"
#include "palpate/core/file_names.h"
#include "palpate/geometry/range_map.h"
#include "palpate/sensing/camera_file.h"
#include "palpate/sensing/decode.h"
#include "palpate/sensing/decode_verdict.h"
#include "palpate/sensing/depth_image.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/multishot.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/pattern_design.h"
#include "palpate/sensing/reason.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/trained_colors.h"
#include "plausible.h"

namespace palpate::python {
namespace {

namespace fs = std::filesystem;
using sensing::Decoder;
using sensing::DecodeResult;
using sensing::Pattern;
using sensing::Rig;
using sensing::TrainedColors;

/// The file with the camera of a range map or of a depth image.
/// \throws FileError naming the argument that is needed.
fs::path camera_file(const fs::path& path, const std::optional<fs::path>& rig,
                     const std::optional<double>& scale) {
  if (!scale && lower_extension(path) == ".png")
    throw FileError(path.string() +
                    ": a depth image needs scale=, the length of one unit in mm: 1 for most "
                    "recordings of RealSense and Azure Kinect cameras");
  if (rig) return *rig;
  const fs::path beside = path.parent_path() / "rig.yaml";
  std::error_code unknown;  // reading will tell more
  if (!fs::exists(beside, unknown)) {
    throw FileError(path.string() + (fs::exists(path, unknown)
                                         ? ": needs its camera: pass the camera file as rig=, "
                                           "or save it as rig.yaml in the same folder"
                                         : ": no such file"));
  }
  return beside;
}

void add_files(py::module_& module) {
  py::class_<Rig>(module, "Rig", "A calibrated camera and projector, and the pose between them.")
      .def_readonly("camera", &Rig::camera, "The camera.")
      .def_readonly("projector", &Rig::projector, "The projector, as a camera.")
      .def_property_readonly(
          "T_projector_camera",
          [](const Rig& rig) { return copy_of(rig.T_projector_camera.matrix()); },
          "(4, 4) maps camera coordinates to projector coordinates [mm].")
      .def(
          "write",
          [](const Rig& rig, const fs::path& path) { sensing::write_rig(output_path(path), rig); },
          arg("path"), "Writes rig.yaml, as read_rig() reads it. Raises OutputError.");
  py::class_<Pattern>(module, "Pattern", "A projected pattern: colour stripes and a sinusoid.")
      .def_readonly("period", &Pattern::period, "[px] of the sinusoid.")
      .def_property_readonly(
          "stripes", [](const Pattern& pattern) { return pattern.stripes.size(); },
          "Number of colour stripes; 0 for a sinusoid alone.")
      .def(
          "write",
          [](const Pattern& pattern, const fs::path& path) {
            sensing::write_pattern(output_path(path), pattern);
          },
          arg("path"), "Writes pattern.yaml, as read_pattern() reads it. Raises OutputError.");
  py::class_<TrainedColors>(module, "TrainedColors", "What the camera sees of each stripe colour.")
      .def_property_readonly(
          "names",
          [](const TrainedColors& trained) {
            std::vector<std::string> names;
            for (const auto& color : trained.colors) names.push_back(color.name);
            return names;
          },
          "Names of the colours.");

  module.def(
      "read_rig",
      [](const fs::path& path) {
        Rig rig = sensing::read_rig(path);
        tell_doubts(path.string(), sensing::rig_doubts(rig));
        return rig;
      },
      arg("path"),
      R"(Reads a rig (OpenCV's YAML), and warns of lengths and angles that are unlikely.

Raises FileError, or InvalidInput if there cannot be such a rig.)");
  module.def("read_pattern", &sensing::read_pattern, arg("path"),
             "Reads a pattern (OpenCV's YAML). Raises FileError.");
  module.def("read_trained_colors", &sensing::read_trained_colors, arg("path"),
             "Reads what train_colors() or `palpate calibrate colors` found. Raises FileError.");
  module.def(
      "train_colors",
      [](const fs::path& folder) {
        const Unlocked unlocked;
        return sensing::train_colors_from_folder(folder);
      },
      arg("folder"),
      R"(Trains the colours with images <colour>_<anything>.png, each of a scene under one colour.

Raises FileError or InvalidInput. Ctrl-C is not heard.)");
  module.def(
      "read_frame",
      [](const fs::path& path) {
        cv::Mat image;
        {
          const Unlocked unlocked;
          image = sensing::read_frame(path);
        }
        return pixels_of(std::move(image));
      },
      arg("path"),
      R"(Reads a camera frame (PNG, TIFF, BMP, JPEG, WebP): uint8 or uint16, (rows, columns) or (rows, columns, 3).

Colours are blue, green, red, as in OpenCV. Raises FileError.)");
  module.def(
      "read_range_map",
      [](const fs::path& path, const std::optional<fs::path>& rig,
         const std::optional<double>& scale) {
        geometry::RangeMap map;
        {
          const Unlocked unlocked;
          const geometry::Camera camera = sensing::read_camera(camera_file(path, rig, scale));
          map = scale ? sensing::read_depth_image(path, *scale, camera)
                      : geometry::RangeMap{geometry::read_depth_tiff(path), camera};
        }
        if (map.z.cols() != map.camera.width || map.z.rows() != map.camera.height) {
          throw InvalidInput(path.string() + ": " + std::to_string(map.z.cols()) + " x " +
                             std::to_string(map.z.rows()) + " pixels, but its camera has " +
                             std::to_string(map.camera.width) + " x " +
                             std::to_string(map.camera.height) +
                             ". Pass the rig that this range map was made with.");
        }
        tell_doubts(path.string(), sensing::range_map_doubts(map, scale));
        return map;
      },
      arg("path"), arg("rig") = py::none(), arg("scale") = py::none(),
      R"(Reads a range map (float32 TIFF, mm), as `palpate decode` writes it, or a depth image (16-bit PNG).

rig: file with its camera, of Palpate, ROS, RealSense or Open3D; None: rig.yaml beside it.
scale: of a depth image, the length of one unit [mm]; None: a range map. Warns of a camera or depths that are unlikely.
Raises FileError, or InvalidInput if the sizes differ, or camera or depths are impossible.)");
}

py::dict counts_of(const DecodeResult& result) {
  py::dict counts;
  for (int code = 0; code < sensing::kReasonCount; ++code) {
    const auto reason = static_cast<sensing::Reason>(code);
    counts[py::str(std::string(sensing::name(reason)))] = sensing::count(result.reasons, reason);
  }
  return counts;
}

void add_design(py::module_& module) {
  using sensing::PatternDesign;
  py::class_<PatternDesign>(module, "PatternDesign",
                            "The result of design_pattern(): a pattern, and what it can do.")
      .def_readonly("pattern", &PatternDesign::pattern, "The pattern.")
      .def_readonly("camera_period", &PatternDesign::camera_period,
                    "[px] shortest period in the camera, on surfaces that face it.")
      .def_readonly("phase_per_relative_depth", &PatternDesign::phase_per_relative_depth,
                    "[rad] a relative error of the depth is the error of the phase divided by it.")
      .def_readonly("edge_tolerance", &PatternDesign::edge_tolerance,
                    "[px] error of a stripe edge in the camera that still identifies the period; "
                    "below 2 the stripes do not identify it reliably.")
      .def_readonly("largest_overlap", &PatternDesign::largest_overlap,
                    "Share of pixels in which the two most similar colours are expected to be "
                    "confused; 0 without trained colours.");
  def_with_options<sensing::PatternOptions>(
      module,
      "design_pattern(rig: Rig, *, trained: TrainedColors | None = None, distances: tuple[float, "
      "float] | None = None",
      "PatternDesign",
      R"(Designs the pattern to project with a rig, as `palpate pattern` does.

trained: the colours are chosen so that the camera distinguishes them best.
distances: [mm] of the nearest and the farthest object; None: where the views overlap.
Raises InvalidInput.)",
      [](const Rig& rig, const std::optional<TrainedColors>& trained,
         const std::optional<std::pair<double, double>>& distances, const py::kwargs& keywords) {
        auto options = options_from<sensing::PatternOptions>(keywords);
        options.trained = trained;
        if (distances) options.range = {distances->first, distances->second};
        const Unlocked unlocked;
        return sensing::design_pattern(rig, options);
      },
      arg("rig"), kw_only(), arg("trained") = py::none(), arg("distances") = py::none());
}

void add_decoder(py::module_& module) {
  py::class_<DecodeResult>(module, "DecodeResult", "The result of Decoder.decode().")
      .def_readonly("range", &DecodeResult::range, "The range map.")
      .def_property_readonly(
          "reasons",
          [](const py::object& self) {
            return image_view(self.cast<DecodeResult&>().reasons, self);
          },
          "(height, width) uint8: 0 where there is a depth, otherwise why there is none.")
      .def_property_readonly("counts", &counts_of,
                             "Number of pixels by reason, in the order of the codes.")
      .def_property_readonly(
          "sigma",
          [](const py::object& self) { return image_view(self.cast<DecodeResult&>().sigma, self); },
          "[mm] (height, width) float32 standard deviation of each depth; NaN without a depth.")
      .def_property_readonly(
          "noise",
          [](const py::object& self) { return image_view(self.cast<DecodeResult&>().noise, self); },
          "[mm] (height, width) float32 part of sigma that is noise of the frame; empty if the rig "
          "has no covariance, since sigma then is noise alone.")
      .def_readonly("transitions", &DecodeResult::transitions, "Stripe edges that were identified.")
      .def_readonly("regions", &DecodeResult::regions, "Smooth regions of the phase.")
      .def_readonly("unresolved_regions", &DecodeResult::unresolved_regions,
                    "Regions with too few stripe edges, or contradicting ones.")
      .def_property_readonly(
          "verdict",
          [](const DecodeResult& result) {
            return sensing::to_string(sensing::judge(result.evidence).verdict);
          },
          "Whether the frame fits rig, pattern and colours: \"accepted\", \"too_little\" to judge "
          "by, or the likely cause. Check it before you use the depths.")
      .def_property_readonly(
          "reason",
          [](const DecodeResult& result) { return sensing::judge(result.evidence).reason; },
          "The verdict in a sentence, with figures and what to try.");
  py::class_<Decoder> added(module, "Decoder", R"(Decodes single frames into range maps.

Threads may decode with the same decoder at the same time.)");
  sensing::DecodeOptions usual;
  def_described(
      added,
      described("__init__(self: Decoder, rig: Rig, pattern: Pattern, colors: TrainedColors, *",
                "None",
                "Prepares everything that does not depend on the frame. Raises InvalidInput.",
                fields_of(usual)),
      py::init([](const Rig& rig, const Pattern& pattern, const TrainedColors& colors,
                  const py::kwargs& keywords) {
        sensing::DecodeOptions options;
        set_fields(fields_of(options), keywords);
        Decoder decoder = [&] {
          const Unlocked unlocked;
          return Decoder(rig, pattern, colors, options);
        }();
        if (!options.anchors.empty())
          tell_doubts("Decoder(): pattern", sensing::sinusoid_doubts(rig, pattern));
        return decoder;
      }),
      arg("rig"), arg("pattern"), arg("colors"));
  added
      .def_property_readonly(
          "rig", [](const Decoder& decoder) { return decoder.rig(); },
          "The rig of the range maps (a copy): its camera has their size.")
      .def(
          "decode",
          [](const Decoder& decoder, const py::object& frame) {
            const Frame given(frame);
            const Unlocked unlocked;
            return decoder.decode(given.mat());
          },
          arg("frame"),
          R"(Decodes a frame of uint8 or uint16, (rows, columns, 3) with blue first, linear in the light.

A frame without the projector's light gives a range map of NaN. Raises InvalidInput if size or
type are wrong, or anchors contradict each other. Ctrl-C is not heard: a frame takes milliseconds.)");
}

void add_multishot(py::module_& module) {
  using sensing::MultishotResult;
  py::class_<MultishotResult>(module, "MultishotResult", "The result of decode_multishot().")
      .def_readonly("decoded", &MultishotResult::decoded, "Depths, reasons and deviations.")
      .def_readonly("disagreement", &MultishotResult::disagreement,
                    R"([rad] error of the phases that is not noise; NaN for three steps.

From 0.02 on the images do not show one still scene under one steady light.)")
      .def_readonly(
          "code_jumps", &MultishotResult::code_jumps,
          R"(Jumps of the phase by whole turns between neighbours, per turn that it runs on.

From 0.02 on the images of the code are not those of the pattern, in its order.)");
  def_with_options<sensing::MultishotOptions>(
      module, "decode_multishot(images: Sequence, rig: Rig, pattern: Pattern, *", "MultishotResult",
      R"(Decodes several images of a static scene into one range map.

images: in the order of the pattern (`palpate pattern --multishot`): shifted sinusoids, then the
code, one exposure after the other; uint8 or uint16, linear in the light.
Raises InvalidInput. Ctrl-C is not heard: it takes about a second.)",
      [](const std::vector<py::object>& images, const Rig& rig, const Pattern& pattern,
         const py::kwargs& keywords) {
        const auto options = options_from<sensing::MultishotOptions>(keywords);
        std::vector<Frame> frames;
        frames.reserve(images.size());
        for (const py::object& image : images) frames.emplace_back(image);
        std::vector<cv::Mat> pixels;
        for (const Frame& frame : frames) pixels.push_back(frame.mat());
        const Unlocked unlocked;
        return sensing::MultishotDecoder(rig, pattern, options).decode(pixels);
      },
      arg("images"), arg("rig"), arg("pattern"));
}

}  // namespace

void add_sensing(py::module_& module) {
  add_files(module);
  add_design(module);
  add_decoder(module);
  add_multishot(module);
}

}  // namespace palpate::python
