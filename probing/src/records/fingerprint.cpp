// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/fingerprint.h"

#include <bit>
#include <cstdint>
#include <cstdio>

namespace palpate::probing {
namespace {

// A hash of one record. Each number is mixed in whole by the finalizer of splitmix64 (Steele, Lea
// and Flood 2014), in which every bit changes about half of the others.
class RecordHash {
 public:
  explicit RecordHash(std::uint64_t kind) { add(kind); }

  void add(std::uint64_t value) {
    state_ += value + 0x9e3779b97f4a7c15ULL;
    state_ = (state_ ^ (state_ >> 30)) * 0xbf58476d1ce4e5b9ULL;
    state_ = (state_ ^ (state_ >> 27)) * 0x94d049bb133111ebULL;
    state_ ^= state_ >> 31;
  }
  void add(long long value) { add(static_cast<std::uint64_t>(value)); }
  void add(const Eigen::Vector3d& vector) {
    // 0 and -0 are one number.
    for (const double number : vector) add(std::bit_cast<std::uint64_t>(number + 0.0));
  }
  [[nodiscard]] std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0;
};

}  // namespace

std::string fingerprint(const Acquisition& acquisition) {
  std::uint64_t sum = 0;  // modulo 2^64: whatever the order
  for (const Contact& contact : acquisition.contacts) {
    RecordHash hash(std::uint64_t{1});
    hash.add(contact.id);
    hash.add(contact.position);
    hash.add(contact.normal);
    sum += hash.value();
  }
  for (const Sample& sample : acquisition.samples) {
    RecordHash hash(std::uint64_t{2});
    hash.add(sample.contact);
    hash.add(sample.group);
    hash.add(sample.force);
    hash.add(sample.a);
    hash.add(sample.b);
    hash.add(std::uint64_t{sample.on_friction_boundary} | std::uint64_t{sample.slipped} << 1);
    sum += hash.value();
  }
  std::string digits(17, '\0');
  std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(sum));
  digits.pop_back();
  return digits;
}

}  // namespace palpate::probing
