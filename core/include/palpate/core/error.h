// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace palpate {

/// Base class of all exceptions of Palpate. The message names the file or argument and the position
/// in it, what was found, and what is expected.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A piece of a message: a text, or the name of a field of options, "DecodeOptions::min_signal".
struct MessagePart {
  std::string text;
  bool is_field = false;
};

/// An argument or a value that the caller can correct.
struct InvalidInput : Error {
  using Error::Error;

  /// A message that names fields of options. Its text has their C++ names.
  explicit InvalidInput(std::vector<MessagePart> parts);

  /// The message with the names that a front end has for the fields, such as "--min-signal".
  [[nodiscard]] std::string with_names(
      const std::function<std::string(const std::string& field)>& name_of) const;

 private:
  std::shared_ptr<const std::vector<MessagePart>> parts_;  // copies of an exception must not throw
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

/// A device that does not answer, or whose answer is not valid.
struct DeviceError : Error {
  using Error::Error;
};

/// A feature that this build of the library does not have; the message names the build option.
struct Unavailable : Error {
  using Error::Error;
};

}  // namespace palpate
