#include <cstdint>
#include <string>

#include "common/core/append_bytes.hpp"
#include "common/messages/returns.hpp"
#include "tools/export/sinks.hpp"

namespace lookout::exporter {

namespace {

class PcdSink final : public Sink {
 public:
  explicit PcdSink(std::optional<std::int64_t> seq) : scan_(ChosenScan::Of::kReturns, seq) {}

  std::vector<bus::Channel> Channels() const override { return {bus::kLidarScan, bus::kSegments}; }
  Taken Take(std::string_view channel, Bytes bytes, std::string&) override { return scan_.Take(channel, bytes); }
  bool IsDone() const override { return scan_.IsDone(); }

  void Finish(std::string& text) override {
    scan_.Finish();
    const auto& scan = scan_.chosen();
    if (!scan) return;
    std::string points;
    int count = 0;
    for (const auto& [part_index, part] : scan->scans) {
      messages::ForEachReturn(part, LabelsOf(*scan, part), [&](const messages::Return& one) {
        ++count;
        for (const double coordinate_m : {one.p_lidar_m.x(), one.p_lidar_m.y(), one.p_lidar_m.z()}) AppendFloat(coordinate_m, points);
        AppendFloat(one.reflectivity, points);
        AppendLittleEndian(static_cast<std::uint32_t>(one.has_label ? one.label : -1), 4, points);
        AppendLittleEndian(static_cast<std::uint32_t>(one.ring), 2, points);
        // Seconds since the first firing, as drivers of lidars give them.
        AppendFloat(static_cast<double>(one.utime_us - scan->utime_us) * 1e-6, points);
      });
    }
    const auto number = std::to_string(count);
    text += "# .PCD v0.7 - Lookout, scan " + std::to_string(scan->seq) + ", first firing at " + std::to_string(scan->utime_us) +
            " us since 1970 UTC; lidar frame, metres\n"
            "VERSION 0.7\nFIELDS x y z intensity label ring time\nSIZE 4 4 4 4 4 2 4\nTYPE F F F F I U F\nCOUNT 1 1 1 1 1 1 1\nWIDTH " +
            number + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + number + "\nDATA binary\n";
    text += points;
  }

 private:
  ChosenScan scan_;
};

}  // namespace

std::unique_ptr<Sink> MakePcdSink(std::optional<std::int64_t> seq) { return std::make_unique<PcdSink>(seq); }

}  // namespace lookout::exporter
