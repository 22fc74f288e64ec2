#include "lab/sim/log_sink.hpp"

#include <utility>
#include <variant>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/runtime/run_info.hpp"
#include "lab/data/scan_message.hpp"

namespace lookout::sim {
namespace {

replay::Plan NavigatorAlone() {
  replay::Plan plan;
  plan.services = {"navigator"};
  return plan;
}

}  // namespace

LogSink::LogSink(const std::filesystem::path& file, const std::filesystem::path& config_folder, std::string model, const std::string& program,
                 const io::OutputOptions& options)
    : model_(std::move(model)),
      run_info_(runtime::MakeRunInfo("sim", config_folder)),
      file_(file, options),
      log_([this](Bytes bytes) { file_.Write(bytes); }),
      navigator_(config_folder, NavigatorAlone(), [this](Utime time, std::string_view channel, Bytes bytes) {
        if (channel == bus::kNavRaw.name) log_.Write(time, channel, bytes);
      }) {
  run_info_.file_name.emplace_back("lookout-sim");
  run_info_.file_text.push_back(program + "\n");
  run_info_.num_files = static_cast<std::int32_t>(run_info_.file_name.size());
}

void LogSink::WriteRunInfo(Utime time) {
  run_info_.utime_us = ToUtimeUs(time);
  log_.Write(time, bus::kRunInfo.name, bus::Encode(run_info_));
  ++run_info_.seq;
}

void LogSink::Send(const HeadSimulation::Event& event) {
  if (!last_) WriteRunInfo(event.time);
  last_ = event.time;
  if (const auto* datagram = std::get_if<Datagram>(&event.heard)) {
    navigator_.OnDatagram({datagram->time, datagram->port, datagram->payload});
    return;
  }
  for (const auto& part : data::ToScanMessages(std::get<HeadScan>(event.heard).scan, model_, bus::kMaxMessageBytes)) {
    log_.Write(event.time, bus::kLidarScan.name, bus::Encode(part));
  }
}

io::OutputFile& LogSink::Finish() {
  navigator_.Finish();
  if (last_) WriteRunInfo(*last_);
  log_.Flush();
  return file_;
}

}  // namespace lookout::sim
