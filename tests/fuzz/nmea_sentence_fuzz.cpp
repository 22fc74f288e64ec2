// Any bytes as datagrams, and as sentences with a right checksum, all the way to poses: no crash, no hang, nothing that is not a number but unknown.
// The same bytes cut into datagrams of two senders, and as rows of CSV.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "services/navigator/core/csv_recording.hpp"
#include "services/navigator/core/item_sequencer.hpp"
#include "services/navigator/core/lines.hpp"
#include "services/navigator/core/navigator.hpp"
#include "tests/fuzz/pose_check.hpp"
#include "tests/unit/navigator/filter_params.hpp"

namespace {

using namespace std::chrono_literals;
using namespace lookout::navigator;

std::string WithChecksum(const std::string& line) {
  static constexpr char kDigits[] = "0123456789ABCDEF";
  unsigned checksum = 0;
  for (const char character : line.substr(1)) checksum ^= static_cast<unsigned char>(character);
  return line + '*' + kDigits[checksum >> 4] + kDigits[checksum & 15U];
}

NavigatorParams FuzzParams() {
  NavigatorParams params;
  params.max_sentence_latency = 24h;  // so that times in sentences matter
  params.position_sd_m = 2.5;
  params.filter = TestFilterParams();
  params.filter.p_vessel_antenna_m = {-0.8, 0.4, 0.9};
  return params;
}

void CheckLines(const DatagramLines& lines) {
  for (const auto& line : lines.lines) {
    if (!IsLine(line)) std::abort();
  }
}

// The first byte says how the rest is cut.
void CheckJoining(lookout::Bytes bytes) {
  if (bytes.empty()) return;
  const std::size_t piece = 1 + bytes[0] % 80;
  const bool requires_checksum = bytes[0] < 128;
  DatagramJoiner joiner;
  LineAssembler assembler;
  lookout::Utime time{};
  for (std::size_t begin = 1; begin < bytes.size(); begin += piece) {
    const auto part = bytes.subspan(begin, std::min(piece, bytes.size() - begin));
    time += std::chrono::milliseconds(4 * part[0]);
    CheckLines(joiner.Add(time, part, part[0] % 8 == 0 ? "a" : "b", requires_checksum));
    CheckLines(assembler.Add(part));
    if (part[0] == 'x') CheckLines(joiner.AdvanceTo(time + 3s));
  }
  CheckLines(joiner.Finish());
  if (!joiner.is_empty()) std::abort();
}

void CheckRows(const std::string& text) {
  const auto end = std::min(text.find('\n'), text.size());
  const auto columns = FindCsvColumns(text.substr(0, end)).value_or(CsvColumns{0, 3});
  const auto row = ReadCsvRow(std::string_view(text).substr(std::min(end + 1, text.size())), columns);
  if (row.is_sentence && row.message.empty()) std::abort();
  ParseIsoTime(text);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  CheckJoining({data, size});
  CheckRows(std::string(data, data + size));
  const auto lines = SplitDatagram({data, size});
  ItemSequencer sequencer;
  Navigator navigator(FuzzParams());
  lookout::Utime time = std::chrono::sys_days(std::chrono::year(2026) / 6 / 1) + 12h;
  const auto consume = [&](const std::vector<Item>& items) {
    for (const auto& item : items) CheckPoses(navigator.Consume(item).poses);
  };
  for (const auto& line : lines.lines) {
    if (!IsLine(line)) std::abort();
    // The first character behind the start moves time.
    time += std::chrono::milliseconds(line.size() > 1 ? line[1] : 0);
    consume(sequencer.OnLines(time, {line, WithChecksum(line)}));
    consume(sequencer.OnLidarSentence(time, line));
  }
  consume(sequencer.Finish(time));
  return 0;
}
