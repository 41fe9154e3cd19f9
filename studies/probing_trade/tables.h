// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "comparison.h"

namespace palpate::bench {

struct ComparedObject {
  std::string name;
  Runs runs;
};

/// Prints the rows of one object: means over seeds, and the deviation of errors from seed to seed.
void print_header();
void print_rows(const ComparedObject& object);

/// Prints what the targets are about: errors relative to those of other strategies, their geometric
/// mean over all objects, friction, and the stated over the actual error.
void print_targets(const std::vector<ComparedObject>& objects);

}  // namespace palpate::bench
