#include "tools/calibrate/recording.hpp"

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/runtime/progress.hpp"
#include "tools/calibrate/collector.hpp"
#include "tools/replay/chain.hpp"
#include "tools/replay/input.hpp"

namespace lookout::calibrate {

Recording ReadRecording(const std::filesystem::path& config_folder, const std::vector<std::filesystem::path>& files, const Stretch& stretch) {
  Recording recording;
  Collector collector(recording, stretch);
  replay::Request request;
  request.only = {"lidar", "navigator"};
  auto inspection = replay::Inspect(files, request);
  // The lidar's motion and the IMU in it are turned by the mounting that is in question, and would agree with it.
  inspection.plan.pose_by_lidar = false;
  replay::Chain chain(config_folder, inspection.plan, [&collector](Utime /*time*/, std::string_view channel, Bytes bytes) {
    if (channel == bus::kLidarScan.name) {
      if (const auto message = bus::Decode<lidar_scan_t>(bytes)) collector.OnScan(*message);
    } else if (channel == bus::kPose.name) {
      if (const auto message = bus::Decode<pose_t>(bytes)) collector.OnPose(*message);
    }
  });
  runtime::Progress progress("calibrate", runtime::OnlyTerminal(stderr));
  const auto summary = replay::Feed(files, inspection, chain, progress);
  replay::Finish(summary, inspection, chain);
  return recording;
}

}  // namespace lookout::calibrate
