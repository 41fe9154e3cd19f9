// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "regions/surface_pieces.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <queue>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "regions/smooth_runs.h"

namespace palpate::sensing {
namespace {

/// The largest vote of a line of pixels against one surface; that for it is 1.
constexpr float kMostAgainst = 2;

/// Variance of pixels in no region.
constexpr float kNoPhase = std::numeric_limits<float>::infinity();

/// Pieces of the image and the votes of their common borders.
class Pieces {
 public:
  explicit Pieces(int tiles) : parent_(static_cast<std::size_t>(tiles)), votes_(parent_.size()) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  void add_border(int one, int other, float votes) {
    votes_of(one)[other] = votes;
    votes_of(other)[one] = votes;
    queue(one, other, votes);
  }
  void join_all() {
    while (!borders_.empty()) {
      const Border border = borders_.top();
      borders_.pop();
      // Borders that have changed since are in the queue once more.
      const auto current = votes_of(border.one).find(border.other);
      if (current == votes_of(border.one).end() || current->second != border.votes) continue;
      join(border.one, border.other);
    }
  }
  int piece_of(int tile) {
    for (int* parent = &parent_of(tile); *parent != tile; parent = &parent_of(tile)) {
      *parent = parent_of(*parent);
      tile = *parent;
    }
    return tile;
  }

 private:
  struct Border {
    float votes = 0;
    int one = 0;
    int other = 0;
    /// Equal votes in the order of the tiles, so that every run joins the same pieces.
    bool operator<(const Border& border) const {
      return std::tie(votes, border.one, border.other) < std::tie(border.votes, one, other);
    }
  };
  int& parent_of(int tile) { return parent_[static_cast<std::size_t>(tile)]; }
  std::unordered_map<int, float>& votes_of(int piece) {
    return votes_[static_cast<std::size_t>(piece)];
  }
  void queue(int one, int other, float votes) {
    if (votes > 0) borders_.push({votes, std::min(one, other), std::max(one, other)});
  }
  void join(int kept, int joined) {
    if (votes_of(kept).size() < votes_of(joined).size()) std::swap(kept, joined);
    parent_of(joined) = kept;
    votes_of(kept).erase(joined);
    for (const auto& [piece, votes] : std::exchange(votes_of(joined), {})) {
      if (piece == kept) continue;
      votes_of(piece).erase(joined);
      float& sum = votes_of(kept)[piece];
      sum += votes;
      votes_of(piece)[kept] = sum;
      queue(kept, piece, sum);
    }
  }

  std::vector<int> parent_;
  std::vector<std::unordered_map<int, float>> votes_;
  std::priority_queue<Border> borders_;
};

/// A tile by its place among the others.
struct Tile {
  long row = 0;
  long column = 0;
};

/// The votes of the lines from the centre of a tile to that of the next one down or, if not `down`,
/// to the right.
float votes_between(const Plane& doubt, const Tile& tile, long size, bool down) {
  const long first_row = tile.row * size + (down ? size / 2 : 0);
  const long first_column = tile.column * size + (down ? 0 : size / 2);
  const long rows = std::min(size, doubt.rows() - first_row);
  const long columns = std::min(size, doubt.cols() - first_column);
  const auto block = doubt.block(first_row, first_column, rows, columns);
  float votes = 0;
  for (long line = 0; line < (down ? columns : rows); ++line) {
    const float most = down ? block.col(line).maxCoeff() : block.row(line).maxCoeff();
    if (most < kNoPhase) votes += std::max(1 - most, -kMostAgainst);
  }
  return votes;
}

}  // namespace

void cut_into_pieces(const SurfaceDoubt& doubt, long tile, long least_pixels, Plane& variance) {
  const long rows = (variance.rows() + tile - 1) / tile;
  const long columns = (variance.cols() + tile - 1) / tile;
  Pieces pieces(static_cast<int>(rows * columns));
  for (long row = 0; row < rows; ++row) {
    for (long column = 0; column < columns; ++column) {
      const int number = static_cast<int>(row * columns + column);
      if (column + 1 < columns)
        pieces.add_border(number, number + 1,
                          votes_between(doubt.across, {row, column}, tile, false));
      if (row + 1 < rows)
        pieces.add_border(number, number + static_cast<int>(columns),
                          votes_between(doubt.down, {row, column}, tile, true));
    }
  }
  pieces.join_all();
  Labels piece(rows, columns);
  std::vector<long> pixels(static_cast<std::size_t>(piece.size()), 0);
  for (int number = 0; number < piece.size(); ++number)
    piece.data()[number] = pieces.piece_of(number);
  for (long row = 0; row < variance.rows(); ++row) {
    for (long column = 0; column < variance.cols(); ++column) {
      const bool known = variance(row, column) < kNoPhase;
      pixels[static_cast<std::size_t>(piece(row / tile, column / tile))] += known ? 1 : 0;
    }
  }
  for (long row = 0; row < variance.rows(); ++row) {
    for (long column = 0; column < variance.cols(); ++column) {
      const int own = piece(row / tile, column / tile);
      const bool border = (row > 0 && piece((row - 1) / tile, column / tile) != own) ||
                          (column > 0 && piece(row / tile, (column - 1) / tile) != own);
      if (border || pixels[static_cast<std::size_t>(own)] < least_pixels)
        variance(row, column) = kNoPhase;
    }
  }
}

}  // namespace palpate::sensing
