// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The whole way through the command, as docs/start.md shows it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cgal_availability.h"
#include "palpate/haptics/evaluate.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

/// Runs with --json, expects success, returns the figures.
nlohmann::json figures(std::vector<std::string> arguments) {
  arguments.emplace_back("--json");
  const CommandResult result = run_palpate(arguments);
  EXPECT_EQ(result.status, 0) << result.err;
  for (const char* mark : {"error: ", "warning: "})
    EXPECT_EQ(result.err.find(mark), std::string::npos) << result.err;
  return nlohmann::json::parse(result.out);
}

class WayOfTheData : public ::testing::Test {
 protected:
  /// Trains the colours and decodes the bundled frames into range/ of `folder`, with meshes.
  static nlohmann::json decode(const ScratchFolder& folder) {
    write_text(folder / "colors.yaml", trained_colors());
    return figures({"decode", demo("frames"), "--rig", demo("rig.yaml"), "--pattern",
                    demo("pattern.yaml"), "--colors", folder / "colors.yaml", "-o",
                    folder / "range", "--meshes", "obj"});
  }

  /// The range maps of the bundled frames, made once; not to be changed.
  struct RangeMaps {
    ScratchFolder folder;
    nlohmann::json decoded = decode(folder);
  };
  static const RangeMaps& range_maps() {
    static const RangeMaps made;
    return made;
  }

  /// Makes acquisition.db and model/ of bundled measurements in `folder`.
  static nlohmann::json fit(const std::string& set, const ScratchFolder& folder) {
    const fs::path data = demo_data() / set;
    figures({"probe", "import", data / "contacts.csv", data / "samples.csv", "-o",
             folder / "acquisition.db"});
    return figures(
        {"fit", folder / "acquisition.db", data / "surface.ply", "-o", folder / "model"});
  }

  /// The model of the sheet, made once; not to be changed.
  struct Sheet {
    ScratchFolder folder;
    nlohmann::json fitted = fit("sheet", folder);
  };
  static const Sheet& sheet() {
    static const Sheet made;
    return made;
  }

  ScratchFolder scratch;
};

TEST_F(WayOfTheData, FramesBecomeRangeMapsThatAgreeWithTheTruth) {
  const nlohmann::json& decoded = range_maps().decoded;
  const ScratchFolder& folder = range_maps().folder;
  EXPECT_EQ(decoded["decoded"], 4);
  const std::vector<std::string> names = {"duck", "flag_a", "flag_b",
                                          "plane"};  // in the order of the frames
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string map = folder / ("range/00000" + std::to_string(i) + ".tiff");
    const nlohmann::json difference =
        figures({"compare", map, demo("truth/" + names[i] + ".tiff")});
    const double distance = decoded["per_frame"][i]["median_depth"];
    EXPECT_LT(difference["median"], 0.001 * distance) << names[i];
    EXPECT_TRUE(fs::exists(folder / ("range/00000" + std::to_string(i) + ".obj")));
  }
  EXPECT_TRUE(fs::exists(folder / "range/rig.yaml"));
}

TEST_F(WayOfTheData, ARangeMapComparedWithItselfHasNoDifferenceAndAPicture) {
  const nlohmann::json difference =
      figures({"compare", demo("truth/duck.tiff"), demo("truth/duck.tiff"), "--picture",
               scratch / "differences.png"});
  EXPECT_EQ(difference["max"], 0);
  EXPECT_TRUE(fs::exists(scratch / "differences.png"));
}

TEST_F(WayOfTheData, NamesOfFilesNeedNotBeUtf8) {
  EXPECT_EQ(figures({"mesh", demo("truth/duck.tiff"), "--rig", demo("rig.yaml"), "-o",
                     scratch / "duck_\xE9.ply"})["file"],
            scratch / "duck_\xEF\xBF\xBD.ply");
}

TEST_F(WayOfTheData, ARangeMapBecomesAMeshThatLiesOnIt) {
  const std::string flag = range_maps().folder / "range/000001.tiff";
  figures({"mesh", flag, "-o", scratch / "surface.ply"});
  const nlohmann::json distance = figures({"compare", scratch / "surface.ply", flag});
  EXPECT_LT(distance["max"], 1e-3);  // mm: the mesh's vertices are the map's points
}

TEST_F(WayOfTheData, ADepthImageBecomesAMesh) {
  const nlohmann::json mesh =
      figures({"mesh", demo("depth_camera/hand.png"), "--scale", "0.125", "--intrinsics",
               "476.007,476.007,313.683,242.755", "-o", scratch / "hand.ply"});
  EXPECT_GT(mesh["triangles"], 100000);
}

TEST_F(WayOfTheData, AMeshIsDecimatedWithinTheToleranceThatCompareFinds) {
  const std::string hand = (demo_data() / "../meshes/hand.ply").string();
  const nlohmann::json mesh =
      figures({"mesh", hand, "-o", scratch / "small.ply", "--tolerance", "0.5"});
  const nlohmann::json decimation = mesh["decimation"];
  EXPECT_EQ(decimation["triangles_before"], 10937);
  EXPECT_EQ(decimation["triangles_after"], mesh["triangles"]);
  EXPECT_LT(mesh["triangles"], 10937 / 4);
  EXPECT_LE(decimation["distance"], 0.5);
  const nlohmann::json distance =
      figures({"compare", scratch / "small.ply", hand, "--picture", scratch / "distances.png"});
  EXPECT_LE(distance["hausdorff"]["lower"], decimation["distance"]);
  EXPECT_LE(distance["rms"], distance["p90"]);
  EXPECT_LT(std::abs(distance["mean"].get<double>()), 0.1);
  EXPECT_TRUE(fs::exists(scratch / "distances.png"));
}

TEST_F(WayOfTheData, MeasurementsSurviveTheStoreUnchanged) {
  figures({"probe", "import", demo("sheet/contacts.csv"), demo("sheet/samples.csv"), "-o",
           scratch / "a.db"});
  figures({"probe", "export", scratch / "a.db", "-o", scratch / "csv"});
  figures({"probe", "import", scratch / "csv/contacts.csv", scratch / "csv/samples.csv", "-o",
           scratch / "b.db"});
  figures({"probe", "export", scratch / "b.db", "-o", scratch / "again"});
  EXPECT_EQ(read_text(scratch / "csv/samples.csv"), read_text(scratch / "again/samples.csv"));
  EXPECT_EQ(read_text(scratch / "csv/contacts.csv"), read_text(demo_data() / "sheet/contacts.csv"));
}

// The errors are those of the table in docs/results.md, with a margin of 5 % because it rounds
// them.
TEST_F(WayOfTheData, MeasurementsBecomeAModelThatIsAsGoodAsTheResultsSay) {
  constexpr double kMargin = 1.05;
  EXPECT_EQ(sheet().fitted["contacts"], 46);
  EXPECT_LT(sheet().fitted["rms"]["median"], kMargin * 0.045);
  const fs::path& folder = sheet().folder.path();
  const nlohmann::json errors =
      figures({"evaluate", folder / "model", "--queries", demo("sheet/queries.csv"),
               "--leave-one-out", folder / "acquisition.db"});
  EXPECT_EQ(errors["queries"]["count"], 400);
  EXPECT_LT(errors["queries"]["median"], kMargin * 0.020);
  EXPECT_LT(errors["queries"]["rms"], kMargin * 0.034);
  const nlohmann::json& left_out = errors["leave_one_out"];
  EXPECT_EQ(left_out["per_contact"].size(), 46u);
  EXPECT_LT(left_out["interior_rms"], kMargin * 0.10);
  EXPECT_LT(left_out["border_rms"], kMargin * 0.25);
}

TEST_F(WayOfTheData, QueriesOfOtherSignsAndColumnsAreToldAsSuch) {
  const std::vector<haptics::Query> right = haptics::read_queries(demo("sheet/queries.csv"));
  const auto said_of = [&](const auto& change) {
    std::string table = "cx,cy,cz,dx,dy,dz,fx,fy,fz";
    for (haptics::Query query : right) {
      change(query);
      const Eigen::Vector3d &c = query.contact, &d = query.displacement, &f = query.force;
      table += fmt::format("\n{},{},{},{},{},{},{},{},{}", c.x(), c.y(), c.z(), d.x(), d.y(), d.z(),
                           f.x(), f.y(), f.z());
    }
    write_text(scratch / "queries.csv", table);
    const CommandResult result =
        run_palpate({"evaluate", (sheet().folder.path() / "model").string(), "--queries",
                     scratch / "queries.csv", "--json"});
    EXPECT_EQ(result.status, 0) << result.err;
    const nlohmann::json warnings = nlohmann::json::parse(result.out)["warnings"];
    return warnings.empty() ? "nothing" : warnings[0]["kind"].get<std::string>();
  };
  EXPECT_EQ(said_of([](haptics::Query&) {}), "nothing");
  EXPECT_EQ(said_of([](haptics::Query& query) { query.force *= -1; }), "queries_scaled");
  EXPECT_EQ(said_of([](haptics::Query& query) { query.force *= 1000; }), "queries_scaled");
  EXPECT_EQ(said_of([](haptics::Query& query) { query.displacement *= -1; }),
            "queries_unexplained");
  EXPECT_EQ(said_of([](haptics::Query& query) { query.displacement /= 1000; }),
            "queries_unexplained");
  EXPECT_EQ(said_of([](haptics::Query& query) {
              std::swap(query.displacement.x(), query.displacement.z());
            }),
            "queries_unexplained");
}

TEST_F(WayOfTheData, APlayedTraceIsTheSameOnEveryRunAndForEveryNumberOfThreads) {
  fit("sheet_block", scratch);
  const std::string model = scratch / "model";
  figures({"play", model, "--trajectory", demo("trajectory.csv"), "--record", scratch / "one.csv"});
  figures({"fit", scratch / "acquisition.db", demo("sheet_block/surface.ply"), "-o",
           scratch / "again", "--threads", "1"});
  figures({"play", scratch / "again", "--trajectory", demo("trajectory.csv"), "--record",
           scratch / "two.csv"});
  const std::string trace = read_text(scratch / "one.csv");
  EXPECT_EQ(trace, read_text(scratch / "two.csv"));
  EXPECT_EQ(trace.find("nan"), std::string::npos);
  EXPECT_EQ(trace.find("inf"), std::string::npos);
  EXPECT_NE(trace.find("stick"), std::string::npos);
  EXPECT_NE(trace.find("slip"), std::string::npos);
}

TEST_F(WayOfTheData, EveryFileExplainsItself) {
  const fs::path& folder = sheet().folder.path();
  for (const std::string& file :
       {demo("rig.yaml"), demo("pattern.yaml"), range_maps().folder / "colors.yaml",
        range_maps().folder / "range/000000.tiff", demo("frames/duck.png"),
        demo("sheet/surface.ply"), (folder / "acquisition.db").string(),
        (folder / "model").string(), demo("sheet/contacts.csv"), demo("sheet/samples.csv"),
        demo("sheet/queries.csv"), demo("trajectory.csv")}) {
    EXPECT_FALSE(figures({"info", file})["kind"].get<std::string>().empty()) << file;
  }
}

TEST_F(WayOfTheData, InfoMeasuresAMesh) {
  // A tetrahedron with three edges of 6 mm along the axes.
  write_text(scratch / "closed.off",
             "OFF\n4 4 0\n0 0 0\n6 0 0\n0 6 0\n0 0 6\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  const auto closed = figures({"info", scratch / "closed.off"});
  EXPECT_NEAR(closed["volume"].get<double>(), 36, 1e-9);
  EXPECT_NEAR(closed["area"].get<double>(), 54 + 18 * std::sqrt(3), 1e-9);
  EXPECT_EQ(closed["euler_characteristic"], 2);
  const auto open = figures({"info", demo("sheet/surface.ply")});
  EXPECT_TRUE(open["volume"].is_null());
  EXPECT_EQ(open["components"], 1);
  EXPECT_EQ(open["boundary_loops"], 1);
  // Two triangles one of which is turned over.
  write_text(scratch / "turned.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 3 2\n");
  EXPECT_NE(figures({"info", scratch / "turned.off"})["not_a_surface"].get<std::string>().find(
                "triangles 0 and 1"),
            std::string::npos);
}

TEST_F(WayOfTheData, InfoListsWhatIsWrongWithAMeshAndMeshMendsIt) {
  // A square in two triangles, one turned; a triangle with a missing vertex; one with a vertex that
  // is not a number.
  write_text(scratch / "broken.off",
             "OFF\n5 4 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\nnan 0 0\n"
             "3 0 1 2\n3 0 3 2\n3 0 1 9\n3 1 0 4\n");
  const auto defects = figures({"info", scratch / "broken.off"})["defects"];
  EXPECT_EQ(defects["infinite_vertex"], 1);
  EXPECT_EQ(defects["corner_out_of_range"], 1);
  EXPECT_EQ(defects["triangle_turned"], 1);
  EXPECT_EQ(run_palpate({"mesh", scratch / "broken.off", "-o", scratch / "mended.ply"}).status, 2);
  const auto mended =
      figures({"mesh", scratch / "broken.off", "--repair", "-o", scratch / "mended.ply"});
  EXPECT_EQ(mended["repair"]["removed_triangles"], 2);
  EXPECT_EQ(mended["triangles"], 2);
  EXPECT_TRUE(figures({"info", scratch / "mended.ply"})["defects"].empty());
}

TEST_F(WayOfTheData, InfoCountsTrianglesThatPassThroughEachOther) {
  write_text(scratch / "crossing.off",
             "OFF\n9 3 0\n0 0 0\n4 0 0\n0 4 0\n1 1 -1\n1 1 1\n9 9 1\n0 0 5\n1 0 5\n0 1 5\n"
             "3 0 1 2\n3 6 7 8\n3 3 4 5\n");
  const auto defects = figures({"info", scratch / "crossing.off"})["defects"];
  EXPECT_EQ(defects.size(), 1U);
  EXPECT_EQ(defects["triangle_intersecting"], 2);
}

TEST_F(WayOfTheData, MeshFillsHolesUpToASize) {
  if (!geometry::test::has_cgal()) GTEST_SKIP() << "the library was built without CGAL";
  // An octahedron of 6 mm in radius without one of its faces, which has a box of 6 x 6 x 6 mm.
  write_text(scratch / "open.off",
             "OFF\n6 7 0\n6 0 0\n-6 0 0\n0 6 0\n0 -6 0\n0 0 6\n0 0 -6\n3 2 1 4\n3 1 3 4\n"
             "3 3 0 4\n3 2 0 5\n3 1 2 5\n3 3 1 5\n3 0 3 5\n");
  const auto fill = [&](const std::string& size) {
    return figures({"mesh", scratch / "open.off", "--fill-holes", size, "-o",
                    scratch / "filled.ply"})["holes"];
  };
  EXPECT_EQ(fill("10")["left"], 1);
  EXPECT_EQ(fill("11")["filled"], 1);
  EXPECT_EQ(figures({"info", scratch / "filled.ply"})["boundary_loops"], 0);
}

TEST_F(WayOfTheData, MeshSmoothsIfAsked) {
  const auto area = [&](const std::string& iterations) {
    figures({"mesh", demo("depth_camera/hand.png"), "--scale", "0.125", "--intrinsics",
             "476.007,476.007,313.683,242.755", "-o", scratch / "hand.ply", "--smooth",
             iterations});
    return figures({"info", scratch / "hand.ply"})["area"].get<double>();
  };
  const double rough = area("0");
  const double smooth = area("20");
  EXPECT_LT(smooth, rough);  // noise adds area
  EXPECT_GT(smooth, 0.99 * rough);
}

TEST_F(WayOfTheData, AMeshIsInTheUnitThatTheCallOrTheFileSays) {
  const std::string triangle = "v 0 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\n";
  const auto expect = [&](const std::vector<std::string>& options, double x, const char* source) {
    std::vector<std::string> call = {"info", scratch / "a.obj"};
    call.insert(call.end(), options.begin(), options.end());
    const nlohmann::json info = figures(call);
    EXPECT_EQ(info["max"][0], x);
    EXPECT_EQ(info["unit_source"], source);
  };
  write_text(scratch / "a.obj", triangle);
  expect({}, 2, "assumed");
  expect({"--unit", "in"}, 50.8, "stated");
  write_text(scratch / "a.obj", "# unit: m\n" + triangle);
  expect({}, 2000, "declared");
  // The same surface in two units that their files declare.
  write_text(scratch / "b.obj", "v 0 0 0\nv 2000 0 0\nv 0 1000 0\nf 1 2 3\n");
  EXPECT_EQ(figures({"compare", scratch / "a.obj", scratch / "b.obj"})["max"], 0);
}

}  // namespace
}  // namespace palpate::apps
