#include "tools/export/boat_of_log.hpp"

#include "common/bus/decode.hpp"
#include "common/config/text_config.hpp"
#include "config/schema/boat.pb.h"
#include "lookout/run_info_t.hpp"

namespace lookout::exporter {

Taken TakeRunInfo(Bytes bytes, std::optional<config::BoatFacts>& boat) try {
  const auto info = bus::Decode<run_info_t>(bytes);
  if (!info) return Taken::kUndecodable;
  for (std::size_t i = 0; i < info->file_name.size(); ++i) {
    if (info->file_name[i] != "boat.txtpb") continue;
    config::Boat message;
    config::ParseText(info->file_text[i], info->file_name[i], message);
    boat = config::ToFacts(message, info->file_name[i]);
  }
  return Taken::kOk;
} catch (const config::ConfigError&) {
  return Taken::kInconsistent;
}

}  // namespace lookout::exporter
