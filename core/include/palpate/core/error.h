// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

namespace palpate {

/// Root of all exceptions of Palpate. The message names the file or argument and the place in it,
/// what was found, and what would be right.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// An argument or a value that the caller can correct.
struct InvalidInput : Error {
  using Error::Error;
};

/// A file that cannot be read: missing, empty, truncated, or not in the expected format.
struct FileError : InvalidInput {
  using InvalidInput::InvalidInput;
};

/// A result that cannot be written: disk full, folder read-only. The previous content is kept.
struct OutputError : Error {
  using Error::Error;
};

/// A numerical method that found no solution for valid input.
struct SolverError : Error {
  using Error::Error;
};

/// A device that does not answer, or answers what cannot be.
struct DeviceError : Error {
  using Error::Error;
};

/// A feature that this build of the library does not have; the message names the build option.
struct Unavailable : Error {
  using Error::Error;
};

}  // namespace palpate
