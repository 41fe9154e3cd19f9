// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Meshes, clouds and range maps are read from pipes as from files.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "file_testing.h"
#include "files/ending.h"
#include "files/random_mesh_file.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/point_file.h"
#include "palpate/geometry/range_map.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

namespace fs = std::filesystem;

/// A named pipe through which a file comes once.
class Pipe {
 public:
  Pipe(fs::path path, const fs::path& file) : path_(std::move(path)) {
    if (::mkfifo(path_.c_str(), 0600) != 0) throw std::runtime_error("no pipe");
    writer_ = std::thread(
        [this, content = read_text(file)] { std::ofstream(path_, std::ios::binary) << content; });
  }
  ~Pipe() {
    writer_.join();
    fs::remove(path_);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
  std::thread writer_;
};

MeshFile bumps() {
  MeshFile file;
  // Larger than the buffer of a pipe; the coordinates are those of a float, as STL has them.
  file.mesh = test::height_field(70, 60, 0.5, [](double x, double y) { return x * y / 64; });
  return file;
}

TEST(Pipes, MeshesComeThroughWithAndWithoutAnEnding) {
  const ScratchFolder folder;
  std::vector<std::string> files = {"a.ply", "a.obj", "a.stl", "a.glb"};
  for (const std::string& name : files) write_mesh_file(folder / name, bumps());
  write_mesh_file(folder / "b.stl", bumps(), {.encoding = Encoding::text});
  write_mesh_file(folder / "b.ply", bumps(), {.encoding = Encoding::text});
  write_text(folder / "a.off", "# a triangle\nOFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  files.insert(files.end(), {"b.stl", "b.ply", "a.off"});
  for (const std::string& name : files) {
    const MeshFile expected = read_mesh_file(folder / name);
    for (const std::string& pipe_name :
         {"pipe" + fs::path(name).extension().string(), std::string("pipe")}) {
      const Pipe pipe(folder / pipe_name, folder / name);
      expect_same(read_mesh_file(pipe.path()), expected);
    }
  }
}

TEST(Pipes, PointsAndRangeMapsComeThrough) {
  const ScratchFolder folder;
  PointCloud cloud;
  cloud.points = bumps().mesh.vertices;
  cloud.width = cloud.points.cols();
  for (const char* name : {"a.pcd", "a.ply"}) {
    write_point_cloud(folder / name, cloud);
    {
      const Pipe pipe(folder / "pipe", folder / name);
      EXPECT_EQ(read_points(pipe.path()), cloud.points);
    }
    const Pipe pipe(folder / "pipe", folder / name);
    EXPECT_TRUE(std::holds_alternative<PointCloud>(read_mesh_or_points(pipe.path())));
  }
  ImageF z(200, 100);
  for (Eigen::Index i = 0; i < z.size(); ++i) z.data()[i] = 500.0F + static_cast<float>(i);
  write_depth_tiff(folder / "a.tiff", z);
  {
    const Pipe pipe(folder / "pipe.tiff", folder / "a.tiff");
    EXPECT_TRUE((read_depth_tiff(pipe.path()) == z).all());
  }
  write_text(folder / "cut.tiff", read_text(folder / "a.tiff").substr(0, 40000));
  const Pipe pipe(folder / "pipe.tiff", folder / "cut.tiff");
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_depth_tiff(pipe.path())), FileError, "pipe.tiff: ");
}

TEST(Pipes, RefuseWhatIsNothingOrOfNoFormat) {
  const ScratchFolder folder;
  write_text(folder / "letter", "to a friend\n");
  write_text(folder / "nothing", "");
  {
    const Pipe pipe(folder / "pipe", folder / "letter");
    EXPECT_THROWS_MESSAGE(static_cast<void>(read_mesh(pipe.path())), FileError,
                          "is not that of a mesh");
  }
  const Pipe pipe(folder / "pipe", folder / "nothing");
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_mesh(pipe.path())), FileError, "nothing came");
  EXPECT_THROWS_MESSAGE(static_cast<void>(read_mesh("/dev/null")), FileError,
                        "neither a file nor a pipe");
}

TEST(Ending, IsToldByTheContent) {
  EXPECT_EQ(ending_by_content("ply\nformat"), ".ply");
  EXPECT_EQ(ending_by_content("# of a scanner\n\nmtllib a.mtl\nv 0 0 0\n"), ".obj");
  EXPECT_EQ(ending_by_content("# .PCD v0.7\nVERSION 0.7\n"), ".pcd");
  EXPECT_EQ(ending_by_content("COFF\n3 1 0\n"), ".off");
  EXPECT_EQ(ending_by_content("solid of words\n"), ".stl");
  // 80 bytes of any header, no triangles.
  EXPECT_EQ(ending_by_content("solid" + std::string(79, '\0')), ".stl");
  EXPECT_EQ(ending_by_content("plywood\n"), "");
  EXPECT_EQ(ending_by_content(""), "");
}

}  // namespace
}  // namespace palpate::geometry
