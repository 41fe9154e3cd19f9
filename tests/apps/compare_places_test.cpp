// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// `palpate compare` doubts surfaces that cannot be two of one object.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "mesh_corpus.h"
#include "palpate/geometry/mesh_io.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ComparePlaces : public ::testing::Test {
 protected:
  CommandResult compare(const geometry::TriangleMesh& a, const geometry::TriangleMesh& b) {
    geometry::write_mesh(scratch / "a.ply", a);
    geometry::write_mesh(scratch / "b.ply", b);
    return run_palpate({"compare", scratch / "a.ply", scratch / "b.ply"});
  }

  geometry::TriangleMesh surface = geometry::test::bumpy(2000);
  ScratchFolder scratch;
};

TEST_F(ComparePlaces, OtherUnitsAndOtherFramesAreDoubted) {
  EXPECT_THAT(compare(surface, surface).err, Not(HasSubstr("same unit")));
  geometry::TriangleMesh metres = surface;
  metres.vertices /= 1000;
  EXPECT_THAT(compare(metres, surface).err, HasSubstr("same unit (--unit) and frame?"));
  EXPECT_THAT(compare(surface, metres).err, HasSubstr("same unit (--unit) and frame?"));
  geometry::TriangleMesh elsewhere = surface;
  elsewhere.vertices.row(2).array() += 5000;
  EXPECT_THAT(compare(elsewhere, surface).err, HasSubstr("mm apart or more"));
}

TEST_F(ComparePlaces, ASurfaceWithoutAreaIsNamed) {
  geometry::TriangleMesh line = surface;
  line.vertices.bottomRows(2).setZero();
  const CommandResult result = compare(line, surface);
  EXPECT_EQ(result.status, kWrongCall);
  EXPECT_THAT(result.err, HasSubstr("a.ply: its triangles have no area"));
}

}  // namespace
}  // namespace palpate::apps
