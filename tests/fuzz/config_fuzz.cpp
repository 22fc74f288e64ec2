// Any text into the config loader: a message or a ConfigError, nothing else.
#include <cstddef>
#include <cstdint>
#include <string>

#include "common/config/text_config.hpp"
#include "config/schema/boat.pb.h"
#include "config/schema/navigator.pb.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    lookout::config::Boat boat;
    lookout::config::ParseText(text, "fuzz", boat);
    lookout::config::EffectiveText(boat);
  } catch (const lookout::config::ConfigError&) {
  }
  try {
    lookout::config::Navigator navigator;
    lookout::config::ParseText(text, "fuzz", navigator);
    lookout::config::EffectiveText(navigator);
  } catch (const lookout::config::ConfigError&) {
  }
  return 0;
}
