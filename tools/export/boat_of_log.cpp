#include "tools/export/boat_of_log.hpp"

#include "common/bus/decode.hpp"
#include "common/config/text_config.hpp"
#include "common/messages/run_info_files.hpp"
#include "config/schema/boat.pb.h"
#include "lookout/run_info_t.hpp"

namespace lookout::exporter {

namespace {

constexpr const char* kBoatFile = "boat.txtpb";

}  // namespace

Taken TakeRunInfo(Bytes bytes, std::optional<config::BoatFacts>& boat) try {
  const auto info = bus::Decode<run_info_t>(bytes);
  if (!info) return Taken::kUndecodable;
  if (const auto* const text = messages::FileTextOf(*info, kBoatFile)) {
    config::Boat message;
    config::ParseText(*text, kBoatFile, message);
    boat = config::ToFacts(message, kBoatFile);
  }
  return Taken::kOk;
} catch (const config::ConfigError&) {
  return Taken::kInconsistent;
}

}  // namespace lookout::exporter
