// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace palpate::apps {

/// A point of a plot of costs and errors.
struct TradeDot {
  std::string name;
  double cost = 0;   ///< > 0
  double error = 0;  ///< >= 0
};

/// The Pareto front: indices of the points that have a smaller error, by more than 1 %, than all
/// others of the same or a smaller cost. Of equal points, the first.
[[nodiscard]] std::vector<std::size_t> pareto_front(const std::vector<TradeDot>& dots);

/// Draws the points, numbered from 1, as SVG: the cost on a logarithmic axis, the error from zero.
/// A line joins the best ones.
/// \param cost, error labels of the axes, with units.
[[nodiscard]] std::string trade_svg(const std::vector<TradeDot>& dots, const std::string& cost,
                                    const std::string& error);

}  // namespace palpate::apps
