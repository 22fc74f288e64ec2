// Seeds of fuzz_mavlink: messages of an autopilot, made by node-mavlink 2.3.0, each behind the byte that says how they are cut.
#include <string>
#include <string_view>

#include "tests/fuzz/corpus.hpp"

namespace lookout::fuzz {

namespace {

std::string FromHex(std::string_view text) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) bytes += static_cast<char>(std::stoi(std::string(text.substr(i, 2)), nullptr, 16));
  return bytes;
}

}  // namespace

void WriteAutopilot(const Folder& folder) {
  const auto attitude = FromHex("fd1c00000701011e000040e20100cdcc4c3d0ad7a33c000080be0ad7233c0ad7a3bc0000003ec2b4");
  const auto attitude_1 = FromHex("fe1c0801011e40e20100cdcc4c3d0ad7a33c000080be0ad7233c0ad7a3bc0000003ed719");
  const auto position = FromHex("fd1c000009010121000044e20100879542209647a6f939300000dc0500002c0170fe05000787f8c8");
  const auto gps =
      FromHex("fd3400000b0101180000d5cf820a8a55060080954220a047a6f90c3000005a008c00f501df77040e04d8000020030000dc0500007800000090d0030028874a9f");
  const auto signed_attitude = FromHex("fd1c01001201011e000040e20100cdcc4c3d0ad7a33c000080be0ad7233c0ad7a3bc0000003ed0e401e0ba46d0ff2007d698f4d795");
  folder.Write("attitude", "\x7F" + attitude);
  folder.Write("attitude_1", "\x7F" + attitude_1);
  folder.Write("all", "\x28" + gps + position + attitude + signed_attitude + attitude_1);
  // As payloads of right frames: the kind and the size of each stand before it.
  folder.Write("payloads", std::string("\x09\x34", 2) + gps.substr(10, 52) + std::string("\x0B\x1C", 2) + position.substr(10, 28) +
                               std::string("\x0A\x1C", 2) + attitude.substr(10, 28));
}

}  // namespace lookout::fuzz
