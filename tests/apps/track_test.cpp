// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate track`: a surface whose true motion is known is followed through a folder of range maps.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core/mat.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "mesh_corpus.h"
#include "palpate/geometry/error_statistics.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/sensing/frame.h"
#include "range_map_scene.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
namespace scene = geometry::test;
using Eigen::Vector3d;
using nlohmann::json;

constexpr int kWidth = 192;     // pixels of 3 mm
constexpr double kNoise = 0.2;  // [mm] standard deviation of the depths
constexpr int kFrames = 6;

/// Returns the position in a frame of the material point that was at `rest` at first: a dent of
/// 12 mm runs across the surface while one side is rolled up.
Vector3d place(const Vector3d& rest, int frame) {
  const double t = static_cast<double>(frame) / (kFrames - 1);
  const Vector3d dent(-110 + 120 * t, -41.1 + 30 * t, 0);
  constexpr double kDentWidth = 40;
  const double r2 = (rest - dent).head<2>().squaredNorm();
  const Vector3d dented =
      rest + Vector3d(0, 0, 12 * t * std::exp(-r2 / (2 * kDentWidth * kDentWidth)));
  return frame == 0 ? dented : scene::bent(dented, 4000 / t);
}

geometry::TriangleMesh reference_mesh() { return scene::bumpy(12000); }

geometry::TriangleMesh true_mesh(int frame) {
  return scene::deformed(reference_mesh(), [&](const Vector3d& p) { return place(p, frame); });
}

std::string name(int frame, const std::string& ending) {
  return "00000" + std::to_string(frame) + ending;
}

/// The demo's rig with another camera.
std::string rig_text(const geometry::Camera& camera) {
  std::string text = read_text(demo_data() / "rig.yaml");
  const auto replace = [&](const std::string& old, const std::string& now) {
    text.replace(text.find(old), old.size(), now);
  };
  std::ostringstream matrix;
  matrix << camera.fx << ", 0.0, " << camera.cx << ", 0.0, " << camera.fy << ", " << camera.cy
         << ", 0.0, 0.0, 1.0";
  replace("[ 640, 480 ]",
          "[ " + std::to_string(camera.width) + ", " + std::to_string(camera.height) + " ]");
  replace("1100.0, 0.0, 319.5, 0.0, 1100.0, 239.5, 0.0, 0.0, 1.0", matrix.str());
  return text;
}

class Track : public ::testing::Test {
 protected:
  static geometry::RangeMap measured(int frame, double noise = kNoise) {
    geometry::RangeMap map = scene::render(true_mesh(frame), scene::bumpy_camera(kWidth));
    scene::add_noise(map, noise, static_cast<unsigned>(frame) + 1);
    return map;
  }

  /// The range maps with their rig, and the reference, rendered once for all tests.
  struct Files {
    ScratchFolder folder;
    Files() {
      fs::create_directory(folder / "range");
      write_text(folder / "range/rig.yaml", rig_text(scene::bumpy_camera(kWidth)));
      for (int frame = 0; frame < kFrames; ++frame)
        geometry::write_depth_tiff(folder / ("range/" + name(frame, ".tiff")), measured(frame).z);
      geometry::write_mesh(folder / "reference.ply", reference_mesh());
    }
  };

  void SetUp() override {
    static const Files files;
    fs::copy(files.folder.path(), scratch.path(), fs::copy_options::recursive);
  }

  std::string map_file(int frame) const { return scratch / ("range/" + name(frame, ".tiff")); }
  std::string mesh_file(int frame) const { return scratch / ("meshes/" + name(frame, ".ply")); }

  CommandResult track(std::vector<std::string> more = {}, const std::string& output = "meshes",
                      const CommandOptions& options = {}) const {
    std::vector<std::string> call = {"track",
                                     scratch / "range",
                                     "-o",
                                     scratch / output,
                                     "--json",
                                     "--reference",
                                     scratch / "reference.ply",
                                     "--nodes",
                                     "250"};
    call.insert(call.end(), more.begin(), more.end());
    return run_palpate(call, options);
  }

  /// Puts the results of track() for the unchanged files into a folder; the first test that needs
  /// them makes them.
  void put_meshes(const std::string& output) const {
    static const ScratchFolder made;
    if (fs::is_empty(made.path())) {
      ASSERT_EQ(track({}, output).status, kDone);
      fs::copy(scratch / output, made.path(), fs::copy_options::recursive);
    } else {
      fs::copy(made.path(), scratch / output, fs::copy_options::recursive);
    }
  }

  /// Expects that the call is refused and nothing is written. Returns its message.
  std::string expect_refused(const std::vector<std::string>& call, const std::string& words) const {
    const auto before = content(scratch.path());
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kWrongCall) << words << '\n' << result.err;
    EXPECT_NE(result.err.find(words), std::string::npos)
        << "no '" << words << "' in " << result.err;
    EXPECT_EQ(content(scratch.path()), before) << words;
    return result.err;
  }
  std::vector<std::string> call(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {"track", scratch / "range", "-o", scratch / "meshes"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  static std::map<std::string, std::string> content(const fs::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file())
        files[entry.path().lexically_relative(folder).string()] = read_text(entry.path());
    }
    return files;
  }

  /// Distances of the visible vertices of a mesh from their material points [mm].
  geometry::ErrorStatistics errors(int frame) const {
    const Eigen::Matrix3Xd found = geometry::read_mesh(mesh_file(frame)).vertices;
    const geometry::TriangleMesh truth = true_mesh(frame);
    const std::vector<bool> visible = scene::visible(truth.vertices, truth, measured(frame, 0));
    std::vector<double> distances;
    for (Eigen::Index v = 0; v < found.cols(); ++v) {
      if (visible[static_cast<std::size_t>(v)])
        distances.push_back((found.col(v) - truth.vertices.col(v)).norm());
    }
    return geometry::error_statistics(distances);
  }

  ScratchFolder scratch;
};

TEST_F(Track, VerticesFollowTheirMaterialPointsAndTrianglesStay) {
  const CommandResult result = track();
  ASSERT_EQ(result.status, kDone) << result.err;
  const json figures = json::parse(result.out);
  const geometry::TriangleMesh rest = reference_mesh();
  EXPECT_EQ(figures["meshes"], kFrames);
  EXPECT_EQ(figures["vertices"], rest.vertices.cols());
  EXPECT_TRUE(figures["lost"].empty());
  for (int frame = 0; frame < kFrames; ++frame) {
    const geometry::MeshFile file = geometry::read_mesh_file(mesh_file(frame));
    EXPECT_EQ(file.mesh.triangles, rest.triangles) << frame;
    const geometry::ErrorStatistics error = errors(frame);
    // Pixels are 3 mm wide and nodes about 45 mm apart: the error of the nodes is well below a
    // pixel, and far below the motion itself.
    EXPECT_LT(error.rms, 1.0) << frame;
    EXPECT_LT(error.median, 0.5) << frame;
    const json& of_frame = figures["per_frame"][static_cast<std::size_t>(frame)];
    EXPECT_LT(of_frame["rms"], 1.5 * kNoise) << frame;
    EXPECT_LT(of_frame["rms"], of_frame["p95"]) << frame;
    EXPECT_LT(of_frame["p95"], of_frame["max"]) << frame;
    EXPECT_GT(of_frame["measured"], 0.8) << frame;
  }
  const Eigen::Matrix3Xd way = true_mesh(kFrames - 1).vertices - rest.vertices;
  EXPECT_GT(std::sqrt(way.colwise().squaredNorm().mean()), 3 * errors(kFrames - 1).rms);
}

TEST_F(Track, FollowsAFolderThatGrowsToTheSameMeshes) {
  put_meshes("meshes");
  const auto all = content(scratch / "meshes");
  for (int frame = 1; frame < kFrames; ++frame)
    fs::rename(map_file(frame), scratch / name(frame, ".tiff"));
  std::thread camera([&] {
    for (int frame = 1; frame < kFrames; ++frame) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      fs::rename(scratch / name(frame, ".tiff"), map_file(frame));
    }
  });
  const CommandResult result = track({"--follow", "2"}, "followed");
  camera.join();
  ASSERT_EQ(result.status, kDone) << result.err;
  EXPECT_EQ(json::parse(result.out)["meshes"], kFrames);
  auto followed = content(scratch / "followed");
  EXPECT_EQ(followed.size(), all.size());
  for (const auto& [file, bytes] : all) {
    if (file != "track.jsonl") EXPECT_EQ(followed[file], bytes) << file;
  }
  // A later run replaces all of these files.
  const CommandResult again = track({}, "followed");
  EXPECT_EQ(again.status, kDone) << again.err;
  EXPECT_EQ(content(scratch / "followed"), all);
}

TEST_F(Track, ALostFrameIsNamedAndTheNextStartsFromTheLastThatWasFound) {
  const std::string whole = read_text(map_file(1));
  write_text(map_file(1), whole.substr(0, whole.size() / 2));
  geometry::RangeMap map = measured(2);
  geometry::write_depth_tiff(map_file(2),
                             geometry::ImageF::Constant(map.z.rows(), map.z.cols(),
                                                        std::numeric_limits<float>::quiet_NaN()));
  map = measured(3);
  map.z.leftCols(kWidth * 4 / 5) = 400;  // a hand before the surface
  geometry::write_depth_tiff(map_file(3), map.z);
  const CommandResult result = track();
  EXPECT_EQ(result.status, kWorkFailed);
  const json figures = json::parse(result.out);
  EXPECT_EQ(figures["lost"], json({name(1, ".tiff"), name(2, ".tiff"), name(3, ".tiff")}));
  EXPECT_NE(result.err.find("000001.tiff: "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("000002.tiff: no pixel has a depth"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("of the vertices that face the camera lie"), std::string::npos);
  EXPECT_NE(result.err.find("3 of 6 frames were lost (000001.tiff, 000002.tiff, 000003.tiff)"),
            std::string::npos)
      << result.err;
  for (const int frame : {1, 2, 3}) EXPECT_FALSE(fs::exists(mesh_file(frame)));
  for (const int frame : {4, 5}) {
    EXPECT_LT(errors(frame).rms, 1.0) << frame;
  }
  // The record has a line for each frame, after its head.
  const std::string record = read_text(scratch / "meshes/track.jsonl");
  EXPECT_EQ(std::count(record.begin(), record.end(), '\n'), kFrames + 1);
}

TEST_F(Track, AResumedRunGivesWhatAnUninterruptedRunGives) {
  const std::string whole_map = read_text(map_file(3));
  write_text(map_file(3), whole_map.substr(0, whole_map.size() / 2));  // lost in both
  ASSERT_EQ(track({}, "whole").status, kWorkFailed);
  const CommandResult part =
      track({"--threads", "1"}, "meshes", {.interrupt_when_there_is = mesh_file(1)});
  ASSERT_EQ(part.status, kInterrupted) << part.err;
  ASSERT_FALSE(fs::exists(mesh_file(kFrames - 1)));
  // As if it was killed in the middle of a line.
  const std::string record = read_text(scratch / "meshes/track.jsonl");
  write_text(scratch / "meshes/track.jsonl", record + R"({"range_map":"0000)");
  const CommandResult rest = track({"--resume"});
  EXPECT_EQ(rest.status, kWorkFailed) << rest.err;
  EXPECT_EQ(json::parse(rest.out)["kept"], std::count(record.begin(), record.end(), '\n') - 1);
  EXPECT_EQ(content(scratch / "meshes"), content(scratch / "whole"));
  // There is nothing left to do.
  const CommandResult again = track({"--resume"});
  EXPECT_EQ(again.status, kWorkFailed);
  EXPECT_EQ(json::parse(again.out)["kept"], kFrames);
  EXPECT_EQ(content(scratch / "meshes"), content(scratch / "whole"));
}

/// A plate of 160 x 120 mm at 700 mm that shows no relief, moves along itself by 1 mm a frame, and
/// has a texture.
TEST_F(Track, FollowsTheTextureOfPicturesBesideTheDepths) {
  const geometry::Camera camera = scene::bumpy_camera(kWidth);
  const Eigen::Matrix2Xd rays = geometry::pixel_rays(camera);
  fs::create_directory(scratch / "plate");
  fs::create_directory(scratch / "color");
  write_text(scratch / "plate/rig.yaml", rig_text(camera));
  for (int frame = 0; frame < 4; ++frame) {
    geometry::ImageF depth(camera.height, camera.width);
    cv::Mat picture(camera.height, camera.width, CV_8UC3);
    for (Eigen::Index i = 0; i < rays.cols(); ++i) {
      const double x = 700 * rays(0, i) - frame, y = 700 * rays(1, i);
      const int row = static_cast<int>(i) / camera.width, col = static_cast<int>(i) % camera.width;
      const bool is_plate = std::abs(x) < 80 && std::abs(y) < 60;
      depth(row, col) = is_plate ? 700 : std::numeric_limits<float>::quiet_NaN();
      const auto grey = static_cast<unsigned char>(
          128 + 50 * std::sin(x / 4 + 0.3 * std::cos(y / 9)) + 50 * std::sin(y / 3.3 - 0.2 * x));
      picture.at<cv::Vec3b>(row, col) = {grey, grey, grey};
    }
    geometry::write_depth_tiff(scratch / ("plate/" + name(frame, ".tiff")), depth);
    sensing::write_png(scratch / ("color/" + name(frame, ".png")), picture);
  }
  const auto moved_by = [&](const std::string& output) {
    const Eigen::Matrix3Xd first = geometry::read_mesh(scratch / (output + "/000000.ply")).vertices,
                           last = geometry::read_mesh(scratch / (output + "/000003.ply")).vertices;
    return Vector3d((last - first).rowwise().mean());
  };
  const auto run = [&](const std::string& output, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"track",          scratch / "plate", "-o",
                                      scratch / output, "--nodes",         "100"};
    words.insert(words.end(), more.begin(), more.end());
    return run_palpate(words);
  };
  const CommandResult blind = run("blind", {});
  ASSERT_EQ(blind.status, kDone) << blind.err;
  EXPECT_NE(blind.err.find("--color-images"), std::string::npos) << blind.err;
  EXPECT_LT(moved_by("blind").norm(), 1.5);
  const CommandResult seeing = run("seeing", {"--color-images", scratch / "color"});
  ASSERT_EQ(seeing.status, kDone) << seeing.err;
  EXPECT_LT((moved_by("seeing") - Vector3d(3, 0, 0)).norm(), 0.2);

  // A resumed run takes the texture from the same frame.
  const auto whole = content(scratch / "seeing");
  std::string record = read_text(scratch / "seeing/track.jsonl");
  record.erase(record.rfind('\n', record.size() - 2) + 1);
  write_text(scratch / "seeing/track.jsonl", record);
  ASSERT_EQ(run("seeing", {"--color-images", scratch / "color", "--resume"}).status, kDone);
  EXPECT_EQ(content(scratch / "seeing"), whole);

  // It does not keep frames whose picture has changed.
  fs::copy(scratch / "color/000000.png", scratch / "color/000002.png",
           fs::copy_options::overwrite_existing);
  const CommandResult changed =
      run("seeing", {"--color-images", scratch / "color", "--resume", "--json"});
  ASSERT_EQ(changed.status, kDone) << changed.err;
  EXPECT_EQ(json::parse(changed.out)["kept"], 2);
  ASSERT_EQ(run("fresh", {"--color-images", scratch / "color"}).status, kDone);
  EXPECT_EQ(content(scratch / "seeing"), content(scratch / "fresh"));

  fs::remove(scratch / "color/000002.png");
  const CommandResult missing = run("missing", {"--color-images", scratch / "color"});
  EXPECT_EQ(missing.status, kWrongCall);
  EXPECT_NE(missing.err.find("has no picture of 000002.tiff"), std::string::npos) << missing.err;
  const CommandResult nowhere = run("nowhere", {"--color-images", scratch / "colour"});
  EXPECT_EQ(nowhere.status, kWrongCall);
  EXPECT_NE(nowhere.err.find("colour: there is no such file or folder"), std::string::npos)
      << nowhere.err;
}

TEST_F(Track, AnEarlierRunStaysAsAWholeUntilAnotherOneIsComplete) {
  put_meshes("meshes");
  const auto before = content(scratch / "meshes");
  const std::vector<std::string> other = {"--threads", "1", "--stiffness", "2", "--format", "obj"};
  const CommandResult part =
      track(other, "meshes",
            {.interrupt_when_there_is = scratch / "meshes/.palpate-unfinished/000001.obj"});
  ASSERT_EQ(part.status, kInterrupted) << part.err;
  EXPECT_NE(part.err.find("holds the results of the earlier run, unchanged; "), std::string::npos)
      << part.err;
  fs::rename(scratch / "meshes/.palpate-unfinished", scratch / "unfinished");
  EXPECT_EQ(content(scratch / "meshes"), before);
  fs::rename(scratch / "unfinished", scratch / "meshes/.palpate-unfinished");
  std::vector<std::string> rest = other;
  rest.emplace_back("--resume");
  const CommandResult resumed = track(rest);
  ASSERT_EQ(resumed.status, kDone) << resumed.err;
  EXPECT_GE(json::parse(resumed.out)["kept"], 1);
  ASSERT_EQ(track(other, "whole").status, kDone);
  EXPECT_EQ(content(scratch / "meshes"), content(scratch / "whole"));
}

TEST_F(Track, AResumedRunTracksAnewFromTheFirstRangeMapThatChanged) {
  put_meshes("meshes");
  fs::copy(map_file(3), map_file(2), fs::copy_options::overwrite_existing);
  write_text(map_file(4), "broken");
  ASSERT_EQ(track({}, "whole").status, kWorkFailed);
  const CommandResult rest = track({"--resume"});
  EXPECT_EQ(rest.status, kWorkFailed) << rest.err;
  EXPECT_EQ(json::parse(rest.out)["kept"], 2);
  EXPECT_EQ(content(scratch / "meshes"), content(scratch / "whole"));
}

TEST_F(Track, AResumedRunTracksAllFramesAgainWithAnotherMask) {
  const std::string mask = scratch / "mask.png";
  const auto write_mask = [&](int columns) {
    cv::Mat kept(scene::bumpy_camera(kWidth).height, kWidth, CV_8U, cv::Scalar(255));
    kept.colRange(0, columns) = 0;
    sensing::write_png(mask, kept);
  };
  for (int frame = 2; frame < kFrames; ++frame) fs::remove(map_file(frame));
  write_mask(1);
  ASSERT_EQ(track({"--mask", mask}).status, kDone);
  write_mask(kWidth / 2);
  const CommandResult rest = track({"--mask", mask, "--resume"});
  ASSERT_EQ(rest.status, kDone) << rest.err;
  EXPECT_EQ(json::parse(rest.out)["kept"], 0);
}

TEST_F(Track, AResumedRunTakesRangeMapsThatWereAdded) {
  fs::rename(map_file(5), scratch / "later.tiff");
  ASSERT_EQ(track().status, kDone);
  fs::rename(scratch / "later.tiff", map_file(5));
  const CommandResult rest = track({"--resume"});
  ASSERT_EQ(rest.status, kDone) << rest.err;
  EXPECT_EQ(json::parse(rest.out)["kept"], kFrames - 1);
  put_meshes("whole");
  EXPECT_EQ(content(scratch / "meshes"), content(scratch / "whole"));
}

TEST_F(Track, OnlyTheSameCallIsResumed) {
  put_meshes("meshes");
  const auto before = content(scratch / "meshes");
  const auto refusal = [&](const std::vector<std::string>& more) {
    const CommandResult result = track(more);
    EXPECT_EQ(result.status, kWrongCall) << result.err;
    EXPECT_EQ(content(scratch / "meshes"), before);
    return result.err;
  };
  EXPECT_NE(refusal({"--resume", "--stiffness", "0.03"}).find("another --stiffness"),
            std::string::npos);
  EXPECT_NE(refusal({"--resume", "--format", "obj"}).find("another --format"), std::string::npos);
  fs::rename(map_file(5), scratch / "range/000007.tiff");
  EXPECT_NE(refusal({"--resume"}).find("range map 5 was 000005.tiff and is now 000007.tiff"),
            std::string::npos);
  // Without --resume the folder holds only the new sequence.
  ASSERT_EQ(track({"--format", "obj"}).status, kDone);
  for (const auto& [file, text] : content(scratch / "meshes"))
    EXPECT_TRUE(file.ends_with(".obj") || file.starts_with("nodes/") || file == "track.jsonl")
        << file;
  EXPECT_TRUE(fs::exists(scratch / "meshes/000007.obj"));
  EXPECT_FALSE(fs::exists(scratch / "meshes/nodes/000005.ply"));
}

TEST_F(Track, TheFirstRangeMapIsTheReferenceWhereNoneIsGiven) {
  for (int frame = 2; frame < kFrames; ++frame) fs::remove(map_file(frame));
  const CommandResult result = run_palpate(call({"--json", "--nodes", "250", "--pictures"}));
  ASSERT_EQ(result.status, kDone) << result.err;
  const geometry::RangeMapMesh first = geometry::mesh_range_map(measured(0));
  for (const int frame : {0, 1})
    EXPECT_EQ(geometry::read_mesh(mesh_file(frame)).triangles, first.mesh.triangles);
  const Eigen::Matrix3Xd found = geometry::read_mesh(mesh_file(0)).vertices;
  EXPECT_LT((found - first.mesh.vertices).colwise().norm().mean(), kNoise);
  EXPECT_TRUE(fs::exists(scratch / "meshes/000001.png"));
}

TEST_F(Track, RefusesWhatCannotBeTracked) {
  const std::string reference = scratch / "reference.ply";
  geometry::TriangleMesh far = reference_mesh();
  far.vertices.row(0).array() += 300;
  geometry::write_mesh(scratch / "far.ply", far);
  const std::vector<std::string> misplaced =
      call({"--reference", scratch / "far.ply", "--nodes", "250"});
  const std::string elsewhere =
      expect_refused(misplaced, "far.ply: does not lie at the pose of the first frame");
  EXPECT_NE(elsewhere.find("palpate compare"), std::string::npos) << elsewhere;
  // Most of it lies on the map, in the wrong place.
  far.vertices.row(0).array() -= 200;
  geometry::write_mesh(scratch / "far.ply", far);
  expect_refused(misplaced, "it is stretched by");
  write_text(scratch / "points.ply",
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
             "property float z\nelement face 0\nproperty list uchar int vertex_indices\n"
             "end_header\n0 0 700\n9 0 700\n0 9 700\n");
  expect_refused(call({"--reference", scratch / "points.ply"}), "points.ply");
  expect_refused(call({"--reference", map_file(0), "--unit", "cm"}), "--unit is for mesh files");
  expect_refused({"track", map_file(0), "-o", scratch / "meshes"}, "give a folder of range maps");
  fs::create_directory(scratch / "empty");
  expect_refused({"track", scratch / "empty", "-o", scratch / "meshes"}, "there is no range map");
  write_text(scratch / "empty/notes.txt", "no map");
  expect_refused({"track", scratch / "empty", "-o", scratch / "meshes"}, "(tiff)");
  expect_refused({"track", scratch / "range", "-o", scratch / "range"}, "range");
  expect_refused({"track", scratch / "range", "-o", scratch.path().string()}, "range");
  expect_refused(call({"--reach", "nan"}), "--reach");
  expect_refused(call({"--nodes", "0"}), "--nodes");
  expect_refused(call({"--format", "stl"}), "--format");

  fs::rename(scratch / "range/rig.yaml", scratch / "rig.yaml");
  expect_refused(call(), "rig.yaml: missing");
  EXPECT_EQ(
      run_palpate(call({"--rig", scratch / "rig.yaml", "--reference", reference, "--nodes", "250"}))
          .status,
      kDone);
}

TEST_F(Track, RefusesAFolderWithoutAnyDepth) {
  for (int frame = 0; frame < kFrames; ++frame) write_text(map_file(frame), "broken");
  expect_refused(call(), "000000.tiff: ");
  expect_refused(call({"--reference", scratch / "reference.ply"}), "000000.tiff: ");
  const geometry::RangeMap map = measured(0);
  geometry::write_depth_tiff(map_file(0),
                             geometry::ImageF::Constant(map.z.rows(), map.z.cols(),
                                                        std::numeric_limits<float>::quiet_NaN()));
  expect_refused(call(), "Give one with --reference");
}

TEST_F(Track, LeavesFilesOfOthersAlone) {
  fs::create_directory(scratch / "meshes");
  write_text(scratch / "meshes/000008.ply", "another's");
  expect_refused(call(), "000008.ply: lies where meshes are to be written");
  fs::remove(scratch / "meshes/000008.ply");
  write_text(scratch / "meshes/track.jsonl", "a letter\n");
  expect_refused(call(), "is not a record of palpate track");
  expect_refused(call({"--resume"}), "is not a record of palpate track");
  fs::remove(scratch / "meshes/track.jsonl");
  write_text(scratch / "meshes/notes.txt", "precious");
  ASSERT_EQ(track().status, kDone);
  // A mesh that was put there after a run is not of that run.
  write_text(scratch / "meshes/mine.ply", "precious");
  expect_refused(call(), "mine.ply: lies where meshes are to be written");
  fs::remove(scratch / "meshes/mine.ply");
  ASSERT_EQ(track().status, kDone);
  EXPECT_EQ(read_text(scratch / "meshes/notes.txt"), "precious");
}

TEST_F(Track, ADiskThatIsFullEndsTheRunAndLeavesNoPartOfAMesh) {
  const CommandResult result = track({}, "meshes", {.max_file_size = 100000});
  EXPECT_EQ(result.status, kWorkFailed) << result.err;
  EXPECT_NE(result.err.find("000000.ply"), std::string::npos) << result.err;
  for (const auto& [file, text] : content(scratch / "meshes"))
    EXPECT_TRUE(file == "track.jsonl" || file.starts_with("nodes/")) << file;
  ASSERT_EQ(track({"--resume"}).status, kDone);
}

}  // namespace
}  // namespace palpate::apps
