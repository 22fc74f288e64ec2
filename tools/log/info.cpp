#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <ostream>
#include <set>
#include <sstream>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/bus/schema.hpp"
#include "common/bus/sequence.hpp"
#include "common/core/log_time.hpp"
#include "common/core/printable.hpp"
#include "common/io/file_kind.hpp"
#include "lookout/run_info_t.hpp"
#include "tools/log/commands.hpp"
#include "tools/log/event_reader.hpp"
#include "tools/log/payloads.hpp"
#include "tools/log/publishers.hpp"
#include "tools/log/run_marks.hpp"

namespace lookout::log {

namespace {

// Types and stretches of a channel or file beyond these numbers are counted, not named.
constexpr std::size_t kMaxTypesNamed = 3;
constexpr std::size_t kMaxStretchesNamed = 10;

struct ChannelSummary {
  std::int64_t num_events = 0;
  std::int64_t num_bytes = 0;
  Utime first;
  Utime last;
  std::chrono::microseconds silence{0};  // the longest between two events, or to an end of the log
  Utime silence_start;
  std::set<std::uint64_t> fingerprints;
  bus::SequenceWatch sequence;
  bool has_sequence = false;
  std::int64_t num_missing = 0;

  void AddSilence(Utime from, Utime to) {
    if (to - from <= silence) return;
    silence = to - from;
    silence_start = from;
  }
};

// RUN_INFO of an event, where it is one that this version can read.
std::optional<run_info_t> RunInfoOf(const bus::LogEvent& event) {
  if (event.channel != bus::kRunInfo.name) return std::nullopt;
  return bus::Decode<run_info_t>(event.bytes);
}

// The computer in one line: the values of "machine.txt" of its RUN_INFO, comma by comma. Empty when it has none.
std::string MachineOf(const run_info_t& run_info) {
  std::string machine;
  for (std::size_t i = 0; i < run_info.file_name.size(); ++i) {
    if (run_info.file_name[i] != "machine.txt") continue;
    std::istringstream lines(run_info.file_text[i]);
    for (std::string line; std::getline(lines, line);) {
      const auto colon = line.find(": ");
      if (colon == std::string::npos) continue;
      const auto value = line.substr(colon + 2);
      const bool needs_name = line.starts_with("glibc_tunables") || line.starts_with("compiler") || line.starts_with("kernel") || value == "unknown";
      machine += (machine.empty() ? "" : ", ") + (needs_name ? line : value);
    }
  }
  return machine;
}

const bus::TypeFingerprint* FindType(std::uint64_t fingerprint) {
  const auto found = std::ranges::find(bus::TypeFingerprints(), fingerprint, &bus::TypeFingerprint::fingerprint);
  return found == bus::TypeFingerprints().end() ? nullptr : &*found;
}

std::string TypeNames(const std::set<std::uint64_t>& fingerprints) {
  std::string text;
  for (const auto fingerprint : fingerprints) text += (text.empty() ? "" : ",") + FindType(fingerprint)->type;
  return text.empty() ? "?" : text;
}

class LogSummary {
 public:
  void Add(const bus::LogEvent& event) {
    if (!first_) first_ = event.time;
    if (last_ && event.time < *last_) ++num_steps_back_;
    last_ = event.time;
    latest_ = latest_ ? std::max(*latest_, event.time) : event.time;
    ++num_events_;
    if (const auto run_info = RunInfoOf(event)) AddRun(*run_info);
    marks_.Add(event.time, event.channel, event.bytes);
    payloads_.Add(num_events_ - 1, event);
    const auto decision = publishers_.Add(num_events_ - 1, event.time, event.channel, event.bytes);
    AddToChannel(event, decision ? std::optional(decision->num_lost) : std::nullopt);
  }

  bool is_empty() const { return num_events_ == 0; }

  void Print(std::ostream& out) {
    payloads_.Print(out);
    out << fmt::format("{:<9} {}\n", "events", num_events_);
    out << fmt::format("{:<9} {}\n{:<9} {}\n{:<9} {}\n", "start", TimeText(*first_), "end", TimeText(*last_), "span", SecondsText(*last_ - *first_));
    if (num_steps_back_ > 0) out << fmt::format("{:<9} {} times the clock of the recording went back\n", "clock", num_steps_back_);
    for (const auto& run : runs_) out << fmt::format("{:<9} {}\n", "made by", run);
    for (const auto& machine : machines_) out << fmt::format("{:<9} {}\n", "machine", machine);
    if (runs_.empty()) out << fmt::format("{:<9} not said: no RUN_INFO\n", "made by");
    PrintMarks(out);
    const auto interleavings = publishers_.Interleavings();
    for (const auto& interleaving : interleavings) out << fmt::format("{:<9} {}\n", "mixed", InWords(interleaving));
    if (!interleavings.empty()) out << fmt::format("{:<9} {}\n", "", kOutsideProof);
    out << fmt::format("\n{:<20} {:<18} {:>9} {:>12} {:>9} {:>8} {:>11}  at\n", "channel", "type", "events", "bytes", "Hz", "missing", "silence_s");
    for (auto& [name, channel] : channels_) {
      channel.AddSilence(*first_, channel.first);
      channel.AddSilence(channel.last, *latest_);
      const double span_s = ToSeconds(channel.last - channel.first);
      out << fmt::format("{:<20} {:<18} {:>9} {:>12} {:>9} {:>8} {:>11.3f}  {}\n", Printable(name), TypeNames(channel.fingerprints),
                         channel.num_events, channel.num_bytes,
                         span_s > 0.0 ? fmt::format("{:.3f}", static_cast<double>(channel.num_events - 1) / span_s) : "",
                         channel.has_sequence ? std::to_string(channel.num_missing) : "", ToSeconds(channel.silence),
                         channel.silence > std::chrono::microseconds(0) ? SecondsText(channel.silence_start - *first_) : "");
    }
  }

 private:
  void AddRun(const run_info_t& run_info) {
    const auto text = Printable(run_info.program + " " + run_info.version + " on " + run_info.host + ", wire types " + run_info.schema.substr(0, 12));
    if (std::ranges::find(runs_, text) == runs_.end() && runs_.size() < kMaxStretchesNamed) runs_.push_back(text);
    const auto machine = Printable(MachineOf(run_info));
    const bool is_new = !machine.empty() && std::ranges::find(machines_, machine) == machines_.end();
    if (is_new && machines_.size() < kMaxStretchesNamed) machines_.push_back(machine);
  }

  // The meaning of the marks for a replay: whether it gives the results of the live run.
  void PrintMarks(std::ostream& out) const {
    if (marks_.Channels().empty()) {
      out << fmt::format("{:<9} no raw channel: cannot be computed again from its beginning\n", "marks");
      return;
    }
    const auto print = [&](const char* word, const char* mark, const std::vector<std::string>& without, const char* meaning) {
      std::vector<std::string> with;
      for (const auto& channel : marks_.Channels()) {
        if (std::ranges::find(without, channel) == without.end()) with.push_back(channel);
      }
      if (!with.empty()) out << fmt::format("{:<9} with {} mark: {}\n", word, mark, fmt::join(with, ", "));
      if (!without.empty()) out << fmt::format("{:<9} without {} mark: {}; {}\n", word, mark, fmt::join(without, ", "), meaning);
    };
    print("begins", "a start", marks_.WithoutStart(), "what a replay gives first need not equal the live run");
    print("ends", "an end", marks_.WithoutEnd(), "cut there: a replay gives nothing for the scan and the poses that were under way");
    if (const auto channels = marks_.CutInside(); !channels.empty()) {
      out << fmt::format("{:<9} a run without an end mark is followed by another: {}; what a replay gives there need not equal the live run\n",
                         "within", fmt::join(channels, ", "));
    }
  }

  // `num_missing` before it, where Publishers knows.
  void AddToChannel(const bus::LogEvent& event, std::optional<std::int64_t> num_missing) {
    auto& channel = channels_[event.channel];
    if (channel.num_events == 0) {
      channel.first = event.time;
    } else {
      channel.AddSilence(channel.last, event.time);
    }
    channel.last = event.time;
    ++channel.num_events;
    channel.num_bytes += static_cast<std::int64_t>(event.num_data_bytes);
    if (event.bytes.size() < 8) return;
    const auto fingerprint = bus::ReadU64BigEndian(event.bytes, 0);
    const auto* type = FindType(fingerprint);
    if (type == nullptr) return;
    if (channel.fingerprints.size() < kMaxTypesNamed) channel.fingerprints.insert(fingerprint);
    // HEALTH has a seq per process.
    const auto header = bus::ReadHeader(event.bytes);
    if (!type->has_seq || !header || event.channel == bus::kHealth.name) return;
    channel.has_sequence = true;
    channel.num_missing += num_missing ? *num_missing : channel.sequence.NumLostBefore(header->seq);
  }

  RunMarks marks_;
  Payloads payloads_;
  Publishers publishers_;
  std::vector<std::string> runs_;
  std::vector<std::string> machines_;
  std::optional<Utime> first_;
  std::optional<Utime> last_;
  std::optional<Utime> latest_;
  std::int64_t num_events_ = 0;
  std::int64_t num_steps_back_ = 0;
  std::map<std::string, ChannelSummary> channels_;
};

void PrintDamage(const EventReader& reader, std::ostream& out) {
  if (reader.damage().empty()) {
    out << fmt::format("{:<9} none\n", "damage");
    return;
  }
  out << fmt::format("{:<9} {} stretches, {} bytes\n", "damage", reader.damage().size(), reader.num_damaged_bytes());
  for (std::size_t i = 0; i < std::min(reader.damage().size(), kMaxStretchesNamed); ++i) {
    const auto& stretch = reader.damage()[i];
    out << fmt::format("{:<9} {} bytes at byte {}, behind {} events\n", "", stretch.size_bytes, stretch.offset_bytes, stretch.num_events_before);
  }
}

}  // namespace

void Info(const std::vector<std::filesystem::path>& files, std::ostream& out, std::FILE* progress) {
  LogSummary summary;
  ReadProgress shown(progress, files);
  for (const auto& file : files) {
    EventReader reader(file);
    while (const auto event = reader.Next()) {
      summary.Add(*event);
      shown.Show(reader.position_bytes());
    }
    shown.EndFile(reader.size_bytes());
    out << fmt::format("{:<9} {}\n{:<9} {} bytes\n", "file", PrintableLines(file.string()), "size", reader.size_bytes());
    PrintDamage(reader, out);
  }
  if (summary.is_empty()) throw std::runtime_error(io::NoEventText(files.front()));
  summary.Print(out);
}

}  // namespace lookout::log
