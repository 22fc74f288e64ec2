// Any bytes as what comes back over an output (lines with a right checksum too, texts of a Signal K server), and as texts of alerts: no crash, and no
// sentence longer than it may be.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "services/plotter/core/alert_sentences.hpp"
#include "services/plotter/core/mavlink.hpp"
#include "services/plotter/core/nmea0183.hpp"
#include "services/plotter/core/signal_k.hpp"

using namespace lookout::plotter;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  AlertCommand command;
  ReadLine(text, command);
  const auto sentence = Sentence(text);
  ReadLine(std::string_view(sentence).substr(0, sentence.size() - 2), command);

  for (const auto& echo : ReadDelta(text).echoes) {
    if (echo.word.size() > size) std::abort();
  }
  Notice notice;
  notice.id = static_cast<std::int64_t>(size) + 1;
  notice.text = text;
  if (Alr("RA", notice, {}).size() > kMaxSentenceBytes) std::abort();
  const auto alf = Alf("RA", notice, {}, 0, 1);
  if (alf.find('$', 1) > kMaxSentenceBytes || alf.size() - alf.find('$', 1) > kMaxSentenceBytes) std::abort();
  // Each frame of a text holds at most 50 bytes of it.
  for (const auto& frame : MavlinkWriter(1, 196).StatusText(MavSeverity::kNotice, text)) {
    if (frame.size() > 66) std::abort();
  }
  const auto echoes = ReadDelta(NoticeDelta(notice, BoatWord(text), {}));
  if (echoes.is_wrong || echoes.echoes.size() != 1 || echoes.echoes[0].is_acknowledged || echoes.echoes[0].is_quiet) std::abort();
  return 0;
}
