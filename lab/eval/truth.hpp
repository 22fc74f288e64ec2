// The truth of a simulation, as lookout-sim writes it (columns: lab/sim/README.md).
#pragma once

#include <Eigen/Core>
#include <GeographicLib/LocalCartesian.hpp>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lookout/lidar_scan_t.hpp"

namespace lookout::eval {

using Polygon = std::vector<Eigen::Vector2d>;  // simple, in either direction; the last vertex joins the first

struct OutlineDistance {
  double edge_m = 0.0;     // to the nearest point of the line itself
  double outside_m = 0.0;  // the same, but 0 for a point inside
};

/// Precondition: the polygon has a vertex. Cost: proportional to its vertices.
OutlineDistance DistanceToOutline(const Eigen::Vector2d& p_m, const Polygon& outline_m);

struct TruthObject {
  std::string name;
  std::string kind;
  bool is_moving = false;
  bool is_in_water = false;  // a boat, swimmer, buoy or marker; false also where the files do not say it
};

struct TruthPose {
  double latitude_deg;
  double longitude_deg;
  double heading_deg;
  double roll_deg;
  double pitch_deg;
};

struct Geodetic {
  double latitude_deg;
  double longitude_deg;
};

/// From when to when a truth goes.
struct TruthSpan {
  std::int64_t begin_us = 0;
  std::int64_t end_us = 0;
};

/// Returns of each object in a scan, from the time of the scan's first shot to its last.
using CountReturns = std::function<std::map<int, int>(const TruthSpan& scan)>;

/// Outlines of the objects in one map frame.
class Outlines {
 public:
  void Add(int object_id, std::int64_t utime_us, Polygon outline_m) { by_object_[object_id][utime_us] = std::move(outline_m); }

  /// @return the outline at a time, between two of a moving object vertex by vertex; before the first and after the last that one itself;
  ///         nullopt for an object without outline
  std::optional<Polygon> At(int object_id, std::int64_t utime_us) const;
  /// From the first outline of an object to the last; nullopt for an object without outline.
  std::optional<TruthSpan> SpanOf(int object_id) const;

 private:
  std::map<int, std::map<std::int64_t, Polygon>> by_object_;
};

/// Out of the folder of a simulation, or put together in memory.
class Truth {
 public:
  /// @throws std::runtime_error "file:line: reason"
  explicit Truth(const std::filesystem::path& folder);

  /// Holds nothing yet. @param tolerance_us  by which times of one return may differ
  explicit Truth(std::int64_t tolerance_us) : tolerance_us_(tolerance_us) {}
  void AddObject(int id, TruthObject object) { objects_[id] = std::move(object); }
  void AddOutline(int object_id, std::int64_t utime_us, std::vector<Geodetic> outline) { outlines_[object_id][utime_us] = std::move(outline); }

  const std::map<int, TruthObject>& objects() const { return objects_; }
  const std::map<std::int64_t, TruthPose>& poses() const { return poses_; }

  struct Return {
    std::int64_t utime_us;
    int ring;
    int return_index;
    int object_id;
    /// Lidar frame, without noise; NaN where the files do not say it.
    Eigen::Vector3f p_lidar_m;
    int column = kNoColumn;  // column of the whole scan, where the files state it
  };
  static constexpr int kNoColumn = -1;

  /// @param returns  some microseconds of them, in any order; those of later calls are later
  void AddReturns(std::vector<Return> returns);
  void ForgetReturnsBefore(std::int64_t utime_us);
  /// By object. @param window  times; both are in it
  std::map<int, int> CountReturns(const TruthSpan& window) const;

  /// @param column  of the whole scan. It counts where the files say it: of clouds without times all returns of a ring are of one
  /// @return a return; times that differ by a microsecond are the same one (a laser fires every 55 us). nullptr = not in the truth
  const Return* Find(std::int64_t utime_us, int ring, int return_index, int column = kNoColumn) const;

  /// @param window  times; both are in it
  /// @return the return of this ring in this direction (the cosine of the angle between is `least_cosine` or more) that is nearest to it; nullptr =
  /// none
  const Return* FindAlong(const Eigen::Vector3d& direction, double least_cosine, const TruthSpan& window, int ring, int return_index) const;

  /// Whether it says where returns lie.
  bool HasPlaces() const { return !returns_.empty() && returns_.front().p_lidar_m.allFinite(); }

  /// Span of the truth's poses and returns; nullopt where there are neither.
  std::optional<TruthSpan> Span() const;

  Outlines OutlinesIn(const GeographicLib::LocalCartesian& map) const;

  /// Calls handle(cell, time_ns, truth) for each return of a part of LIDAR_SCAN, in the order of its cells. time_ns: since utime_us of the part;
  /// truth: nullptr where it is not in the truth.
  void ForEachReturn(const lidar_scan_t& part, const std::function<void(std::size_t cell, std::int64_t time_ns, const Return* truth)>& handle) const;

 private:
  std::map<int, TruthObject> objects_;
  std::map<int, std::map<std::int64_t, std::vector<Geodetic>>> outlines_;
  std::map<std::int64_t, TruthPose> poses_;
  std::deque<Return> returns_;  // by time
  std::int64_t tolerance_us_ = 1;
  bool has_columns_ = false;
};

}  // namespace lookout::eval
