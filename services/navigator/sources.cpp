#include "services/navigator/sources.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <spdlog/fmt/chrono.h>
#include <spdlog/spdlog.h>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "common/io/file_kind.hpp"
#include "common/io/udp_receiver.hpp"
#include "services/navigator/io/gpsd_client.hpp"
#include "services/navigator/io/serial_port.hpp"
#include "services/navigator/io/tcp_client.hpp"
#include "services/navigator/io/text_log_player.hpp"

namespace lookout::navigator {

namespace {

// Seconds of sentences at 115200 baud; more can only be a flood.
constexpr int kReceiveBufferBytes = 256 * 1024;
// How late a tick may come: a tenth of its period.
constexpr std::chrono::milliseconds kTick(10);
constexpr int kMaxPieces = 64;

std::vector<TextLogPlayer::Log> LogsOf(const Params& params) {
  std::vector<TextLogPlayer::Log> logs;
  for (const auto& connection : params.connections) {
    if (const auto reason = io::WhyNot(connection.file, io::Wanted::kTextLog); !reason.empty()) throw std::runtime_error(reason);
    if (!IsTextLog(connection.file)) throw std::runtime_error("text log " + connection.file.string() + ": holds no sentence of NMEA 0183");
    logs.push_back({connection.name, connection.file, connection.day});
  }
  return logs;
}

// Text logs have times of their own: the clock of this computer decides only when a line is due.
class TextLogSource final : public runtime::SourceReader {
 public:
  TextLogSource(const Params& params, Service& service)
      : SourceReader(kTick),
        taker_{[&service](Utime time) { service.AdvanceTo(time); },
               [&service](Utime time, Bytes line, const std::string& name) { service.OnDatagram(time, line, name); }},
        player_(LogsOf(params), params.connections.front().speed),
        fault_(fmt::format("plays a text log of {:%Y-%m-%d %H:%M:%S} UTC, so POSE is not of now: what is measured now finds none",
                           std::chrono::floor<std::chrono::seconds>(player_.start()))) {
    for (const auto& name : player_.dateless()) fault_ += "; no sentence of input '" + name + "' tells a date, set text_log.date";
    spdlog::warn("{}", fault_);
  }

  bool Read() override {
    player_.Play(runtime::SteadyNow(), taker_);
    if (!player_.is_finished()) return true;
    if (const auto fault = player_.fault(); !fault.empty()) spdlog::warn("{}: played as far as it can be read", fault);
    return false;
  }
  Utime Now() const override { return player_.time(); }
  std::string fault() const override { return fault_; }
  std::vector<Counter> counters() const override { return player_.counters(); }

 private:
  TextLogPlayer::Taker taker_;
  TextLogPlayer player_;
  std::string fault_;
};

}  // namespace

std::unique_ptr<io::Source> OpenSource(const Connection& connection) {
  switch (connection.kind) {
    case Connection::Kind::kSerial:
      return std::make_unique<SerialPort>(connection.name, connection.file, connection.baud);
    case Connection::Kind::kTcp:
      return std::make_unique<TcpClient>(connection.name, connection.address, connection.port);
    case Connection::Kind::kGpsd:
      return std::make_unique<GpsdClient>(connection.name, connection.address, connection.port);
    case Connection::Kind::kTextLog:
      throw std::logic_error("a text log is no source of now");
    case Connection::Kind::kUdp:
      break;
  }
  return std::make_unique<io::UdpReceiver>(io::UdpOptions{
      .name = connection.name, .bind_address = connection.address, .port = connection.port, .receive_buffer_bytes = kReceiveBufferBytes});
}

void Pass(const std::string& name, const io::Source::Piece& piece, Service& service) {
  switch (piece.kind) {
    case io::Source::Kind::kBreak:
      return service.OnStreamEnd(name);
    case io::Source::Kind::kDatagram:
      return service.OnDatagram(piece.host_time, piece.bytes, name, piece.source_address + " " + std::to_string(piece.source_port));
    case io::Source::Kind::kStream:
      return service.OnStream(piece.host_time, piece.bytes, name);
  }
}

std::unique_ptr<runtime::SourceReader> OpenSources(const Params& params, Service& service) {
  if (params.reads_nav_raw) return nullptr;
  const auto is_text_log = [](const auto& connection) { return connection.kind == Connection::Kind::kTextLog; };
  if (!params.connections.empty() && std::ranges::all_of(params.connections, is_text_log)) return std::make_unique<TextLogSource>(params, service);
  std::vector<runtime::LiveReader::NamedSource> sources;
  for (const auto& connection : params.connections) sources.push_back({connection.name, OpenSource(connection)});
  return std::make_unique<runtime::LiveReader>(
      std::move(sources), runtime::LiveReader::Limits{.period = kTick, .max_pieces = kMaxPieces, .reads_when_readable = true},
      runtime::LiveReader::Handlers{.on_piece = [&service](const std::string& name, const io::Source::Piece& piece) { Pass(name, piece, service); },
                                    // A process that stood still since the start of the round would otherwise look like a clock that was set back.
                                    .on_round = [&service](const auto& round) { service.AdvanceTo(round.latest); }});
}

}  // namespace lookout::navigator
