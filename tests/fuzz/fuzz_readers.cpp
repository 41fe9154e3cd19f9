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
#include <vector>

#include "fuzz_readers.h"
#include "palpate/core/error.h"
#include "palpate/devices/device_record.h"
#include "palpate/documents/document.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map.h"
#include "palpate/haptics/evaluate.h"
#include "palpate/haptics/loop_record.h"
#include "palpate/haptics/model_io.h"
#include "palpate/haptics/pose_path.h"
#include "palpate/haptics/scene_file.h"
#include "palpate/haptics/trajectory_file.h"
#include "palpate/probing/acquisition_csv.h"
#include "palpate/probing/acquisition_import.h"
#include "palpate/probing/acquisition_mapping.h"
#include "palpate/probing/acquisition_store.h"
#include "palpate/probing/arm_setup.h"
#include "palpate/probing/contact_plan.h"
#include "palpate/probing/finite_element_mesh.h"
#include "palpate/probing/specimen_file.h"
#include "palpate/sensing/camera_file.h"
#include "palpate/sensing/depth_image.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/frame_source.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/response.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/trained_colors.h"
#include "palpate/sensing/virtual_sensor.h"
#include "shared/project_file.h"

namespace {

namespace fs = std::filesystem;
using namespace palpate;

struct Reader {
  const char* file;  ///< name of what it reads, beside the files of PALPATE_FUZZ_MODEL
  std::function<void(const fs::path&)> read;
};

void read_mesh(const fs::path& path) {
  geometry::ReadOptions options;
  options.keep_defects = true;
  (void)geometry::read_mesh_file(path, options);
}

void read_video(const fs::path& path) {
  sensing::FrameSource source({path});
  while (source.next()) {
  }
}

void read_arm_record(const fs::path& path) {
  devices::ReplayDevice device(path);
  device.activate();
  device.begin_trial(0);
  devices::DeviceState state;
  while (device.read(state)) {
  }
}

void read_mat(const fs::path& path) {
  const probing::AcquisitionMapping mapping{.columns = {{"px", "F(:,1)"},
                                                        {"py", "F(:,2)"},
                                                        {"pz", "F(:,3)"},
                                                        {"ax", "data.A(:,1)"},
                                                        {"ay", "data.A(:,2)"},
                                                        {"az", "data.A(:,3)"}},
                                            .content = probing::RowContent::presses,
                                            .contacts = probing::ContactSource::place,
                                            .normals_from_forces = true};
  (void)probing::import_acquisition(std::vector{path}, mapping);
}

/// Shapes of the model whose document is the seed of the reader "field".
void read_shapes(const fs::path& path) {
  const fs::path model = path.parent_path().parent_path();
  fs::copy(PALPATE_FUZZ_SEEDS "/field/field.json", model, fs::copy_options::skip_existing);
  (void)haptics::read_model(model);
}

/// A reader of a path.
template <typename Result>
std::function<void(const fs::path&)> of(Result (*read)(const fs::path&)) {
  return [read](const fs::path& path) { (void)read(path); };
}

const std::map<std::string, Reader>& readers() {
  static const std::map<std::string, Reader> all = {
      {"ply", {"a.ply", read_mesh}},
      {"obj", {"a.obj", read_mesh}},
      {"off", {"a.off", read_mesh}},
      {"stl", {"a.stl", read_mesh}},
      {"glb", {"a.glb", read_mesh}},
      {"pcd", {"a.pcd", [](const fs::path& path) { (void)geometry::read_point_cloud(path); }}},
      {"tiff", {"a.tiff", of(geometry::read_depth_tiff)}},
      {"png", {"a.png", of(sensing::read_frame)}},
      {"depth",
       {"a.png",
        [](const fs::path& path) {
          constexpr double kMillimetre = 1;
          const geometry::Camera camera{
              .width = 8, .height = 6, .fx = 8, .fy = 8, .cx = 4, .cy = 3};
          (void)sensing::read_depth_image(path, kMillimetre, camera);
        }}},
      {"video", {"a.avi", read_video}},
      {"rig", {"a.yaml", of(sensing::read_rig)}},
      {"camera", {"a.json", of(sensing::read_camera_file)}},
      {"pattern", {"a.yaml", of(sensing::read_pattern)}},
      {"colors", {"a.yaml", of(sensing::read_trained_colors)}},
      {"response", {"a.yaml", of(sensing::read_response)}},
      {"sensor", {"a.yaml", of(sensing::read_virtual_sensor)}},
      {"contacts",
       {"a.csv",
        [](const fs::path& path) {
          (void)probing::read_acquisition_csv(path, path.parent_path() / "samples.csv");
        }}},
      {"samples",
       {"a.csv",
        [](const fs::path& path) {
          (void)probing::read_acquisition_csv(path.parent_path() / "contacts.csv", path);
        }}},
      {"mat", {"a.mat", read_mat}},
      {"database", {"a.db", of(probing::read_acquisition)}},
      {"mapping", {"a.yaml", of(probing::read_mapping)}},
      {"plan", {"a.json", of(probing::read_plan)}},
      {"gmsh", {"a.msh", of(probing::read_gmsh)}},
      {"specimen",
       {"a.json",
        [](const fs::path& path) {
          (void)probing::parse_specimen(documents::read_json_text(path), path.string());
        }}},
      {"arm",
       {"a.json",
        [](const fs::path& path) {
          (void)probing::parse_arm_setup(documents::read_json_text(path), path.string());
        }}},
      {"arm_record", {"a.arm", read_arm_record}},
      {"field",
       {"field.json", [](const fs::path& path) { (void)haptics::read_model(path.parent_path()); }}},
      {"cbor",
       {"field.cbor", [](const fs::path& path) { (void)haptics::read_model(path.parent_path()); }}},
      {"shapes", {"deformed/response.bin", read_shapes}},
      {"queries", {"a.csv", of(haptics::read_queries)}},
      {"trajectory", {"a.csv", of(haptics::read_trajectory_file)}},
      {"poses", {"a.csv", of(haptics::read_pose_path)}},
      {"record", {"a.bin", of(haptics::read_loop_record)}},
      {"scene", {"a.json", of(haptics::read_scene)}},
      {"project", {"a.yaml", of(apps::read_project)}},
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

/// A folder for a file, with the files that readers need besides; in memory, if there is such a
/// folder.
class Folder {
 public:
  explicit Folder(const char* file) {
    fs::create_directories((path_ / file).parent_path());
    fs::copy(PALPATE_FUZZ_MODEL, path_);
  }
  ~Folder() {
    std::error_code left;
    fs::remove_all(path_, left);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  fs::path operator/(const char* name) const { return path_ / name; }

 private:
  fs::path path_ = (fs::exists("/dev/shm") ? fs::path("/dev/shm") : fs::temp_directory_path()) /
                   std::to_string(getpid()).insert(0, "palpate-fuzz-");
};

}  // namespace

std::string refusal_of(const std::uint8_t* data, std::size_t size) {
  static const Reader& reader = wanted_reader();
  static const Folder folder(reader.file);
  static const fs::path file = folder / reader.file;
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    reader.read(file);
  } catch (const FileError& refusal) {
    return refusal.what();
  } catch (const InvalidInput& refusal) {
    return refusal.what();
  }
  return {};
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  (void)refusal_of(data, size);
  return 0;
}
