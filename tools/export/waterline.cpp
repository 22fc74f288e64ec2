#include "tools/export/waterline.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

namespace lookout::exporter {

namespace {

// Sides first, so that a step of a staircase is not cut short.
constexpr std::array<std::pair<int, int>, 8> kNeighbours{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};

}  // namespace

void Waterline::Add(const GeodeticPlace& datum, std::span<const Eigen::Vector2d> middles_m) {
  if (cells_.empty() || !MapOfDatum(cells_.back().first).IsOf(datum)) cells_.emplace_back(datum, std::set<Cell>());
  for (const auto& middle_m : middles_m) {
    cells_.back().second.emplace(static_cast<std::int64_t>(std::floor(middle_m.x() / kCellM)),
                                 static_cast<std::int64_t>(std::floor(middle_m.y() / kCellM)));
  }
}

std::vector<std::vector<Waterline::Cell>> Waterline::Chains(std::set<Cell> cells) {
  const auto neighbour_of = [&cells](const Cell& cell) -> std::optional<Cell> {
    for (const auto& [east, north] : kNeighbours) {
      const Cell neighbour{cell.first + east, cell.second + north};
      if (cells.contains(neighbour)) return neighbour;
    }
    return std::nullopt;
  };
  const auto num_neighbours = [&cells](const Cell& cell) {
    std::size_t number = 0;
    for (const auto& [east, north] : kNeighbours) number += cells.contains({cell.first + east, cell.second + north}) ? 1 : 0;
    return number;
  };
  std::vector<std::vector<Cell>> chains;
  const auto follow = [&](const Cell& begin) {
    auto& chain = chains.emplace_back(1, begin);
    cells.erase(begin);
    for (auto next = neighbour_of(begin); next; next = neighbour_of(chain.back())) {
      chain.push_back(*next);
      cells.erase(*next);
    }
  };
  const std::vector<Cell> all(cells.begin(), cells.end());
  for (const auto& cell : all) {
    if (cells.contains(cell) && num_neighbours(cell) <= 1) follow(cell);
  }
  // The remaining cells form closed lines.
  for (const auto& cell : all) {
    if (!cells.contains(cell)) continue;
    follow(cell);
    auto& chain = chains.back();
    const bool is_closed = chain.size() > 3 && std::abs(chain.back().first - cell.first) <= 1 && std::abs(chain.back().second - cell.second) <= 1;
    if (is_closed) chain.push_back(cell);
  }
  return chains;
}

Eigen::Vector2d Waterline::MiddleOf(const Cell& cell) {
  return kCellM * Eigen::Vector2d(static_cast<double>(cell.first) + 0.5, static_cast<double>(cell.second) + 0.5);
}

// Middles of cells where the line begins, turns and ends.
std::vector<Eigen::Vector2d> Waterline::Corners(const std::vector<Cell>& chain) {
  if (chain.size() == 1) {
    const Eigen::Vector2d half_m(kCellM / 2.0, 0.0);
    return {MiddleOf(chain.front()) - half_m, MiddleOf(chain.front()) + half_m};
  }
  std::vector<Eigen::Vector2d> corners_m;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const bool goes_straight = i > 0 && i + 1 < chain.size() && chain[i + 1].first - chain[i].first == chain[i].first - chain[i - 1].first &&
                               chain[i + 1].second - chain[i].second == chain[i].second - chain[i - 1].second;
    if (!goes_straight) corners_m.push_back(MiddleOf(chain[i]));
  }
  return corners_m;
}

std::vector<std::vector<MapPlace>> Waterline::Lines(const Near* near) const {
  std::vector<std::vector<MapPlace>> lines;
  for (const auto& [datum, cells] : cells_) {
    const MapOfDatum map(datum);
    std::set<Cell> held;
    for (const auto& cell : cells) {
      if (near == nullptr || near->Holds(map.PlaceAt(MiddleOf(cell)))) held.insert(cell);
    }
    for (const auto& chain : Chains(held)) lines.push_back(map.Line(Corners(chain)));
  }
  return lines;
}

}  // namespace lookout::exporter
