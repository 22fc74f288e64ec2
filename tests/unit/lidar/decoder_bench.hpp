// A decoder, and what it made of the packets that were sent to it.
#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

#include "common/core/angles.hpp"
#include "services/lidar/core/vlp16/decoder.hpp"
#include "tests/unit/lidar/packet_maker.hpp"

namespace lookout::vlp16::test {

inline const Utime kDecoderTime = Utime(std::chrono::hours(24 * 20000));

struct DecoderBench {
  explicit DecoderBench(const DecoderParams& params = {})
      : decoder(
            params, [this](const Scan& scan) { scans.push_back(scan); }, [this](const SentenceOfLidar& sentence) { sentences.push_back(sentence); }) {
  }

  // The host takes a packet when its last shot has gone out.
  void Send(SpinningSensor& sensor, int num_packets = 1) {
    for (int i = 0; i < num_packets; ++i) {
      const auto payload = sensor.Next();
      decoder.OnDataPayload(kDecoderTime + std::chrono::floor<std::chrono::microseconds>(std::chrono::nanoseconds(sensor.time_ns)), payload);
    }
  }

  std::int64_t CountOf(std::string_view name) const {
    const auto counters = decoder.counters();
    const auto found = std::ranges::find(counters, name, &Counter::name);
    return found != counters.end() ? found->count : -1;
  }

  std::vector<Scan> scans;
  std::vector<SentenceOfLidar> sentences;
  Decoder decoder;
};

inline DecoderParams Cut(double cut_deg) {
  DecoderParams params;
  params.cut_azimuth_rad = DegToRad(cut_deg);
  return params;
}

}  // namespace lookout::vlp16::test
