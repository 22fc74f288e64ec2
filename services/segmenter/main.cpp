// The segmenter process: LIDAR_SCAN in, SEGMENTS out.
#include <chrono>
#include <iostream>

#include "common/runtime/options.hpp"
#include "common/runtime/process.hpp"
#include "common/runtime/run_info.hpp"
#include "services/segmenter/params.hpp"
#include "services/segmenter/service.hpp"

namespace {

constexpr std::chrono::milliseconds kTick(1000);

}  // namespace

int main(int argc, char** argv) {
  const auto options = lookout::runtime::ParseOptions(argc, argv, "lookout-segmenter", "LIDAR_SCAN in, SEGMENTS out");
  return lookout::runtime::RunMain("segmenter", [&options] {
    const auto params = lookout::segmenter::LoadParams(options.config_folder);
    if (options.check_only) {
      std::cout << lookout::runtime::EffectiveConfig(options.config_folder, {"boat.txtpb", "segmenter.txtpb"});
      return;
    }
    lookout::runtime::Process process("segmenter", options.lcm_url);
    lookout::segmenter::Service service(process.bus(), params);
    process.Every(kTick, [&service] { service.AdvanceTo(lookout::runtime::HostNow()); });
    process.Run([&service] { return service.Report(); });
  });
}
