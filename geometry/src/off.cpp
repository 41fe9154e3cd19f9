// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "off.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "input_file.h"
#include "palpate/error.h"

namespace palpate::geometry {
namespace {

namespace fs = std::filesystem;

/// The lines of an OFF file without blank ones and comments.
class Lines {
 public:
  Lines(std::string_view content, std::string file)
      : content_(content), rest_(content), file_(std::move(file)) {}

  /// The next line that holds something; empty at the end of the file.
  std::string_view next() {
    while (!rest_.empty()) {
      offset_ = content_.size() - rest_.size();
      std::string_view line = next_line(rest_);
      line = line.substr(0, line.find('#'));
      std::string_view words = line;
      if (!next_word(words).empty()) return line;
    }
    return {};
  }

  /// The same where row `row` of `count` must be.
  std::string_view next_row(const char* what, std::uint64_t row, std::uint64_t count) {
    const std::string_view line = next();
    if (line.empty())
      throw FileError(file_ + ": holds " + std::to_string(row) + " of " + std::to_string(count) +
                      " " + what + "; it is truncated or its header is wrong");
    return line;
  }

  template <typename Number>
  Number number(std::string_view& words) const {
    const std::string_view word = next_word(words);
    const std::optional<Number> value = parse_number<Number>(word);
    if (!value) fail(quoted(word) + " is not a number of the kind that is needed here");
    return *value;
  }

  [[noreturn]] void fail(const std::string& reason) const {
    throw FileError(file_ + ": line " + std::to_string(line_number(content_, offset_)) + ": " +
                    reason);
  }

 private:
  std::string_view content_;
  std::string_view rest_;
  std::string file_;
  std::size_t offset_ = 0;
};

/// What stands behind the first word, or empty if the counts are on the next line. ST, C and N
/// announce what is skipped; 4 and n would change what a coordinate is.
std::string_view after_magic(Lines& lines, const std::string& file) {
  std::string_view line = lines.next();
  const std::string_view magic = next_word(line);
  const std::size_t prefix = magic.find("OFF");
  if (prefix == std::string_view::npos || magic.size() != prefix + 3 ||
      magic.substr(0, prefix).find_first_not_of("STCN") != std::string_view::npos)
    throw FileError(file + ": is not a text OFF file; its first word must be OFF, not " +
                    quoted(magic));
  return line;
}

}  // namespace

PolygonMesh read_off(const fs::path& path) {
  const std::string content = read_input_file(path);
  const std::string file = path.string();
  Lines lines(content, file);
  std::string_view counts = after_magic(lines, file);
  std::string_view words = counts;
  if (next_word(words).empty()) counts = lines.next_row("lines with counts", 0, 1);
  const auto vertices = lines.number<std::uint64_t>(counts);
  const auto faces = lines.number<std::uint64_t>(counts);

  PolygonMesh mesh;  // grows as the file is read: the counts may be wrong
  for (std::uint64_t row = 0; row < vertices; ++row) {
    std::string_view line = lines.next_row("vertices", row, vertices);
    Eigen::Vector3d vertex;
    for (double& coordinate : vertex) coordinate = lines.number<double>(line);
    mesh.vertices.push_back(vertex);
  }
  for (std::uint64_t row = 0; row < faces; ++row) {
    std::string_view line = lines.next_row("faces", row, faces);
    const auto size = lines.number<std::uint32_t>(line);
    if (size > line.size()) lines.fail("a face of " + std::to_string(size) + " corners ends early");
    for (std::uint32_t corner = 0; corner < size; ++corner)
      mesh.corners.push_back(lines.number<std::int32_t>(line));
    mesh.sizes.push_back(static_cast<int>(size));
  }
  return mesh;
}

}  // namespace palpate::geometry
