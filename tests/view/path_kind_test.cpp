// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "path_kind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "refusal.h"
#include "scratch_folder.h"

namespace palpate::view {
namespace {

using ::testing::HasSubstr;

std::filesystem::path file(const ScratchFolder& folder, const std::string& name) {
  std::filesystem::create_directories((folder / name).parent_path());
  write_text(folder / name, "x");
  return folder / name;
}

TEST(PathKind, IsKnownByNames) {
  const ScratchFolder folder;
  EXPECT_EQ(kind_of(file(folder, "m/field.json").parent_path()), PathKind::model);
  EXPECT_EQ(kind_of(file(folder, "c/field.cbor").parent_path()), PathKind::model);
  EXPECT_EQ(kind_of(file(folder, "s/surface.ply").parent_path()), PathKind::model)
      << "its reader says what is missing";
  EXPECT_EQ(kind_of(file(folder, "r/000000.tiff").parent_path()), PathKind::range_maps);
  EXPECT_EQ(kind_of(file(folder, "one.tiff")), PathKind::range_maps);
  EXPECT_EQ(kind_of(file(folder, "a.db")), PathKind::acquisition);
  EXPECT_EQ(kind_of(file(folder, "hand.PLY")), PathKind::mesh);
  EXPECT_EQ(kind_of(file(folder, "hand.glb")), PathKind::mesh);
}

TEST(PathKind, RefusesTheRestAndSaysWhatWouldBeRight) {
  const ScratchFolder folder;
  EXPECT_THAT(refusal([&] { return kind_of(folder / "no"); }), HasSubstr("no such file or folder"));
  EXPECT_THAT(refusal([&] { return kind_of(folder.path()); }), HasSubstr("is an empty folder"));
  EXPECT_THAT(refusal([&] { return kind_of(file(folder, "scene.json")); }),
              HasSubstr("scene.json: is of no kind that can be shown; expected a model"));
  EXPECT_THAT(refusal([&] { return kind_of(folder.path()); }),
              HasSubstr("is a folder without a model or range maps in it; expected a model"));
}

}  // namespace
}  // namespace palpate::view
