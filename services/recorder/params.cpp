#include "services/recorder/params.hpp"

#include "common/config/text_config.hpp"
#include "config/schema/recorder.pb.h"

namespace lookout::recorder {

Params LoadParams(const std::filesystem::path& config_folder) {
  const auto message = config::Load<config::Recorder>(config_folder, "recorder.txtpb");
  if (message.log_folder().empty())
    throw config::ConfigError({config::FaultLine(config_folder / "recorder.txtpb", "log_folder", "must not be empty")});
  return {message.log_folder(), message.max_file_bytes(), std::chrono::seconds(message.max_file_s()), message.reserve_bytes(), message.queue_bytes()};
}

}  // namespace lookout::recorder
