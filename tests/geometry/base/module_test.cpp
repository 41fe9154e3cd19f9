// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/module.h"

#include <gtest/gtest.h>

#include "file_testing.h"
#include "palpate/error.h"

namespace palpate {
namespace {

TEST(Module, OneThatIsMissingIsNamedWithTheFolderWhereItHasToBe) {
  for (const char* const words : {"/libpalpate_nowhere-", "cannot open shared object file",
                                  "installed beside libpalpate_geometry.so"}) {
    EXPECT_THROWS_MESSAGE((void)module_symbol("nowhere"), Error, words);
  }
}

}  // namespace
}  // namespace palpate
