#include "services/plotter/core/sectors.hpp"

#include <algorithm>

#include "common/core/angles.hpp"
#include "common/core/elementary.hpp"
#include "common/core/outlines.hpp"

namespace lookout::plotter {

namespace {

constexpr auto kNum = static_cast<int>(kNumSectors);
static_assert(kNum * kSectorDeg == 360);

}  // namespace

std::size_t Sectors::IndexOf(const Eigen::Vector2d& p_m) {
  // From the bow clockwise; y is to port.
  const double bearing_rad = WrapTo2Pi(Atan2(-p_m.y(), p_m.x()) + DegToRad(kSectorDeg / 2.0));
  return std::min(static_cast<std::size_t>(bearing_rad / DegToRad(kSectorDeg)), kNumSectors - 1);
}

void Sectors::Keep(std::size_t sector, const Eigen::Vector2d& p_m) {
  const double distance_m = p_m.norm();
  if (!(distance_m < distance_m_[sector])) return;
  distance_m_[sector] = distance_m;
  nearest_m_[sector] = p_m;
}

void Sectors::KeepPiece(std::size_t sector, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) {
  const Eigen::Vector2d edge_m = to_m - from_m;
  const double length2_m2 = edge_m.squaredNorm();
  const double share = length2_m2 > 0.0 ? std::clamp(-from_m.dot(edge_m) / length2_m2, 0.0, 1.0) : 0.0;
  Keep(sector, from_m + share * edge_m);
}

void Sectors::AddEdge(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m) {
  auto sector = static_cast<int>(IndexOf(from_m));
  const auto last = static_cast<int>(IndexOf(to_m));
  // The short way round; of two that are opposite the side on which the edge passes the boat.
  const int ahead = (last - sector + kNum) % kNum;
  const bool is_clockwise = ahead * 2 == kNum ? Cross(from_m, to_m) < 0.0 : ahead * 2 < kNum;
  const int step = is_clockwise ? 1 : -1;
  const Eigen::Vector2d edge_m = to_m - from_m;
  Eigen::Vector2d begin_m = from_m;
  while (sector != last) {
    const auto border = SinCosOfDegrees((sector + step * 0.5) * kSectorDeg);
    const Eigen::Vector2d direction(border.cos, -border.sin);
    const double turn = Cross(direction, edge_m);
    const double share = turn != 0.0 ? std::clamp(-Cross(direction, from_m) / turn, 0.0, 1.0) : 1.0;
    const Eigen::Vector2d end_m = from_m + share * edge_m;
    KeepPiece(static_cast<std::size_t>(sector), begin_m, end_m);
    begin_m = end_m;
    sector = (sector + step + kNum) % kNum;
  }
  KeepPiece(static_cast<std::size_t>(last), begin_m, to_m);
}

void Sectors::AddOutline(std::span<const Eigen::Vector2d> corners_m) {
  for (std::size_t i = 0; i < corners_m.size(); ++i) AddEdge(corners_m[i], corners_m[i + 1 < corners_m.size() ? i + 1 : 0]);
}

}  // namespace lookout::plotter
