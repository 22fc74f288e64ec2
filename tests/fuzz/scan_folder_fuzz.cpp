// Any bytes as each file of a folder of scans: PCD, KITTI with labels, boxes, records of OXTS, lists of times, meanings of labels. The first byte
// picks.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "common/bus/channels.hpp"
#include "common/config/text_config.hpp"
#include "tools/import/box_labels.hpp"
#include "tools/import/label_map.hpp"
#include "tools/import/oxts.hpp"
#include "tools/import/point_message.hpp"
#include "tools/import/ros_import.hpp"
#include "tools/import/ros_message.hpp"
#include "tools/import/stamps.hpp"

namespace {

using namespace lookout::importer;

constexpr std::int64_t kFuzzStampNs = 1'781'532'600'000'000'000;

// A cloud as it is learned from and imported.
void ImportPoints(const PointMessage& made, std::string_view type) {
  if (made.bytes.empty()) return;
  if (!ParsePointCloud(Encoding::kRos1, made.bytes)) std::abort();  // what is written can be read
  const Topic topic{"/points", std::string(type), Encoding::kRos1};
  LogMaker log({}, true, [](lookout::Utime, const lookout::bus::Channel&, lookout::Bytes bytes) {
    if (bytes.size() > static_cast<std::size_t>(lookout::bus::kMaxMessageBytes)) std::abort();
  });
  RosImport import({{"/points", {Use::kLidarScan}}}, log);
  for (int i = 0; i < 2; ++i) import.Take({made.stamp_ns, &topic, made.bytes});
  log.Finish();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  switch (data[0] % 7) {
    case 0:
      ImportPoints(MessageOfPcd(text, "pcd", kFuzzStampNs, {}), kTypePcd);
      break;
    case 1:
      ImportPoints(MessageOfPcd(text, "pcd", std::nullopt, {}), kTypePcd);
      break;
    case 2: {
      // 20 bytes of a point and its label: so both files fit each other.
      const std::size_t num_points = text.size() / 20;
      ImportPoints(MessageOfKitti(text.substr(0, 16 * num_points), "bin", kFuzzStampNs, {text.substr(16 * num_points, 4 * num_points), {}}),
                   kTypeKittiPoints);
      ImportPoints(MessageOfKitti(text, "bin", kFuzzStampNs, {text, {}}), kTypeKittiPoints);
      break;
    }
    case 3:
      if (const auto boxes = ParseBoxes(text)) LabelAt(*boxes, 1.0, 2.0, 3.0);
      break;
    case 4:
      ParseOxts(text, lookout::Utime(std::chrono::microseconds(kFuzzStampNs / 1000)));
      break;
    case 5: {
      const TimeList list(text);
      for (std::size_t i = 0; i < 4; ++i) list.Of("1", i, 4);
      const auto stamp = ParseStamp(text);
      if (stamp && (stamp->time_ns < 0 || !IsRecordedTime(stamp->time_ns))) std::abort();
      StampOfName(text);
      break;
    }
    default:
      try {
        ParseLabelMap(std::string(text), "labels");
      } catch (const lookout::config::ConfigError&) {
        // No map: said, not a fault.
      }
  }
  return 0;
}
