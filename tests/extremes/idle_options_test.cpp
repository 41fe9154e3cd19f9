// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// A field that another one makes meaningless is refused by the library, by the names of both.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <ostream>
#include <string>

#include "operations.h"
#include "palpate/core/error.h"
#include "palpate/core/field_text.h"
#include "palpate/haptics/virtual_coupling.h"
#include "palpate/probing/acquisition_mapping.h"

namespace palpate::extremes {
namespace {

/// Fields of which the first does nothing because of the second.
struct Idle {
  const char* operation;  ///< that has these options
  const char* type;
  const char* words;  ///< NAME=VALUE, first that of the cause, then that of the idle field
};

void PrintTo(const Idle& idle, std::ostream* stream) { *stream << idle.type << ' ' << idle.words; }

constexpr Idle kIdle[] = {
    {"smooth", "SmoothingOptions", "iterations=0 pass_band=0.2"},
    {"smooth", "SmoothingOptions", "iterations=0 keep_border=true"},
    {"decimate: tolerance", "DecimationOptions", "tolerance=1 max_triangles=10"},
    {"design_pattern", "PatternOptions", "period=20 min_camera_period=9"},
    {"design_pattern", "PatternOptions", "period=20 min_projector_period=9"},
    {"simulate", "VirtualSensor", "exposure_distance=900 exposure_percentile=0.5"},
    {"simulate", "VirtualSensor", "full_well=0 read_noise=3"},
    {"Campaign", "CampaignOptions", "strategy=pooled resolution=0.2"},
    {"Campaign", "CampaignOptions", "strategy=bisection friction_accuracy=0.02"},
    {"Campaign", "CampaignOptions", "strategy=bisection cautious=0.2"},
    {"Campaign", "CampaignOptions", "strategy=pooled until=0.1"},
    {"Campaign", "CampaignOptions", "strategy=bisection max_hours=1"},
    {"Campaign", "CampaignOptions", "strategy=pooled max_samples=50"},
    {"build_model", "BuildOptions", "passive=local compare_always=true"},
    {"build_model", "BuildOptions", "passive=certified try_certified=false"},
    {"Playback", "PlaybackOptions", "motion=brent energy_credit=1"},
    {"Playback", "PlaybackOptions", "motion=friction_boundary energy_credit=1"},
    {"couple", "CouplingOptions", "coupling=false coupling_stiffness=1"},
    {"couple", "CouplingOptions", "coupling=false coupling_steps=3"},
    {"couple", "CouplingOptions", "coupling_stiffness=1 coupling_safety=0.4"},
    {"couple", "CouplingOptions", "coupling_stiffness=1 coupling_damping=0.01"},
    {"import", "AcquisitionMapping", "contacts=table same_place=2"},
};

/// Runs the operation with its options changed, or only the check of options that have no
/// operation.
void run(const std::string& operation, const Change& change) {
  if (operation == "couple") {
    haptics::CouplingOptions options;
    change(fields_of(options));
    haptics::check_coupling(options);
  } else if (operation == "import") {
    probing::AcquisitionMapping mapping;
    change(fields_of(mapping));
    probing::check_mapping(mapping);
  } else {
    const auto found = std::ranges::find(all_operations(), operation, &Operation::name);
    ASSERT_NE(found, all_operations().end()) << operation;
    (void)found->run(small_input(), change);
  }
}

class IdleFields : public ::testing::TestWithParam<Idle> {};

TEST_P(IdleFields, AreRefusedWithTheNameOfTheFieldThatMakesThemSo) {
  const Idle& idle = GetParam();
  try {
    run(idle.operation, [&](const FieldList& fields) { assign_words(fields, idle.words); });
    FAIL() << "is taken";
  } catch (const InvalidInput& error) {
    const std::string words = idle.words, type = std::string(idle.type) + "::";
    const std::size_t second = words.find(' ') + 1;
    const auto name_at = [&](std::size_t begin) {
      return type + words.substr(begin, words.find('=', begin) - begin);
    };
    EXPECT_THAT(error.what(), ::testing::HasSubstr(name_at(0)));
    EXPECT_THAT(error.what(), ::testing::HasSubstr(name_at(second)));
  }
}

INSTANTIATE_TEST_SUITE_P(All, IdleFields, ::testing::ValuesIn(kIdle));

}  // namespace
}  // namespace palpate::extremes
