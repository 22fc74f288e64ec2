// A capture with truth, made by the simulator and packed as the second world's are.
#pragma once

#include <lzma.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "lab/eval/methods/captures.hpp"
#include "lab/sim/lidar.hpp"
#include "lab/sim/scene_file.hpp"
#include "lab/sim/sinks.hpp"
#include "tests/support/files.hpp"

namespace lookout::eval::test {

/// As xz would have written it.
inline std::string Pack(const std::string& bytes) {
  std::vector<std::uint8_t> packed(lzma_stream_buffer_bound(bytes.size()));
  std::size_t size = 0;
  const auto* in = reinterpret_cast<const std::uint8_t*>(bytes.data());
  constexpr std::uint32_t kFast = 1;
  if (lzma_easy_buffer_encode(kFast, LZMA_CHECK_CRC32, nullptr, in, bytes.size(), packed.data(), &size, packed.size()) != LZMA_OK) {
    throw std::runtime_error("xz");
  }
  return {packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(size)};
}

/// A folder of its own for each test, removed at its end.
class Captures : public ::testing::Test {
 protected:
  static constexpr std::uint64_t kSeed = 7;
  static constexpr double kSeconds = 0.4;  // three whole scans

  void Write(const std::string& name, const std::string& bytes) const { std::ofstream(folder_ / name, std::ios::binary) << bytes; }

  /// The scene as a capture, NAME-7, with its truth; scene_ and boat_ are what was rendered.
  void Make(const std::string& name) {
    boat_ = LoadBoat(kConfig);
    scene_ = sim::LoadScene(sim::FindScene(name, kConfig), kSeed);
    sim::LidarParams params;
    params.use_vertical_origin_offsets = boat_.lidar.decoder.use_vertical_origin_offsets;
    constexpr Utime kStart{std::chrono::microseconds(1'781'532'600'000'000)};
    sim::Lidar lidar(scene_, boat_.facts, params, kStart, kSeed);
    const auto capture = folder_ / "plain.pcap";
    sim::PcapSink sink(capture, {vlp16::format::kDataPort});
    std::ostringstream truth;
    truth << "utime_us,ring,return_index,range_m,object_id\n";
    const Utime end = kStart + std::chrono::microseconds(static_cast<std::int64_t>(kSeconds * 1e6));
    for (auto packet = lidar.Next(); packet.end_time <= end; packet = lidar.Next()) {
      sink.Send({packet.end_time + std::chrono::microseconds(150), vlp16::format::kDataPort, {packet.payload.begin(), packet.payload.end()}});
      for (const auto& one : packet.returns) {
        const std::size_t block = static_cast<std::size_t>(one.slot) / 32;
        const std::size_t place = block * vlp16::format::kBlockSizeBytes + vlp16::format::kBlockReturnsOffset +
                                  static_cast<std::size_t>(one.slot) % 32 * vlp16::format::kReturnSizeBytes;
        const int range = packet.payload[place] + 256 * packet.payload[place + 1];
        truth << ToUtimeUs(one.time) << ',' << one.ring << ',' << one.return_index << ',' << range / 500 << '.'
              << std::to_string(1000 + range % 500 * 2).substr(1) << ',' << one.object_id << '\n';
      }
    }
    sink.Finish().Commit();
    std::ifstream in(capture, std::ios::binary);
    pcap_ = std::string(std::istreambuf_iterator<char>(in), {});
    std::filesystem::remove(capture);
    truth_ = truth.str();
    objects_ = "utime_us,object_id,type\n";
    for (const auto& object : scene_.objects) objects_ += "0," + std::to_string(object.id) + "," + object.kind + "\n";
    name_ = name + "-" + std::to_string(kSeed);
    WriteAll();
  }

  void WriteAll() const {
    Write(name_ + ".pcap.xz", Pack(pcap_));
    Write(name_ + ".truth.csv.xz", Pack(truth_));
    Write(name_ + ".objects.csv.xz", Pack(objects_));
  }

  CaptureReport Read(const ScanHandler& on_scan = [](const LabelledScan&) {}) const {
    return ReadCapture(ListCaptures(folder_).at(0), LoadBoatOfCaptures(folder_, kConfig), on_scan);
  }

  /// Why it cannot be read, without the folder; empty when it can.
  std::string Fault() const {
    try {
      Read();
    } catch (const std::runtime_error& error) {
      std::string reason = error.what();
      for (auto at = reason.find(folder_.string() + "/"); at != std::string::npos; at = reason.find(folder_.string() + "/")) {
        reason.erase(at, folder_.string().size() + 1);
      }
      return reason;
    }
    return "";
  }

  const std::filesystem::path kConfig = support::kCatabotConfig;
  support::TempDir folder_;
  std::string name_;
  std::string pcap_;
  std::string truth_;
  std::string objects_;
  sim::Scene scene_;
  Boat boat_;
};

}  // namespace lookout::eval::test
