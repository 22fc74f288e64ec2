#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <string>

#include "common/core/append_bytes.hpp"
#include "tools/export/cloud.hpp"

namespace lookout::exporter {

namespace {

class PcdWriter final : public CloudWriter {
 public:
  PcdWriter(CloudFrame frame, bool is_of_one_scan) : frame_(frame), is_of_one_scan_(is_of_one_scan) {}

  bool is_geodetic() const override { return false; }

  void BeginScan(std::int64_t seq, std::int64_t utime_us, const Datum& datum) override {
    if (num_scans_++ > 0) return;
    seq_ = seq;
    utime_us_ = utime_us;
    datum_ = datum;
  }

  bool Add(const CloudPoint& point, std::string& text) override {
    for (const double coordinate_m : point.p) AppendFloat(coordinate_m, text);
    AppendFloat(point.reflectivity, text);
    AppendLittleEndian(static_cast<std::uint32_t>(point.label.value_or(-1)), 4, text);
    AppendLittleEndian(static_cast<std::uint32_t>(point.ring), 2, text);
    // Seconds since the first firing, as drivers of lidars give them.
    const double time_s = static_cast<double>(point.utime_us - utime_us_) * 1e-6;
    if (is_of_one_scan_) {
      AppendFloat(time_s, text);
    } else {
      AppendLittleEndian(std::bit_cast<std::uint64_t>(time_s), 8, text);
    }
    ++num_points_;
    return true;
  }

  std::string Head() const override {
    std::string title = fmt::format("# .PCD v0.7 - Lookout, scan {}, first firing at {} us since 1970 UTC; {}", seq_, utime_us_, NameOf(frame_));
    if (frame_ == CloudFrame::kEarth)
      title += fmt::format("; datum {:.9f} {:.9f} deg, {:.3f} m", datum_.latitude_deg, datum_.longitude_deg, datum_.ellipsoid_height_m);
    const auto tail = fmt::format(
        "VERSION 0.7\nFIELDS x y z intensity label ring time\nSIZE 4 4 4 4 4 2 {0}\nTYPE F F F F I U F\nCOUNT 1 1 1 1 1 1 1\nWIDTH {1}\nHEIGHT 1\n"
        "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {1}\nDATA binary\n",
        is_of_one_scan_ ? 4 : 8, num_points_);
    if (is_of_one_scan_) return title + "\n" + tail;
    // Numbers that are known at the end change no length.
    title += fmt::format("; {} scans from this one on", num_scans_);
    constexpr std::size_t kHeadBytes = 512;
    title.append(kHeadBytes - 1 - title.size() - tail.size(), ' ');
    return title + "\n" + tail;
  }

  std::int64_t num_points() const override { return num_points_; }

 private:
  CloudFrame frame_;
  bool is_of_one_scan_;
  std::int64_t num_scans_ = 0;
  std::int64_t seq_ = 0;
  std::int64_t utime_us_ = 0;
  Datum datum_;
  std::int64_t num_points_ = 0;
};

}  // namespace

std::string_view NameOf(CloudFrame frame) {
  switch (frame) {
    case CloudFrame::kLidar:
      return "lidar frame, metres";
    case CloudFrame::kVessel:
      return "vessel frame (x forward, y port, z up), metres";
    case CloudFrame::kEarth:
      return "east, north and up of the datum, metres";
  }
  return {};
}

std::unique_ptr<CloudWriter> MakePcdWriter(CloudFrame frame, bool is_of_one_scan) { return std::make_unique<PcdWriter>(frame, is_of_one_scan); }

}  // namespace lookout::exporter
