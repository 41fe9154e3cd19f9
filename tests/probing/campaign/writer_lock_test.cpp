// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "campaign/writer_lock.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <optional>

#include "palpate/core/error.h"
#include "scratch_folder.h"

namespace palpate::probing {
namespace {

TEST(WriterLock, IsHeldByOneUntilItLetsGo) {
  const ScratchFolder folder;
  const std::filesystem::path path = folder / "a.db";
  EXPECT_THROW(WriterLock{path}, OutputError);  // there is no file
  std::ofstream(path) << "x";
  std::optional<WriterLock> first(std::in_place, path);
  EXPECT_THROW(WriterLock{path}, OutputError);
  first.reset();
  EXPECT_NO_THROW(WriterLock{path});
}

}  // namespace
}  // namespace palpate::probing
