// A folder with a hand-written truth: object 1, a square of 2 m whose south-west corner is the datum and which goes north by 1 m/s; object 2, a
// square that stands still 10 m east of it.
#pragma once

#include <GeographicLib/LocalCartesian.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/files.hpp"

namespace lookout::eval {

inline constexpr double kDatumLatitudeDeg = 43.63;
inline constexpr double kDatumLongitudeDeg = -72.15;
inline constexpr double kDatumHeightM = 201.0;
inline constexpr long long kStartUs = 1'781'532'600'000'000;

using support::WriteFile;

inline std::string OutlineRows(int object_id, long long utime_us, double east_m, double north_m) {
  const GeographicLib::LocalCartesian map(kDatumLatitudeDeg, kDatumLongitudeDeg, kDatumHeightM);
  const double corners_m[4][2] = {{0.0, 0.0}, {2.0, 0.0}, {2.0, 2.0}, {0.0, 2.0}};
  std::string rows;
  for (int i = 0; i < 4; ++i) {
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
    double height_m = 0.0;
    map.Reverse(east_m + corners_m[i][0], north_m + corners_m[i][1], 0.0, latitude_deg, longitude_deg, height_m);
    char row[160];
    std::snprintf(row, sizeof(row), "%d,%lld,%d,%.9f,%.9f,0,0\n", object_id, utime_us, i, latitude_deg, longitude_deg);
    rows += row;
  }
  return rows;
}

inline const std::filesystem::path& WriteTruth(const std::filesystem::path& folder) {
  WriteFile(folder / "objects.csv", "object_id,name,kind,is_moving\n-1,own_vessel,own_vessel,1\n0,stray,stray,0\n1,ferry,boat,1\n2,pile,pile,0\n");
  WriteFile(folder / "outlines.csv", "object_id,utime_us,vertex_index,latitude_deg,longitude_deg,east_m,north_m\n" +
                                         OutlineRows(1, kStartUs, 0.0, 0.0) + OutlineRows(1, kStartUs + 1'000'000, 0.0, 1.0) +
                                         OutlineRows(2, kStartUs, 10.0, 0.0));
  WriteFile(folder / "pose.csv", "utime_us,latitude_deg,longitude_deg,heading_deg,roll_deg,pitch_deg,speed_mps,course_deg\n" +
                                     std::to_string(kStartUs) + ",43.63,-72.15,359.9,1,2,3,4\n");
  // Rows out of order: returns of a dual packet are.
  WriteFile(folder / "returns.csv", "utime_us,ring,return_index,object_id\n" + std::to_string(kStartUs + 55) + ",0,0,2\n" + std::to_string(kStartUs) +
                                        ",0,0,1\n" + std::to_string(kStartUs + 2) + ",8,0,1\n" + std::to_string(kStartUs + 57) + ",8,0,0\n");
  return folder;
}

}  // namespace lookout::eval
