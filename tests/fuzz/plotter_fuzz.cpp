// Any bytes as what comes back over an output (lines with a right checksum too, texts of a Signal K server, frames of NMEA 2000 and MAVLink), and as
// texts of alerts: no crash, no sentence longer than it may be, and no flood of answers.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "services/plotter/core/alert_sentences.hpp"
#include "services/plotter/core/mavlink.hpp"
#include "services/plotter/core/n2k_device.hpp"
#include "services/plotter/core/nmea0183.hpp"
#include "services/plotter/core/signal_k.hpp"

using namespace lookout::plotter;

namespace {

// Each line of the text is a frame, a tenth of a second after the one before.
void HearFrames(std::string_view text) {
  N2kDevice device({.name = N2kName(0x12345), .preferred_address = 35, .sent_pgns = {128520}});
  std::chrono::milliseconds now{0};
  std::size_t num_lines = 0;
  std::size_t num_sendings = 0;
  for (device.Begin(now); !text.empty(); ++num_lines) {
    const auto end = std::min(text.find('\n'), text.size());
    const auto heard = ReadHeardLine(text.substr(0, end));
    if (heard && heard->frame.bytes.size() > 8) std::abort();
    if (heard) device.Take(heard->frame, now);
    text.remove_prefix(std::min(end + 1, text.size()));
    now += std::chrono::milliseconds(100);
    device.Advance(now);
    for (const auto& [message, source] : device.TakeSendings()) {
      if (message.payload.size() > kMostFastPacketBytes || (!message.is_fast_packet && message.payload.size() > 8)) std::abort();
      for (const auto& frame : FramesOf(message, source, 0)) {
        const auto line = RawLine(frame);
        if (ReadRawLine(std::string_view(line).substr(0, line.size() - 2)) != frame) std::abort();
      }
      ++num_sendings;
    }
    if (device.address() > kMostN2kAddress) std::abort();
  }
  // A request is answered by two messages at most, and once a minute it begins anew.
  if (num_sendings > 3 * num_lines + 4) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  AlertCommand command;
  ReadLine(text, command);
  const auto sentence = Sentence(text);
  ReadLine(std::string_view(sentence).substr(0, sentence.size() - 2), command);

  for (const auto& echo : ReadDelta(text).echoes) {
    if (echo.word.size() > size) std::abort();
  }
  HearFrames(text);
  Notice notice;
  notice.id = static_cast<std::int64_t>(size) + 1;
  notice.text = text;
  notice.sound = Sound::kSounds;
  if (Alr("RA", notice, {}).size() > kMaxSentenceBytes) std::abort();
  const auto alf = Alf("RA", notice, {}, 0, 1);
  if (alf.find('$', 1) > kMaxSentenceBytes || alf.size() - alf.find('$', 1) > kMaxSentenceBytes) std::abort();
  // Each frame of a text holds at most 50 bytes of it.
  for (const auto& frame : MavlinkWriter(1, 196).StatusText(MavSeverity::kNotice, text)) {
    if (frame.size() > 66) std::abort();
  }
  MavlinkReader whole;
  MavlinkReader bytewise;
  int num_heartbeats = 0;
  for (const char byte : text) num_heartbeats += bytewise.CountHeartbeats({&byte, 1});
  if (whole.CountHeartbeats(text) != num_heartbeats) std::abort();
  const auto echoes = ReadDelta(NoticeDelta(notice, BoatWord(text), {}));
  if (echoes.is_wrong || echoes.echoes.size() != 1 || echoes.echoes[0].is_acknowledged || echoes.echoes[0].is_quiet) std::abort();
  return 0;
}
