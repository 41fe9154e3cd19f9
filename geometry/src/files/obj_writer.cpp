// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "files/file_formats.h"
#include "files/file_unit.h"
#include "files/scalar_type.h"
#include "palpate/geometry/texture.h"

namespace palpate::geometry {
namespace {

template <typename Row>
void put(std::string& text, const char* keyword, const Row& numbers) {
  text += keyword;
  for (const double number : numbers) {
    text += ' ';
    append_digits(text, number);
  }
}

/// The texture lines of the file, each place once, and the line of each corner.
class TextureLines {
 public:
  explicit TextureLines(const CornerTexture& texture) {
    std::map<std::pair<double, double>, std::int64_t> known;
    for (Eigen::Index t = 0; t < texture.coordinates.cols(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector2d at = texture.coordinates.block<2, 1>(2 * k, t);
        if (!at.allFinite()) {
          lines_of_.push_back(0);
          continue;
        }
        const auto [place, is_new] =
            known.try_emplace({at.x(), at.y()}, static_cast<std::int64_t>(known.size()) + 1);
        lines_of_.push_back(place->second);
        if (!is_new) continue;
        put(text_, "vt", at);
        text_ += '\n';
      }
    }
  }

  [[nodiscard]] const std::string& text() const { return text_; }
  /// Line of a corner, counted from 1; 0 for none.
  [[nodiscard]] std::int64_t line(Eigen::Index triangle, int corner) const {
    return lines_of_[static_cast<std::size_t>(3 * triangle + corner)];
  }

 private:
  std::string text_;
  std::vector<std::int64_t> lines_of_;
};

/// `7`, `7/1`, `7/1/7` or `7//7`.
void put_corner(std::string& text, std::int64_t vertex, std::int64_t texture, bool has_normal) {
  text += ' ' + std::to_string(vertex);
  if (texture == 0 && !has_normal) return;
  text += '/';
  if (texture != 0) text += std::to_string(texture);
  if (has_normal) text += '/' + std::to_string(vertex);
}

}  // namespace

void write_obj(std::ostream& stream, const MeshFile& file) {
  std::string text = "# " + std::string(kUnitComment) + "\n";
  for (const std::string& comment : file.comments) text += "# " + comment + "\n";
  for (const std::string& name : file.material_files) text += "mtllib " + name + "\n";
  const std::optional<Eigen::Matrix4Xd> color = colors(file.vertex_attributes);
  const std::optional<Eigen::Matrix3Xd> normal = normals(file.vertex_attributes);
  const std::optional<CornerTexture> texture = corner_texture(file.triangle_attributes);
  const TriangleMesh& mesh = file.mesh;
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    put(text, "v", mesh.vertices.col(i));
    if (color) put(text, "", color->col(i).head<3>());
    text += '\n';
  }
  for (Eigen::Index i = 0; normal && i < normal->cols(); ++i) {
    put(text, "vn", normal->col(i));
    text += '\n';
  }
  std::optional<TextureLines> lines;
  if (texture) text += lines.emplace(*texture).text();
  const std::optional<Eigen::VectorXd> number = scalars(file.triangle_attributes, "texnumber");
  std::size_t material = file.materials.size();  // none yet
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    if (number && (*number)[t] >= 0 && (*number)[t] < static_cast<double>(file.materials.size()) &&
        material != static_cast<std::size_t>((*number)[t])) {
      material = static_cast<std::size_t>((*number)[t]);
      text += "usemtl " + file.materials[material] + "\n";
    }
    text += 'f';
    for (int k = 0; k < 3; ++k)
      put_corner(text, std::int64_t{mesh.triangles(k, t)} + 1, lines ? lines->line(t, k) : 0,
                 normal.has_value());
    text += '\n';
  }
  stream.write(text.data(), static_cast<std::streamsize>(text.size()));
}

}  // namespace palpate::geometry
