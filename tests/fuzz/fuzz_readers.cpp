// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Feeds the reader that PALPATE_READER names with what libFuzzer makes of the files it is given. A
// reader may refuse a file with palpate::FileError or palpate::InvalidInput; anything else that
// leaves it ends the program, and so does a fault that a sanitizer sees, a file that takes too
// long, or one that takes too much memory.
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <string>

#include "palpate/error.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"

namespace {

namespace fs = std::filesystem;
using namespace palpate;

struct Reader {
  const char* extension;
  std::function<void(const fs::path&)> read;
};

void read_mesh(const fs::path& path) {
  (void)geometry::read_mesh_file(path, {.keep_defects = true});
}

const std::map<std::string, Reader>& readers() {
  static const std::map<std::string, Reader> all = {
      {"ply", {".ply", read_mesh}},
      {"obj", {".obj", read_mesh}},
      {"off", {".off", read_mesh}},
      {"stl", {".stl", read_mesh}},
      {"glb", {".glb", read_mesh}},
      {"pcd", {".pcd", [](const fs::path& path) { (void)geometry::read_point_cloud(path); }}},
      {"tiff", {".tiff", [](const fs::path& path) { (void)geometry::read_depth_tiff(path); }}},
      {"png", {".png", [](const fs::path& path) { (void)sensing::read_frame(path); }}},
      {"rig", {".yaml", [](const fs::path& path) { (void)sensing::read_rig(path); }}},
      {"pattern", {".yaml", [](const fs::path& path) { (void)sensing::read_pattern(path); }}},
  };
  return all;
}

const Reader& wanted_reader() {
  const char* name = std::getenv("PALPATE_READER");
  const auto found = name == nullptr ? readers().end() : readers().find(name);
  if (found != readers().end()) return found->second;
  std::fprintf(stderr, "PALPATE_READER must be one of:");
  for (const auto& [known, reader] : readers()) std::fprintf(stderr, " %s", known.c_str());
  std::fprintf(stderr, "\n");
  std::exit(2);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Reader& reader = wanted_reader();
  // In memory, if there is such a folder.
  static const fs::path file =
      (fs::exists("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path()) /
      ("palpate-fuzz-" + std::to_string(getpid()) + reader.extension);
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    reader.read(file);
  } catch (const FileError&) {
  } catch (const InvalidInput&) {
  }
  fs::remove(file);
  return 0;
}
