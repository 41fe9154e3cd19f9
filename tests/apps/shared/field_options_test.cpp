// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/field_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/geometry/registration.h"
#include "palpate/geometry/remeshing.h"
#include "palpate/haptics/playback.h"
#include "palpate/sensing/decode.h"
#include "shared/command_line.h"

namespace palpate::apps {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class FieldOptions : public ::testing::Test {
 protected:
  FieldOptions() {
    show_shared_options(app);
    app.set_help_all_flag("--help-all", "All");
    command = app.add_subcommand("decode", "Decode");
    add_fields(*command, fields_of(options));
  }
  void parse(const std::string& words) { app.parse("decode " + words); }
  std::string refusal(const std::string& words) {
    try {
      parse(words);
    } catch (const CLI::ParseError& error) {
      return error.what();
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return {};
  }

  sensing::DecodeOptions options;
  CLI::App app{"Test", "palpate"};
  CLI::App* command = nullptr;
};

TEST_F(FieldOptions, SetTheFieldsOfTheirNames) {
  parse("--window-periods 3.5 --half-resolution --segmentation snakes --color-window-px 7");
  EXPECT_EQ(options.window_periods, 3.5);
  EXPECT_TRUE(options.half_resolution);
  EXPECT_EQ(options.segmentation, sensing::Segmentation::snakes);
  EXPECT_EQ(options.color_window_px, 7);
  EXPECT_EQ(options.min_signal, sensing::DecodeOptions{}.min_signal);
}

TEST_F(FieldOptions, OfATableAreGivenRowByRow) {
  parse("--anchor 1,2,700 --anchor 3,4,800.5");
  ASSERT_EQ(options.anchors.size(), 2U);
  EXPECT_EQ(options.anchors[0].z, 700);
  EXPECT_EQ(options.anchors[1].u_px, 3);
  EXPECT_EQ(options.anchors[1].z, 800.5);
}

TEST_F(FieldOptions, AreRefusedOutsideTheirRange) {
  EXPECT_THAT(refusal("--window-periods 9"),
              HasSubstr("--window-periods: is 9; it must be in [1.25, 8]"));
  EXPECT_THAT(refusal("--window-periods nan"), HasSubstr("it must be in [1.25, 8]"));
  EXPECT_THAT(refusal("--segmentation fire"), HasSubstr("it must be flood or snakes"));
  EXPECT_THAT(refusal("--color-window-px 2.5"),
              HasSubstr("--color-window-px: is 2.5; it must be a whole number >= 1"));
  EXPECT_THAT(refusal("--anchor 1,2,700,4"), Not(HasSubstr("unknown")));
  EXPECT_NE(refusal("--anchor 1,2,700,4"), "");
}

TEST_F(FieldOptions, OfExpertsAreInTheLongHelpAlone) {
  const std::string usual = command->help("", CLI::AppFormatMode::Normal);
  const std::string all = command->help("", CLI::AppFormatMode::All);
  EXPECT_THAT(usual, HasSubstr("--window-periods"));
  EXPECT_THAT(usual, HasSubstr("[periods of the sinusoid]"));
  EXPECT_THAT(usual, Not(HasSubstr("--min-signal")));
  EXPECT_THAT(all, HasSubstr("--min-signal"));
  EXPECT_THAT(all, HasSubstr("--max-phase-sigma FLOAT:> 0 and finite=0.25")) << "is no angle";
  EXPECT_THAT(all, HasSubstr(kExpertOptions));
}

TEST_F(FieldOptions, NameTheFieldsInErrorsOfTheLibrary) {
  parse("");
  sensing::DecodeOptions wrong{.min_signal = 2};
  try {
    require_in_range(fields_of(wrong));
    FAIL() << "nothing was thrown";
  } catch (const InvalidInput& error) {
    EXPECT_EQ(with_option_names(error, app),
              "--min-signal is 2 fraction of full scale; it must be in (0, 1)");
  }
  try {
    require("rig.yaml: camera: fx", -1, above(0), "px");
    FAIL() << "nothing was thrown";
  } catch (const InvalidInput& error) {
    EXPECT_EQ(with_option_names(error, app), "rig.yaml: camera: fx is -1 px; it must be > 0");
  }
  haptics::PlaybackOptions other{.hold_ticks = -1};
  try {
    require_in_range(fields_of(other));
    FAIL() << "nothing was thrown";
  } catch (const InvalidInput& error) {
    EXPECT_EQ(with_option_names(error, app), "hold_ticks is -1 ticks; it must be >= 0")
        << "the command has no such option";
  }
}

TEST_F(FieldOptions, HaveTheNamesOfTheirListsInErrorsOfTheLibrary) {
  geometry::RemeshingOptions remeshing;
  add_fields(*command, fields_of(remeshing));
  parse("");
  const auto told = [&](const std::string& field) {
    return with_option_names(InvalidInput(std::vector<MessagePart>{{field, true}}), app);
  };
  EXPECT_EQ(told("RemeshingOptions::edge_length"), "--remesh");
  EXPECT_EQ(told("DecodeOptions::anchors[1].z"), "--anchor");
  EXPECT_EQ(told("HoleFillingOptions::max_diameter"), "max_diameter")
      << "the command has no --fill-holes";
  EXPECT_EQ(field_option("HoleFillingOptions::max_diameter"), "--fill-holes");
  EXPECT_EQ(field_option("ReduceOptions::slip"), "--no-slip") << "a flag that is true by default";
  EXPECT_EQ(field_option("BuildOptions::rate"), "--rate");
}

TEST_F(FieldOptions, TakeAnglesInDegrees) {
  geometry::RegistrationOptions turned;
  CLI::App other{"Test", "palpate"};
  add_fields(other, fields_of(turned));
  EXPECT_THAT(other.help(), HasSubstr("--search-rotation FLOAT:in [0, 180]=45"));
  EXPECT_THAT(other.help(), HasSubstr("[degrees]"));
  other.parse("--search-rotation 180");
  EXPECT_EQ(turned.search_rotation, std::numbers::pi);
  EXPECT_EQ(option_values(fields_of(turned))["--search-rotation"], "180");
  turned.search_rotation = std::numbers::pi / 3;
  geometry::RegistrationOptions usual;
  const std::string words = changed_options(fields_of(turned), fields_of(usual));
  other.parse(words);
  EXPECT_NEAR(turned.search_rotation, std::numbers::pi / 3, 1e-15);
  EXPECT_THAT(words, HasSubstr(" --search-rotation 6")) << "60, or as near as numbers are";
}

TEST_F(FieldOptions, AreThoseThatACommandWants) {
  CLI::App other{"Test", "palpate"};
  constexpr std::array<std::string_view, 2> kWanted{"half_resolution", "min_signal"};
  EXPECT_EQ(add_fields(other, fields_of(options), kWanted).size(), 2U);
  EXPECT_NE(other.get_option_no_throw("--min-signal"), nullptr);
  EXPECT_EQ(other.get_option_no_throw("--window-periods"), nullptr);
}

TEST_F(FieldOptions, OfAFlagAreRefusedWithoutIt) {
  geometry::RegistrationOptions turned;
  CLI::Option* align = command->add_flag("--align");
  add_fields_of(*align, *command, fields_of(turned));
  EXPECT_THAT(command->help(), HasSubstr("With --align"));
  EXPECT_THAT(refusal("--min-overlap 0.2"), HasSubstr("--align"));
  EXPECT_EQ(refusal("--align --min-overlap 0.2"), "");
  EXPECT_EQ(turned.min_overlap, 0.2);
}

TEST_F(FieldOptions, AndFunctionsAreCalledWhatTheCommandCallsThem) {
  const InvalidInput error(std::vector<MessagePart>{{"fit()", true},
                                                    {": too few presses; give "},
                                                    {"FitOptions::count", true},
                                                    {" or "},
                                                    {"FitOptions::max_bases", true}});
  EXPECT_EQ(with_names(error, {{"fit()", "a.db"}, {"FitOptions::count", "--presses"}}),
            "a.db: too few presses; give --presses or --max-bases");
}

TEST_F(FieldOptions, ThatDifferMakeACallThatSetsThem) {
  sensing::DecodeOptions changed{
      .window_periods = 2.5, .half_resolution = true, .anchors = {{1, 2, 700}, {3, 4, 800.5}}};
  sensing::DecodeOptions usual;
  const std::string words = changed_options(fields_of(changed), fields_of(usual));
  EXPECT_EQ(words, " --window-periods 2.5 --half-resolution --anchor 1,2,700 --anchor 3,4,800.5");
  parse(words);
  EXPECT_EQ(option_values(fields_of(options)), option_values(fields_of(changed)));
  EXPECT_EQ(changed_options(fields_of(usual), fields_of(usual)), "");
}

}  // namespace
}  // namespace palpate::apps
