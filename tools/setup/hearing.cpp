#include "tools/setup/hearing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <thread>

#include "common/io/network.hpp"
#include "common/io/stop_signal.hpp"
#include "common/io/udp_receiver.hpp"
#include "common/runtime/process.hpp"
#include "services/lidar/core/vlp16/packet_format.hpp"
#include "services/lidar/io/capture_reader.hpp"
#include "tools/doctor/cable.hpp"
#include "tools/doctor/machine.hpp"
#include "tools/setup/serial_search.hpp"

namespace lookout::setup {

namespace {

constexpr int kBufferBytes = 1 << 20;
constexpr int kMostPiecesPerPoll = 200;
constexpr std::chrono::milliseconds kPause(5);

class Ear {
 public:
  void Take(const io::Source::Piece& piece) {
    lidars_.Add(piece.host_time, piece.source_address, piece.destination_address, piece.port, piece.bytes);
    Take(piece.host_time, piece.port, piece.bytes, !piece.destination_address.empty());
  }
  void Take(Utime time, int port, Bytes payload, bool is_frame) {
    if (payload.size() == vlp16::format::kPositionPacketSizeBytes) {
      nmea.AddPositionPacket(time, payload);
    } else {
      nmea.AddDatagram(time, port, payload, is_frame);
    }
  }
  void Take(const lidar::Datagram& datagram) {
    lidars_.Add(datagram.host_time, datagram.source_address, datagram.destination_address, datagram.destination_port, datagram.payload);
    Take(datagram.host_time, datagram.destination_port, datagram.payload, true);
  }

  Heard Result() const {
    Heard heard;
    for (auto& speaker : lidars_.Speakers()) {
      if (lidar::ConfigLines(speaker).empty()) {
        heard.unread.push_back(speaker.name);
      } else {
        heard.lidars.push_back(std::move(speaker));
      }
    }
    heard.nmea = nmea.Sources();
    return heard;
  }

  NmeaSurvey nmea;

 private:
  lidar::Survey lidars_;
};

std::string LidarInWords(const lidar::Speaker& speaker, bool is_recording) {
  std::string text = "lidar: " + speaker.name;
  if (!speaker.source_address.empty()) text += " at " + speaker.source_address;
  text += fmt::format(", port {}", speaker.data_port);
  const double seconds = ToSeconds(speaker.last - speaker.first);
  if (seconds > 0.0 && speaker.num_packets > 1) text += fmt::format(", {:.0f} packets/s", static_cast<double>(speaker.num_packets - 1) / seconds);
  const auto clock = speaker.host_minus_stamp && speaker.stamp
                         ? lidar::ClockDifferenceText(*speaker.host_minus_stamp, *speaker.stamp, is_recording ? "the recording's" : "this computer's")
                         : std::string();
  return text + (clock.empty() ? "" : "; its clock: " + clock);
}

std::string PlaceOf(const NmeaHeard& heard) {
  switch (heard.kind) {
    case NmeaHeard::Kind::kLidar:
      return "through the lidar";
    case NmeaHeard::Kind::kSerial:
      return fmt::format("serial port {}, {} baud", heard.device, heard.baud);
    default:
      return fmt::format("UDP port {}", heard.port);
  }
}

bool HasImu(const lidar::Speaker& speaker) { return speaker.other == lidar::OtherModel::kOuster && speaker.second_port.has_value(); }

}  // namespace

Heard Listen(std::chrono::milliseconds duration, const std::vector<std::filesystem::path>& devices) {
  Ear ear;
  std::vector<std::string> faults;
  doctor::Cable cable({});
  std::unique_ptr<io::UdpReceiver> nmea;
  try {
    io::UdpOptions options;
    options.bind_address = "0.0.0.0";
    options.port = kNmeaPort;
    options.receive_buffer_bytes = kBufferBytes;
    nmea = std::make_unique<io::UdpReceiver>(options);
  } catch (const std::exception& error) {
    faults.emplace_back(error.what());
  }
  const auto own_addresses = doctor::ReadInterfaces();
  std::vector<SerialSearch> searches(devices.begin(), devices.end());
  const auto end = std::chrono::steady_clock::now() + duration;
  const auto is_done = [](const SerialSearch& search) { return search.IsDone(); };
  while (std::chrono::steady_clock::now() < end || !std::ranges::all_of(searches, is_done)) {
    io::ThrowIfStopAsked();
    const auto now = runtime::HostNow();
    cable.Poll(now, [&](const io::Source::Piece& piece) {
      // Datagrams that are captured on interfaces come to the sockets, too, so sockets count for loopback alone, which is not captured. Datagrams of
      // this computer come from no sensor.
      const bool is_frame = !piece.destination_address.empty();
      const auto sender = io::ParseIpAddress(piece.source_address);
      if (is_frame && sender && std::ranges::find(own_addresses, sender, &doctor::InterfaceSeen::address) != own_addresses.end()) return;
      if (is_frame || !cable.hears_all_ports() || (sender && io::IsLoopback(*sender))) ear.Take(piece);
    });
    if (nmea) {
      nmea->Poll(now);
      for (int i = 0; i < kMostPiecesPerPoll; ++i) {
        const auto piece = nmea->Receive(now);
        if (!piece) break;
        ear.Take(*piece);
      }
    }
    for (auto& search : searches) search.Poll(now, ear.nmea);
    std::this_thread::sleep_for(kPause);
  }
  auto heard = ear.Result();
  for (const auto& search : searches) {
    if (search.is_found()) continue;
    faults.push_back(search.device().string() + ": " + (search.fault().empty() ? "no NMEA 0183 at any usual baud rate" : search.fault()));
  }
  heard.faults = std::move(faults);
  return heard;
}

Heard ReadRecordings(const std::vector<std::filesystem::path>& files) {
  Ear ear;
  std::vector<std::string> faults;
  for (const auto& file : files) {
    lidar::CaptureReader reader(file);
    while (const auto datagram = reader.Next()) {
      io::ThrowIfStopAsked();
      ear.Take(*datagram);
    }
    if (reader.num_damaged() > 0) faults.push_back(file.string() + ": " + reader.damage());
  }
  auto heard = ear.Result();
  heard.faults = std::move(faults);
  heard.is_recording = true;
  return heard;
}

std::vector<std::string> InWords(const Heard& heard) {
  constexpr std::size_t kMostLacking = 4;
  std::vector<std::string> lines;
  lines.reserve(heard.lidars.size() + heard.unread.size() + heard.nmea.size() + heard.faults.size() + kMostLacking);
  for (const auto& speaker : heard.lidars) lines.push_back(LidarInWords(speaker, heard.is_recording));
  for (const auto& name : heard.unread) lines.push_back("lidar: " + name + ", whose packets are not read");
  bool has_position = false;
  bool has_heading = false;
  bool has_tilt = std::ranges::any_of(heard.lidars, HasImu);
  for (const auto& source : heard.nmea) {
    lines.push_back("NMEA 0183, " + PlaceOf(source) + ": " + SentencesInWords(source));
    has_position |= source.has_position;
    has_heading |= source.has_heading;
    has_tilt |= source.has_tilt;
  }
  for (const auto& fault : heard.faults) lines.push_back("not heard: " + fault);
  if (heard.lidars.empty())
    lines.emplace_back("lacking: no lidar. Is it switched on, and has this computer an address in its network (a VLP-16: 192.168.1.x)?");
  if (!has_position) lines.emplace_back("lacking: no position. Tracks and alerts are then relative to where the boat started");
  if (!has_heading) lines.emplace_back("lacking: no heading. The course over ground stands in for it above 1 m/s");
  if (!has_tilt) lines.emplace_back("lacking: no roll and pitch. In waves places far away are less sure");
  return lines;
}

}  // namespace lookout::setup
