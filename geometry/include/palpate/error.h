// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

namespace palpate {

/// Root of everything Palpate throws. The message names the file or argument, the place in it,
/// what is wrong and what would be right.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// An argument or a value that the caller can put right.
struct InvalidInput : Error {
  using Error::Error;
};

/// A file that cannot be read: missing, empty, truncated, or not of the expected format.
struct FileError : InvalidInput {
  using InvalidInput::InvalidInput;
};

/// A result that could not be written: disk full, folder read-only. What was there before is kept.
struct OutputError : Error {
  using Error::Error;
};

/// A numerical method that found no answer on valid input.
struct SolverError : Error {
  using Error::Error;
};

/// Something this build of the library was made without; the message names the build option.
struct Unavailable : Error {
  using Error::Error;
};

}  // namespace palpate
