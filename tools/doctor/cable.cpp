#include "tools/doctor/cable.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <exception>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>

#include "common/bus/memory_bus.hpp"
#include "common/io/udp_receiver.hpp"
#include "services/lidar/io/capture_reader.hpp"
#include "services/lidar/io/live_capture.hpp"
#include "services/lidar/service.hpp"
#include "tools/doctor/machine.hpp"
#include "tools/doctor/watch.hpp"

namespace lookout::doctor {

namespace {

constexpr int kBufferBytes = 1 << 20;
constexpr int kMaxPiecesPerPoll = 200;
// As delivered: Velodyne and Hesai, Ouster, RoboSense, Livox.
constexpr std::array kUsualPorts{2368, 8308, 7502, 7503, 6699, 7788, 56301, 56401};

}  // namespace

Cable::Cable(const std::vector<int>& ports_in_use) {
  for (const auto& interface : ReadInterfaces()) {
    if (interface.is_loopback || !interface.has_carrier) continue;
    try {
      lidar::LiveOptions options;
      options.interface = interface.name;
      options.filter = "udp or (vlan and udp)";
      options.has_large_packets = true;
      options.receive_buffer_bytes = kBufferBytes;
      sources_.push_back(std::make_unique<lidar::LiveCapture>(options));
      hears_all_ports_ = true;
    } catch (const std::exception&) {
      // Without the right to capture the sockets below hear.
    }
  }
  for (const int port : kUsualPorts) {
    if (std::ranges::find(ports_in_use, port) != ports_in_use.end()) continue;
    try {
      io::UdpOptions options;
      options.bind_address = "0.0.0.0";
      options.port = port;
      options.receive_buffer_bytes = kBufferBytes;
      sources_.push_back(std::make_unique<io::UdpReceiver>(options));
    } catch (const std::exception&) {
      // Another program has the port.
    }
  }
}

void Cable::Poll(Utime now, const std::function<void(const io::Source::Piece&)>& take) {
  for (auto& source : sources_) {
    source->Poll(now);
    for (int i = 0; i < kMaxPiecesPerPoll; ++i) {
      const auto piece = source->Receive(now);
      if (!piece) break;
      take(*piece);
    }
  }
}

void Cable::Poll(Utime now, lidar::Survey& survey) {
  Poll(now, [&survey](const io::Source::Piece& piece) {
    survey.Add(piece.host_time, piece.source_address, piece.destination_address, piece.port, piece.bytes);
  });
}

std::int64_t NumReassemblyFailures() {
  // Two lines "Ip: ...": names, then numbers.
  std::ifstream file("/proc/net/snmp");
  std::string names;
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("Ip:", 0) != 0) continue;
    if (names.empty()) {
      names = line;
      continue;
    }
    std::istringstream name_words(names);
    std::istringstream number_words(line);
    std::string name;
    std::string number;
    while (name_words >> name && number_words >> number) {
      if (name == "ReasmFails") return std::stoll(number);
    }
  }
  return -1;
}

void ReadCaptures(const std::vector<std::filesystem::path>& files, Observations& seen) {
  bus::MemoryBus memory;
  Utime now{};
  Notes notes(seen, [&now] { return now; });
  notes.ListenTo(memory, Via::kItself);
  std::optional<lidar::Service> service;
  seen.lidar.via = Via::kItself;
  seen.lidar.is_capture = true;
  if (seen.config.lidar) {
    seen.config.lidar->input = lidar::Input::kOutside;
    service.emplace(memory, *seen.config.lidar);
  }
  const auto drain = [&memory] {
    while (memory.HandleOnce()) {
    }
  };
  lidar::Survey survey;
  Utime first{};
  std::int64_t num_datagrams = 0;
  for (const auto& file : files) {
    lidar::CaptureReader reader(file);
    while (const auto datagram = reader.Next()) {
      now = datagram->host_time;
      if (num_datagrams++ == 0) first = now;
      survey.Add(now, datagram->source_address, datagram->destination_address, datagram->destination_port, datagram->payload);
      if (!service) continue;
      service->AdvanceTo(now);
      service->OnDatagram(now, datagram->destination_port, datagram->payload, {datagram->source_address, datagram->source_port});
      drain();
    }
    for (const auto& counter : reader.counters()) {
      if (counter.name == "datagrams_given_up") seen.lidar.num_fragments_lost += counter.count;
    }
    if (reader.num_damaged() > 0) seen.lidar.fault = file.string() + ": " + reader.damage();
  }
  if (service) {
    service->Finish(now);
    drain();
    // Packets that the decoder refuses for longer than 1 s are a complaint, so time goes on behind the capture. Where scans came the end of the
    // capture is no silence.
    constexpr std::chrono::seconds kSilence(2);
    if (seen.lidar.model.empty()) service->AdvanceTo(now + kSilence);
    seen.lidar.complaint = service->Report().reason;
  }
  seen.lidar.speakers = survey.Speakers();
  seen.end = now;
  seen.watched_s = ToSeconds(now - first);
}

}  // namespace lookout::doctor
