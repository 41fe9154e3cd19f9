// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/fingerprint.h"

#include <cstdint>

#include "records/record_hash.h"

namespace palpate::probing {
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
  return RecordHash::to_digits(sum);
}

}  // namespace palpate::probing
