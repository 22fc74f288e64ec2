// Any bytes as data packets, one after the other, through the whole decoder.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "services/vlp16/core/decoder.hpp"
#include "services/vlp16/wire.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lookout;
  using namespace lookout::vlp16;
  const auto expect = [](bool is_true) {
    if (!is_true) std::abort();
  };
  Decoder decoder(
      DecoderParams{},
      [&](const Turn& turn) {
        expect(turn.num_columns() > 0);
        expect(turn.range.size() == turn.azimuth_rad.size() * format::kNumLasers * static_cast<std::size_t>(turn.num_returns()));
        for (const auto& part : ToScanMessages(turn, 0, true, 120'000)) expect(part.getEncodedSize() <= 120'000);
      },
      [](const SentenceOfLidar&) {});
  Bytes rest(data, size);
  Utime host_time{};
  while (!rest.empty()) {
    const auto payload = rest.first(std::min(rest.size(), format::kDataPacketSizeBytes));
    decoder.OnDataPayload(host_time, payload);
    host_time += std::chrono::microseconds(1327);
    rest = rest.subspan(payload.size());
  }
  decoder.Flush();
  return 0;
}
