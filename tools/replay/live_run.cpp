#include "tools/replay/live_run.hpp"

#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "common/io/stop_signal.hpp"
#include "lookout/alerts_t.hpp"
#include "services/tracker/wire.hpp"

namespace lookout::replay {

namespace {

void Add(const alerts_t& message, tracker::Script& script) {
  const auto time = UtimeFromWire(message.utime_us);
  const auto begin_time = UtimeFromWire(message.begin_utime_us);
  if (message.is_watch || !time || !begin_time) return;  // of the watch: by the host's clock
  const tracker::ScanKey key{*time, message.seq};
  const tracker::ScanKey begin{*begin_time, message.begin_seq};
  auto& stretches = script.stretches;
  if (stretches.empty() || stretches.back().begin != begin) {
    stretches.push_back({begin, begin, key});  // also where the first ALERTS were lost
  } else if (key < stretches.back().last) {
    stretches.push_back({begin, key, key});
  }
  stretches.back().last = key;
  for (const auto& acknowledgement : message.acknowledged) {
    if (!messages::FaultOf(acknowledgement)) script.acknowledged[key].push_back(tracker::ToAcknowledgement(acknowledgement));
  }
}

}  // namespace

std::optional<tracker::Script> ReadScript(const std::vector<std::filesystem::path>& logs) {
  tracker::Script script;
  for (const auto& log : logs) {
    bus::LogReader reader(log, io::ThrowIfStopAsked);
    while (const auto event = reader.NextView([](std::string_view channel) { return channel == bus::kAlerts.name; })) {
      io::ThrowIfStopAsked();
      if (event->channel != bus::kAlerts.name) continue;
      if (const auto message = bus::Decode<alerts_t>(event->bytes)) Add(*message, script);
    }
  }
  if (script.stretches.empty()) return std::nullopt;
  return script;
}

}  // namespace lookout::replay
