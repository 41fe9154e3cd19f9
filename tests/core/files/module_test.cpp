// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/module.h"

#include <gtest/gtest.h>

#include "palpate/core/error.h"
#include "throws_message.h"

namespace palpate {
namespace {

TEST(Module, OneThatIsMissingIsNamedWithTheFolderWhereItHasToBe) {
  for (const char* const words : {"/libpalpate_nowhere-", "cannot open shared object file",
                                  "installed beside libpalpate_core.so"}) {
    EXPECT_THROWS_MESSAGE((void)module_symbol("nowhere"), Unavailable, words);
  }
}

}  // namespace
}  // namespace palpate
