#include "services/vlp16/params.hpp"

#include "common/config/text_config.hpp"
#include "common/core/angles.hpp"
#include "config/schema/vlp16.pb.h"

namespace lookout::vlp16 {

namespace {

ModelChoice ToChoice(config::Vlp16::Model model) {
  switch (model) {
    case config::Vlp16::MODEL_VLP16:
      return ModelChoice::kVlp16;
    case config::Vlp16::MODEL_PUCK_HI_RES:
      return ModelChoice::kPuckHiRes;
    default:
      return ModelChoice::kAuto;
  }
}

TimeChoice ToChoice(config::Vlp16::TimeSource source) {
  switch (source) {
    case config::Vlp16::TIME_SENSOR:
      return TimeChoice::kSensor;
    case config::Vlp16::TIME_HOST:
      return TimeChoice::kHost;
    default:
      return TimeChoice::kAuto;
  }
}

}  // namespace

Params LoadParams(const std::filesystem::path& config_folder) {
  const auto file = config_folder / "vlp16.txtpb";
  config::Vlp16 message;
  config::LoadText(file, message);
  const bool is_capture = message.source() == config::Vlp16::CAPTURE;
  if (is_capture && message.capture_file().empty()) config::Refuse(file, "capture_file", "must be set when source is CAPTURE");
  if (message.data_port() == message.position_port()) config::Refuse(file, "position_port", "must differ from data_port");

  Params params;
  params.input = message.source() == config::Vlp16::LOG ? Input::kLog : Input::kOutside;
  params.data_port = message.data_port();
  params.position_port = message.position_port();
  params.decoder.model = ToChoice(message.model());
  params.decoder.time = ToChoice(message.time_source());
  params.decoder.cut_azimuth_rad = DegToRad(message.cut_azimuth_deg());
  params.use_vertical_origin_offsets = message.use_vertical_origin_offsets();
  if (is_capture) params.capture_file = config_folder / message.capture_file();
  params.bind_address = message.bind_address();
  params.receive_buffer_bytes = message.receive_buffer_bytes();
  return params;
}

}  // namespace lookout::vlp16
