// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "c_calls.h"

#include <array>
#include <new>
#include <string>

#include "palpate/core/error.h"

namespace {

// Words of the latest failure of each thread; longer ones are cut.
thread_local std::array<char, 1024> error_text{};

}  // namespace

namespace palpate::c {

palpate_status fail(palpate_status status, const char* words) noexcept {
  const std::size_t size = std::min(std::strlen(words), error_text.size() - 1);
  std::memcpy(error_text.data(), words, size);
  error_text[size] = '\0';
  return status;
}

palpate_status fail_as_thrown() noexcept {
  try {
    throw;
  } catch (const FileError& error) {
    return fail(PALPATE_FILE, error.what());
  } catch (const InvalidInput& error) {
    return fail(PALPATE_INVALID, error.what());
  } catch (const std::bad_alloc&) {
    return fail(PALPATE_NO_MEMORY, "there is not enough memory");
  } catch (const std::exception& error) {
    return fail(PALPATE_FAILED, error.what());
  } catch (...) {
    return fail(PALPATE_FAILED, "an unknown failure");
  }
}

void copy_floats(const Eigen::Matrix3Xd& from, float* to, std::uint64_t count, const char* what) {
  if (count < static_cast<std::uint64_t>(from.size())) {
    throw InvalidInput(std::string(what) + ": count is " + std::to_string(count) + "; there are " +
                       std::to_string(from.size()) + " values");
  }
  Eigen::Map<Eigen::Matrix3Xf>(to, 3, from.cols()) = from.cast<float>();
}

}  // namespace palpate::c

int32_t palpate_interface(void) { return PALPATE_INTERFACE; }
const char* palpate_version(void) { return PALPATE_VERSION; }
const char* palpate_error_text(void) { return error_text.data(); }
