// Clouds of returns in file formats of other programs: of one scan, of a part of a log, or of a whole log; in the frame of the lidar, of the vessel
// or of the earth.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/core/pose.hpp"

namespace lookout::exporter {

enum class CloudFrame : std::uint8_t { kLidar, kVessel, kEarth };

/// "lidar, metres"
std::string_view NameOf(CloudFrame frame);

struct CloudPoint {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();  // in the frame, metres; for a geodetic writer longitude, latitude (deg) and height (m)
  int reflectivity = 0;
  std::optional<int> label = {};  // 0: in no segment; nullopt: not known
  int ring = 0;
  int return_number = 1;
  int num_returns = 1;
  std::int64_t utime_us = 0;
};

/// Makes the bytes of a file: a head, which is known at the end only, then points.
class CloudWriter {
 public:
  virtual ~CloudWriter() = default;

  /// Whether points of the earth are in degrees; else they are in the map frame of the datum.
  virtual bool is_geodetic() const = 0;

  /// Before the points of each scan. @param datum  of the map frame; not known but on the earth
  virtual void BeginScan(std::int64_t seq, std::int64_t utime_us, const Datum& datum) = 0;

  /// Appends a point. @return false where it is farther off than the format can tell
  virtual bool Add(const CloudPoint& point, std::string& text) = 0;

  /// The head for all points so far; always of equal length.
  virtual std::string Head() const = 0;

  virtual std::int64_t num_points() const = 0;
};

/// LAS 1.4, point format 6, not compressed, with the frame as WKT. X, Y and Z in 0.1 mm; on the earth 1e-9 deg and 1 mm. Intensity: reflectivity
/// times 257. User data: ring. Point source: label (0 also where it is not known). Classification: 1 (unclassified) where the label is known, else 0.
/// Source: ASPRS, LAS Specification 1.4 - R15.
/// @param program  for "generating software"
std::unique_ptr<CloudWriter> MakeLasWriter(CloudFrame frame, std::string_view program);

/// PCD 0.7 (binary) of the Point Cloud Library: x y z intensity label ring time. `label` is -1 where it is not known; time in seconds since the first
/// firing of the first scan, in double precision where there may be several.
std::unique_ptr<CloudWriter> MakePcdWriter(CloudFrame frame, bool is_of_one_scan);

}  // namespace lookout::exporter
