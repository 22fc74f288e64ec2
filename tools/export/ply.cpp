#include <cstdint>
#include <string>

#include "common/core/append_bytes.hpp"
#include "common/messages/returns.hpp"
#include "tools/export/colour.hpp"
#include "tools/export/sinks.hpp"

namespace lookout::exporter {

namespace {

constexpr int kUnknownLabel = -1;

class PlySink final : public Sink {
 public:
  explicit PlySink(std::optional<std::int64_t> seq) : scan_(ChosenScan::Of::kReturns, seq) {}

  std::vector<bus::Channel> Channels() const override { return {bus::kLidarScan, bus::kSegments}; }
  Taken Take(std::string_view channel, Bytes bytes, std::string&) override { return scan_.Take(channel, bytes); }
  bool IsDone() const override { return scan_.IsDone(); }

  void Finish(std::string& text) override {
    scan_.Finish();
    const auto& scan = scan_.chosen();
    if (!scan) return;
    std::string vertices;
    int count = 0;
    for (const auto& [part_index, part] : scan->scans) {
      messages::ForEachReturn(part, LabelsOf(*scan, part), [&](const messages::Return& one) {
        ++count;
        for (const double coordinate_m : {one.p_lidar_m.x(), one.p_lidar_m.y(), one.p_lidar_m.z()}) AppendFloat(coordinate_m, vertices);
        const Rgb colour = one.label > 0 ? ColourOfSegment(one.label) : ColourOfReason(one.reason);
        for (const auto channel : {colour.red, colour.green, colour.blue}) AppendLittleEndian(channel, 1, vertices);
        AppendFloat(one.reflectivity, vertices);
        AppendLittleEndian(static_cast<std::uint32_t>(one.has_label ? one.label : kUnknownLabel), 4, vertices);
        AppendLittleEndian(static_cast<std::uint32_t>(one.ring), 2, vertices);
      });
    }
    text +=
        "ply\nformat binary_little_endian 1.0\n"
        "comment Lookout, scan " +
        std::to_string(scan->seq) + ", first firing at " + std::to_string(scan->utime_us) +
        " us since 1970 UTC\n"
        "comment lidar frame, metres: x along azimuth 0, y left, z up\n"
        "comment label: id of the segment, 0 in none, -1 not labelled; ring from the lowest beam up\n"
        "element vertex " +
        std::to_string(count) +
        "\n"
        "property float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
        "property float intensity\nproperty int label\nproperty ushort ring\n"
        "end_header\n";
    text += vertices;
  }

 private:
  ChosenScan scan_;
};

}  // namespace

std::unique_ptr<Sink> MakePlySink(std::optional<std::int64_t> seq) { return std::make_unique<PlySink>(seq); }

}  // namespace lookout::exporter
