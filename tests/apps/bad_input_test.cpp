// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Errors of users in calls of the command: a clear message, the right exit status, no file
// overwritten.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "repository.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using ::testing::IsSupersetOf;

class BadInput : public ::testing::Test {
 protected:
  /// Expects that the call is refused with status 2 and a message that contains `place`, and that
  /// `kept` stays unchanged.
  void expect_refused(const std::vector<std::string>& arguments, const std::string& place) {
    const CommandResult result = run_palpate(arguments);
    EXPECT_EQ(result.status, kWrongCall) << result.out << result.err;
    EXPECT_NE(result.err.find(place), std::string::npos)
        << "no '" << place << "' in: " << result.err;
    EXPECT_TRUE(result.out.empty()) << result.out;
    EXPECT_EQ(read_text(kept), "kept") << "an old result was overwritten";
  }

  /// A copy of a bundled file with one text replaced.
  std::string changed(const std::string& name, const std::string& from, const std::string& to) {
    std::string text = read_text(demo_data() / name);
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    return written(fs::path(name).filename().string(), text);
  }

  std::string written(const std::string& name, const std::string& text) {
    write_text(scratch / name, text);
    return scratch / name;
  }

  /// The first half of a bundled file.
  std::string truncated(const std::string& name) {
    const std::string text = read_text(demo_data() / name);
    return written(fs::path(name).filename().string(), text.substr(0, text.size() / 2));
  }

  std::vector<std::string> decode_call(const std::string& frame, const std::string& rig,
                                       const std::string& pattern, const std::string& colors) {
    return {"decode", frame,      "--rig", rig,  "--pattern",
            pattern,  "--colors", colors,  "-o", scratch / "range"};
  }

  void train() { write_text(scratch / "colors.yaml", trained_colors()); }

  void SetUp() override {
    fs::create_directories(scratch.path() / "range");
    write_text(scratch / "range/decode.jsonl", "{}\n");  // the result is of an earlier run
    kept = scratch / "range/000000.tiff";
    write_text(kept, "kept");
  }

  ScratchFolder scratch;
  std::string kept;
};

TEST_F(BadInput, NoCommandOrAnUnknownOneIsAWrongCall) {
  EXPECT_EQ(run_palpate({}).status, kWrongCall);
  EXPECT_EQ(run_palpate({"decoed"}).status, kWrongCall);
  EXPECT_EQ(run_palpate({"decode", "--no-such-option"}).status, kWrongCall);
  EXPECT_EQ(run_palpate({"--help"}).status, 0);
}

struct Help {
  std::vector<std::string> words;  // that call the command
  CommandResult result;
};

// The help of all commands without subcommands of their own.
std::vector<Help> all_commands(const std::vector<std::string>& words = {}) {
  std::vector<std::string> call = words;
  call.emplace_back("--help");
  const CommandResult help = run_palpate(call);
  std::vector<Help> result;
  for (const std::string& command : listed_commands(help.out)) {
    std::vector<std::string> longer = words;
    longer.push_back(command);
    const std::vector<Help> inner = all_commands(longer);
    result.insert(result.end(), inner.begin(), inner.end());
  }
  if (result.empty()) result.push_back({words, help});
  return result;
}

TEST_F(BadInput, EveryCommandShowsAnExampleOfItself) {
  std::vector<std::vector<std::string>> commands;
  for (const Help& help : all_commands()) {
    commands.push_back(help.words);
    EXPECT_EQ(help.result.status, 0);
    std::string words = "palpate";
    for (const std::string& word : help.words) words += " " + word;
    const std::size_t example = help.result.out.find("Example");
    ASSERT_NE(example, std::string::npos) << words;
    EXPECT_NE(help.result.out.find(words, example), std::string::npos) << words;
  }
  EXPECT_THAT(commands, IsSupersetOf(std::vector<std::vector<std::string>>{
                            {"fit"}, {"calibrate", "rig"}, {"probe", "import"}}));
}

TEST_F(BadInput, FramesThatAreMissingEmptyOrTruncated) {
  train();
  const auto call = [&](const std::string& frame) {
    return decode_call(frame, demo("rig.yaml"), demo("pattern.yaml"), scratch / "colors.yaml");
  };
  expect_refused(call(scratch / "nothing.png"), "nothing.png");
  fs::create_directory(scratch.path() / "empty");
  expect_refused(call(scratch / "empty"), "empty");
  expect_refused(call(written("void.png", "")), "void.png");
  expect_refused(call(truncated("frames/duck.png")), "duck.png");
  expect_refused(call(written("text.png", "this is not an image")), "text.png");
}

TEST_F(BadInput, PathsThatCannotBeLookedAt) {
  const std::string too_long = scratch / std::string(300, 'x');
  for (const std::string command : {"info", "decode"}) {
    std::vector<std::string> call = {command, too_long};
    if (command == "decode") call = decode_call(too_long, demo("rig.yaml"), "p.yaml", "c.yaml");
    expect_refused(call, too_long + ": cannot be read: File name too long");
  }
  expect_refused({"mesh", too_long + ".tiff", "--rig", demo("rig.yaml"), "-o", scratch / "x.ply"},
                 too_long + ".tiff: cannot be read: File name too long");
}

TEST_F(BadInput, AUnitThatIsNone) {
  expect_refused({"info", demo("sheet/surface.ply"), "--unit", "furlong"},
                 "unit \"furlong\" is not known; use um, mm, cm, m or in");
}

TEST_F(BadInput, ABrokenFrameAmongOthersDoesNotStopThem) {
  train();
  fs::remove(kept);
  fs::create_directory(scratch.path() / "frames");
  fs::copy(demo("frames/duck.png"), scratch / "frames/1.png");
  write_text(scratch / "frames/0.png", "this is not an image");
  const CommandResult result = run_palpate(decode_call(
      scratch / "frames", demo("rig.yaml"), demo("pattern.yaml"), scratch / "colors.yaml"));
  EXPECT_EQ(result.status, kWorkFailed);
  EXPECT_NE(result.err.find("0.png"), std::string::npos);
  EXPECT_TRUE(fs::exists(scratch / "range/000001.tiff"));
  EXPECT_FALSE(fs::exists(scratch / "range/000000.tiff"));
}

TEST_F(BadInput, ARigForAnotherImageSize) {
  train();
  const std::string rig =
      changed("rig.yaml", "camera_size: [ 640, 480 ]", "camera_size: [ 800, 600 ]");
  expect_refused(
      decode_call(demo("frames/duck.png"), rig, demo("pattern.yaml"), scratch / "colors.yaml"),
      "800");
}

TEST_F(BadInput, ARigWithNumbersThatCannotBe) {
  train();
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"1100.0", ".nan"},
                                                        {"1100.0", "-1100.0"},
                                                        {"1100.0", ".inf"},
                                                        {"camera_matrix", "camera_matrics"}}) {
    expect_refused(decode_call(demo("frames/duck.png"), changed("rig.yaml", from, to),
                               demo("pattern.yaml"), scratch / "colors.yaml"),
                   "rig.yaml");
  }
  expect_refused(decode_call(demo("frames/duck.png"), truncated("rig.yaml"), demo("pattern.yaml"),
                             scratch / "colors.yaml"),
                 "rig.yaml");
}

TEST_F(BadInput, APipeWhereAFileIsReadTwice) {
  const std::string pipe = scratch / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), S_IRUSR | S_IWUSR), 0);
  expect_refused(
      decode_call(demo("frames/duck.png"), pipe, demo("pattern.yaml"), scratch / "colors.yaml"),
      "--rig: " + pipe + " is a pipe; write its content to a file");
}

TEST_F(BadInput, AFrameMayComeThroughAPipe) {
  train();
  std::vector<std::string> call =
      decode_call("/dev/stdin", demo("rig.yaml"), demo("pattern.yaml"), scratch / "colors.yaml");
  const CommandResult result = run_palpate(call, {.answers = read_text(demo("frames/flag_a.png"))});
  EXPECT_EQ(result.status, kDone) << result.err;
  EXPECT_NE(read_text(kept), "kept");
}

TEST_F(BadInput, ARigInMetresIsRefused) {
  train();
  const std::string rig = changed("rig.yaml", "150.0, 165.0, -20.0", "0.150, 0.165, -0.020");
  for (const std::vector<std::string>& call :
       {decode_call(demo("frames/flag_a.png"), rig, demo("pattern.yaml"), scratch / "colors.yaml"),
        std::vector<std::string>{"pattern", "--rig", rig, "-o", scratch / "pattern"}}) {
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kWrongCall) << result.err;
    EXPECT_NE(result.err.find("rig.yaml: t: the projector is 0.224 mm from the camera, which is "
                              "impossible; lengths are in mm (223.9 mm if"),
              std::string::npos)
        << result.err;
  }
}

TEST_F(BadInput, AnAnchorThatIsOnNoSurface) {
  const std::string pattern = written(
      "sine.yaml",
      "%YAML:1.0\n---\naxis: y\nperiod_px: 10.0\nphase: 0.0\nmean: 0.575\namplitude: 0.425\n");
  for (const auto& [anchor, warned] : {std::pair("320,240,690.75", false),  // mm
                                       std::pair("320,240,0.69075", true)}) {
    const CommandResult result =
        run_palpate({"decode", demo("frames/plane.png"), "--rig", demo("rig.yaml"), "--pattern",
                     pattern, "--anchor", anchor, "-o", scratch / "range"});
    EXPECT_EQ(result.status, kDone) << result.err;
    EXPECT_EQ(result.err.find("on surfaces without an anchor, only") != std::string::npos, warned)
        << anchor << result.err;
  }
}

TEST_F(BadInput, ASinusoidAcrossTheBaselineShowsNoSteps) {
  const std::string pattern = written(
      "sine.yaml",
      "%YAML:1.0\n---\naxis: y\nperiod_px: 10.0\nphase: 0.0\nmean: 0.575\namplitude: 0.425\n");
  const auto errors = [&](const std::string& t) {
    const std::string rig = changed("rig.yaml", "150.0, 165.0, -20.0", t);
    const CommandResult result =
        run_palpate({"decode", demo("frames/plane.png"), "--rig", rig, "--pattern", pattern,
                     "--anchor", "320,240,690.75", "-o", scratch / "range"});
    EXPECT_EQ(result.status, kDone) << result.err;
    return result.err;
  };
  EXPECT_EQ(errors("150.0, 165.0, -20.0").find("baseline"), std::string::npos);
  EXPECT_NE(errors("190.0, 60.0, 0.0").find("sine.yaml: axis: only 30 % of the baseline"),
            std::string::npos);
}

TEST_F(BadInput, AColourThatWasNeverSeenInTraining) {
  train();
  const std::string pattern = changed("pattern.yaml", "name: M", "name: Pink");
  expect_refused(
      decode_call(demo("frames/duck.png"), demo("rig.yaml"), pattern, scratch / "colors.yaml"),
      "Pink");
}

TEST_F(BadInput, APatternWithoutStripesNeedsAnAnchor) {
  const std::string pattern = written(
      "sine.yaml",
      "%YAML:1.0\n---\naxis: y\nperiod_px: 10.0\nphase: 0.0\nmean: 0.575\namplitude: 0.425\n");
  expect_refused({"decode", demo("frames/duck.png"), "--rig", demo("rig.yaml"), "--pattern",
                  pattern, "-o", scratch / "range"},
                 "anchor");
}

TEST_F(BadInput, AWindowShorterThanItCanBe) {
  train();
  std::vector<std::string> call = decode_call(demo("frames/duck.png"), demo("rig.yaml"),
                                              demo("pattern.yaml"), scratch / "colors.yaml");
  call.insert(call.end(), {"--window-periods", "1"});
  expect_refused(call, "--window-periods: is 1; it must be in [1.25, 8]");
}

TEST_F(BadInput, ADepthImageWithoutAPositiveScaleOrACamera) {
  const std::string hand = demo("depth_camera/hand.png");
  const std::string camera = "476.007,476.007,313.683,242.755";
  for (const std::string scale : {"-0.125", "0", "nan"}) {
    expect_refused(
        {"mesh", hand, "--scale", scale, "--intrinsics", camera, "-o", scratch / "hand.ply"},
        "scale");
  }
  expect_refused({"mesh", hand, "--scale", "0.125", "-o", scratch / "hand.ply"}, "intrinsics");
  expect_refused({"mesh", hand, "--scale", "0.125", "--intrinsics", "-476,476,313,242", "-o",
                  scratch / "hand.ply"},
                 "camera");
  expect_refused(
      {"mesh", hand, "--scale", "0.125", "--intrinsics", camera, "-o", scratch / "hand.xyz"},
      ".xyz");
  EXPECT_FALSE(fs::exists(scratch / "hand.ply"));
}

TEST_F(BadInput, ADepthImageWithACameraOrAUnitThatCannotBe) {
  const auto mesh = [&](const std::string& scale, const std::string& intrinsics) {
    return std::vector<std::string>{
        "mesh", demo("depth_camera/hand.png"), "--scale", scale, "--intrinsics", intrinsics,
        "-o",   scratch / "hand.ply"};
  };
  const std::string camera = "476.007,476.007,313.683,242.755";
  expect_refused(mesh("0.125", "5.8,5.8,318.5,242"), "a focal length in mm");
  expect_refused(mesh("0.000125", camera), "if the number is in metres");
  expect_refused(mesh("1e12", camera), "depths: half of them are below");
  EXPECT_FALSE(fs::exists(scratch / "hand.ply"));
  const CommandResult told = run_palpate(mesh("0.125", "476.007,476.007,2000,242.755"));
  EXPECT_EQ(told.status, kDone) << told.err;
  EXPECT_NE(told.err.find("degrees from the optical axis"), std::string::npos) << told.err;
}

TEST_F(BadInput, ARigInMetresOrMicrometres) {
  train();
  // t of the bundled rig, which is 223.9 mm long.
  const std::string text = read_text(demo("rig.yaml"));
  const auto begin = text.find('[', text.find("data", text.find("\nt:"))) + 1;
  const std::string numbers = text.substr(begin, text.find(']', begin) - begin);
  for (const auto& [exponent, unit] : {std::pair{"e-3", "metres"}, {"e3", "micrometres"}}) {
    const std::string scaled =
        std::regex_replace(numbers, std::regex("(\\.[0-9]*)"), std::string("$1") + exponent);
    expect_refused(decode_call(demo("frames/duck.png"), changed("rig.yaml", numbers, scaled),
                               demo("pattern.yaml"), scratch / "colors.yaml"),
                   std::string("223.9 mm if the number is in ") + unit);
  }
}

TEST_F(BadInput, WhatIsDoneToAMeshTakesNumbersThatMakeSense) {
  const std::string hand = repository("meshes/hand.ply").string();
  for (const std::string option : {"--tolerance", "--fill-holes"}) {
    for (const std::string number : {"0", "-1", "nan", "much"})
      expect_refused({"mesh", hand, option, number, "-o", scratch / "x.ply"}, option);
  }
  expect_refused({"mesh", hand, "--smooth", "-3", "-o", scratch / "x.ply"}, "--smooth");
  expect_refused({"mesh", hand, "--unit", "parsec", "-o", scratch / "x.ply"}, "parsec");
}

TEST_F(BadInput, AnEightBitImageIsNoDepthImage) {
  expect_refused({"mesh", demo("frames/duck.png"), "--scale", "1", "--intrinsics",
                  "500,500,320,240", "-o", scratch / "x.ply"},
                 "duck.png");
}

TEST_F(BadInput, RangeMapsThatAreDamagedOrWithoutARig) {
  expect_refused(
      {"mesh", truncated("truth/duck.tiff"), "--rig", demo("rig.yaml"), "-o", scratch / "x.ply"},
      "duck.tiff");
  expect_refused({"mesh", demo("truth/duck.tiff"), "-o", scratch / "x.ply"}, "rig.yaml");
  expect_refused(
      {"compare", demo("truth/duck.tiff"), scratch / "nothing.tiff", "--rig", demo("rig.yaml")},
      "nothing.tiff");
}

TEST_F(BadInput, MeasurementsThatCannotBe) {
  const std::string contacts = demo("sheet/contacts.csv");
  const std::string samples = demo("sheet/samples.csv");
  const std::string header = "id,x,y,z,nx,ny,nz\n";
  const auto import_contacts = [&](const std::string& text, const std::string& place) {
    expect_refused(
        {"probe", "import", written("contacts.csv", text), samples, "-o", scratch / "a.db"}, place);
  };
  import_contacts("", "contacts.csv");
  import_contacts("id,x,y\n0,1,2\n", "z");
  import_contacts(header + "0,1,2,nan,0,0,-1\n", "contacts.csv");
  import_contacts(header + "0,1,2,3,0,0,-1\n1,1,2,3,0,0,-1\n", "1");  // two at one place
  import_contacts(header + "0,1,2,3,0,0,-1\n0,4,5,6,0,0,-1\n", "0");  // one id twice
  import_contacts(header + "0,1,2,3,0,0,-1\n", "contact");            // samples without contact
  expect_refused(
      {"probe", "import", contacts, truncated("sheet/samples.csv"), "-o", scratch / "a.db"},
      "samples.csv");
  expect_refused({"probe", "import", contacts, changed("sheet/samples.csv", "0.149662", "inf"),
                  "-o", scratch / "a.db"},
                 "samples.csv");
  EXPECT_FALSE(fs::exists(scratch / "a.db"));
}

TEST_F(BadInput, StoresAndModelsThatAreNone) {
  const std::string surface = demo("sheet/surface.ply");
  expect_refused({"fit", scratch / "nothing.db", surface, "-o", scratch / "model"}, "nothing.db");
  expect_refused({"fit", written("text.db", "not a database"), surface, "-o", scratch / "model"},
                 "text.db");
  ASSERT_EQ(run_palpate({"probe", "import", demo("sheet/contacts.csv"), demo("sheet/samples.csv"),
                         "-o", scratch / "a.db"})
                .status,
            0);
  expect_refused({"fit", scratch / "a.db", truncated("sheet/surface.ply"), "-o", scratch / "model"},
                 "surface.ply");
  expect_refused({"fit", scratch / "a.db", surface, "-o", scratch / "range"},
                 "range");  // a folder that is no model
  expect_refused({"evaluate", scratch.path().string(), "--queries", demo("sheet/queries.csv")},
                 "field.json");
  expect_refused({"play", scratch / "nothing", "--trajectory", demo("trajectory.csv")}, "nothing");
  expect_refused({"play", scratch / "model", "--trajectory", scratch.path().string()},
                 "is a folder");
  EXPECT_FALSE(fs::exists(scratch / "model"));
}

TEST_F(BadInput, AContactOffTheSurface) {
  const std::string contacts = changed("sheet/contacts.csv", "699.093", "399.093");
  ASSERT_EQ(
      run_palpate({"probe", "import", contacts, demo("sheet/samples.csv"), "-o", scratch / "a.db"})
          .status,
      0);
  expect_refused({"fit", scratch / "a.db", demo("sheet/surface.ply"), "-o", scratch / "model"},
                 "contact 0");
}

TEST_F(BadInput, NothingIsWrittenOverWhatIsRead) {
  const std::string contacts = written("contacts.csv", read_text(demo("sheet/contacts.csv")));
  const std::string samples = demo("sheet/samples.csv");
  expect_refused({"probe", "import", contacts, samples, "-o", contacts}, "contacts.csv");
  EXPECT_EQ(read_text(contacts), read_text(demo("sheet/contacts.csv")));

  train();
  fs::create_directory(scratch.path() / "cap");
  fs::copy(demo("frames/duck.png"), scratch / "cap/000000.png");
  expect_refused(
      {"decode", scratch / "cap", "--rig", demo("rig.yaml"), "--pattern", demo("pattern.yaml"),
       "--colors", scratch / "colors.yaml", "-o", scratch / "cap", "--pictures"},
      "cap");
  EXPECT_EQ(read_text(scratch / "cap/000000.png"), read_text(demo("frames/duck.png")));

  fs::create_directory(scratch.path() / "work");
  ASSERT_EQ(run_palpate({"probe", "import", contacts, samples, "-o", scratch / "work/a.db"}).status,
            0);
  write_text(scratch / "work/field.json", "an older model");
  expect_refused({"fit", scratch / "work/a.db", demo("sheet/surface.ply"), "-o", scratch / "work"},
                 "a.db");
  EXPECT_TRUE(fs::exists(scratch / "work/a.db"));
}

TEST_F(BadInput, AFrameThatDoesNotFitTheRigIsNamed) {
  train();
  expect_refused(decode_call(demo("truth/duck_id.png"), demo("rig.yaml"), demo("pattern.yaml"),
                             scratch / "colors.yaml"),
                 "duck_id.png");
}

TEST_F(BadInput, AFullDiskIsAFailureThatLeavesTheOldResult) {
  const std::string store = scratch / "a.db";
  const std::vector<std::string> import = {
      "probe", "import", demo("sheet/contacts.csv"), demo("sheet/samples.csv"), "-o", store};
  ASSERT_EQ(run_palpate(import).status, kDone);
  const std::string before = read_text(store);
  const CommandResult result = run_palpate(import, {.max_file_size = 100000});
  EXPECT_EQ(result.status, kWorkFailed) << result.err;
  EXPECT_NE(result.err.find("a.db"), std::string::npos) << result.err;
  EXPECT_EQ(read_text(store), before);
  const CommandResult mesh = run_palpate(
      {"mesh", demo("truth/plane.tiff"), "--rig", demo("rig.yaml"), "-o", scratch / "x.ply"},
      {.max_file_size = 100000});
  EXPECT_EQ(mesh.status, kWorkFailed) << mesh.err;
  for (const fs::directory_entry& entry : fs::directory_iterator(scratch.path())) {
    EXPECT_EQ(entry.path().string().find(".palpate-"), std::string::npos)
        << entry.path() << " was left behind";
  }
}

TEST_F(BadInput, AnOutputThatCannotBeMadeIsAFailure) {
  const CommandResult result = run_palpate(
      {"mesh", demo("truth/plane.tiff"), "--rig", demo("rig.yaml"), "-o", kept + "/x.ply"});
  EXPECT_EQ(result.status, kWorkFailed) << result.err;
  EXPECT_NE(result.err.find("000000.tiff is a file"), std::string::npos) << result.err;
  EXPECT_EQ(read_text(kept), "kept");
}

TEST_F(BadInput, AnOutputThatCannotBeMadeIsFoundBeforeTheInputIsRead) {
  const std::string broken = written("broken.csv", "this is no table");
  const CommandResult result =
      run_palpate({"probe", "import", broken, broken, "-o", kept + "/store.db"});
  EXPECT_EQ(result.status, kWorkFailed) << result.err;
  EXPECT_NE(result.err.find("store.db: cannot be written"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace palpate::apps
