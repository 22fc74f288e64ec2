// Any text typed at the questions of lookout-setup: answers of which a boat is made that its own loader takes, or the end of the input.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>

#include "common/config/boat.hpp"
#include "common/config/text_config.hpp"
#include "config/schema/boat.pb.h"
#include "tools/setup/boat_file.hpp"
#include "tools/setup/picture.hpp"
#include "tools/setup/questions.hpp"

namespace {

// The first byte says what was heard.
lookout::setup::Heard HeardOf(std::uint8_t choice) {
  lookout::setup::Heard heard;
  for (int i = 0; i < choice % 3; ++i) {
    lookout::lidar::Speaker speaker;
    speaker.source_address = "192.168.1." + std::to_string(201 + i);
    speaker.data_port = 2368;
    speaker.name = "Velodyne VLP-16";
    speaker.is_of_vlp16_family = true;
    heard.lidars.push_back(speaker);
  }
  if (choice >= 128) heard.nmea.push_back({.port = 10110, .num_by_type = {{"HDT", 1}}, .has_heading = true});
  return heard;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto heard = HeardOf(data[0]);
  std::istringstream in(std::string(reinterpret_cast<const char*>(data + 1), size - 1));
  std::ostringstream out;
  lookout::config::Answers answers;
  if (!lookout::setup::Ask(heard, in, out, answers)) return 0;
  lookout::setup::Picture(answers);
  lookout::config::Boat boat;
  lookout::config::ParseText(lookout::setup::BoatFile(answers, heard), "boat.txtpb", boat);  // a fault ends the target
  lookout::config::ToFacts(boat, "boat.txtpb");
  return 0;
}
