// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Data of other laboratories, through mapping files.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "mat_writer.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/probing/acquisition_csv.h"
#include "palpate/probing/acquisition_store.h"
#include "repository.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using palpate::support::mat_structure;
using palpate::support::mat_variable;
using palpate::support::mat_variables;
using palpate::support::write_mat;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The mapping files of docs/measurements.md.
std::vector<std::string> mappings_of_page() {
  const std::string page = read_text(repository("docs/measurements.md"));
  std::vector<std::string> blocks;
  const std::string begin = "\n```yaml\n";
  for (std::size_t at = page.find(begin); at != std::string::npos; at = page.find(begin, at)) {
    at += begin.size();
    blocks.push_back(page.substr(at, page.find("```", at) - at));
  }
  return blocks;
}

class ImportMapping : public ::testing::Test {
 protected:
  CommandResult import(const std::string& mapping, std::vector<std::string> call) const {
    write_text(scratch / "lab.yaml", mapping);
    call.insert(call.begin(), {"probe", "import", "--mapping", scratch / "lab.yaml"});
    call.insert(call.end(), {"-o", scratch / "a.db"});
    return run_palpate(call);
  }
  probing::CheckedAcquisition imported() const {
    return probing::read_acquisition(scratch.path() / "a.db");
  }
  /// Exports a store; the text of both files.
  std::string exported(const std::string& folder) const {
    EXPECT_EQ(run_palpate({"probe", "export", scratch / "a.db", "-o", scratch / folder}).status,
              kDone);
    return read_text(scratch / (folder + "/contacts.csv")) +
           read_text(scratch / (folder + "/samples.csv"));
  }

  const std::string contacts = (demo_data() / "sheet/contacts.csv").string();
  const std::string samples = (demo_data() / "sheet/samples.csv").string();
  ScratchFolder scratch;
};

TEST_F(ImportMapping, GivesBackToTheByteWhatWasExported) {
  ASSERT_EQ(run_palpate({"probe", "import", contacts, samples, "-o", scratch / "a.db"}).status,
            kDone);
  const std::string first = exported("first");
  const std::string c = scratch / "first/contacts.csv", s = scratch / "first/samples.csv";
  ASSERT_EQ(import("separator: ','\n", {c, s}).status, kDone);
  EXPECT_EQ(exported("second"), first);
}

TEST_F(ImportMapping, IsChangedBySingleOptionsAndIsTheSameAsThem) {
  std::string text = read_text(samples);
  text.replace(text.find("px,py,pz"), 8, "Fx,Fy,Fz");
  write_text(scratch / "s.csv", text);
  const std::vector<std::string> files = {contacts, scratch / "s.csv"};
  const CommandResult by_mapping =
      import("columns: {px: Fx, py: Fy, pz: Fz}\nunits: {force: N, length: mm}\n", files);
  ASSERT_EQ(by_mapping.status, kDone) << by_mapping.err;
  const std::string right = exported("mapping");
  ASSERT_EQ(run_palpate({"probe", "import", files[0], files[1], "-o", scratch / "a.db", "--map",
                         "px=Fx,py=Fy,pz=Fz"})
                .status,
            kDone);
  EXPECT_EQ(exported("options"), right);
  // Both, in any order: the option wins.
  const CommandResult both = import("columns: {px: Fx, py: Fy, pz: F}\nunits: {force: kN}\n",
                                    {files[0], files[1], "--map", "pz=Fz", "--force-unit", "N"});
  ASSERT_EQ(both.status, kDone) << both.err;
  EXPECT_EQ(exported("both"), right);
}

/// Presses on springs in the frame of a laboratory: points, tips in m, and the forces on the tool
/// in mN, as the first mapping of the page describes them.
struct LabPresses {
  Eigen::MatrixXd points, tips, forces;  // N x 3, M x 3, 3 x M
  Eigen::VectorXd numbers, point_of;     // N, M
};

LabPresses lab_presses() {
  LabPresses lab;
  const int columns = 5, rows = 4, levels = 3;
  const Eigen::Index count = columns * rows, presses = count * levels;
  lab.points.resize(count, 3);
  lab.tips.resize(presses, 3);
  lab.forces.setZero(3, presses);
  lab.numbers.resize(count);
  lab.point_of.resize(presses);
  for (int i = 0; i < columns * rows; ++i) {
    const double x = 12.0 * (i % columns), y = 15.0 * (i / columns);  // [mm]
    const double stiffness = 0.3 + 0.01 * i;                          // [N/mm]
    lab.points.row(i) << 1e-3 * x, 1e-3 * y, 0.02;
    lab.numbers[i] = 10 + i;
    for (int k = 0; k < levels; ++k) {
      const int row = i * levels + k;
      const double depth = 1.5 * (k + 1);
      lab.tips.row(row) << 1e-3 * x, 1e-3 * y, 0.02 - 1e-3 * depth;
      lab.forces(2, row) = 1e3 * stiffness * depth;
      lab.point_of[row] = 10 + i;
    }
  }
  return lab;
}

void write_lab(const fs::path& path, const LabPresses& lab) {
  auto fields = mat_variables(mat_variable("point", lab.point_of), mat_variable("tip", lab.tips),
                              mat_variable("force", lab.forces));
  write_mat(path, mat_variables(mat_variable("P", lab.points), mat_variable("nr", lab.numbers),
                                mat_structure("data", std::move(fields))));
}

TEST_F(ImportMapping, OfThePageReadsAMatFileAndItsPressesMakeAModelWithoutASurface) {
  write_lab(scratch.path() / "lab.mat", lab_presses());
  const CommandResult result =
      import(mappings_of_page().at(0),
             {scratch / "lab.mat", "--surface-out", scratch / "surface.ply", "--json"});
  ASSERT_EQ(result.status, kDone) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
  EXPECT_EQ(json::parse(result.out).at("surface"), scratch / "surface.ply");
  const probing::CheckedAcquisition read = imported();
  ASSERT_EQ(read.contacts().size(), 20u);
  // x' = -y + 120, y' = x, z' = z + 35.5, as the page says.
  EXPECT_LT((read.contacts()[7].position - Eigen::Vector3d(120 - 15, 24, 55.5)).norm(), 1e-12);
  EXPECT_EQ(read.contacts()[7].normal, Eigen::Vector3d(0, 0, 1));
  const probing::Sample& sample = read.samples_of(7)[1];
  EXPECT_LT((sample.a - Eigen::Vector3d(105, 24, 52.5)).norm(), 1e-12);
  EXPECT_LT((sample.force - Eigen::Vector3d(0, 0, -0.37 * 3)).norm(), 1e-12);
  EXPECT_EQ(geometry::read_mesh(scratch / "surface.ply").triangles.cols(), 2 * 4 * 3);

  const CommandResult fitted = run_palpate(
      {"fit", scratch / "a.db", scratch / "surface.ply", "-o", scratch / "model", "--json"});
  ASSERT_EQ(fitted.status, kDone) << fitted.err;
  EXPECT_THAT(fitted.err, AllOf(HasSubstr("at all contacts, all forces have one direction"),
                                HasSubstr("no contact determines its friction")));
  const json figures = json::parse(fitted.out);
  ASSERT_EQ(figures.at("warnings").size(), 1u);
  EXPECT_EQ(figures.at("warnings")[0].at("kind"), "one_direction");
  EXPECT_GT(figures.at("explained"), 0.99);
}

// A table of places, positions and forces alone: no ids, normals, surface or slips.
TEST_F(ImportMapping, OfPlacesPositionsAndForcesAloneMakesAModelOfUnknownFriction) {
  std::string table = "X,Y,Z,tx,ty,tz,Fx,Fy,Fz\n";
  for (int i = 0; i < 16; ++i) {
    for (const double depth : {1.0, 2.0, 3.0}) {
      const int x = 10 * (i % 4), y = 10 * (i / 4);
      table += fmt::format("{0},{1},0,{0},{1},{2},0,0,{3}\n", x, y, -depth,
                           -0.2 * depth * (1 + 0.01 * x));
    }
  }
  write_text(scratch / "t.csv", table);
  const CommandResult result = import(
      "content: presses\ncontacts: place\ncolumns: {x: X, y: Y, z: Z, ax: tx, ay: ty, az: tz, px: "
      "Fx, py: Fy, pz: Fz}\n",
      {scratch / "t.csv", "--json"});
  ASSERT_EQ(result.status, kDone) << result.err;
  EXPECT_THAT(result.err, HasSubstr("has no normals"));
  EXPECT_EQ(imported().contacts()[3].normal, Eigen::Vector3d(0, 0, 1));

  const CommandResult fitted =
      run_palpate({"fit", scratch / "a.db", "-o", scratch / "model", "--json"});
  ASSERT_EQ(fitted.status, kDone) << fitted.err;
  EXPECT_THAT(fitted.err, AllOf(HasSubstr("the surface is made of the 16 contacts alone"),
                                HasSubstr("the friction of the model is unknown")));
  EXPECT_TRUE(json::parse(fitted.out).at("per_contact")[0].at("friction").is_null());
  const json info = json::parse(run_palpate({"info", scratch / "model", "--json"}).out);
  EXPECT_EQ(info.at("unknown_friction"), 16);
  EXPECT_TRUE(info.at("friction").is_null());

  write_text(scratch / "way.csv", "t,x,y,z\n0,12,12,0.5\n0.001,12,12,-1\n0.002,12.5,12,-1\n");
  const std::vector<std::string> play = {"play", scratch / "model", "--trajectory",
                                         scratch / "way.csv"};
  const CommandResult alone = run_palpate(play);
  EXPECT_THAT(alone.err, AllOf(HasSubstr("the friction of 16 contacts is unknown"),
                               HasSubstr("slides without friction")));
  EXPECT_THAT(alone.out, HasSubstr("1 stick, 1 slip"));
  std::vector<std::string> rough = play;
  rough.insert(rough.end(), {"--unknown-friction", "2"});
  const CommandResult with = run_palpate(rough);
  EXPECT_THAT(with.err, HasSubstr("coefficient of 2"));
  EXPECT_THAT(with.out, HasSubstr("2 stick, 0 slip"));
}

TEST_F(ImportMapping, SuspectsWrongSignsAndUnitsAThousandTimesOff) {
  const std::string right = mappings_of_page().at(0);
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = right;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  const std::string mat = scratch / "lab.mat";
  write_lab(mat, lab_presses());
  const CommandResult signs = import(changed("forces_on: tool", "forces_on: object"), {mat});
  EXPECT_EQ(signs.status, kWrongCall);
  EXPECT_THAT(signs.err, AllOf(HasSubstr("lab.mat: these cannot be measurements"),
                               HasSubstr("of the object on the tool")));
  const CommandResult normals = import(changed("nz: 1", "nz: -1"), {mat});
  EXPECT_EQ(normals.status, kWrongCall);
  EXPECT_THAT(normals.err, HasSubstr("the normals point into the object"));
  EXPECT_FALSE(fs::exists(scratch / "a.db"));
  const CommandResult forces = import(changed("force: mN", "force: N"), {mat});
  EXPECT_EQ(forces.status, kDone);
  EXPECT_THAT(forces.err, AllOf(HasSubstr("suspicious"), HasSubstr("the largest force is 22")));
  const CommandResult lengths = import(changed("length: m,", "length: mm,"), {mat});
  EXPECT_EQ(lengths.status, kDone);
  EXPECT_THAT(lengths.err, AllOf(HasSubstr("suspicious"), HasSubstr("all contacts lie within")));
  // The tips alone in another unit.
  LabPresses lab = lab_presses();
  lab.tips *= 1000;
  write_lab(mat, lab);
  fs::remove(scratch / "a.db");
  const CommandResult tips = import(right, {mat});
  EXPECT_EQ(tips.status, kWrongCall);
  EXPECT_THAT(tips.err, HasSubstr("as in mm beside contacts in m"));
  EXPECT_FALSE(fs::exists(scratch / "a.db"));
}

TEST_F(ImportMapping, OfThePageReadsDepthsAndLoads) {
  std::string table = "X,Y,indentation,load\n";
  for (const double x : {0, 12, 24}) {
    for (const double y : {0, 12}) {
      for (const double depth : {1, 2, 3})
        table += std::to_string(x) + ',' + std::to_string(y) + ',' + std::to_string(depth) + ',' +
                 std::to_string(50 * depth) + '\n';
    }
  }
  write_text(scratch / "one.csv", table);
  const CommandResult result = import(mappings_of_page().at(1), {scratch / "one.csv"});
  ASSERT_EQ(result.status, kDone) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
  ASSERT_EQ(imported().contacts().size(), 6u);
  EXPECT_EQ(imported().samples()[1].a, Eigen::Vector3d(0, 0, -2));
  EXPECT_NEAR(imported().samples()[1].force.z(), -0.1 * 9.80665, 1e-12);
}

TEST_F(ImportMapping, OfThePageReadsARecordingAndSaysWhatIsLeftOut) {
  std::string table = "t\tX\tY\tZ\tFx\tFy\tFz\n";
  double time = 0;
  const auto add = [&](double x, double z, double most) {
    table += std::to_string(time) + '\t' + std::to_string(x) + "\t5\t" + std::to_string(z) +
             "\t0.1\t0\t" + std::to_string(std::max(-most, 0.3 - 4 * std::max(-z, 0.0))) + '\n';
    time += 0.01;
  };
  for (const double x : {0.0, 20.0, 40.0}) {
    for (int i = 0; i < 50; ++i) add(x, 1, 1e9);
    for (int i = 0; i < 50; ++i) add(x, 1 - 0.05 * i, 1e9);
    for (int i = 0; i < 50; ++i) add(x, -1.5, 1e9);
    // The last one continues to the limit of its sensor.
    for (int i = 0; i < 50; ++i) add(x, x < 40 ? -1.5 : -3, 10);
    for (int i = 0; i < 50; ++i) add(x, 1, 1e9);
  }
  write_text(scratch / "r.tsv", table);
  const CommandResult result = import(mappings_of_page().at(2), {scratch / "r.tsv", "-v"});
  ASSERT_EQ(result.status, kDone) << result.err;
  EXPECT_THAT(result.err, AllOf(HasSubstr("3 presses were found"),
                                HasSubstr("50 moments are left out: the sensor was at its limit")));
  const probing::CheckedAcquisition read = imported();
  ASSERT_EQ(read.contacts().size(), 3u);
  for (const probing::Sample& sample : read.samples()) {
    EXPECT_NEAR(sample.force.z(), 4 * sample.a.z(), 1e-5);
    EXPECT_NEAR(sample.a.z(), -1.5, 0.1);
  }
}

TEST_F(ImportMapping, ThatIsWrongIsRefusedBeforeAnythingIsWritten) {
  write_lab(scratch.path() / "lab.mat", lab_presses());
  const std::string right = mappings_of_page().at(0);
  LabPresses lab = lab_presses();
  lab.tips(4, 1) = std::nan("");
  write_lab(scratch.path() / "nan.mat", lab);
  write_text(scratch / "empty.mat", "");
  for (const auto& [mapping, data, words] :
       std::vector<std::tuple<std::string, std::string, std::vector<std::string>>>{
           {right + "colums: {}\n", "lab.mat", {"lab.yaml: line 24", "'colums' is unknown"}},
           {right + "units: {}\n", "lab.mat", {"'units' is there twice"}},
           {"units: {force: lbs}\n", "lab.mat", {"lab.yaml: line 1", "lbf"}},
           {"content: presses\n", "lab.mat", {"lab.mat: there is no variable 'id'", "--map"}},
           {right, "nan.mat", {"nan.mat: data.tip(:,2) (ay), row 5: found NaN"}},
           {right, "empty.mat", {"empty.mat: the file is empty"}},
           {right, "none.mat", {"none.mat: there is no such file"}},
           {"normals: forces\n", "lab.mat", {"lab.yaml", "contacts: column or place"}},
           {"content: time_series\n", "lab.mat", {"--mapping: contacts", "place, or column"}}}) {
    const CommandResult result = import(mapping, {scratch / data});
    EXPECT_EQ(result.status, kWrongCall) << mapping;
    for (const std::string& word : words) EXPECT_THAT(result.err, HasSubstr(word));
    EXPECT_FALSE(fs::exists(scratch / "a.db"));
  }
  const CommandResult none = run_palpate({"probe", "import", "--mapping", scratch / "none.yaml",
                                          scratch / "lab.mat", "-o", scratch / "a.db"});
  EXPECT_EQ(none.status, kWrongCall);
  EXPECT_THAT(none.err, HasSubstr("none.yaml: no such file"));
  // Contacts of which no surface can be made.
  lab = lab_presses();
  lab.points.col(1).setZero();
  lab.points.col(0) = 1e-3 * Eigen::VectorXd::LinSpaced(20, 0, 100);
  for (Eigen::Index i = 0; i < lab.tips.rows(); ++i)
    lab.tips.row(i).head(2) = lab.points.row(i / 3).head(2);
  write_lab(scratch.path() / "line.mat", lab);
  const CommandResult line =
      import(right, {scratch / "line.mat", "--surface-out", scratch / "s.ply"});
  EXPECT_EQ(line.status, kWrongCall);
  EXPECT_THAT(line.err, AllOf(HasSubstr("--surface-out"), HasSubstr("in a line")));
  EXPECT_FALSE(fs::exists(scratch / "a.db"));
  EXPECT_FALSE(fs::exists(scratch / "s.ply"));
}

}  // namespace
}  // namespace palpate::apps
