// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "input_checks.h"

#include "palpate/core/error.h"

namespace palpate::pictures {

void refuse_unless(bool holds, const char* what, const std::string& reason) {
  if (!holds) {
    throw InvalidInput(std::string(what) + ": " + reason);
  }
}

void check_image(const geometry::ImageF& image, const char* what) {
  refuse_unless(image.size() > 0, what, "is empty: an image of at least one pixel is needed");
  refuse_unless(image.isFinite().any(), what, "holds no finite value: there is nothing to draw");
}

void check_surface(const geometry::TriangleMesh& mesh, const char* what) {
  refuse_unless(mesh.triangles.cols() > 0, what, "has no triangle: there is nothing to draw");
  for (Eigen::Index triangle = 0; triangle < mesh.triangles.cols(); ++triangle) {
    for (const int vertex : mesh.triangles.col(triangle)) {
      const bool exists = vertex >= 0 && vertex < mesh.vertices.cols();
      if (exists && mesh.vertices.col(vertex).allFinite()) continue;
      const std::string place =
          "triangle " + std::to_string(triangle) + " names vertex " + std::to_string(vertex);
      refuse_unless(exists, what,
                    place + ": one of the " + std::to_string(mesh.vertices.cols()) + " is needed");
      refuse_unless(false, what, place + ", which is not finite");
    }
  }
}

void check_count(Eigen::Index got, Eigen::Index wanted, const char* what) {
  refuse_unless(
      got == wanted, what,
      "has " + std::to_string(got) + " entries where " + std::to_string(wanted) + " are needed");
}

void check_some_finite(const Eigen::Ref<const Eigen::MatrixXd>& values, const char* what) {
  refuse_unless(values.size() > 0, what, "is empty: there is nothing to draw");
  refuse_unless(values.array().isFinite().any(), what,
                "holds no finite value: there is nothing to draw");
}

}  // namespace palpate::pictures
