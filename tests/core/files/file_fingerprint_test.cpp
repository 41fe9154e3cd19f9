// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/file_fingerprint.h"

#include <gtest/gtest.h>

#include <string>

#include "scratch_folder.h"

namespace palpate {
namespace {

TEST(FileFingerprint, IsThePublishedHash) {
  // Test vectors of FNV-1a by its authors.
  EXPECT_EQ(text_fingerprint(""), "cbf29ce484222325");
  EXPECT_EQ(text_fingerprint("a"), "af63dc4c8601ec8c");
  EXPECT_EQ(text_fingerprint("foobar"), "85944171f73967e8");
}

TEST(FileFingerprint, OfAFileIsThatOfItsContent) {
  const ScratchFolder folder;
  std::string content;  // longer than a block
  for (int i = 0; i < 30000; ++i) content += std::to_string(i);
  write_text(folder / "content", content);
  EXPECT_EQ(file_fingerprint(folder / "content"), text_fingerprint(content));
  content.back() = 'x';
  EXPECT_NE(file_fingerprint(folder / "content"), text_fingerprint(content));
}

}  // namespace
}  // namespace palpate
