// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The code that docs/model-file.md shows, run by its own interpreters, against ours.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <iomanip>

#include "code_blocks.h"
#include "following_surface.h"
#include "model_testing.h"
#include "palpate/geometry/geodesic_distance.h"
#include "palpate/haptics/blended_field.h"
#include "palpate/haptics/contact_strength.h"
#include "palpate/haptics/deformed_shape.h"
#include "repository.h"
#include "sphere_model.h"

namespace palpate::haptics {
namespace {

namespace fs = std::filesystem;

const std::string kModelPage = "docs/model-file.md";

std::vector<std::string> blocks_of(const std::string& language) {
  std::vector<std::string> blocks = code_blocks(kModelPage, language);
  for (const std::string& block : blocks) {
    EXPECT_LE(std::ranges::count(block, '\n'), 12) << "lines are to be few";
  }
  return blocks;
}

TEST(ModelDocumentation, ShowsNoCodeInOtherLanguagesThanThoseThatTestsRun) {
  const std::string page = read_text(repository(kModelPage));
  std::size_t fences = 0;
  for (std::size_t at = 0; (at = page.find("```", at)) != std::string::npos; at += 3) ++fences;
  EXPECT_EQ(blocks_of("python").size(), 5u);
  EXPECT_EQ(blocks_of("javascript").size(), 2u);
  EXPECT_EQ(fences, 2 * (5u + 2u));
}

// Returns the output of a script; it stands in a folder that is its working directory.
std::string output_of(const std::string& interpreter, const fs::path& script) {
  const fs::path folder = script.parent_path();
  const std::string command = "cd '" + folder.string() + "' && " + interpreter + " '" +
                              script.string() + "' > output.txt 2> errors.txt";
  EXPECT_EQ(std::system(command.c_str()), 0) << read_text(folder / "errors.txt");
  return read_text(folder / "output.txt");
}

const std::string kPython = "'" PALPATE_PYTHON "' -B";

const std::vector<Eigen::Vector3d> kDisplacements = {
    {1.2, -0.7, 2.5}, {0.5, -0.2, 1.5}, {1e-3, 2e-3, -1e-3}, {40, 9, -30}};

// `printed`: after what the page's own example prints, the force of each contact at each of the
// displacements.
void expect_forces(const Model& model, const std::string& printed) {
  std::istringstream forces(printed);
  std::string example;
  std::getline(forces, example);
  EXPECT_EQ(example.front(), '[');
  for (const ContactModel& contact : model.contacts) {
    for (const Eigen::Vector3d& displacement : kDisplacements) {
      Eigen::Vector3d found;
      ASSERT_TRUE(forces >> found.x() >> found.y() >> found.z()) << printed;
      const Eigen::Vector3d expected =
          contact.frame * force(contact.field, contact.frame.transpose() * displacement);
      EXPECT_LE((found - expected).norm(), 1e-12 * expected.norm());
    }
  }
}

TEST(ModelDocumentation, PythonAloneComputesTheForcesOfContacts) {
  const ScratchFolder scratch;
  write_model(scratch / "model", some_model());
  write_text(scratch / "script.py",
             blocks_of("python").at(1) + blocks_of("python").at(2) +
                 "for contact in document['contacts']:\n"
                 "    for d in [[1.2, -0.7, 2.5], [0.5, -0.2, 1.5], [1e-3, 2e-3, -1e-3], "
                 "[40, 9, -30]]:\n"
                 "        print(*force(contact, d))\n");
  expect_forces(some_model(), output_of(kPython + " -I", scratch / "script.py"));
}

TEST(ModelDocumentation, PythonAloneComputesTheDeformedSurface) {
  const ScratchFolder scratch;
  FollowingSheet sheet;
  sheet.model.response = sheet.fit({.nodes = 60});
  write_model(scratch / "model", sheet.model);
  const Eigen::Vector3d place = sheet.model.contacts[2].position, displacement(1, -2, 6);
  const BlendedField field(sheet.model);
  const geometry::SurfacePoint at = field.surface().closest_point(place).at;
  const Eigen::VectorXd distances =
      geometry::geodesic_distance(sheet.model.surface, {&at, 1}).distance;
  std::ostringstream script;
  script << blocks_of("python").at(3) << blocks_of("python").at(4) << "distances = ["
         << std::setprecision(17);
  for (const double distance : distances) script << distance << ", ";
  script << "]\nfor move in [*moves(2, distances, [1, -2, 6]), *recorded(7, distances)]:\n"
         << "    print(*move)\n";
  write_text(scratch / "script.py", script.str());
  std::istringstream printed(output_of(kPython + " -I", scratch / "script.py"));
  const Eigen::Matrix3Xd shape = measured_shape(sheet.model.surface, *sheet.model.response,
                                                field.weights(at), at, displacement);
  int compared = 0;
  for (Eigen::Index v = 0; v < shape.cols(); ++v) {
    Eigen::Vector3d move;
    ASSERT_TRUE(printed >> move.x() >> move.y() >> move.z());
    if (distances[v] < 8) continue;  // within the dent that closes the gap
    EXPECT_LT((shape.col(v) - sheet.model.surface.vertices.col(v) - move).norm(), 1e-9) << v;
    ++compared;
  }
  EXPECT_GT(compared, 1000);
  ASSERT_EQ(sheet.model.response->shape_contacts[7], 2);
  const Eigen::Matrix3Xd kept = recorded_shape(sheet.model.surface, *sheet.model.response, at, 7);
  for (Eigen::Index v = 0; v < kept.cols(); ++v) {
    Eigen::Vector3d move;
    ASSERT_TRUE(printed >> move.x() >> move.y() >> move.z());
    EXPECT_LT((kept.col(v) - sheet.model.surface.vertices.col(v) - move).norm(), 1e-9) << v;
  }
}

TEST(ModelDocumentation, JavaScriptComputesTheForcesOfContacts) {
  const ScratchFolder scratch;
  write_model(scratch / "model", some_model());
  write_text(scratch / "script.js",
             blocks_of("javascript").at(0) + blocks_of("javascript").at(1) +
                 "for (const contact of model.contacts)\n"
                 "  for (const d of [[1.2, -0.7, 2.5], [0.5, -0.2, 1.5], [1e-3, 2e-3, -1e-3], "
                 "[40, 9, -30]])\n"
                 "    console.log(...force(contact, d));\n");
  expect_forces(some_model(), output_of("'" PALPATE_NODE "'", scratch / "script.js"));
}

// Contacts inside of triangles of the surface, three of them in one, on edges and at vertices; two
// of them in no triangle of contacts.
Model scattered_model() {
  Model model = uneven_model();
  const auto add = [&](double x, double y) {
    ContactModel contact = model.contacts[model.contacts.size() % 4];
    contact.id = 20 + static_cast<long long>(model.contacts.size());
    contact.position << x, y, 700;
    contact.friction_axis = Eigen::Vector3d(x / 100, 0.1, 1).normalized();
    model.contacts.push_back(contact);
  };
  add(-23.1, -14.7);
  add(3.4, 4.1);
  add(4.4, 3.7);
  add(2.2, 2.9);
  add(20, 13);
  add(-50, 26.5);
  std::vector<geometry::SurfacePoint> points;
  const geometry::SurfaceQuery query(model.surface);
  for (const ContactModel& contact : model.contacts)
    points.push_back(query.closest_point(contact.position).at);
  model.surface_weights = geometry::triangulate_contacts(model.surface, points).weights;
  return model;
}

const std::string kFindReader =
    "import sys\nsys.path.insert(0, '" + repository("docs").string() + "')\n";

// 1200 places in all: what docs/read_model.py says of `count` random places of the surface and
// displacements of some millimetres is what `BlendedField`, and so `Playback`, says.
void expect_same_everywhere(const Model& given, int count) {
  const ScratchFolder scratch;
  write_model(scratch / "model", given);
  const Model model = read_model(scratch / "model");
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  std::vector<Eigen::Vector3d> places, displacements;
  std::ostringstream queries;
  queries << std::setprecision(17);
  for (int i = 0; i < count; ++i) {
    const auto triangle = static_cast<Eigen::Index>(
        uniform(random) * static_cast<double>(model.surface.triangles.cols()));
    Eigen::Vector3d barycentric{-std::log(uniform(random)), -std::log(uniform(random)),
                                -std::log(uniform(random))};
    barycentric /= barycentric.sum();
    places.emplace_back(model.surface.vertices(Eigen::all, model.surface.triangles.col(triangle)) *
                        barycentric);
    displacements.push_back({3 * normal(random), 3 * normal(random), 3 * normal(random)});
    queries << places.back().transpose() << ' ' << displacements.back().transpose() << '\n';
  }
  write_text(scratch / "queries.txt", queries.str());
  write_text(scratch / "script.py", kFindReader +
                                        "import numpy\n"
                                        "from read_model import Model\n"
                                        "model = Model('model')\n"
                                        "for query in numpy.loadtxt('queries.txt'):\n"
                                        "    force, friction, cone, axis = "
                                        "model.evaluate(query[:3], query[3:])\n"
                                        "    print(*force, friction, *cone, *axis)\n");
  std::istringstream found(output_of(kPython + " -I", scratch / "script.py"));
  const BlendedField field(model);
  for (std::size_t i = 0; i < places.size(); ++i) {
    Eigen::Vector3d force, cone, axis;
    double friction = 0;
    ASSERT_TRUE(found >> force.x() >> force.y() >> force.z() >> friction >> cone.x() >> cone.y() >>
                cone.z() >> axis.x() >> axis.y() >> axis.z());
    const Blend at = field.blend(places[i]);
    constexpr double kForceTolerance = 1e-9;  // [N]
    EXPECT_LE((force - field.force(at, displacements[i])).norm(), kForceTolerance) << i;
    EXPECT_NEAR(friction, at.friction, 1e-9) << i;
    EXPECT_LE((cone - at.frame.col(2)).norm(), 1e-9) << i;
    EXPECT_LE((axis - at.friction_axis).norm(), 1e-9) << i;
  }
}

TEST(ModelDocumentation, TheExampleOfTheReaderRuns) {
  const ScratchFolder scratch;
  const Model model = with_compliances(uneven_model(), 2);
  write_model(scratch / "model", model);
  write_text(scratch / "script.py",
             kFindReader + blocks_of("python").at(0) + "print(*force, friction)\n");
  std::istringstream printed(output_of(kPython + " -I", scratch / "script.py"));
  Eigen::Vector3d force;
  double friction = 0;
  ASSERT_TRUE(printed >> force.x() >> force.y() >> force.z() >> friction);
  const BlendedField field(model);
  EXPECT_LE((force - field.force({3, 4, 700}, {0.2, -0.1, 1.5})).norm(), 1e-9);
  EXPECT_NEAR(friction, field.blend(Eigen::Vector3d(3, 4, 700)).friction, 1e-12);
}

Model twisted_ball(bool whole) {
  Model model = ball_model([&](const Eigen::Vector3d& place) { return whole || place.z() > -9; },
                           [](int i) { return 2.3 * i; }, 40, 3);
  for (ContactModel& contact : model.contacts) {
    contact.frame =
        contact.frame * rotation_exp({0.1, 0.05 * static_cast<double>(contact.id % 3), 0});
    contact.friction = 0.3 + 0.01 * static_cast<double>(contact.id);
  }
  return model;
}

TEST(ModelDocumentation, TheReaderHasAtMost80LinesAndNeedsOnlyNumpy) {
  const std::string reader = read_text(repository("docs/read_model.py"));
  EXPECT_LE(std::ranges::count(reader, '\n'), 80);
  EXPECT_NE(reader.find("\nimport json, re\nimport numpy as np\n\n"), std::string::npos);
  EXPECT_EQ(reader.find("import", reader.find("import numpy") + 1), std::string::npos);
}

TEST(ModelDocumentation, TheReaderSaysWhatPlaybackSaysOnAClosedSurface) {
  expect_same_everywhere(with_compliances(twisted_ball(true), 2), 400);
}

TEST(ModelDocumentation, TheReaderSaysWhatPlaybackSaysOnAnOpenSurface) {
  expect_same_everywhere(with_compliances(twisted_ball(false), 2), 200);
  expect_same_everywhere(some_model(), 100);  // one contact has no compliance
  expect_same_everywhere(with_compliances(scattered_model(), 2), 200);
}

TEST(ModelDocumentation, TheReaderSaysWhatPlaybackSaysWhereForcesAreBlended) {
  expect_same_everywhere(uneven_model(), 100);  // no contact has a strength
  expect_same_everywhere(with_strengths(uneven_model(), 2), 100);
  expect_same_everywhere(with_strengths(scattered_model(), 2), 200);
}

}  // namespace
}  // namespace palpate::haptics
