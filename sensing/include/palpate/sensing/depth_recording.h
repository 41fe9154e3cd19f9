// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace palpate::sensing {

/// [mm] Length of one unit of the depth images of such a recording: 5000 units are a metre.
inline constexpr double kRecordingUnit = 0.2;

/// [s] A colour image belongs to a depth image if it was taken at most this long before or after.
inline constexpr double kColorDelay = 0.02;

/// A depth image of a recording, and the colour image that belongs to it.
struct RecordedDepth {
  double time = 0;                  ///< [s]
  std::filesystem::path depth;      ///< 16-bit PNG
  std::filesystem::path color;      ///< empty if none was taken within `kColorDelay`
  std::filesystem::path recording;  ///< the folder of depth.txt
};

/// Returns true if a folder is a recording of a depth camera in the layout of TUM's RGB-D
/// benchmark: `depth.txt` and `rgb.txt` list the images, mostly in `depth/` and `rgb/`.
[[nodiscard]] bool is_depth_recording(const std::filesystem::path& folder);

/// Lists the images of a recording by time. Each line of `depth.txt` and `rgb.txt` has a time [s]
/// and the name of a file, which may have spaces; lines that begin with # are comments. `rgb.txt`
/// may be missing. The images themselves are not looked at.
/// \throws FileError naming the file and the line if there is no depth image, a line has another
/// form, or a time occurs twice.
[[nodiscard]] std::vector<RecordedDepth> read_depth_recording(const std::filesystem::path& folder);

/// Recordings whose lists are read once. Threads may use an object at the same time.
class DepthRecordings {
 public:
  /// As `read_depth_recording`.
  [[nodiscard]] std::vector<RecordedDepth> read(const std::filesystem::path& folder);

  /// The entry of a depth image in the recording that lists it: that of its folder, or of the
  /// folder above. None if neither lists this very file; a `depth.txt` of another form does not
  /// count.
  [[nodiscard]] std::optional<RecordedDepth> find(const std::filesystem::path& depth_image);

 private:
  struct Listed {
    std::vector<RecordedDepth> frames;
    std::string error;  ///< if they could not be read
  };
  /// The reference stays valid.
  const Listed& listed(const std::filesystem::path& folder);

  std::mutex mutex_;
  std::map<std::filesystem::path, Listed> by_folder_;
};

}  // namespace palpate::sensing
