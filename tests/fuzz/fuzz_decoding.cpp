// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Decodes images that the given bytes make up, with a rig, a pattern, options and anchors that they
// make up too. The decoder may refuse them with palpate::InvalidInput; anything else that leaves it
// ends the program, and so do a fault that a sanitizer sees and a result that contradicts itself.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "fuzz_readers.h"
#include "palpate/core/error.h"
#include "palpate/sensing/decode.h"
#include "palpate/sensing/multishot.h"
#include "palpate/sensing/pattern_design.h"
#include "synthetic_scene.h"

namespace {

using namespace palpate;
using namespace palpate::sensing;

/// Reads the bytes as numbers; zeros follow the last one.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  [[nodiscard]] bool left() const { return next_ < size_; }
  int byte() { return left() ? data_[next_++] : 0; }
  /// In 0 ... end - 1, end <= 256.
  int below(int end) { return byte() % end; }
  double within(double low, double high) {
    const int high_byte = byte();
    return low + (high - low) * (256 * high_byte + byte()) / 65535;
  }
  /// Any double: NaN, infinite, huge, or of either sign.
  double any() {
    std::uint64_t bits = 0;
    for (int i = 0; i < 8; ++i) bits = bits << 8U | static_cast<std::uint64_t>(byte());
    return std::bit_cast<double>(bits);
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
  std::size_t next_ = 0;
};

enum class Kind { anchored, striped, multishot };

struct Task {
  Kind kind = Kind::anchored;
  Rig rig;
  Pattern pattern;
  DecodeOptions options;
  MultishotOptions multishot;
  Surface surface;
};

Surface surface_of(Bytes& bytes) {
  Surface surface = plane({bytes.within(-0.5, 0.5), bytes.within(-0.5, 0.5), 1}, 720);
  for (int balls = bytes.below(4); balls > 0; --balls) {
    const double x = bytes.within(-100, 100);
    const double y = bytes.within(-80, 80);
    const double z = bytes.within(400, 700);
    surface = nearer(surface, sphere({x, y, z}, bytes.within(5, 90)));
  }
  return surface;
}

Rig rig_of(Bytes& bytes) {
  Rig rig = make_rig(bytes.below(2) == 1);
  geometry::Camera& camera = rig.camera;
  const double scale = bytes.within(0.1, 0.3);
  camera.width = 16 + bytes.below(80);
  camera.height = 16 + bytes.below(64);
  camera.fx *= scale;
  camera.fy *= scale;
  camera.cx = bytes.within(-0.2, 1.2) * camera.width;
  camera.cy = bytes.within(-0.2, 1.2) * camera.height;
  camera.distortion[0] = bytes.within(-0.3, 0.3);
  rig.projector.distortion[0] = bytes.within(-0.3, 0.3);
  rig.T_projector_camera.translation() *= bytes.within(-1, 2);
  rig.T_projector_camera.rotate(
      Eigen::AngleAxisd(bytes.within(-0.3, 0.3), Eigen::Vector3d::UnitZ()));
  if (bytes.below(4) == 0) rig.covariance = RigCovariance::Identity() * bytes.within(0, 1);
  return rig;
}

Pattern pattern_of(Bytes& bytes, Kind kind, const Rig& rig) {
  const Axis axis = bytes.below(2) == 0 ? Axis::x : Axis::y;
  const double period = bytes.within(10, 250);
  if (kind == Kind::striped) return make_pattern(axis, period, axis == Axis::x ? 768 : 1024);
  const Pattern single{.axis = axis, .period = period, .phase = 0.7, .mean = 0.5, .amplitude = 0.5};
  if (kind == Kind::anchored) return single;
  return multishot_pattern(single, 3 + bytes.below(6), {rig.projector.width, rig.projector.height});
}

/// Puts any number at one of the places where there may be one.
void spoil(Bytes& bytes, Task& task) {
  geometry::Camera& camera = task.rig.camera;
  geometry::Camera& projector = task.rig.projector;
  DecodeOptions& options = task.options;
  double ignored = 0;
  double* const places[] = {&ignored,
                            &camera.fx,
                            &camera.fy,
                            &camera.cx,
                            &camera.distortion[0],
                            &camera.distortion[2],
                            &camera.distortion[4],
                            &projector.fx,
                            &projector.cy,
                            &projector.distortion[1],
                            &task.rig.T_projector_camera.translation().x(),
                            &task.rig.T_projector_camera.translation().z(),
                            &task.rig.red.alpha,
                            &task.rig.blue.gamma,
                            &task.pattern.period,
                            &task.pattern.phase,
                            &task.pattern.amplitude,
                            &options.window_periods,
                            &options.min_signal,
                            &options.min_modulation,
                            &options.max_phase_sigma,
                            &options.max_phase_variance,
                            &options.max_phase_step,
                            &options.max_sensitivity,
                            &options.min_agreement,
                            &task.multishot.max_phase_variance};
  *places[bytes.below(static_cast<int>(std::size(places)))] = bytes.any();
}

void add_anchors(Bytes& bytes, Task& task) {
  for (int i = bytes.below(4); i >= 0; --i) {
    Anchor anchor{.u_px = bytes.within(-0.4, task.rig.camera.width - 0.6),
                  .v_px = bytes.within(-0.4, task.rig.camera.height - 0.6)};
    const Eigen::Vector2d ray = geometry::undistort(task.rig.camera, {anchor.u_px, anchor.v_px});
    const bool on_surface = bytes.below(4) > 0;
    anchor.z = on_surface ? task.surface(ray) : bytes.any();
    task.options.anchors.push_back(anchor);
  }
}

Task task_of(Bytes& bytes) {
  Task task;
  task.kind = static_cast<Kind>(bytes.below(3));
  task.surface = surface_of(bytes);
  task.rig = rig_of(bytes);
  task.pattern = pattern_of(bytes, task.kind, task.rig);
  DecodeOptions& options = task.options;
  options.window_periods = bytes.within(1.25, 4);
  options.half_resolution = bytes.below(2) == 1;
  options.segmentation = bytes.below(2) == 1 ? Segmentation::snakes : Segmentation::flood;
  options.max_phase_variance = bytes.within(0.001, 0.2);
  options.max_phase_step = bytes.within(0.2, 3);
  if (task.kind == Kind::anchored) add_anchors(bytes, task);
  task.multishot.exposures = 1 + bytes.below(2);
  return task;
}

/// Writes bytes over parts of an image, as many as there are.
void damage(Bytes& bytes, cv::Mat& image) {
  for (int parts = bytes.below(6); parts > 0 && bytes.left(); --parts) {
    const cv::Rect part{bytes.below(image.cols), bytes.below(image.rows), 1 + bytes.below(64),
                        1 + bytes.below(64)};
    cv::Mat damaged = image(part & cv::Rect(0, 0, image.cols, image.rows));
    const int first = bytes.byte();
    const int second = bytes.byte();
    const int spread = bytes.byte();
    for (int row = 0; row < damaged.rows; ++row) {
      auto* const values = damaged.ptr<std::uint8_t>(row);
      for (int i = 0; i < damaged.cols * damaged.channels(); ++i)
        values[i] = static_cast<std::uint8_t>(first + (row * second) + (i * spread));
    }
  }
}

cv::Mat image_of(Bytes& bytes, const Task& task, const Pattern& pattern) {
  cv::Mat image;
  render(task.rig, pattern, task.surface).frame.convertTo(image, CV_8U, 1 / 257.0);
  if (task.kind != Kind::striped && bytes.below(2) == 0) cv::extractChannel(image, image, 1);
  damage(bytes, image);
  return image;
}

void fail(const char* what) {
  std::fprintf(stderr, "the result contradicts itself: %s\n", what);
  std::abort();
}

void check_result(const DecodeResult& result) {
  const geometry::ImageF& z = result.range.z;
  if (z.rows() != result.reasons.rows() || z.cols() != result.reasons.cols()) fail("sizes");
  if (result.reasons.size() > 0 && result.reasons.maxCoeff() >= kReasonCount) fail("a reason");
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    const float depth = z.data()[i];
    const bool known = result.reasons.data()[i] == 0;
    if (known != (depth > 0 && std::isfinite(depth))) fail("a depth and its reason");
    if (known && !(result.sigma.data()[i] >= 0)) fail("a standard deviation");
  }
}

/// \param drawn what the images show.
void decode_frame(Bytes& bytes, const Task& task, const Task& drawn) {
  const Decoder decoder(task.rig, task.pattern,
                        task.kind == Kind::striped ? ideal_colors() : TrainedColors{},
                        task.options);
  check_result(decoder.decode(image_of(bytes, drawn, drawn.pattern)));
}

/// All images of the code show sinusoids too: what they say is arbitrary.
void decode_scene(Bytes& bytes, const Task& task, const Task& drawn) {
  const MultishotDecoder decoder(task.rig, task.pattern, task.multishot);
  const std::vector<double>& shifts = drawn.pattern.multishot->shifts;
  Pattern shown = drawn.pattern;
  shown.multishot.reset();
  std::vector<cv::Mat> images;
  for (std::size_t k = 0; k < static_cast<std::size_t>(decoder.images()); ++k) {
    shown.phase = drawn.pattern.phase + shifts[k % shifts.size()];
    images.push_back(image_of(bytes, drawn, shown));
  }
  check_result(decoder.decode(images).decoded);
}

}  // namespace

std::string refusal_of(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  try {
    const Task drawn = task_of(bytes);
    Task task = drawn;
    if (bytes.below(4) == 3) spoil(bytes, task);
    if (task.kind == Kind::multishot) {
      decode_scene(bytes, task, drawn);
    } else {
      decode_frame(bytes, task, drawn);
    }
  } catch (const InvalidInput& refusal) {
    return refusal.what();
  }
  return {};
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  (void)refusal_of(data, size);
  return 0;
}
