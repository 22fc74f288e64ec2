// The nearest thing in each sector around the boat.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>
#include <span>

namespace lookout::plotter {

inline constexpr std::size_t kNumSectors = 72;
inline constexpr int kSectorDeg = 5;

/// Sector i is centred on 5 i deg from the bow clockwise, and is half open. Places are in the vessel frame seen from above, with the boat level:
/// x forward, y to port, metres from the reference point.
class Sectors {
 public:
  static std::size_t IndexOf(const Eigen::Vector2d& p_m);

  void AddPoint(const Eigen::Vector2d& p_m) { Keep(IndexOf(p_m), p_m); }
  /// Each sector that the edge crosses gets the nearest place of the edge within it.
  void AddEdge(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m);
  /// @param corners_m  of a closed outline; a single corner is a point
  void AddOutline(std::span<const Eigen::Vector2d> corners_m);

  /// @return infinite where nothing is
  double distance_m(std::size_t sector) const { return distance_m_[sector]; }
  /// The place at distance_m. Precondition: distance_m(sector) is finite.
  const Eigen::Vector2d& nearest_m(std::size_t sector) const { return nearest_m_[sector]; }

 private:
  void Keep(std::size_t sector, const Eigen::Vector2d& p_m);
  void KeepPiece(std::size_t sector, const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m);

  static constexpr std::array<double, kNumSectors> Infinite() {
    std::array<double, kNumSectors> values{};
    values.fill(std::numeric_limits<double>::infinity());
    return values;
  }

  std::array<double, kNumSectors> distance_m_ = Infinite();
  std::array<Eigen::Vector2d, kNumSectors> nearest_m_{};
};

/// The surroundings of the boat, as one scan shows them.
struct Look {
  Sectors sectors;
  /// False: nobody looked into the sector (a gap of half a degree or more from the own boat to the reach), so an empty sector need not be free.
  std::array<bool, kNumSectors> is_looked{};
  double reach_m = 0.0;  // range to which is_looked holds
};

}  // namespace lookout::plotter
