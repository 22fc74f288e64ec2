#include "common/viewer/boat_of_run_info.hpp"

#include "common/config/text_config.hpp"
#include "common/messages/run_info_files.hpp"
#include "config/schema/boat.pb.h"

namespace lookout::viewer {

namespace {

constexpr const char* kBoatFile = "boat.txtpb";

}  // namespace

bool TakeBoat(const run_info_t& info, std::optional<config::BoatFacts>& boat) try {
  const auto* const text = messages::FileTextOf(info, kBoatFile);
  if (text == nullptr) return true;
  config::Boat message;
  config::ParseText(*text, kBoatFile, message);
  boat = config::ToFacts(message, kBoatFile);
  return true;
} catch (const config::ConfigError&) {
  return false;
}

}  // namespace lookout::viewer
