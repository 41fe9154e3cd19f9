// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace palpate::sensing {

/// Keeps objects that are costly to construct for reuse; holds as many as were ever in use at the
/// same time. Thread-safe; must outlive its loans.
template <typename T>
class Pool {
  struct GiveBack {
    Pool* pool;
    void operator()(T* object) const { pool->take_back(std::unique_ptr<T>(object)); }
  };

 public:
  /// Returns the object to the pool on destruction, in its current state.
  using Loan = std::unique_ptr<T, GiveBack>;

  [[nodiscard]] Loan borrow() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) {
      free_.reserve(++made_);  // so that giving back never allocates
      return Loan(std::make_unique<T>().release(), GiveBack{this});
    }
    std::unique_ptr<T> object = std::move(free_.back());
    free_.pop_back();
    return Loan(object.release(), GiveBack{this});
  }

 private:
  void take_back(std::unique_ptr<T> object) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(object));
  }

  std::mutex mutex_;
  std::vector<std::unique_ptr<T>> free_;
  std::size_t made_ = 0;
};

}  // namespace palpate::sensing
