// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <matio.h>

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

// MAT files written by libmatio, as other programs write them.
namespace palpate::support {

struct MatVariableDelete {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using MatVariable = std::unique_ptr<matvar_t, MatVariableDelete>;

inline MatVariable mat_variable(const std::string& name, Eigen::MatrixXd values) {
  std::size_t size[] = {static_cast<std::size_t>(values.rows()),
                        static_cast<std::size_t>(values.cols())};
  return MatVariable(
      Mat_VarCreate(name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size, values.data(), 0));
}

/// A structure; it takes its fields over.
inline MatVariable mat_structure(const std::string& name, std::vector<MatVariable> fields) {
  std::vector<const char*> names;
  names.reserve(fields.size());
  for (const MatVariable& field : fields) names.push_back(field->name);
  std::size_t size[] = {1, 1};
  MatVariable result(Mat_VarCreateStruct(name.c_str(), 2, size, names.data(),
                                         static_cast<unsigned>(names.size())));
  for (MatVariable& field : fields) {
    const std::string field_name = field->name;
    Mat_VarSetStructFieldByName(result.get(), field_name.c_str(), 0, field.release());
  }
  return result;
}

inline void write_mat(const std::filesystem::path& path, const std::vector<MatVariable>& variables,
                      matio_compression compression = MAT_COMPRESSION_ZLIB,
                      mat_ft version = MAT_FT_MAT5) {
  mat_t* const file = Mat_CreateVer(path.c_str(), nullptr, version);
  if (file == nullptr) throw std::runtime_error("cannot write " + path.string());
  bool written = true;
  for (const MatVariable& variable : variables)
    written = Mat_VarWrite(file, variable.get(), compression) == 0 && written;
  if (Mat_Close(file) != 0 || !written) throw std::runtime_error("cannot write " + path.string());
}

template <typename... Variables>
std::vector<MatVariable> mat_variables(Variables... variables) {
  std::vector<MatVariable> result;
  (result.push_back(std::move(variables)), ...);
  return result;
}

}  // namespace palpate::support
