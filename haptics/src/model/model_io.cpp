// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/model_io.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <ostream>
#include <streambuf>
#include <string>

#include "model/field_document.h"
#include "model/field_document_format.h"
#include "model/surface_response_file.h"
#include "palpate/core/error.h"
#include "palpate/core/input_file.h"
#include "palpate/core/output_file.h"
#include "palpate/geometry/mesh_io.h"

namespace palpate::haptics {
namespace {

namespace fs = std::filesystem;

constexpr const char* kContacts = "contacts.ply";
constexpr const char* kDocument = "field.json";
constexpr const char* kBinaryDocument = "field.cbor";
constexpr const char* kDeformed = "deformed";
constexpr const char* kResponse = "response.bin";  // in kDeformed
// Vertex properties in surface.ply: the contacts that have influence there, and their weights.
constexpr std::array<const char*, 3> kContactNames = {"contact_0", "contact_1", "contact_2"};
constexpr std::array<const char*, 3> kWeightNames = {"weight_0", "weight_1", "weight_2"};

void write_surface(const fs::path& path, const Model& model) {
  const geometry::SurfaceWeights weights = vertex_weights(model);
  geometry::MeshFile file;
  file.mesh = model.surface;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::RowVectorXi contacts = weights.contacts.row(static_cast<Eigen::Index>(k));
    file.vertex_attributes.push_back(
        {kContactNames[k], std::vector<std::int32_t>(contacts.begin(), contacts.end()), {}});
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::RowVectorXd values = weights.weights.row(static_cast<Eigen::Index>(k));
    file.vertex_attributes.push_back(
        {kWeightNames[k], std::vector<double>(values.begin(), values.end()), {}});
  }
  geometry::write_mesh_file(path, file);
}

Eigen::VectorXd vertex_property(const fs::path& path, const geometry::MeshFile& file,
                                const char* name) {
  if (auto values = geometry::scalars(file.vertex_attributes, name)) return *std::move(values);
  throw FileError(path.string() + ": its vertices have no property " + name +
                  "; the vertices of a model's surface have the weights of the contacts");
}

geometry::SurfaceWeights read_weights(const fs::path& path, const geometry::MeshFile& file,
                                      const Model& model) {
  geometry::SurfaceWeights result;
  const auto highest = static_cast<double>(model.contacts.size()) - 1;
  result.contacts.resize(3, file.mesh.vertices.cols());
  result.weights.resize(3, file.mesh.vertices.cols());
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::VectorXd contacts = vertex_property(path, file, kContactNames[k]);
    for (Eigen::Index v = 0; v < contacts.size(); ++v) {
      if (contacts[v] >= -1 && contacts[v] <= highest && std::trunc(contacts[v]) == contacts[v])
        continue;
      throw FileError(path.string() + ": " + kContactNames[k] + " of vertex " + std::to_string(v) +
                      " is " + std::to_string(contacts[v]) + ", expected -1 (none) to " +
                      std::to_string(model.contacts.size() - 1));
    }
    const auto row = static_cast<Eigen::Index>(k);
    result.contacts.row(row) = contacts.transpose().cast<int>();
    result.weights.row(row) = vertex_property(path, file, kWeightNames[k]).transpose();
  }
  return result;
}

Model read_document(const fs::path& folder) {
  std::error_code error;
  fs::path path = folder / kDocument;
  const bool binary = !fs::exists(path, error);
  if (binary) path = folder / kBinaryDocument;
  if (!fs::is_regular_file(path, error)) {
    throw FileError(folder.string() + ": there is neither " + kDocument + " nor " +
                    kBinaryDocument + " in it; expected a model folder");
  }
  try {
    return read_field_document(read_input_file(path),
                               binary ? ModelEncoding::cbor : ModelEncoding::json);
  } catch (const FileError&) {
    throw;
  } catch (const InvalidInput& wrong) {
    throw FileError(path.string() + ": " + wrong.what());
  }
}

ModelEncoding usual_encoding(const Model& model) {
  return model.contacts.size() > kMaxJsonContacts ? ModelEncoding::cbor : ModelEncoding::json;
}

/// Counts what is written, and forgets it.
class CountedBytes : public std::streambuf {
 public:
  [[nodiscard]] std::streamsize count() const { return count_; }

 private:
  std::streamsize xsputn(const char* /*text*/, std::streamsize length) override {
    count_ += length;
    return length;
  }
  int_type overflow(int_type character) override {
    ++count_;
    return traits_type::not_eof(character);
  }

  std::streamsize count_ = 0;
};

}  // namespace

Model read_model(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw FileError(folder.string() + ": there is no such folder; expected a model folder with " +
                    kSurfaceFile + " and " + kDocument);
  }
  Model model = read_document(folder);
  const fs::path surface = folder / kSurfaceFile;
  geometry::MeshFile file = geometry::read_mesh_file(surface);
  model.surface_weights = read_weights(surface, file, model);
  model.surface = std::move(file.mesh);
  if (const fs::path response = folder / kDeformed / kResponse; fs::exists(response, error))
    model.response = read_surface_response(response);
  try {
    check_model(model);
  } catch (const InvalidInput& wrong) {
    throw FileError(folder.string() + ": " + wrong.what());
  }
  return model;
}

std::vector<fs::path> model_entries() {
  return {kSurfaceFile, kContacts, kDocument, kBinaryDocument, kDeformed};
}

void write_model(const fs::path& folder, const Model& model,
                 std::optional<ModelEncoding> encoding) {
  check_model(model);
  const ModelEncoding chosen = encoding.value_or(usual_encoding(model));
  write_folder(folder, model_entries(), [&](const fs::path& temporary) {
    write_surface(temporary / kSurfaceFile, model);
    // Redundant copy of the triangles in the document, for mesh viewers.
    if (model.triangles.cols() > 0) {
      geometry::write_mesh(temporary / kContacts, contact_mesh(model));
    }
    if (model.response) {
      fs::create_directory(temporary / kDeformed);
      write_surface_response(temporary / kDeformed / kResponse, *model.response);
    }
    const bool is_text = chosen == ModelEncoding::json;
    write_file(temporary / (is_text ? kDocument : kBinaryDocument),
               [&](std::ostream& out) { write_field_document(out, model, chosen); });
  });
}

double folder_size(const Model& model) {
  check_model(model);
  constexpr double kPlyHeader = 512, kFace = 1 + 3 * sizeof(std::int32_t);
  constexpr double kPlace = 3 * sizeof(double),
                   kWeights = 3 * (sizeof(std::int32_t) + sizeof(double));
  double size = kPlyHeader +
                (kPlace + kWeights) * static_cast<double>(model.surface.vertices.cols()) +
                kFace * static_cast<double>(model.surface.triangles.cols());
  if (model.triangles.cols() > 0)
    size += kPlyHeader + kPlace * static_cast<double>(model.contacts.size()) +
            kFace * static_cast<double>(model.triangles.cols());
  if (model.response) size += static_cast<double>(surface_response_size(*model.response));
  CountedBytes bytes;
  std::ostream out(&bytes);
  write_field_document(out, model, usual_encoding(model));
  return size + static_cast<double>(bytes.count());
}

void write_field_document(const fs::path& path, const Model& model, ModelEncoding encoding) {
  check_model(model);
  write_file(path, [&](std::ostream& out) { write_field_document(out, model, encoding); });
}

}  // namespace palpate::haptics
