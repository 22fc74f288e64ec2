#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <limits>

#include "common/core/append_bytes.hpp"
#include "tools/export/cloud.hpp"

namespace lookout::exporter {

namespace {

constexpr std::uint16_t kLasHeaderBytes = 375;
constexpr std::uint16_t kLasVlrHeadBytes = 54;
constexpr std::uint16_t kLasPointBytes = 30;
constexpr int kLasMostReturns = 15;

constexpr std::string_view kEarthWkt =
    R"(GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563,AUTHORITY["EPSG","7030"]],AUTHORITY["EPSG","6326"]],)"
    R"(PRIMEM["Greenwich",0,AUTHORITY["EPSG","8901"]],UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],AUTHORITY["EPSG","4326"]])";
constexpr std::string_view kVesselWkt =
    R"(LOCAL_CS["vessel: x forward, y port, z up",LOCAL_DATUM["vessel",0],UNIT["metre",1],AXIS["x",OTHER],AXIS["y",OTHER],AXIS["z",UP]])";
constexpr std::string_view kLidarWkt =
    R"(LOCAL_CS["lidar: as the sensor is mounted",LOCAL_DATUM["lidar",0],UNIT["metre",1],AXIS["x",OTHER],AXIS["y",OTHER],AXIS["z",OTHER]])";

// GPS time runs on where UTC has a leap second. Source: IERS, Bulletin C; the last was at the end of 2016.
constexpr std::array<std::chrono::sys_days, 18> kLeapDays{
    std::chrono::sys_days(std::chrono::year(1981) / 7 / 1), std::chrono::sys_days(std::chrono::year(1982) / 7 / 1),
    std::chrono::sys_days(std::chrono::year(1983) / 7 / 1), std::chrono::sys_days(std::chrono::year(1985) / 7 / 1),
    std::chrono::sys_days(std::chrono::year(1988) / 1 / 1), std::chrono::sys_days(std::chrono::year(1990) / 1 / 1),
    std::chrono::sys_days(std::chrono::year(1991) / 1 / 1), std::chrono::sys_days(std::chrono::year(1992) / 7 / 1),
    std::chrono::sys_days(std::chrono::year(1993) / 7 / 1), std::chrono::sys_days(std::chrono::year(1994) / 7 / 1),
    std::chrono::sys_days(std::chrono::year(1996) / 1 / 1), std::chrono::sys_days(std::chrono::year(1997) / 7 / 1),
    std::chrono::sys_days(std::chrono::year(1999) / 1 / 1), std::chrono::sys_days(std::chrono::year(2006) / 1 / 1),
    std::chrono::sys_days(std::chrono::year(2009) / 1 / 1), std::chrono::sys_days(std::chrono::year(2012) / 7 / 1),
    std::chrono::sys_days(std::chrono::year(2015) / 7 / 1), std::chrono::sys_days(std::chrono::year(2017) / 1 / 1)};
constexpr std::chrono::sys_days kGpsEpoch(std::chrono::year(1980) / 1 / 6);
constexpr double kAdjustedS = 1e9;  // that LAS takes off, for the sake of precision

double AdjustedGpsS(std::int64_t utime_us) {
  const Utime time{std::chrono::microseconds(utime_us)};
  const auto num_leaps = std::ranges::count_if(kLeapDays, [time](std::chrono::sys_days day) { return time >= day; });
  return static_cast<double>((time - kGpsEpoch).count()) * 1e-6 + static_cast<double>(num_leaps) - kAdjustedS;
}

void AppendDouble(double value, std::string& text) { AppendLittleEndian(std::bit_cast<std::uint64_t>(value), 8, text); }

void AppendPadded(std::string_view words, std::size_t size, std::string& text) {
  text.append(words.substr(0, size));
  text.append(size - std::min(size, words.size()), '\0');
}

class LasWriter final : public CloudWriter {
 public:
  LasWriter(CloudFrame frame, std::string_view program)
      : frame_(frame),
        program_(program),
        scale_(frame == CloudFrame::kEarth ? Eigen::Vector3d(1e-9, 1e-9, 1e-3) : Eigen::Vector3d::Constant(1e-4)),
        wkt_(frame == CloudFrame::kEarth    ? kEarthWkt
             : frame == CloudFrame::kVessel ? kVesselWkt
                                            : kLidarWkt) {}

  bool is_geodetic() const override { return true; }

  void BeginScan(std::int64_t /*seq*/, std::int64_t utime_us, const Datum& /*datum*/) override {
    if (!first_utime_us_) first_utime_us_ = utime_us;
  }

  bool Add(const CloudPoint& point, std::string& text) override {
    if (!offset_) {
      // Degrees have nine decimals in 32 bits for two degrees to each side.
      offset_ = Eigen::Vector3d::Zero();
      if (frame_ == CloudFrame::kEarth) offset_ = Eigen::Vector3d(std::round(point.p.x()), std::round(point.p.y()), 0.0);
    }
    std::array<std::int32_t, 3> counts{};
    for (int axis = 0; axis < 3; ++axis) {
      const double count = std::round((point.p[axis] - (*offset_)[axis]) / scale_[axis]);
      if (!(std::abs(count) <= std::numeric_limits<std::int32_t>::max())) return false;
      counts[static_cast<std::size_t>(axis)] = static_cast<std::int32_t>(count);
    }
    for (std::size_t axis = 0; axis < counts.size(); ++axis) {
      least_[axis] = num_points_ == 0 ? counts[axis] : std::min(least_[axis], counts[axis]);
      greatest_[axis] = num_points_ == 0 ? counts[axis] : std::max(greatest_[axis], counts[axis]);
      AppendLittleEndian(static_cast<std::uint32_t>(counts[axis]), 4, text);
    }
    const int num_returns = std::clamp(point.num_returns, 1, kLasMostReturns);
    const int number = std::clamp(point.return_number, 1, num_returns);
    constexpr std::uint64_t kFullScale = 257;  // 255 becomes 65535
    AppendLittleEndian(static_cast<std::uint64_t>(std::clamp(point.reflectivity, 0, 255)) * kFullScale, 2, text);
    text += static_cast<char>(number | num_returns << 4);
    text += '\0';  // flags, channel of the scanner, direction, edge: none
    text += static_cast<char>(point.label ? 1 : 0);
    text += static_cast<char>(point.ring);
    AppendLittleEndian(0, 2, text);  // angle of a scanner that looks down
    AppendLittleEndian(static_cast<std::uint64_t>(point.label.value_or(0)), 2, text);
    AppendDouble(AdjustedGpsS(point.utime_us), text);
    ++num_points_;
    ++by_return_[static_cast<std::size_t>(number - 1)];
    return true;
  }

  std::string Head() const override {
    std::string head = "LASF";
    constexpr std::uint64_t kAdjustedStandardGpsTime = 1;
    constexpr std::uint64_t kWkt = 16;
    const auto vlr_bytes = kLasVlrHeadBytes + wkt_.size() + 1;
    AppendLittleEndian(0, 2, head);
    AppendLittleEndian(kAdjustedStandardGpsTime | kWkt, 2, head);
    AppendPadded("", 16, head);  // GUID: none
    head += '\1';
    head += '\4';
    AppendPadded("lookout", 32, head);
    AppendPadded(program_, 32, head);
    // The day of the recording, since the same log makes the same file.
    const auto day = std::chrono::floor<std::chrono::days>(Utime(std::chrono::microseconds(first_utime_us_.value_or(0))));
    const std::chrono::year_month_day date(day);
    AppendLittleEndian(static_cast<std::uint64_t>((day - std::chrono::sys_days(date.year() / 1 / 1)).count() + 1), 2, head);
    AppendLittleEndian(static_cast<std::uint64_t>(static_cast<int>(date.year())), 2, head);
    AppendLittleEndian(kLasHeaderBytes, 2, head);
    AppendLittleEndian(kLasHeaderBytes + vlr_bytes, 4, head);  // where points begin
    AppendLittleEndian(1, 4, head);                            // records of variable length
    head += '\6';
    AppendLittleEndian(kLasPointBytes, 2, head);
    AppendPadded("", 4 + 5 * 4, head);  // counts of older versions
    const Eigen::Vector3d offset = offset_.value_or(Eigen::Vector3d::Zero());
    for (const double value : scale_) AppendDouble(value, head);
    for (const double value : offset) AppendDouble(value, head);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto index = static_cast<Eigen::Index>(axis);
      AppendDouble(greatest_[axis] * scale_[index] + offset[index], head);
      AppendDouble(least_[axis] * scale_[index] + offset[index], head);
    }
    AppendPadded("", 8 + 8 + 4, head);  // waveforms, extended records: none
    AppendLittleEndian(static_cast<std::uint64_t>(num_points_), 8, head);
    for (const auto count : by_return_) AppendLittleEndian(static_cast<std::uint64_t>(count), 8, head);
    // The record that holds the frame.
    constexpr std::uint64_t kWktRecord = 2112;
    AppendLittleEndian(0, 2, head);
    AppendPadded("LASF_Projection", 16, head);
    AppendLittleEndian(kWktRecord, 2, head);
    AppendLittleEndian(wkt_.size() + 1, 2, head);
    AppendPadded("frame", 32, head);
    AppendPadded(wkt_, wkt_.size() + 1, head);
    return head;
  }

  std::int64_t num_points() const override { return num_points_; }

 private:
  CloudFrame frame_;
  std::string program_;
  Eigen::Vector3d scale_;
  std::string_view wkt_;
  std::optional<std::int64_t> first_utime_us_;
  std::optional<Eigen::Vector3d> offset_;
  std::array<std::int32_t, 3> least_{};
  std::array<std::int32_t, 3> greatest_{};
  std::int64_t num_points_ = 0;
  std::array<std::int64_t, kLasMostReturns> by_return_{};
};

}  // namespace

std::unique_ptr<CloudWriter> MakeLasWriter(CloudFrame frame, std::string_view program) { return std::make_unique<LasWriter>(frame, program); }

}  // namespace lookout::exporter
