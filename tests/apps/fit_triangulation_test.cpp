// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate fit --triangulation`: the triangulation of the contacts of a model.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "palpate/geometry/contact_triangulation.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/probing/acquisition_csv.h"
#include "palpate/probing/acquisition_store.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

using geometry::ContactTriangulationMethod;
using nlohmann::json;

class FitTriangulation : public ::testing::Test {
 protected:
  /// All contacts of the sheet, whose triangles do not depend on their samples: a few are enough.
  void SetUp() override {
    probing::Acquisition sheet = probing::read_acquisition_csv(demo_data() / "sheet/contacts.csv",
                                                               demo_data() / "sheet/samples.csv")
                                     .records();
    constexpr int kEach = 12;
    int number = 0;
    std::erase_if(sheet.samples, [&](const auto&) { return ++number % kEach != 0; });
    probing::write_acquisition(scratch.path() / "a.db", sheet);
  }

  CommandResult fit(const std::vector<std::string>& more) const {
    std::vector<std::string> call = {"fit",       scratch / "a.db", surface, "--max-bases",    "1",
                                     "--passive", "local",          "-o",    scratch / "model"};
    call.insert(call.end(), more.begin(), more.end());
    return run_palpate(call);
  }

  // The triangles that the library makes from the contacts of a model.
  json triangles_of(const json& model, ContactTriangulationMethod method) const {
    const geometry::TriangleMesh mesh = geometry::read_mesh(surface);
    const geometry::SurfaceQuery query(mesh);
    std::vector<geometry::SurfacePoint> points;
    for (const json& contact : model.at("contacts")) {
      const std::vector<double> p = contact.at("position");
      points.push_back(query.closest_point({p[0], p[1], p[2]}).at);
    }
    const geometry::ContactTriangulation triangulation =
        geometry::triangulate_contacts(mesh, points, {.method = method});
    json result = json::array();
    for (const auto& t : triangulation.mesh.triangles.colwise())
      result.push_back({t[0], t[1], t[2]});
    return result;
  }

  /// Returns the triangles without their order, which has no meaning.
  static std::multiset<json> in_order(const json& triangles) {
    return {triangles.begin(), triangles.end()};
  }

  const std::string surface = demo_data() / "sheet/surface.ply";
  ScratchFolder scratch;
};

TEST_F(FitTriangulation, TakesTheMethodThatIsAskedForAndRecordsIt) {
  struct Case {
    std::vector<std::string> options;
    ContactTriangulationMethod method;
    std::string recorded;
  };
  std::vector<json> found;
  for (const Case& c : {Case{{}, ContactTriangulationMethod::delaunay, "delaunay"},
                        Case{{"--triangulation", "voronoi_dual"},
                             ContactTriangulationMethod::voronoi_dual,
                             "voronoi_dual"}}) {
    const CommandResult result = fit(c.options);
    ASSERT_EQ(result.status, 0) << result.err;
    const json model = json::parse(read_text(scratch / "model/field.json"));
    EXPECT_EQ(model.at("triangulation"), c.recorded);
    EXPECT_EQ(in_order(model.at("triangles")), in_order(triangles_of(model, c.method)))
        << c.recorded;
    found.push_back(model.at("triangles"));
  }
  EXPECT_NE(found[0], found[1]);
}

TEST_F(FitTriangulation, RefusesAnUnknownMethod) {
  const CommandResult result = fit({"--triangulation", "euclid"});
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("--triangulation"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace palpate::apps
