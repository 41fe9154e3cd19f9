// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/model_bytes.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "model_testing.h"
#include "palpate/haptics/playback.h"

namespace palpate::haptics {
namespace {

/// The trace of a tool that presses and slides, bit by bit.
std::vector<double> trace_of(const Model& model) {
  const Playback playback(model);
  LoopState state;
  std::vector<double> trace;
  const Eigen::Vector3d middle = model.surface.vertices.rowwise().mean();
  const Eigen::Vector3d inward = model.contacts.front().friction_axis;
  const Eigen::Vector3d along = inward.unitOrthogonal();
  for (int tick = 0; tick < 400; ++tick) {
    const Command command =
        playback.step(middle + (0.02 * tick - 2) * inward + 0.03 * tick * along, state);
    trace.insert(trace.end(), command.force.data(), command.force.data() + 3);
    trace.insert(trace.end(), command.contact.data(), command.contact.data() + 3);
  }
  return trace;
}

TEST(ModelBytes, GiveAModelThatPlaysTheSameBits) {
  for (Model model : {some_model(), sheet_model(), uneven_model()}) {
    model.rate = {{0.25, 0.1}};
    const Model again = model_of_bytes(to_bytes(model));
    const std::vector<double> trace = trace_of(model);
    EXPECT_EQ(trace_of(again), trace);
    EXPECT_TRUE(std::ranges::any_of(trace, [](double x) { return x != 0; }));
    EXPECT_EQ(again.contacts.size(), model.contacts.size());
    EXPECT_EQ(again.contacts[1].uncertainty, model.contacts[1].uncertainty);
    EXPECT_EQ(again.probe_radius, model.probe_radius);
  }
}

// Playback needs nothing of the acquisition.
TEST(ModelBytes, LeaveOutWhatBelongsToTheAcquisition) {
  const Model again = model_of_bytes(to_bytes(some_model()));
  EXPECT_FALSE(again.samples_fingerprint || again.pressing_offsets || again.noise);
}

// A page has no geodesic triangulation: the weights come with the bytes.
TEST(ModelBytes, HoldTheWeightsOfAModelWithoutAny) {
  Model model = sheet_model();
  model.surface_weights = {};
  const Model again = model_of_bytes(to_bytes(model));
  EXPECT_EQ(again.surface_weights.weights.cols(), model.surface.vertices.cols());
}

TEST(ModelBytes, AreRefusedWhereverTheyEnd) {
  const std::vector<std::byte> bytes = to_bytes(sheet_model());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(refusal([&] { return model_of_bytes(std::span(bytes).first(size)); }).empty())
        << size;
  }
  std::vector<std::byte> longer = bytes;
  longer.push_back(std::byte{0});
  EXPECT_NE(refusal([&] { return model_of_bytes(longer); }).find("after its end"),
            std::string::npos);
}

TEST(ModelBytes, AreRefusedOrPlayedWhateverByteIsDamaged) {
  const std::vector<std::byte> bytes = to_bytes(sheet_model());
  std::mt19937 random(1);
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    std::vector<std::byte> damaged = bytes;
    damaged[random() % bytes.size()] ^= static_cast<std::byte>(1 + random() % 255);
    try {
      EXPECT_EQ(model_of_bytes(damaged).contacts.size(), 4U);
    } catch (const InvalidInput&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
  std::vector<std::byte> other = bytes;
  other[5] = std::byte{9};
  EXPECT_NE(refusal([&] { return model_of_bytes(other); }).find("another version"),
            std::string::npos);
}

}  // namespace
}  // namespace palpate::haptics
