// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Messages of the program for a wrong call, and their form.
#include "shared/wrong_call.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

constexpr int kDone = 0;
constexpr int kWrongCall = 2;

/// Expects that the call is wrong, changes nothing, and prints these words in one line.
void expect_words(const std::vector<std::string>& call, const std::string& words) {
  const CommandResult result = run_palpate(call);
  EXPECT_EQ(result.status, kWrongCall) << result.err;
  EXPECT_EQ(result.err.find("palpate: error: "), 0U) << result.err;
  EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
  EXPECT_EQ(result.err.find('\n'), result.err.size() - 1) << result.err;
}

TEST(NearestWord, DiffersByOneTypingErrorInThreeLetters) {
  const std::vector<std::string> words = {"decode", "demo", "mesh", "fit"};
  EXPECT_EQ(nearest_word("decod", words), "decode");
  EXPECT_EQ(nearest_word("edcode", words), "decode");
  EXPECT_EQ(nearest_word("dexcose", words), "decode");
  EXPECT_EQ(nearest_word("fti", words), "fit");
  EXPECT_EQ(nearest_word("train", words), std::nullopt);
  EXPECT_EQ(nearest_word("xyz", {}), std::nullopt);
}

TEST(WrongCall, NamesTheNearestCommand) {
  expect_words({"decod", "x"}, "unknown command 'decod' of palpate; did you mean decode?");
  expect_words({"--threads", "2", "mehs", "a.ply"}, "did you mean mesh?");
  expect_words({"calibrate", "colrs", "x"},
               "unknown command 'colrs' of palpate calibrate; did you mean colors?");
  expect_words({"reconstruct"}, "the commands are demo, plan, run, trade, merge-shards, info, ");
  expect_words({}, "palpate needs a command: demo, ");
}

TEST(WrongCall, NamesTheValuesThatAnOptionNeeds) {
  expect_words({"mesh", "a.png", "-o", "b.ply", "--intrinsics", "580,580,318.5"},
               "--intrinsics: needs 4 values (Depth image: fx,fy,cx,cy of its camera [px]");
}

TEST(WrongCall, NamesTheNearestOption) {
  expect_words({"mesh", "a.ply", "-o", "b.ply", "--tolerence", "3"},
               "unknown option '--tolerence' of palpate mesh; did you mean --tolerance?");
  expect_words({"mesh", "a.ply", "-o", "b.ply", "--tread=3"}, "did you mean --threads?");
  expect_words({"export", "m", "--obk"},
               "unknown option '--obk' of palpate export; did you mean --obj?");
  expect_words({"mesh", "a.ply", "b.ply"}, "");
}

TEST(WrongCall, NamesTheFolderOrFileThatIsMissing) {
  expect_words({"mesh", "missing/", "--format", "obj", "-o", "out"},
               "missing/: there is no such file or folder");
  const ScratchFolder scratch;
  const auto decode = [&](const std::vector<std::string>& colors) {
    std::vector<std::string> call = {
        "decode",    demo("frames/flag_a.png"), "--rig", demo("rig.yaml"),
        "--pattern", demo("pattern.yaml"),      "-o",    scratch / "range"};
    call.insert(call.end(), colors.begin(), colors.end());
    return call;
  };
  expect_words(decode({}), "--colors: is missing; " + demo("pattern.yaml"));
  expect_words(decode({"--colors", "missing.yaml"}), "missing.yaml: no such file");
  EXPECT_FALSE(fs::exists(scratch / "range"));
}

TEST(WrongCall, TellsWhatAFolderIsWhereASurfaceIsWanted) {
  const ScratchFolder scratch;
  fs::create_directory(scratch / "model");
  write_text(scratch / "model/field.json", "{}");
  const std::string surface = demo("sheet/surface.ply");
  expect_words({"compare", surface, scratch / "model"},
               "model: is a model folder; compare measures the distance of surfaces. Give its "
               "surface, " +
                   (scratch / "model/surface.ply"));
  expect_words({"compare", scratch / "model", surface}, "use palpate evaluate");
  expect_words({"compare", demo("truth"), surface}, "give one range map or mesh in it");
  expect_words({"fit", scratch / "a.db", surface, "-o", scratch / "m"},
               "a.db: there is no such file");
  expect_words({"transfer", scratch / "model", demo("sheet"), "-o", scratch / "m"}, "");
}

TEST(Messages, OfErrorsAndWarningsLookDifferent) {
  const ScratchFolder scratch;
  const std::vector<std::string> call = {
      "simulate",  demo("../meshes/hand.ply"), "--rig", demo("rig.yaml"),
      "--pattern", demo("pattern.yaml"),       "-o",    scratch / "out"};
  const CommandResult moved = run_palpate(call);
  EXPECT_EQ(moved.status, kDone) << moved.err;
  EXPECT_EQ(moved.err.find("palpate: warning: "), 0U) << moved.err;
  std::vector<std::string> quiet = call;
  quiet.emplace_back("-q");
  const CommandResult nothing = run_palpate(quiet);
  EXPECT_EQ(nothing.status, kDone);
  EXPECT_EQ(nothing.err + nothing.out, "");
  quiet.emplace_back("--json");
  EXPECT_NE(run_palpate(quiet).out.find("\"frames\": 1"), std::string::npos);
}

TEST(Help, OfACommandListsTheOptionsOfEveryCommand) {
  for (const std::vector<std::string>& call :
       {std::vector<std::string>{"decode", "--help"}, {"calibrate", "rig", "--help"}, {"--help"}}) {
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kDone);
    const std::size_t group = result.out.find("Options of every command:");
    ASSERT_NE(group, std::string::npos) << result.out;
    for (const char* option : {"--json", "--threads", "-v", "-q,--quiet"})
      EXPECT_NE(result.out.find(option, group), std::string::npos) << option << result.out;
  }
}

}  // namespace
}  // namespace palpate::apps
