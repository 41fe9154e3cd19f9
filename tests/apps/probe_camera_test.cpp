// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate probe run --camera`: the deformed object recorded with each sample, and the model made
// from both.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map.h"
#include "palpate/haptics/model_io.h"
#include "palpate/probing/acquisition_store.h"
#include "palpate/probing/specimen_file.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kSoftBody =
    R"({"type": "elastic_body", "young_modulus": 0.08, "poisson_ratio": 0.5, "size": 80})";

class ProbeCamera : public ::testing::Test {
 protected:
  static json figures_of(std::vector<std::string> call) {
    call.emplace_back("--json");
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kDone) << call[1] << ": " << result.err;
    return json::parse(result.out, nullptr, false);
  }

  static const std::string& colors() {
    static const ScratchFolder folder;
    static const std::string file = [] {
      write_text(folder / "colors.yaml", trained_colors());
      return folder / "colors.yaml";
    }();
    return file;
  }

  static std::vector<std::string> camera_call(const std::string& plan, const std::string& specimen,
                                              const std::string& store) {
    return {"probe",
            "run",
            plan,
            "--specimen",
            specimen,
            "-o",
            store,
            "--camera",
            "simulated",
            "--rig",
            demo("rig.yaml"),
            "--pattern",
            demo("pattern.yaml"),
            "--colors",
            colors()};
  }

  /// An uninterrupted campaign of three contacts, made once; not to be changed.
  struct Campaign {
    ScratchFolder folder;
    std::string specimen = folder / "body.json", plan = folder / "plan.json",
                store = folder / "whole/acquisition.db";
    json done;

    Campaign() {
      write_text(specimen, kSoftBody);
      (void)figures_of({"probe", "plan", "--specimen", specimen, "-o", plan, "--contacts", "3",
                        "--levels", "2", "--lowest-force", "0.7", "--highest-force", "1.5",
                        "--directions", "1"});
      std::vector<std::string> call = camera_call(plan, specimen, store);
      call.emplace_back("--truth");
      done = figures_of(call);
    }
  };
  static const Campaign& campaign() {
    static const Campaign made;
    return made;
  }

  static std::string refusal_of(const std::vector<std::string>& call) {
    const CommandResult result = run_palpate(call);
    EXPECT_EQ(result.status, kWrongCall) << result.err;
    return result.err;
  }

  static std::map<std::string, std::string> files_in(const fs::path& folder) {
    std::map<std::string, std::string> files;
    for (const fs::directory_entry& file : fs::directory_iterator(folder))
      files[file.path().filename().string()] = read_text(file.path().string());
    return files;
  }

  ScratchFolder scratch;
  const std::string store = scratch / "acquisition.db";
};

TEST_F(ProbeCamera, RecordsARangeMapWithEachSample) {
  const json& done = campaign().done;
  EXPECT_GE(done["samples"], 8);
  EXPECT_TRUE(done["not_seen"].empty());
  const fs::path folder = fs::path(campaign().store).parent_path();
  int seen = 0;
  const probing::CheckedAcquisition acquisition = probing::read_acquisition(campaign().store);
  for (const probing::Sample& sample : acquisition.samples()) {
    EXPECT_TRUE(sample.slipped || sample.range_map.has_value()) << sample.id;
    if (!sample.range_map) continue;  // the tip fell off
    ++seen;
    EXPECT_TRUE(fs::exists(folder / *sample.range_map)) << *sample.range_map;
  }
  EXPECT_GE(seen, 6);
  EXPECT_EQ(done["range_maps"], seen);
  // Its own rig lies beside the range maps, so that other commands need no option for it.
  const json compared = figures_of({"compare", (folder / "range/000000.tiff").string(),
                                    (folder / "truth/000000.tiff").string()});
  EXPECT_LT(compared["median"], 0.1) << compared;
  const json told = figures_of({"info", campaign().store});
  EXPECT_EQ(told["range_maps"], seen);
  EXPECT_THAT(run_palpate({"probe", "status", campaign().store}).out,
              HasSubstr(std::to_string(seen) + " range maps"));
}

TEST_F(ProbeCamera, InterruptedAndResumedRecordsTheSame) {
  const CommandResult stopped =
      run_palpate(camera_call(campaign().plan, campaign().specimen, store),
                  {.interrupt_when_there_is = scratch.path() / "range/000001.tiff"});
  ASSERT_EQ(stopped.status, kInterrupted) << stopped.err;
  const json resumed = figures_of({"probe", "resume", store});
  EXPECT_EQ(resumed["fingerprint"], campaign().done["fingerprint"]);
  EXPECT_EQ(resumed["range_maps"], campaign().done["range_maps"]);
  EXPECT_EQ(files_in(scratch.path() / "range"),
            files_in(fs::path(campaign().store).parent_path() / "range"));
}

TEST_F(ProbeCamera, KnowsTheRigWithWhichItBegan) {
  std::vector<std::string> call = camera_call(campaign().plan, campaign().specimen, store);
  fs::copy_file(demo("rig.yaml"), scratch / "rig.yaml");
  call[10] = scratch / "rig.yaml";
  const CommandResult stopped =
      run_palpate(call, {.interrupt_when_there_is = scratch.path() / "range/000001.tiff"});
  ASSERT_EQ(stopped.status, kInterrupted) << stopped.err;
  std::string rig = read_text(scratch / "rig.yaml");
  write_text(scratch / "rig.yaml", rig.replace(rig.find("1100.0"), 6, "1101.0"));
  EXPECT_THAT(refusal_of({"probe", "resume", store}),
              HasSubstr("rig.yaml: is not the file with which the campaign"));
  fs::remove(scratch / "rig.yaml");
  EXPECT_THAT(refusal_of({"probe", "resume", store}), HasSubstr("there is no such file"));
  // It may lie elsewhere.
  EXPECT_EQ(figures_of({"probe", "resume", store, "--rig", demo("rig.yaml")})["fingerprint"],
            campaign().done["fingerprint"]);
}

TEST_F(ProbeCamera, NamesTheTrialsInWhichNothingOfUseWasSeen) {
  std::vector<std::string> call = camera_call(campaign().plan, campaign().specimen, store);
  call.insert(call.end(), {"--least-depths", "0.9"});
  const json done = figures_of(call);
  EXPECT_EQ(done["samples"], campaign().done["samples"]);
  EXPECT_EQ(done["range_maps"], 0);
  EXPECT_EQ(done["not_seen"].size(), campaign().done["range_maps"]);
  const CommandResult status = run_palpate({"probe", "status", store});
  EXPECT_THAT(status.out, HasSubstr("nothing of use was seen in trials 0, 1, "));
  EXPECT_THAT(status.out, HasSubstr("less than 90 %"));
}

TEST_F(ProbeCamera, EndsInAModelWhoseSurfaceFollowsAsRecorded) {
  const fs::path folder = fs::path(campaign().store).parent_path();
  ASSERT_EQ(run_palpate(
                {"probe", "truth", campaign().specimen, "--queries", "0", "-o", scratch / "truth"})
                .status,
            kDone);
  const std::string surface = scratch / "truth/surface.ply";
  (void)figures_of({"track", (folder / "range").string(), "--reference", surface, "--acquisition",
                    campaign().store, "-o", scratch / "tracked"});
  (void)figures_of(
      {"fit", campaign().store, surface, "--shapes", scratch / "tracked", "-o", scratch / "model"});
  const haptics::Model model = haptics::read_model(scratch / "model");
  ASSERT_TRUE(model.response.has_value());
  EXPECT_GE(model.response->shape_contacts.size(), 4U);
  // The tracked surface against the true one, under the force of the sample.
  const auto specimen = probing::parse_specimen(kSoftBody, "");
  const probing::CheckedAcquisition acquisition = probing::read_acquisition(campaign().store);
  for (const probing::Sample& sample : acquisition.samples()) {
    if (sample.slipped) continue;
    const std::string stem = fs::path(*sample.range_map).stem().string();
    const geometry::TriangleMesh tracked =
        geometry::read_mesh(fs::path(scratch / "tracked") / (stem + ".ply"));
    const Eigen::Vector3d at = acquisition.contacts()[*acquisition.find(sample.contact)].position;
    const Eigen::Matrix3Xd error = tracked.vertices - specimen->deformed_surface(at, sample.force);
    EXPECT_LT(std::sqrt(error.colwise().squaredNorm().mean()), 0.5) << stem;
  }
}

TEST_F(ProbeCamera, TrackingRefusesAnAcquisitionThatDoesNotBelongToTheRangeMaps) {
  const std::string range = (fs::path(campaign().store).parent_path() / "range").string();
  const auto refused = [&](const std::string& acquisition, const geometry::TriangleMesh& surface) {
    geometry::write_mesh(scratch / "reference.ply", surface);
    return refusal_of({"track", range, "--reference", scratch / "reference.ply", "--acquisition",
                       acquisition, "-o", scratch / "tracked"});
  };
  geometry::TriangleMesh surface = probing::parse_specimen(kSoftBody, "")->surface();
  (void)figures_of(
      {"probe", "run", campaign().plan, "--specimen", campaign().specimen, "-o", store});
  EXPECT_THAT(refused(store, surface), HasSubstr("no sample that held names a range map"));
  surface.vertices.row(0).array() += 200;
  EXPECT_THAT(refused(campaign().store, surface),
              HasSubstr("mm from the reference; both must be in the frame of the camera"));
  EXPECT_FALSE(fs::exists(scratch / "tracked"));
}

TEST_F(ProbeCamera, TrackingWarnsOfRangeMapsThatTheCampaignDidNotRecord) {
  const fs::path recorded = fs::path(campaign().store).parent_path() / "range",
                 swapped = scratch.path() / "swapped";
  fs::create_directory(swapped);
  fs::copy_file(recorded / "rig.yaml", swapped / "rig.yaml");
  fs::copy_file(recorded / "000001.tiff", swapped / "000000.tiff");
  geometry::write_mesh(scratch / "reference.ply",
                       probing::parse_specimen(kSoftBody, "")->surface());
  const auto warning = [&](const fs::path& range, const std::string& output) {
    return run_palpate({"track", range.string(), "--reference", scratch / "reference.ply",
                        "--acquisition", campaign().store, "-o", scratch / output})
        .err;
  };
  EXPECT_THAT(warning(swapped, "tracked"),
              HasSubstr("000000.tiff: is not the range map that the campaign of"));
  fs::copy_file(recorded / "000000.tiff", swapped / "000000.tiff",
                fs::copy_options::overwrite_existing);
  EXPECT_THAT(warning(swapped, "again"), Not(HasSubstr("is not the range map")));
}

TEST_F(ProbeCamera, DecodesWhatAConnectedCameraSends) {
  // A camera that always sends the same frame, of another object: as `palpate decode` decodes it,
  // except where the tool is.
  fs::create_directory(scratch.path() / "frames");
  fs::copy_file(demo("frames/flag_a.png"), scratch.path() / "frames/flag_a.png");
  std::vector<std::string> call = camera_call(campaign().plan, campaign().specimen, store);
  call[8] = "simulated:" + scratch / "frames";
  call.insert(call.end(), {"--frames", "3", "--rate", "200"});
  const json done = figures_of(call);
  EXPECT_EQ(done["range_maps"], campaign().done["range_maps"]);
  (void)figures_of({"decode", scratch / "frames", "--rig", demo("rig.yaml"), "--pattern",
                    demo("pattern.yaml"), "--colors", colors(), "-o", scratch / "decoded"});
  const geometry::ImageF seen = geometry::read_depth_tiff(scratch / "range/000000.tiff"),
                         whole = geometry::read_depth_tiff(scratch / "decoded/000000.tiff");
  const auto both = seen.isFinite() && whole.isFinite();
  EXPECT_GT(both.count(), whole.isFinite().count() * 9 / 10);
  EXPECT_EQ(seen.isFinite().count(), both.count());
  EXPECT_EQ((both && (seen - whole).abs() > 1e-3F).count(), 0);
}

TEST_F(ProbeCamera, RefusesSettingsOfTheOtherKindOfCamera) {
  const auto refused = [&](const std::string& camera, std::vector<std::string> more) {
    std::vector<std::string> call = camera_call(campaign().plan, campaign().specimen, store);
    call[8] = camera;
    call.insert(call.end(), more.begin(), more.end());
    return refusal_of(call);
  };
  EXPECT_THAT(refused("simulated", {"--exposure", "4000"}),
              HasSubstr("--exposure 4000: has no effect with --camera simulated"));
  EXPECT_THAT(refused("simulated", {"--size", "640", "480"}), HasSubstr("--size: has no effect"));
  const std::string folder = "simulated:" + demo("frames");
  EXPECT_THAT(refused(folder, {"--truth"}), HasSubstr("--truth: has no effect with --camera"));
  EXPECT_THAT(refused(folder, {"--frames", "0"}), HasSubstr("--frames"));
  EXPECT_THAT(refused("basler", {}), HasSubstr("it must be 'simulated', or a connected camera"));
  EXPECT_FALSE(fs::exists(store));
}

TEST_F(ProbeCamera, RefusesWhatItCannotRecord) {
  const auto with = [&](std::size_t at, const std::string& value) {
    std::vector<std::string> call = camera_call(campaign().plan, campaign().specimen, store);
    call[at] = value;
    return call;
  };
  write_text(scratch / "sheet.json", R"({"type": "sheet"})");
  (void)figures_of({"probe", "plan", "--specimen", scratch / "sheet.json", "-o",
                    scratch / "sheet_plan.json", "--contacts", "1"});
  EXPECT_THAT(refusal_of(camera_call(scratch / "sheet_plan.json", scratch / "sheet.json", store)),
              HasSubstr("--camera simulated: the shape of this object"));
  EXPECT_THAT(refusal_of(with(12, scratch / "no.yaml")), HasSubstr("no.yaml"));
  EXPECT_THAT(refusal_of(with(8, "aravis:nobody")), HasSubstr("nobody"));
  std::vector<std::string> without_colors =
      camera_call(campaign().plan, campaign().specimen, store);
  without_colors.resize(13);
  EXPECT_THAT(refusal_of(without_colors), HasSubstr("--colors: is missing"));
  EXPECT_THAT(refusal_of({"probe", "run", campaign().plan, "--specimen", campaign().specimen, "-o",
                          store, "--rig", demo("rig.yaml")}),
              HasSubstr("--camera"));
  fs::create_directories(scratch / "range");
  write_text(scratch / "range/notes.txt", "mine");
  EXPECT_THAT(refusal_of(camera_call(campaign().plan, campaign().specimen, store)),
              HasSubstr("holds files already"));
  EXPECT_FALSE(fs::exists(store));
}

}  // namespace
}  // namespace palpate::apps
