// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "export/animation_file.h"

#include <fmt/format.h>

#include <cstddef>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/geometry/mesh_animation.h"
#include "palpate/geometry/mesh_io.h"
#include "shared/progress.h"
#include "shared/words.h"
#include "surfaces/motion_sequence.h"
#include "surfaces/track_record.h"

namespace palpate::apps {
namespace {

/// [Hz] Pages begin to play at this rate too.
constexpr double kUsualRate = 5;

geometry::MeshAnimation read_animation(const std::vector<MotionFrame>& frames, double rate,
                                       const geometry::ReadOptions& options) {
  geometry::MeshAnimation animation;
  Progress progress("reading");
  for (const MotionFrame& frame : frames) {
    if (animation.times.empty()) {
      animation.first = geometry::read_mesh_file(frame.file, options);
    } else {
      const geometry::TriangleMesh& first = animation.first.mesh;
      const geometry::MeshFile mesh = read_motion_frame(frame.file, first, options);
      animation.displacements.emplace_back((mesh.mesh.vertices - first.vertices).cast<float>());
    }
    animation.times.push_back(frame.time / rate);
    progress.show(animation.times.size(), frames.size());
  }
  return animation;
}

std::string lost_in_words(const std::vector<std::string>& lost) {
  if (lost.empty()) return {};
  return fmt::format(
      ". {} of the sequence {} lost and left out ({}{}); the surface moves on between the frames "
      "beside them",
      lost.size() == 1 ? "1 frame" : fmt::format("{} frames", lost.size()),
      lost.size() == 1 ? "was" : "were", lost.front(), lost.size() == 1 ? "" : ", ...");
}

}  // namespace

std::string write_animation(const PageCall& page, const fs::path& output,
                            const std::optional<double>& rate_of_call) {
  const MotionSequence sequence = motion_sequence(page.input);
  const std::optional<double> rate = frame_rate(sequence, rate_of_call);
  std::vector<MotionFrame> frames;
  for (std::size_t i = 0; i < sequence.frames.size();
       i += static_cast<std::size_t>(page.every.value_or(1)))
    frames.push_back(sequence.frames[i]);
  if (frames.size() < 2) {
    throw InvalidInput(
        fmt::format("{}: an animation takes at least two meshes; {}", page.input.string(),
                    sequence.frames.size() < 2
                        ? "the folder has one. Export " + frames.front().file.string() + " alone."
                        : fmt::format("--every takes one of {}", sequence.frames.size())));
  }
  const geometry::MeshAnimation animation =
      read_animation(frames, rate.value_or(kUsualRate), page.meshes);
  geometry::write_mesh_animation(output, animation);
  return fmt::format(
      "{} frames of {} vertices in {:.3g} s{}, {}{}", frames.size(),
      animation.first.mesh.vertices.cols(), animation.times.back(),
      rate ? "" : fmt::format(" ({:g} frames per second; --rate sets another rate)", kUsualRate),
      megabytes(fs::file_size(output)), lost_in_words(lost_frames(page.input)));
}

}  // namespace palpate::apps
