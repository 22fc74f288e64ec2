// Any bytes as packets of each of Hesai's models, and as the table of a unit's angles.
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "services/lidar/core/models/hesai.hpp"
#include "tests/fuzz/packet_reader_check.hpp"

namespace {

using namespace lookout;
using namespace lookout::lidar;

void CheckAngles(std::string_view csv) {
  try {
    const auto angles = ParseHesaiAngles(csv);
    fuzz::Expect(!angles.empty() && angles.size() <= 128);
    for (const auto& angle : angles) {
      fuzz::Expect(angle.elevation_deg >= -90.0 && angle.elevation_deg <= 90.0);
      fuzz::Expect(angle.azimuth_offset_deg >= -180.0 && angle.azimuth_offset_deg <= 180.0);
    }
  } catch (const std::runtime_error& error) {
    fuzz::Expect(!std::string_view(error.what()).empty());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const int kind = data[0] % (kNumHesaiModels + 1);
  const Bytes rest = Bytes(data, size).subspan(1);
  if (kind == kNumHesaiModels) {
    CheckAngles({reinterpret_cast<const char*>(rest.data()), rest.size()});
    return 0;
  }
  HesaiReader reader(static_cast<HesaiModel>(kind));
  fuzz::ReadAll(reader, rest);
  return 0;
}
