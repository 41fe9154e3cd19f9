// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate export --html`; tests/web tests the page itself.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "../haptics/sheet_model.h"
#include "palpate/haptics/model_io.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

class ExportPage : public ::testing::Test {
 protected:
  CommandResult export_model(const haptics::Model& model, std::vector<std::string> more = {}) {
    haptics::write_model(scratch / "a <model>", model);
    more.insert(more.begin(),
                {"export", scratch / "a <model>", "--html", "-o", scratch / "p.html"});
    return run_palpate(more);
  }
  [[nodiscard]] std::string page() const { return read_text(scratch / "p.html"); }
  ScratchFolder scratch;
};

TEST_F(ExportPage, IsOneFileThatLoadsNothing) {
  ASSERT_EQ(export_model(haptics::sheet_model()).status, kDone);
  const std::string text = page();
  EXPECT_NE(text.find("<title>a &lt;model&gt;</title>"), std::string::npos);
  EXPECT_EQ(text.find("{{"), std::string::npos) << "marks of the template";
  EXPECT_EQ(text.find("src="), std::string::npos);
  EXPECT_EQ(text.find("http:"), std::string::npos);
  EXPECT_EQ(text.find("https:"), std::string::npos);
  EXPECT_NE(text.find("default-src 'none'"), std::string::npos);
}

TEST_F(ExportPage, TakesATitleAsItIs) {
  ASSERT_EQ(export_model(haptics::sheet_model(), {"--title", "{{model}} & \"x\""}).status, kDone);
  EXPECT_NE(page().find("<title>{{model}} &amp; &quot;x&quot;</title>"), std::string::npos);
}

TEST_F(ExportPage, PlaysUnknownFrictionAsTheLoopDoes) {
  haptics::Model model = haptics::sheet_model();
  for (haptics::ContactModel& contact : model.contacts) {
    contact.friction = 0;
    contact.friction_source = haptics::FrictionSource::none;
  }
  const CommandResult without = export_model(model);
  EXPECT_EQ(without.status, kDone);
  EXPECT_NE(without.err.find("friction of 4 contacts is unknown"), std::string::npos);
  const std::string slippery = page();
  EXPECT_EQ(export_model(model, {"--unknown-friction", "0.4"}).status, kDone);
  EXPECT_NE(page(), slippery);
  const CommandResult known = export_model(haptics::sheet_model(), {"--unknown-friction", "0.4"});
  EXPECT_EQ(known.status, kWrongCall);
  EXPECT_NE(known.err.find("--unknown-friction: is for contacts whose friction is unknown"),
            std::string::npos);
}

TEST_F(ExportPage, IsNotWrittenForAModelThatCannotBePlayed) {
  haptics::Model model = haptics::sheet_model();
  model.contacts[1].position.z() -= 30;
  const CommandResult result = export_model(model);
  EXPECT_EQ(result.status, kWrongCall);
  EXPECT_NE(result.err.find("contact 11"), std::string::npos) << result.err;
  EXPECT_FALSE(fs::exists(scratch / "p.html"));
}

TEST_F(ExportPage, AloneHasATitleAndAFriction) {
  haptics::write_model(scratch / "m", haptics::sheet_model());
  for (const std::string option : {"--title", "--unknown-friction"}) {
    const CommandResult result =
        run_palpate({"export", scratch / "m", "--ply", "-o", scratch / "m.ply", option, "0.5"});
    EXPECT_EQ(result.status, kWrongCall);
    EXPECT_NE(result.err.find(option + ": is that of a page"), std::string::npos) << result.err;
  }
}

}  // namespace
}  // namespace palpate::apps
