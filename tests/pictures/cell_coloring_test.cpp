// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "cell_coloring.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "picture_test_utils.h"

namespace palpate::pictures {
namespace {

constexpr int kCells = 60;

/// The nearest of some random places for each vertex of a square.
Eigen::VectorXi random_cells(const geometry::TriangleMesh& square, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0, 100);
  Eigen::Matrix3Xd seeds = Eigen::Matrix3Xd::Zero(3, kCells);
  for (Eigen::Index cell = 0; cell < kCells; ++cell) {
    seeds.col(cell) << place(random), place(random), 0;
  }
  Eigen::VectorXi labels(square.vertices.cols());
  for (Eigen::Index vertex = 0; vertex < labels.size(); ++vertex) {
    (seeds.colwise() - square.vertices.col(vertex)).colwise().norm().minCoeff(&labels(vertex));
  }
  return labels;
}

void expect_neighbours_differ(const geometry::TriangleMesh& mesh, const Eigen::VectorXi& labels,
                              const std::vector<int>& colors) {
  for (const auto& corners : mesh.triangles.colwise()) {
    for (int corner = 0; corner < 3; ++corner) {
      const int one = labels(corners(corner));
      const int other = labels(corners((corner + 1) % 3));
      if (one != other) {
        EXPECT_NE(colors[static_cast<std::size_t>(one)], colors[static_cast<std::size_t>(other)])
            << "cells " << one << " and " << other;
      }
    }
  }
}

TEST(ColorCells, NeighboursDifferWithSixColoursOnAPlane) {
  const geometry::TriangleMesh square = make_square({0, 0, 0}, 100, 80);
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Eigen::VectorXi labels = random_cells(square, seed);
    const std::vector<int> colors = color_cells(square.triangles, labels, kCells, 6);
    ASSERT_EQ(colors.size(), static_cast<std::size_t>(kCells));
    EXPECT_LT(*std::max_element(colors.begin(), colors.end()), 6);
    expect_neighbours_differ(square, labels, colors);
  }
}

TEST(ColorCells, UsesAllColoursAboutEqually) {
  const geometry::TriangleMesh square = make_square({0, 0, 0}, 100, 80);
  const std::vector<int> colors = color_cells(square.triangles, random_cells(square, 1), kCells, 8);
  for (int color = 0; color < 8; ++color) {
    EXPECT_GE(std::count(colors.begin(), colors.end(), color), kCells / 8 / 2);
  }
}

TEST(ColorCells, LeavesVerticesWithoutCellAlone) {
  const geometry::TriangleMesh square = make_square({0, 0, 0}, 1, 1);
  const std::vector<int> colors =
      color_cells(square.triangles, Eigen::Vector4i(-1, 0, -1, 1), 2, 8);
  EXPECT_NE(colors[0], colors[1]);
}

TEST(ColorCells, StillColoursWhereColoursRunOut) {
  Eigen::Matrix3Xi triangle(3, 1);
  triangle << 0, 1, 2;
  const std::vector<int> colors = color_cells(triangle, Eigen::Vector3i(0, 1, 2), 3, 2);
  EXPECT_EQ(
      std::count(colors.begin(), colors.end(), 0) + std::count(colors.begin(), colors.end(), 1), 3);
}

}  // namespace
}  // namespace palpate::pictures
