// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Measurements of other labs: their columns and units, and messages for wrong ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "code_blocks.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/probing/acquisition_csv.h"
#include "palpate/probing/acquisition_store.h"
#include "palpate/probing/fingerprint.h"
#include "repository.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// The bundled sheet with fewer samples, all of five contacts and few of the others.
probing::Acquisition sheet() {
  probing::Acquisition acquisition =
      probing::read_acquisition_csv(demo_data() / "sheet/contacts.csv",
                                    demo_data() / "sheet/samples.csv")
          .records();
  std::erase_if(acquisition.contacts, [](const auto& contact) { return contact.id >= 12; });
  std::erase_if(acquisition.samples, [](const auto& sample) { return sample.contact >= 12; });
  return acquisition;
}

class Measurements : public ::testing::Test {
 protected:
  void write_csv(const probing::Acquisition& acquisition) const {
    probing::write_acquisition_csv(acquisition, scratch.path() / "c.csv", scratch.path() / "s.csv");
  }
  CommandResult import_csv(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> call = {"probe",           "import", scratch / "c.csv",
                                     scratch / "s.csv", "-o",     scratch / "a.db"};
    call.insert(call.end(), more.begin(), more.end());
    return run_palpate(call);
  }
  void write_store(const probing::Acquisition& acquisition) const {
    probing::write_acquisition(scratch.path() / "a.db", acquisition);
  }
  CommandResult fit(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> call = {"fit", scratch / "a.db", surface, "-o", scratch / "model"};
    call.insert(call.end(), more.begin(), more.end());
    return run_palpate(call);
  }
  /// Expects that import and fit refuse the measurements with these words and write nothing.
  void expect_refused(const probing::Acquisition& acquisition, const std::string& words) const {
    write_csv(acquisition);
    const CommandResult imported = import_csv();
    EXPECT_EQ(imported.status, kWrongCall) << words;
    EXPECT_THAT(imported.err,
                AllOf(HasSubstr("s.csv: these cannot be measurements"), HasSubstr(words)));
    EXPECT_FALSE(fs::exists(scratch / "a.db"));
    // A store that another program wrote.
    write_store(acquisition);
    for (const CommandResult& result : {fit(), run_palpate({"identify", scratch / "a.db"})}) {
      EXPECT_EQ(result.status, kWrongCall) << words;
      EXPECT_THAT(result.err,
                  AllOf(HasSubstr("a.db: these cannot be measurements"), HasSubstr(words)));
    }
    EXPECT_FALSE(fs::exists(scratch / "model"));
    EXPECT_FALSE(fs::exists(scratch / "model.fits"));
    fs::remove(scratch / "a.db");
  }

  const std::string surface = demo_data() / "sheet/surface.ply";
  ScratchFolder scratch;
};

TEST_F(Measurements, WithTheWrongSignUnitOrGroupAreRefusedInPlainWords) {
  probing::Acquisition reversed = sheet();
  for (probing::Sample& sample : reversed.samples) sample.force *= -1;
  expect_refused(reversed, "of the object on the tool");
  probing::Acquisition inwards = sheet();
  for (probing::Contact& contact : inwards.contacts) contact.normal *= -1;
  expect_refused(inwards, "the normals point into the object");
  probing::Acquisition one_group = sheet();
  for (probing::Sample& sample : one_group.samples) sample.group = 0;
  expect_refused(one_group, "share their normal force");
  probing::Acquisition metres = sheet();
  for (probing::Sample& sample : metres.samples) {
    sample.a /= 1000;
    sample.b /= 1000;
  }
  expect_refused(metres, "as in m beside contacts in mm");
  probing::Acquisition slips = sheet();
  for (probing::Sample& sample : slips.samples) {
    sample.slipped = !sample.slipped;
    sample.on_friction_boundary = false;
  }
  expect_refused(slips, "samples that slipped have smaller tangential forces");
}

TEST_F(Measurements, ThatAreOnlySuspiciousAreImportedWithWarnings) {
  probing::Acquisition acquisition = sheet();
  for (probing::Sample& sample : acquisition.samples) sample.force *= 1000;
  acquisition.contacts[2].normal *= -1;
  write_csv(acquisition);
  const CommandResult result = import_csv({"--json"});
  EXPECT_EQ(result.status, kDone) << result.err;
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("suspicious"), HasSubstr("(contact 2)"), HasSubstr("--force-unit")));
  const json warnings = json::parse(result.out).at("warnings");
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_EQ(warnings[0].at("kind"), "normals_inwards");
  EXPECT_EQ(warnings[1].at("kind"), "force_scale");
  EXPECT_THAT(warnings[1].at("message").get<std::string>(), HasSubstr("the largest force is"));
}

TEST_F(Measurements, ThatAreRightGiveNoWarning) {
  write_csv(sheet());
  const CommandResult imported = import_csv({"--json"});
  EXPECT_THAT(imported.err, IsEmpty());
  EXPECT_THAT(json::parse(imported.out).at("warnings"), IsEmpty());
  const CommandResult fitted = fit({"--json"});
  EXPECT_EQ(fitted.status, kDone) << fitted.err;
  const json figures = json::parse(fitted.out);
  EXPECT_THAT(figures.at("warnings"), IsEmpty());
  EXPECT_THAT(figures.at("left_out"), IsEmpty());
  EXPECT_GT(figures.at("explained"), 0.95);
}

TEST_F(Measurements, OfOtherProgramsAreReadWithTheirNamesSeparatorAndUnits) {
  const probing::Acquisition acquisition = sheet();
  write_csv(acquisition);
  ASSERT_EQ(import_csv().status, kDone);
  const probing::CheckedAcquisition expected = probing::read_acquisition(scratch.path() / "a.db");

  probing::Acquisition other = acquisition;
  for (probing::Contact& contact : other.contacts) contact.position /= 1000;
  for (probing::Sample& sample : other.samples) {
    sample.a /= 1000;
    sample.b /= 1000;
    sample.force *= 1000;
  }
  write_csv(other);
  for (const char* const name : {"c.csv", "s.csv"}) {
    std::string text = read_text(scratch / name);
    std::ranges::replace(text, ',', ';');
    for (const auto& [ours, theirs] :
         std::vector<std::pair<std::string, std::string>>{{";px;py;pz;", ";Fx;F y;Fz;"}}) {
      const std::size_t at = text.find(ours);
      if (at != std::string::npos) text.replace(at, ours.size(), theirs);
    }
    write_text(scratch / name, text);
  }
  const CommandResult plain = import_csv();
  EXPECT_EQ(plain.status, kWrongCall);
  EXPECT_THAT(plain.err, AllOf(HasSubstr("no column 'px'"), HasSubstr("--map px=NAME"),
                               Not(HasSubstr("no column 'id'"))));
  for (const std::vector<std::string>& separator :
       std::vector<std::vector<std::string>>{{}, {"--separator", ";"}}) {
    std::vector<std::string> options = {"--map", "px=Fx, py=F y, pz = Fz", "--length-unit",
                                        "m",     "--force-unit",           "mN"};
    options.insert(options.end(), separator.begin(), separator.end());
    const CommandResult result = import_csv(options);
    ASSERT_EQ(result.status, kDone) << result.err;
    EXPECT_THAT(result.err, IsEmpty());
    const probing::CheckedAcquisition found = probing::read_acquisition(scratch.path() / "a.db");
    ASSERT_EQ(found.samples().size(), expected.samples().size());
    for (std::size_t i = 0; i < found.samples().size(); ++i) {
      const probing::Sample &l = found.samples()[i], &r = expected.samples()[i];
      EXPECT_LT((l.force - r.force).norm() + (l.a - r.a).norm() + (l.b - r.b).norm(), 1e-9);
      EXPECT_EQ(l.group, r.group);
    }
  }
}

TEST_F(Measurements, OfForcesOnTheToolAreReadWithTheirSignsChanged) {
  const probing::Acquisition acquisition = sheet();
  probing::Acquisition reversed = acquisition;
  for (probing::Sample& sample : reversed.samples) sample.force = -sample.force;
  write_csv(reversed);
  EXPECT_THAT(import_csv().err, HasSubstr("--forces-on tool"));
  const CommandResult result = import_csv({"--forces-on", "tool"});
  ASSERT_EQ(result.status, kDone) << result.err;
  EXPECT_EQ(probing::fingerprint(probing::read_acquisition(scratch.path() / "a.db").records()),
            probing::fingerprint(acquisition));
}

std::string replaced(std::string text, const std::string& old, const std::string& now) {
  for (std::size_t at = text.find(old); at != std::string::npos;
       at = text.find(old, at + now.size()))
    text.replace(at, old.size(), now);
  return text;
}

TEST_F(Measurements, OfASpreadsheetWithDecimalCommasOrOfALoggerWithoutNamesAreRead) {
  const probing::Acquisition acquisition = sheet();
  const auto expect_read = [&](const CommandResult& result) {
    ASSERT_EQ(result.status, kDone) << result.err;
    EXPECT_EQ(probing::fingerprint(probing::read_acquisition(scratch.path() / "a.db").records()),
              probing::fingerprint(acquisition));
  };
  write_csv(acquisition);
  const std::string contacts = read_text(scratch / "c.csv"), samples = read_text(scratch / "s.csv");
  const auto spreadsheet = [](std::string text) {
    text = replaced(replaced(replaced(text, ",", ";"), ".", ","), "\n", "\r\n");
    return "\xEF\xBB\xBF\"id\"" + text.substr(2) + "\r\n";
  };
  write_text(scratch / "c.csv", spreadsheet(contacts));
  write_text(scratch / "s.csv", spreadsheet(samples));
  EXPECT_THAT(import_csv().err,
              AllOf(HasSubstr("c.csv: line 2, column 'z'"), HasSubstr("--decimal comma")));
  expect_read(import_csv({"--decimal", "comma"}));

  const auto nameless = [](const std::string& text) { return text.substr(text.find('\n') + 1); };
  write_text(scratch / "c.csv", nameless(contacts));
  write_text(scratch / "s.csv", nameless(samples));
  EXPECT_THAT(import_csv().err, AllOf(HasSubstr("c.csv: line 1"), HasSubstr("numbers only"),
                                      HasSubstr("header: false")));
  expect_read(import_csv(
      {"--no-header", "--map",
       "contacts.id=column_1,x=column_2,y=column_3,z=column_4,nx=column_5,ny=column_6,nz=column_7",
       "--map",
       "samples.id=column_1,contact=column_2,group_id=column_3,px=column_4,py=column_5,pz=column_6,"
       "ax=column_7,ay=column_8,az=column_9,bx=column_10,by=column_11,bz=column_12",
       "--map",
       "on_friction_boundary=column_13,slipped=column_14,range_map=column_15,time=column_16"}));
}

TEST_F(Measurements, WhoseFilesCannotBeReadAreRefusedWithWhatWouldBeRight) {
  write_csv(sheet());
  const std::string contacts = read_text(scratch / "c.csv"), samples = read_text(scratch / "s.csv");
  const std::size_t second = samples.find('\n') + 1;
  const auto with_cell = [&](const std::string& cell) {  // id of the first sample
    return samples.substr(0, second) + cell + samples.substr(samples.find(',', second));
  };
  for (const auto& [text, words] : std::vector<std::tuple<std::string, std::string>>{
           {std::string("PK\3\4\24\0\6\0", 8),
            "s.csv: is a workbook (.xlsx, .ods) or a zip archive"},
           {std::string("\xFF\xFEi\0d\0", 6), "s.csv: is text in UTF-16; save it as UTF-8"},
           {replaced(samples, "pz", "pz (mN)"),
            "s.csv: line 1: there is no column 'pz', but 'pz (mN)'"},
           {replaced(samples, ",by,", ",ax,"), "s.csv: line 1: column 'ax' is there twice"},
           {with_cell("1.5"), "s.csv: line 2, column 'id': found '1.5', expected a whole number"},
           {replaced(samples, "\n1,", "\n1,NaN,"), "s.csv: line 3: 17 cells"}}) {
    write_text(scratch / "s.csv", text);
    const CommandResult result = import_csv();
    EXPECT_EQ(result.status, kWrongCall) << words;
    EXPECT_THAT(result.err, HasSubstr(words));
    EXPECT_FALSE(fs::exists(scratch / "a.db"));
  }
  // A unit in a name that is given must be the unit in use.
  write_text(scratch / "s.csv", replaced(samples, "pz", "Fz (mN)"));
  EXPECT_THAT(import_csv({"--map", "pz=Fz (mN)"}).err,
              AllOf(HasSubstr("--map: 'pz' is the column 'Fz (mN)'"), HasSubstr("--force-unit")));
}

TEST_F(Measurements, RefuseImportOptionsThatAreWrong) {
  write_csv(sheet());
  for (const auto& [option, value, words] :
       std::vector<std::tuple<std::string, std::string, std::string>>{
           {"--map", "px", "pairs such as px=Fx"},
           {"--map", "force=Fx", "--map: there is no column 'force'"},
           {"--map", "px=Fx", "no column 'Fx' (for px)"},
           {"--map", "samples.id=Nr", "--map contacts.id=NAME or samples.id=NAME"},
           {"--separator", "::", "one character"},
           {"--separator", "|", "Give the separator"},
           {"--forces-on", "hand", "object or tool"},
           {"--length-unit", "ell", "um, mm, cm, m or in"},
           {"--decimal", "dot", "point or comma"},
           {"--time-unit", "h", "s, ms, us or min"},
           {"--force-unit", "dyn", "N, mN, kN, g, kg or lbf"}}) {
    const CommandResult result = import_csv({option, value});
    EXPECT_EQ(result.status, kWrongCall) << option << ' ' << value;
    EXPECT_THAT(result.err, HasSubstr(words)) << option;
    EXPECT_FALSE(fs::exists(scratch / "a.db"));
  }
}

TEST_F(Measurements, OfWhichSomeContactsDoNotFitTheSurfaceAreFittedWithoutThem) {
  probing::Acquisition acquisition = sheet();
  acquisition.contacts[3].normal *= -1;
  const Eigen::Vector3d off = 12 * acquisition.contacts[5].normal;
  acquisition.contacts[5].position += off;
  for (probing::Sample& sample : acquisition.samples) {
    if (sample.contact != acquisition.contacts[5].id) continue;
    sample.a += off;
    sample.b += off;
  }
  write_store(acquisition);
  const CommandResult refused = fit();
  EXPECT_EQ(refused.status, kWrongCall);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("contact 3 has a normal that points into the surface"),
                                 HasSubstr("--max-left-out of 2"), Not(HasSubstr("BuildOptions")),
                                 Not(HasSubstr("build_model"))));
  EXPECT_FALSE(fs::exists(scratch / "model"));
  const CommandResult result = fit({"--max-left-out", "2", "--json"});
  EXPECT_EQ(result.status, kDone) << result.err;
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("contact 3 is left out"), HasSubstr("contact 5 is left out")));
  const json figures = json::parse(result.out);
  EXPECT_EQ(figures.at("contacts"), 10);
  EXPECT_EQ(figures.at("left_out")[1].at("contact"), 5);
  // Or it is allowed to be far away.
  acquisition.contacts[3].normal *= -1;
  write_store(acquisition);
  const CommandResult far = fit();
  EXPECT_THAT(far.err, HasSubstr("--max-distance"));
  EXPECT_EQ(fit({"--max-distance", "15"}).status, kDone);
}

TEST_F(Measurements, WhoseSlipsContradictTheFrictionOrWhoseForcesAreUnexplainedAreToldSo) {
  probing::Acquisition acquisition = sheet();
  // A fifth of the marks are wrong.
  for (probing::Sample& sample : acquisition.samples) {
    sample.on_friction_boundary = false;
    if (sample.id * 7 % 10 < 2) sample.slipped = !sample.slipped;
  }
  // Tangential displacements that alternate between along and against the force.
  for (std::size_t i = 0; i < acquisition.samples.size(); ++i) {
    probing::Sample& sample = acquisition.samples[i];
    const Eigen::Vector3d way = (sample.b - sample.a) * (i % 3 == 0 ? -3.0 : 3.0);
    if (!sample.slipped) sample.b = sample.a + way;
  }
  write_store(acquisition);
  const CommandResult result = fit({"--json"});
  EXPECT_EQ(result.status, kDone) << result.err;
  std::vector<std::string> kinds;
  const json figures = json::parse(result.out);
  for (const json& warning : figures.at("warnings")) kinds.push_back(warning.at("kind"));
  EXPECT_THAT(kinds, ::testing::IsSupersetOf({"friction_contradicted", "poorly_explained"}));
}

TEST_F(Measurements, AreFittedWithFindingsInPlainWords) {
  probing::Acquisition acquisition = sheet();
  std::erase_if(acquisition.samples, [](const auto& sample) { return sample.slipped; });
  write_store(acquisition);
  const std::vector<std::string> few_bases = {"--max-bases", "1", "--passive", "local"};
  const CommandResult prose = fit(few_bases);
  EXPECT_EQ(prose.status, kDone) << prose.err;
  EXPECT_THAT(prose.err, AllOf(HasSubstr("no sample slipped"), Not(HasSubstr("never_slipped"))));
  for (const char* const code :
       {"unexplained", "no_gain", "max_bases", "not_converged", "not_needed", "convex,"})
    EXPECT_THAT(prose.out + prose.err, Not(HasSubstr(code)));
  const json figures = json::parse(fit({"--json"}).out);
  EXPECT_EQ(figures.at("per_contact")[0].at("friction_stop"), "never_slipped");
}

TEST_F(Measurements, ArePlayedWithoutNan) {
  write_store(sheet());
  ASSERT_EQ(fit({"--probe-radius", "4"}).status, kDone);
  EXPECT_EQ(json::parse(run_palpate({"info", scratch / "model", "--json"}).out).at("probe_radius"),
            4);
  write_text(scratch / "t.csv", "t,x,y,z\n0,0,0,100\n0.001,0,0,101\n");
  const CommandResult prose =
      run_palpate({"play", scratch / "model", "--trajectory", scratch / "t.csv"});
  EXPECT_EQ(prose.status, kDone);
  EXPECT_THAT(prose.out, AllOf(HasSubstr("no step slipped"), Not(HasSubstr("nan"))));
  EXPECT_THAT(prose.err, HasSubstr("never touches the model"));
  const CommandResult figures =
      run_palpate({"play", scratch / "model", "--trajectory", scratch / "t.csv", "--json"});
  EXPECT_TRUE(json::parse(figures.out).at("us_per_step").at("slip_median").is_null());
}

TEST_F(Measurements, OfThePageAreImportedAndFitted) {
  const std::vector<std::string> blocks = code_blocks("docs/measurements.md", "csv");
  ASSERT_EQ(blocks.size(), 2u);
  write_text(scratch / "c.csv", blocks[0]);
  write_text(scratch / "s.csv", blocks[1]);
  const CommandResult result = import_csv({"--probe-radius", "2.5"});
  EXPECT_EQ(result.status, kDone);
  EXPECT_THAT(result.err, IsEmpty());
  const probing::CheckedAcquisition read = probing::read_acquisition(scratch.path() / "a.db");
  // The stiffnesses and the friction that the page states.
  for (const probing::Sample& sample : read.samples()) {
    const probing::Contact& contact = read.contacts()[*read.find(sample.contact)];
    EXPECT_NEAR(sample.force.z(), 0.5 * (sample.a - contact.position).z(), 1e-9);
    EXPECT_EQ(sample.slipped, sample.force.x() > 0.6 * sample.force.z());
    if (!sample.slipped) {
      EXPECT_NEAR(sample.force.x(), 0.4 * (sample.b - sample.a).x(), 1e-9);
    }
  }
  geometry::TriangleMesh plate;
  plate.vertices.resize(3, 4);
  plate.vertices.row(0) << -50, 100, 100, -50;
  plate.vertices.row(1) << -50, -50, 100, 100;
  plate.vertices.row(2).setConstant(700);
  plate.triangles.resize(3, 2);
  plate.triangles.col(0) << 0, 2, 1;
  plate.triangles.col(1) << 0, 3, 2;
  geometry::write_mesh(scratch.path() / "plate.ply", plate);
  std::vector<std::string> call{"fit", scratch / "a.db", scratch / "plate.ply", "-o",
                                scratch / "model"};
  EXPECT_EQ(run_palpate(call).status, kDone);
  EXPECT_THAT(run_palpate({"info", scratch / "model"}).out,
              HasSubstr("measured with a ball of 2.5 mm radius"));
  call.insert(call.end(), {"--probe-radius", "3"});
  EXPECT_THAT(run_palpate(call).err,
              HasSubstr("--probe-radius: is 3 mm; the measurements say 2.5 mm"));
}

TEST_F(Measurements, OfPressingAloneAreImportedAsThePageSays) {
  // The call of the page whose columns are those of the contacts and the presses only.
  const std::vector<std::string> calls = code_blocks("docs/measurements.md", "sh");
  const auto found = std::ranges::find_if(
      calls, [](const std::string& each) { return each.find("group_id=id") != std::string::npos; });
  ASSERT_NE(found, calls.end());
  const std::string& call = *found;
  const std::size_t at = call.find("--map ") + 6;
  const std::string map = call.substr(at, call.find('\n', at) - at);
  write_text(scratch / "c.csv", "id,x,y,z,nx,ny,nz\n4,0,0,700,0,0,-1\n5,9,0,700,0,0,-1\n");
  write_text(scratch / "s.csv",
             "id,contact,px,py,pz,ax,ay,az\n0,4,0,0,1,0,0,702\n1,4,0,0,2,0,0,704\n"
             "2,5,0,0,1,9,0,702\n");
  const CommandResult result = import_csv({"--map", map});
  EXPECT_EQ(result.status, kDone) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
  const probing::CheckedAcquisition read = probing::read_acquisition(scratch.path() / "a.db");
  ASSERT_EQ(read.samples().size(), 3u);
  EXPECT_EQ(read.samples()[1].group, 1);
  EXPECT_EQ(read.samples()[1].b, Eigen::Vector3d(0, 0, 704));
}

}  // namespace
}  // namespace palpate::apps
