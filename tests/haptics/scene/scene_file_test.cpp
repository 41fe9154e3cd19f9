// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/scene_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "palpate/haptics/model_io.h"
#include "sheet_model.h"

namespace palpate::haptics {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

// A scene of one model twice, once at a pose and once on a path, and a tool.
class SceneFileTest : public ::testing::Test {
 protected:
  SceneFileTest() {
    write_model(scratch / "model", sheet_model());
    std::ofstream(scratch / "tool.csv") << "t,x,y,z\n0,3,4,695\n0.1,3,4,705\n";
    std::ofstream(scratch / "path.csv") << "t,x,y,z,qw,qx,qy,qz\n0,1000,0,0,1,0,0,0\n";
    scene = json::parse(R"({
      "objects": [{"name": "fixed", "model": "model", "pose": [0, -1, 0, 10,  1, 0, 0, 20,  0, 0, 1, 30]},
                  {"name": "moving", "model": "model", "path": "path.csv"},
                  {"name": "here", "model": "model"}],
      "tools": [{"name": "left", "trajectory": "tool.csv"}],
      "near_tools": "refuse", "closest_tools": 12, "fade_ticks": 7, "rate": 500})");
  }
  std::string file() {
    std::ofstream(scratch / "scene.json") << scene.dump();
    return scratch / "scene.json";
  }
  std::string refused() {
    return refusal([&] { return read_scene(file()); });
  }

  ScratchFolder scratch;
  json scene;
};

TEST_F(SceneFileTest, SaysWhatIsWhere) {
  const SceneFile read = read_scene(file());
  EXPECT_THAT(read.objects, ::testing::ElementsAre("fixed", "moving", "here"));
  EXPECT_THAT(read.tools, ::testing::ElementsAre("left"));
  EXPECT_EQ(read.options.near_tools, NearTools::refuse);
  EXPECT_EQ(read.options.closest_tools, 12);
  EXPECT_EQ(read.options.fade_ticks, 7);
  EXPECT_EQ(tick_count(read.motion), 51U);
  const SceneInput input = input_at(read.motion, 0);
  EXPECT_EQ(input.poses[0] * Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(10, 21, 30));
  EXPECT_EQ(input.poses[1].translation(), Eigen::Vector3d(1000, 0, 0));
  EXPECT_EQ(input.poses[2].matrix(), Eigen::Matrix4d::Identity());

  const Scene made = make_scene(read);
  ASSERT_EQ(made.objects().size(), 3U);
  EXPECT_EQ(made.objects()[0].playback, made.objects()[2].playback);
  EXPECT_EQ(play(made, read.motion).tools[0].back().object, 2);
}

TEST_F(SceneFileTest, PlaysEachObjectAsItSays) {
  scene["objects"][2]["playback"] = {{"tolerance", 1e-3}, {"motion", "brent"}, {"hold_ticks", 3}};
  const SceneFile read = read_scene(file());
  EXPECT_EQ(read.playback[0], PlaybackOptions{});
  EXPECT_EQ(read.playback[2],
            (PlaybackOptions{.motion = ContactMotion::brent, .tolerance = 1e-3, .hold_ticks = 3}));
  // The objects 0 and 2 have one model.
  const Scene made = make_scene(read);
  EXPECT_NE(made.objects()[0].playback, made.objects()[2].playback);

  const auto refused_with = [&](const json& playback) {
    scene["objects"][2]["playback"] = playback;
    return refused();
  };
  EXPECT_THAT(refused_with({{"tolerance", 0}}),
              HasSubstr("at /objects/2/playback/tolerance: found 0, expected a number > 0"));
  EXPECT_THAT(refused_with({{"hold_ticks", 1.5}}), HasSubstr("expected a whole number"));
  EXPECT_THAT(refused_with({{"motion", "newton"}}), HasSubstr("\"friction_boundary\""));
  EXPECT_THAT(refused_with({{"speed", 1}}),
              HasSubstr("'speed' is unknown; there are unknown_friction"));
}

TEST_F(SceneFileTest, DefaultsAreThoseOfTheLibrary) {
  for (const char* member : {"near_tools", "closest_tools", "fade_ticks", "rate"})
    scene.erase(member);
  const SceneFile read = read_scene(file());
  EXPECT_EQ(read.options.near_tools, SceneOptions{}.near_tools);
  EXPECT_EQ(read.options.closest_tools, SceneOptions{}.closest_tools);
  EXPECT_EQ(read.options.fade_ticks, SceneOptions{}.fade_ticks);
  EXPECT_EQ(read.motion.rate, SceneMotion{}.rate);
}

TEST_F(SceneFileTest, RefusesWhatIsWrongAndSaysWhere) {
  const json good = scene;
  const auto with = [&](const char* pointer, const json& value) {
    scene = good;
    scene[json::json_pointer(pointer)] = value;
    const std::string words = refused();
    EXPECT_THAT(words, HasSubstr("scene.json"));
    return words;
  };
  EXPECT_THAT(with("/obstacles", 1),
              HasSubstr("at /obstacles: 'obstacles' is unknown; there are objects"));
  EXPECT_THAT(with("/objects/1/posse", 1), HasSubstr("at /objects/1/posse: 'posse' is unknown"));
  EXPECT_THAT(with("/objects/1/pose", json::array({1})), HasSubstr("either 'pose' or 'path'"));
  EXPECT_THAT(with("/objects/0/pose", json::array({1, 2})), HasSubstr("12 numbers"));
  EXPECT_THAT(with("/objects/0/pose/1", -1.001), HasSubstr("a rigid motion"));
  EXPECT_THAT(with("/objects/0/pose/1", 1), HasSubstr("right-handed"));
  EXPECT_THAT(with("/objects/0/name", "a/b"), HasSubstr("letters, digits"));
  EXPECT_THAT(with("/objects/0/name", "here"), HasSubstr("no other"));
  EXPECT_THAT(with("/objects", json::array()), HasSubstr("at least one object"));
  EXPECT_THAT(with("/tools", json::array()), HasSubstr("at least one tool"));
  EXPECT_THAT(with("/near_tools", "stop"), HasSubstr("\"independent\", \"fade\" or \"refuse\""));
  EXPECT_THAT(with("/closest_tools", -1), HasSubstr(">= 0"));
  EXPECT_THAT(with("/rate", 0), HasSubstr("> 0"));
  EXPECT_THAT(with("/rate", 1e11), HasSubstr("1e7 ticks"));
  scene = json::array();
  EXPECT_THAT(refused(), HasSubstr("an object"));
  std::ofstream(scratch / "broken.json") << "{";
  EXPECT_THAT(refusal([&] { return read_scene(scratch / "broken.json"); }), HasSubstr("not JSON"));
  EXPECT_THAT(refusal([&] { return read_scene(scratch / "nothing.json"); }),
              HasSubstr("no such file"));

  // Of the files that it names, the message is about these.
  scene = good;
  scene["tools"][0]["trajectory"] = "none.csv";
  EXPECT_THAT(refused(), HasSubstr("none.csv"));
  scene = good;
  scene["objects"][0]["model"] = "none";
  const SceneFile read = read_scene(file());
  EXPECT_THAT(refusal([&] { return make_scene(read); }), HasSubstr("none"));
}

}  // namespace
}  // namespace palpate::haptics
