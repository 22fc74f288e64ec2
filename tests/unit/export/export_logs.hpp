// Hand-filled messages and little logs for the tests of lookout-export.
#pragma once

#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/segments_t.hpp"
#include "tests/support/file_log.hpp"
#include "tests/support/files.hpp"
#include "tests/support/messages.hpp"
#include "tools/export/export.hpp"

namespace lookout::exporter {

inline constexpr std::int64_t kStartUs = 1'700'000'000'000'000;  // 2023-11-14 22:13:20 UTC
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Two rings (-15 and 0 degrees), `num_columns` columns 90 degrees apart from azimuth 0, single return; a scan of 0.1 s in one part.
/// Every range is 5000 counts (10 m), every reflectivity 7.
inline lidar_scan_t MakeScan(std::int64_t seq, int num_columns = 2, int first_column = 0) {
  auto scan = support::OfScan<lidar_scan_t>(kStartUs + 100'000 * seq, seq, 99'999);
  std::vector<float> azimuth_rad;
  std::vector<std::int32_t> time_ns;
  for (int column = first_column; column < first_column + num_columns; ++column) {
    azimuth_rad.push_back(static_cast<float>(column % 4) * 1.57079633F);
    time_ns.push_back(column * 55'296);
  }
  support::FillColumns(scan, azimuth_rad, time_ns, 5000);
  scan.time_source = lidar_scan_t::TIME_SENSOR;
  scan.model = "VLP-16";
  scan.elevation_rad = {static_cast<float>(-15.0 * 3.14159265358979 / 180.0), 0.0F};
  scan.first_column = first_column;
  return scan;
}

/// SEGMENTS of a scan: every cell has `label`, no segment.
inline segments_t MakeSegments(const lidar_scan_t& scan, std::int16_t label = 1) { return support::LabelsOf(scan, label); }

/// A segment of four corners, one metre wide, with its nearest side `x_m` ahead of the lidar.
inline segment_t MakeSegment(int id, float x_m) {
  segment_t segment{};
  segment.utime_us = kStartUs + 5;
  segment.id = id;
  segment.confidence = segment_t::CONFIDENCE_SURE;
  segment.seen_share = 0.75F;
  segment.thing_probability = 0.9375F;
  segment.land_probability = 0.0625F;
  segment.num_points = 12;
  segment.centroid_m[0] = x_m + 0.5F;
  segment.centroid_m[1] = -1.25F;
  segment.centroid_m[2] = 0.125F;
  segment.nearest_m[0] = x_m;
  segment.length_m = 2.5F;
  segment.width_m = 1.0F;
  segment.min_z_m = -0.25F;
  segment.max_z_m = 1.25F;
  segment.num_hull = 4;
  segment.hull_x_m = {x_m, x_m + 1.0F, x_m + 1.0F, x_m};
  segment.hull_y_m = {0.0F, 0.0F, 1.0F, 1.0F};
  segment.hull_time_us.assign(4, 0);
  return segment;
}

/// A folder of one test, removed at its end.
class ExportTest : public ::testing::Test {
 protected:
  template <typename T>
  void Add(const bus::Channel& channel, const T& message) {
    AddBytes(channel.name, bus::Encode(message));
  }
  void AddBytes(std::string_view channel, const std::vector<std::uint8_t>& bytes) { AddBytesAt(kStartUs, channel, bytes); }
  /// @param utime_us  of the event
  void AddBytesAt(std::int64_t utime_us, std::string_view channel, const std::vector<std::uint8_t>& bytes) {
    if (!writer_) writer_ = std::make_unique<support::FileLog>(log_);
    writer_->Write(Utime(std::chrono::microseconds(utime_us)), channel, bytes);
  }

  /// Exports what was added so far.
  /// @return exit code; text_ is what was written, errors_ what was told
  int Export(const std::string& table, const std::string& format = "csv", std::optional<std::int64_t> scan = std::nullopt) {
    return Export(Request{.inputs = {log_}, .table = table, .format = format, .output = folder_ / "out", .force = true, .scan = scan});
  }
  int Export(const Request& request) {
    writer_.reset();
    std::ostringstream errors;
    const int code = exporter::Run(request, errors);
    errors_ = errors.str();
    text_ = request.output && std::filesystem::exists(*request.output) ? support::ReadFile(*request.output) : "";
    return code;
  }

  /// Lines of text_ without the header.
  std::vector<std::string> Rows() const {
    std::vector<std::string> rows;
    std::istringstream in(text_);
    std::string line;
    std::getline(in, line);
    while (std::getline(in, line)) rows.push_back(line);
    return rows;
  }

  support::TempDir folder_;
  std::filesystem::path log_ = folder_ / "log";
  std::unique_ptr<support::FileLog> writer_;
  std::string text_;
  std::string errors_;
};

}  // namespace lookout::exporter
