// Any bytes into the guarded decoder of every channel's type: no crash, no hang, no great allocation.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "common/bus/decode.hpp"
#include "lookout/attitude_t.hpp"
#include "lookout/gnss_fix_t.hpp"
#include "lookout/health_t.hpp"
#include "lookout/lidar_clock_t.hpp"
#include "lookout/lidar_nmea_t.hpp"
#include "lookout/lidar_packets_t.hpp"
#include "lookout/lidar_scan_t.hpp"
#include "lookout/nav_raw_t.hpp"
#include "lookout/obstacles_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/run_info_t.hpp"
#include "lookout/segments_t.hpp"

namespace {

// The first byte chooses the type; its fingerprint is put in front, since no fuzzer guesses one.
template <typename T>
void DecodeAs(lookout::Bytes body) {
  std::vector<std::uint8_t> bytes;
  const auto fingerprint = static_cast<std::uint64_t>(T::getHash());
  for (int shift = 56; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(fingerprint >> shift));
  bytes.insert(bytes.end(), body.begin(), body.end());
  const auto message = lookout::bus::Decode<T>(bytes);
  // What decodes took exactly these bytes; encoded again it has the same length, unless a string holds a zero byte.
  if (message && message->getEncodedSize() != static_cast<int>(bytes.size())) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const lookout::Bytes body(data + 1, size - 1);
  switch (data[0] % 12) {
    case 0:
      DecodeAs<lookout::lidar_packets_t>(body);
      break;
    case 1:
      DecodeAs<lookout::lidar_scan_t>(body);
      break;
    case 2:
      DecodeAs<lookout::lidar_clock_t>(body);
      break;
    case 3:
      DecodeAs<lookout::lidar_nmea_t>(body);
      break;
    case 4:
      DecodeAs<lookout::segments_t>(body);
      break;
    case 5:
      DecodeAs<lookout::nav_raw_t>(body);
      break;
    case 6:
      DecodeAs<lookout::gnss_fix_t>(body);
      break;
    case 7:
      DecodeAs<lookout::attitude_t>(body);
      break;
    case 8:
      DecodeAs<lookout::pose_t>(body);
      break;
    case 9:
      DecodeAs<lookout::obstacles_t>(body);
      break;
    case 10:
      DecodeAs<lookout::health_t>(body);
      break;
    default:
      DecodeAs<lookout::run_info_t>(body);
      break;
  }
  return 0;
}
