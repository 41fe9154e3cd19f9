// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "mesh/editable_mesh.h"

#include <algorithm>
#include <array>
#include <string>

#include "base/numbers.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_topology.h"

namespace palpate::geometry {

EditableMesh::EditableMesh(const TriangleMesh& mesh, const char* what)
    : live_(static_cast<int>(mesh.triangles.cols())) {
  const Eigen::Matrix3Xi opposite = opposite_half_edges(mesh);
  opposite_.assign(opposite.data(), opposite.data() + opposite.size());
  start_.assign(mesh.triangles.data(), mesh.triangles.data() + mesh.triangles.size());
  feature_.assign(start_.size(), 0);
  for (const auto& vertex : mesh.vertices.colwise()) positions_.emplace_back(vertex);
  leaving_.assign(positions_.size(), kNone);
  std::vector<int> triangles(positions_.size(), 0);
  for (int h = 0; h < half_edge_count(); ++h) {
    ++triangles[size(start(h))];
    if (leaving_[size(start(h))] == kNone) begin_fan(h);
  }
  for (int v = 0; v < vertex_count(); ++v) {
    each_leaving(v, [&](int) { --triangles[size(v)]; });
    if (triangles[size(v)] == 0) continue;
    throw InvalidInput(std::string(what) + ": several fans of triangles meet at vertex " +
                       std::to_string(v) +
                       "; separate them with repair_mesh (palpate mesh "
                       "--repair)");
  }
}

void EditableMesh::make_feature(int h) {
  feature_[size(h)] = 1;
  if (opposite(h) >= 0) feature_[size(opposite(h))] = 1;
}

void EditableMesh::join(int h, int g) {
  if (h >= 0) opposite_[size(h)] = g;
  if (g >= 0) opposite_[size(g)] = h;
}

void EditableMesh::begin_fan(int h) {
  const int first = h;
  while (opposite(h) >= 0) {
    h = next(opposite(h));
    if (h == first) break;
  }
  leaving_[size(start(h))] = h;
}

/// Connects a half-edge to the surface in the place of another one.
void EditableMesh::take(int h, int from) {
  feature_[size(h)] = feature_[size(from)];
  join(h, opposite(from));
}

void EditableMesh::neighbours(int v, std::vector<int>& found) const {
  found.clear();
  each_leaving(v, [&](int h) {
    found.push_back(end(h));
    if (opposite(last(h)) < 0) found.push_back(apex(h));
  });
}

bool EditableMesh::are_neighbours(int v, int w) const {
  bool found = false;
  each_leaving(v, [&](int h) { found = found || end(h) == w || apex(h) == w; });
  return found;
}

int EditableMesh::split(int h) {
  const int middle = vertex_count();
  positions_.emplace_back((at(start(h)) + at(end(h))) / 2);
  leaving_.push_back(kNone);
  const int across = opposite(h);
  // Cuts a triangle from the middle of a half-edge to its apex; its first part keeps the start.
  // Returns the half-edge of the new, second part.
  const auto cut = [&](int side) {
    const int added = half_edge_count();
    const int corner_end = end(side), corner_apex = apex(side);
    for (const int corner : {middle, corner_end, corner_apex}) start_.push_back(corner);
    opposite_.insert(opposite_.end(), 3, kNone);
    feature_.insert(feature_.end(), 3, 0);
    ++live_;
    feature_[size(added)] = feature_[size(side)];
    take(added + 1, next(side));
    start_[size(next(side))] = middle;
    feature_[size(next(side))] = 0;
    join(next(side), added + 2);
    return added;
  };
  const int second = cut(h);
  if (across >= 0) {
    const int other = cut(across);
    join(h, other);
    join(second, across);
    begin_fan(next(other));
    begin_fan(last(other));
  }
  begin_fan(second);
  begin_fan(next(second));
  begin_fan(last(second));
  return middle;
}

bool EditableMesh::can_flip(int h) const {
  const int g = opposite(h);
  return g >= 0 && !is_feature(h) && apex(h) != apex(g) && !are_neighbours(apex(h), apex(g));
}

void EditableMesh::flip(int h) {
  const int g = opposite(h);
  const int h_next = next(h), h_last = last(h), g_next = next(g), g_last = last(g);
  const int begin = start(h), finish = end(h), top = apex(h), bottom = apex(g);
  struct Side {
    int across;
    char feature;
  };
  const auto side = [&](int i) { return Side{opposite(i), feature_[size(i)]}; };
  const std::array<Side, 4> sides = {side(h_next), side(h_last), side(g_next), side(g_last)};
  const auto put = [&](int i, int from, const Side& at_side) {
    start_[size(i)] = from;
    feature_[size(i)] = at_side.feature;
    join(i, at_side.across);
  };
  start_[size(h)] = bottom;
  start_[size(g)] = top;
  put(h_next, top, sides[1]);     // top -> begin
  put(h_last, begin, sides[2]);   // begin -> bottom
  put(g_next, bottom, sides[3]);  // bottom -> finish
  put(g_last, finish, sides[0]);  // finish -> top
  for (const int i : {h_next, h_last, g_next, g_last}) begin_fan(i);
}

bool EditableMesh::can_collapse(int h) {
  const int a = start(h), b = end(h), g = opposite(h);
  // Two parts of a border would come together.
  if (g >= 0 && is_on_border(a) && is_on_border(b)) return false;
  for (const int side : {h, g}) {
    if (side < 0) continue;
    const int one = opposite(next(side)), other = opposite(last(side));
    if (one < 0 && other < 0) return false;  // the triangle is an ear
    // They would lie on each other, as at a tetrahedron.
    if (one >= 0 && other >= 0 && apex(one) == apex(other)) return false;
  }
  neighbours(a, around_[0]);
  neighbours(b, around_[1]);
  std::sort(around_[0].begin(), around_[0].end());
  const auto common = std::count_if(around_[1].begin(), around_[1].end(), [&](int v) {
    return std::binary_search(around_[0].begin(), around_[0].end(), v);
  });
  return common == (g >= 0 ? 2 : 1);
}

/// Removes a triangle whose half-edge has lost its length, and joins its two neighbours.
/// \return a half-edge of the edge in its place
int EditableMesh::close(int h) {
  const int one = opposite(next(h)), other = opposite(last(h));
  const bool feature = is_feature(next(h)) || is_feature(last(h));
  join(one, other);
  join(other, one);
  for (const int i : {one, other})
    if (i >= 0) feature_[size(i)] = feature ? 1 : 0;
  const int t = h / 3;
  for (int i = 3 * t; i < 3 * t + 3; ++i) start_[size(i)] = kNone;
  --live_;
  return one >= 0 ? one : other;
}

void EditableMesh::collapse(int h) {
  const int removed = start(h), kept = end(h), g = opposite(h);
  std::vector<int>& leaving = around_[0];
  leaving.clear();
  each_leaving(removed, [&](int i) { leaving.push_back(i); });
  for (const int i : leaving) start_[size(i)] = kept;
  leaving_[size(removed)] = kNone;
  const int first = close(h);
  const int second = g >= 0 ? close(g) : first;
  for (const int edge : {first, second}) {
    begin_fan(edge);
    begin_fan(next(edge));
  }
}

TriangleMesh EditableMesh::mesh() const {
  std::vector<int> number(positions_.size(), kNone);
  int count = 0;
  for (int v = 0; v < vertex_count(); ++v)
    if (is_vertex_live(v)) number[size(v)] = count++;
  TriangleMesh mesh;
  mesh.vertices.resize(3, count);
  for (int v = 0; v < vertex_count(); ++v)
    if (is_vertex_live(v)) mesh.vertices.col(number[size(v)]) = at(v);
  mesh.triangles.resize(3, live_);
  Eigen::Index t = 0;
  for (int h = 0; h < half_edge_count(); h += 3) {
    if (!is_live(h)) continue;
    mesh.triangles.col(t++) << number[size(start(h))], number[size(start(h + 1))],
        number[size(start(h + 2))];
  }
  return mesh;
}

}  // namespace palpate::geometry
