// Any text into the config loader, as each file of a boat: a message or a ConfigError, nothing else.
#include <cstddef>
#include <cstdint>
#include <string>

#include "common/config/text_config.hpp"
#include "config/schema/answers.pb.h"
#include "config/schema/boat.pb.h"
#include "config/schema/georeferencer.pb.h"
#include "config/schema/lidar.pb.h"
#include "config/schema/navigator.pb.h"
#include "config/schema/recorder.pb.h"
#include "config/schema/segmenter.pb.h"
#include "config/schema/tracker.pb.h"

namespace {

template <typename Message>
void ParseAs(const std::string& text) {
  try {
    Message message;
    lookout::config::ParseText(text, "fuzz", message);
    lookout::config::EffectiveText(message);
  } catch (const lookout::config::ConfigError&) {
    // A refusal: said, not a fault.
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  ParseAs<lookout::config::Answers>(text);
  ParseAs<lookout::config::Boat>(text);
  ParseAs<lookout::config::Georeferencer>(text);
  ParseAs<lookout::config::Tracker>(text);
  ParseAs<lookout::config::Navigator>(text);
  ParseAs<lookout::config::Recorder>(text);
  ParseAs<lookout::config::Segmenter>(text);
  ParseAs<lookout::config::Lidar>(text);
  return 0;
}
