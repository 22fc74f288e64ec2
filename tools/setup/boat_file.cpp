#include "tools/setup/boat_file.hpp"

#include <fmt/format.h>

#include <google/protobuf/text_format.h>
#include <sstream>

namespace lookout::setup {

namespace {

std::string Quoted(const std::string& text) {
  config::Answers message;
  message.set_name(text);
  google::protobuf::TextFormat::Printer printer;
  printer.SetUseUtf8StringEscaping(true);
  std::string quoted;
  printer.PrintFieldValueToString(message, config::Answers::descriptor()->FindFieldByName("name"), -1, &quoted);
  return quoted;
}

std::string PlaceText(const Place& place) { return fmt::format("x_m: {} y_m: {} z_m: {}", place.x_m, place.y_m, place.z_m); }

// Lines for a lidar that was not heard: its model, and ports as delivered.
std::string UnheardLidar(config::Lidar::Model model) {
  lidar::Speaker speaker;
  constexpr int kFirstOther = config::Lidar::MODEL_VLP32C;
  if (model < kFirstOther) return "  model: " + config::Lidar::Model_Name(model) + "\n";
  const auto other = static_cast<lidar::OtherModel>(model - kFirstOther);
  const auto& row = lidar::RowOf(other);
  std::string text = "  model: " + config::Lidar::Model_Name(model) + "\n";
  text += fmt::format("  data_port: {}\n  position_port: {}\n", row.usual_data_port, row.usual_position_port);
  if (row.needs_beam_file)
    text += "  beam_file: \"metadata.json\"  # fetch it: curl http://SENSOR/api/v1/sensor/metadata; or sensor_address in its place\n";
  return text;
}

std::string HeardLidar(const lidar::Speaker& speaker, bool is_one_of_several) {
  std::string text;
  std::istringstream lines(lidar::ConfigLines(speaker));
  for (std::string line; std::getline(lines, line);) {
    const bool is_asked = line.starts_with("beam_file") && !speaker.source_address.empty();
    text += "  " + (is_asked ? "sensor_address: " + Quoted(speaker.source_address) + "  # it says its own beams" : line) + "\n";
  }
  if (is_one_of_several) text += "  allowed_source_address: " + Quoted(speaker.source_address) + "  # others send, too\n";
  return text;
}

std::string LidarInput(const config::Answers& answers, const Heard& heard) {
  const auto* const speaker = ChosenLidar(answers, heard);
  std::string text = "# How the lidar is heard: by UDP on every interface.\nlidar_input {\n";
  if (speaker == nullptr) {
    text += "  # None was heard: as it is delivered. lookout-doctor says which one speaks, and its lines.\n" + UnheardLidar(answers.lidar_model());
  } else {
    text += "  # " + speaker->name + "\n" + HeardLidar(*speaker, heard.lidars.size() > 1);
  }
  return text + "}\n";
}

std::string TypesOf(const NmeaHeard& source) {
  std::string text;
  for (const auto& [type, unused] : source.num_by_type) text += (text.empty() ? "" : " ") + type;
  return text;
}

std::string NavigatorInput(const config::Answers& answers, const Heard& heard) {
  std::string inputs;
  std::string port_comment = "NMEA 0183 by UDP, port 10110, from every interface";
  int number = 0;
  for (const auto& source : heard.nmea) {
    if (source.kind == NmeaHeard::Kind::kSerial) {
      inputs += fmt::format("  input {{ name: \"serial{}\" serial {{ device: {} baud: {} }} }}  # {}\n", ++number, Quoted(source.device), source.baud,
                            TypesOf(source));
    } else if (source.kind == NmeaHeard::Kind::kUdp && source.port == kNmeaPort) {
      port_comment += ": " + TypesOf(source);
    } else if (source.kind == NmeaHeard::Kind::kUdp) {
      inputs += fmt::format("  input {{ name: \"udp{}\" udp {{ bind_address: \"0.0.0.0\" port: {} }} }}  # {}\n", source.port, source.port,
                            TypesOf(source));
    }
  }
  std::string text = "# Where position, heading, roll and pitch come from; the sentences that the lidar passes on count, too.\nnavigator {\n";
  text += "  bind_address: \"0.0.0.0\"  # " + port_comment + "\n" + inputs;
  if (answers.heading_offset_deg() != 0.0) text += fmt::format("  heading_offset_deg: {}\n", answers.heading_offset_deg());
  return text + "}\n";
}

std::string TrackerText(const config::Answers& answers) {
  const double range_m = GuardZoneM(answers);
  if (range_m <= 0.0) return {};
  return fmt::format(
      "# What comes nearer than this ahead, to 60 degrees on each side, raises an alert.\n"
      "tracker {{ guard_zone {{ range_m: {} from_bearing_deg: 300 to_bearing_deg: 60 }} }}\n",
      range_m);
}

}  // namespace

std::string BoatFile(const config::Answers& answers, const Heard& heard) {
  const auto box = BoxOf(answers);
  std::string text =
      "# proto-file: config/schema/boat.proto\n# proto-message: lookout.config.Boat\n"
      "# A boat in one file, written by lookout-setup. Metres in the vessel frame: x forward, y to port, z up, from the middle of the hull at the "
      "height\n"
      "# of the water. All that does not stand here has the defaults of config/schema/*.proto; lookout-up --check --values prints them.\n";
  text += fmt::format("name: {}\nhull_length_m: {}\nhull_beam_m: {}\n", Quoted(answers.name()), answers.hull_length_m(), answers.hull_beam_m());
  text += "reference_point_above_water_m: 0\n";
  text += fmt::format("lidar {{ {} roll_deg: {} pitch_deg: {} yaw_deg: {} }}\n", PlaceText(LidarPlace(answers)), answers.lidar_roll_deg(),
                      answers.lidar_pitch_deg(), answers.lidar_faces_deg());
  text +=
      fmt::format("gnss_antenna {{ {} }}{}\n", PlaceText(AntennaPlace(answers)), answers.has_gnss_antenna() ? "" : "  # not told: that of the lidar");
  text += "# Returns inside are the own boat: the hull with 0.2 m around it, from below the water to above the lidar.\n";
  text += fmt::format("own_vessel {{ min_x_m: {} max_x_m: {} min_y_m: {} max_y_m: {} min_z_m: {} max_z_m: {} }}\n", box.min.x_m, box.max.x_m,
                      box.min.y_m, box.max.y_m, box.min.z_m, box.max.z_m);
  text += "\n" + LidarInput(answers, heard) + NavigatorInput(answers, heard) + TrackerText(answers);
  if (answers.viewers() == config::Answers::EVERYBODY) {
    text += "# Everybody in each network of this computer sees the picture, without a password.\npage { bind_address: \"0.0.0.0\" }\n";
  }
  return text;
}

}  // namespace lookout::setup
