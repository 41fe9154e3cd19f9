// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <exception>
#include <string>
#include <typeinfo>

/// Checks that `statement` throws `Exception` (not one derived from it) and that its message has
/// `words`: what it tells the user to do.
#define EXPECT_THROWS_MESSAGE(statement, Exception, words)                               \
  try {                                                                                  \
    statement;                                                                           \
    ADD_FAILURE() << "nothing was thrown";                                               \
  } catch (const std::exception& error) {                                                \
    EXPECT_EQ(typeid(error), typeid(Exception)) << error.what();                         \
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what(); \
  }
