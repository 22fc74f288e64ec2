// Any bytes as each message of ROS that is used, in both encodings: the first byte picks them.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "common/bus/channels.hpp"
#include "tools/import/ros_import.hpp"
#include "tools/import/ros_message.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lookout::importer;
  if (size == 0) return 0;
  struct Kind {
    Use use;
    std::string_view type;
  };
  constexpr std::array kKinds{Kind{Use::kLidarScan, kTypePointCloud},
                              Kind{Use::kLidarPackets, kTypeVelodyneScan},
                              Kind{Use::kImu, kTypeImu},
                              Kind{Use::kFix, kTypeNavSatFix},
                              Kind{Use::kSentences, kTypeSentence},
                              Kind{Use::kSentences, kTypeString},
                              Kind{Use::kVelocity, kTypeTwist},
                              Kind{Use::kVelocity, kTypeTwistWithCovariance},
                              Kind{Use::kLidarPackets, kTypePandarScan},
                              Kind{Use::kLidarPackets, kTypeNebulaPackets},
                              Kind{Use::kPositionPackets, kTypesOusterPacket[0]},
                              Kind{Use::kLidarScan, kTypesLivox[0]}};
  const auto& kind = kKinds.at(data[0] % kKinds.size());
  const Topic topic{"/topic", std::string(kind.type), data[0] / kKinds.size() % 2 == 0 ? Encoding::kRos1 : Encoding::kCdr};
  LogMaker log({}, true, [](lookout::Utime, const lookout::bus::Channel&, lookout::Bytes bytes) {
    if (bytes.size() > static_cast<std::size_t>(lookout::bus::kMaxMessageBytes)) std::abort();
  });
  RosImport import({{"/topic", {kind.use}}}, log);
  for (int i = 0; i < 2; ++i) import.Take({1'781'532'600'000'000'000, &topic, { data + 1, size - 1 }});
  log.Finish();
  return 0;
}
