// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "model/surface_response_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "following_surface.h"
#include "palpate/haptics/model_bytes.h"
#include "palpate/haptics/model_io.h"
#include "refusal.h"
#include "scratch_folder.h"

namespace palpate::haptics {
namespace {

using ::testing::HasSubstr;

class SurfaceResponseFile : public ::testing::Test {
 protected:
  SurfaceResponseFile() { model.response = FollowingSheet().fit({.nodes = 30}); }

  ScratchFolder scratch;
  Model model = FollowingSheet().model;
};

TEST_F(SurfaceResponseFile, KeepsTheResponseOfAModelExactly) {
  write_model(scratch.path() / "model", model);
  EXPECT_EQ(read_model(scratch.path() / "model").response, model.response);
  EXPECT_EQ(model_of_bytes(to_bytes(model)).response, model.response);
  // As docs/model-file.md says.
  EXPECT_EQ(std::filesystem::file_size(scratch.path() / "model/deformed/response.bin"),
            72 + 12 * model.surface.vertices.cols() + 32 * 4 + 18 * 30 * 4 + (16 + 6 * 30) * 12);
  // A model without one takes the place of a model with one.
  model.response.reset();
  write_model(scratch.path() / "model", model);
  EXPECT_FALSE(read_model(scratch.path() / "model").response);
}

TEST_F(SurfaceResponseFile, RefusesDamagedFiles) {
  const std::filesystem::path path = scratch.path() / "response.bin";
  const auto refused = [&] { return refusal([&] { return read_surface_response(path); }); };
  write_surface_response(path, *model.response);
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 1);
  EXPECT_THAT(refused(), HasSubstr("truncated"));
  std::filesystem::resize_file(path, 20);
  EXPECT_THAT(refused(), HasSubstr("PALPDEFO"));
  write_surface_response(path, *model.response);
  std::fstream(path, std::ios::in | std::ios::out | std::ios::binary).seekp(8).put(9);
  EXPECT_THAT(refused(), HasSubstr("has version 9; this program reads version 1"));
  EXPECT_THAT(refusal([&] { return read_surface_response(scratch.path() / "none.bin"); }),
              HasSubstr("none.bin: cannot be read"));
}

}  // namespace
}  // namespace palpate::haptics
