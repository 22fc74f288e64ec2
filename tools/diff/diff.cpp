#include "tools/diff/diff.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <ostream>
#include <set>
#include <stdexcept>
#include <system_error>

#include "common/bus/channels.hpp"
#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "common/core/log_time.hpp"
#include "common/core/printable.hpp"
#include "common/io/file_kind.hpp"
#include "common/runtime/progress.hpp"
#include "tools/log/publishers.hpp"
#include "tools/log/run_marks.hpp"
#include "tools/log/watch_alerts.hpp"

namespace lookout::diff {

namespace {

struct FirstDifference {
  std::int64_t index = 0;  // of the message on its channel in A, or in B where only B has it; from 0
  Utime time;              // of the message's event
  Difference difference;
};

struct ChannelResult {
  std::int64_t num_a = 0;
  std::int64_t num_b = 0;
  std::int64_t num_different = 0;  // pairs
  std::int64_t num_only_a = 0;
  std::int64_t num_only_b = 0;
  std::int64_t num_behind_a = 0;  // of num_only_a, behind the last message of the other log
  std::int64_t num_behind_b = 0;
  std::optional<FirstDifference> first;
};

// One log, and where the events of each channel stand.
struct IndexedLog {
  /// @param show  is told where it reads
  IndexedLog(const std::filesystem::path& file, const std::function<void(std::int64_t position_bytes)>& show) : reader(file) {
    for (std::int64_t number = 0; const auto event = reader.Next(); ++number) {
      show(reader.position_bytes());
      if (log::IsWatchAlert(event->channel, event->bytes)) {
        ++num_watch_alerts;
        continue;
      }
      places[event->channel].push_back(event->position_bytes);
      marks.Add(event->time, event->channel, event->bytes);
      publishers.Add(number, event->time, event->channel, event->bytes);
      if (!first_time) first_time = event->time;
    }
    num_damaged = reader.num_damaged();
    if (places.empty() && num_watch_alerts == 0 && reader.size_bytes() > 0) throw std::runtime_error(io::NoEventText(file));
  }

  bus::LogEvent Read(std::int64_t place) {
    reader.Seek(place);
    auto event = reader.Next();
    if (!event) throw std::runtime_error("a log has changed while it was read");
    return *std::move(event);
  }

  bus::LogReader reader;
  std::map<std::string, std::vector<std::int64_t>, std::less<>> places;
  log::RunMarks marks;
  log::Publishers publishers;
  std::optional<Utime> first_time;
  std::int64_t num_damaged = 0;
  std::int64_t num_watch_alerts = 0;
};

// They tell of the machine, not of the water; LCM_SELF_TEST is what LCM sends to itself when it opens UDP multicast.
bool IsLeftOut(std::string_view channel) { return channel == bus::kHealth.name || channel == bus::kRunInfo.name || channel == "LCM_SELF_TEST"; }

// How far a message that one log lacks is looked for in the other, and how often in vain: logs that have nothing in common are not searched through.
constexpr std::size_t kMaxMissingInARow = 1000;
constexpr int kMaxSearchesInVain = 4;

// The messages of one channel in both logs, in their order.
class ChannelComparison {
 public:
  /// @param show  is told how many messages of A are compared
  ChannelComparison(const std::string& channel, const Tolerances& tolerances, IndexedLog& a, IndexedLog& b,
                    const std::function<void(std::int64_t num_done)>& show)
      : tolerances_(tolerances), a_(a, channel), b_(b, channel), show_(show) {}

  ChannelResult Compare() {
    result_.num_a = a_.NumLeft();
    result_.num_b = b_.NumLeft();
    while (a_.NumLeft() > 0 && b_.NumLeft() > 0) {
      show_(static_cast<std::int64_t>(a_.next));
      const auto event_a = a_.Read(0);
      const auto event_b = b_.Read(0);
      auto difference = CompareMessages(tolerances_, event_a.bytes, event_b.bytes);
      if (!difference) difference = CompareRests(event_a, event_b);
      if (difference && StepOverMissing(event_a, event_b)) continue;
      if (difference) {
        ++result_.num_different;
        SetFirst(a_, event_a.time, *std::move(difference));
      }
      ++a_.next;
      ++b_.next;
    }
    result_.num_behind_a = NumBehind(a_, b_);
    result_.num_behind_b = NumBehind(b_, a_);
    StepOver(a_, a_.NumLeft(), result_.num_only_a, "only in A");
    StepOver(b_, b_.NumLeft(), result_.num_only_b, "only in B");
    return std::move(result_);
  }

 private:
  struct Side {
    Side(IndexedLog& indexed_log, const std::string& channel) : log(indexed_log) {
      const auto found = log.places.find(channel);
      if (found != log.places.end()) places = &found->second;
    }
    std::int64_t NumLeft() const { return places == nullptr ? 0 : static_cast<std::int64_t>(places->size() - next); }
    bus::LogEvent Read(std::size_t ahead) { return log.Read((*places)[next + ahead]); }

    IndexedLog& log;
    const std::vector<std::int64_t>* places = nullptr;
    std::size_t next = 0;
  };

  // Compares the rest of events that are larger than one read.
  std::optional<Difference> CompareRests(const bus::LogEvent& a, const bus::LogEvent& b) const {
    if (a.num_data_bytes != b.num_data_bytes) return Difference{"size", std::to_string(a.num_data_bytes), std::to_string(b.num_data_bytes)};
    constexpr std::size_t kPieceBytes = 1024UL * 1024;
    std::vector<std::uint8_t> piece_a;
    std::vector<std::uint8_t> piece_b;
    for (auto offset = a.bytes.size(); offset < a.num_data_bytes; offset += piece_a.size()) {
      piece_a.resize(std::min(kPieceBytes, a.num_data_bytes - offset));
      piece_b.resize(piece_a.size());
      a_.log.reader.ReadData(a.position_bytes, a.channel.size(), offset, piece_a);
      b_.log.reader.ReadData(b.position_bytes, b.channel.size(), offset, piece_b);
      const auto found = std::ranges::mismatch(piece_a, piece_b);
      if (found.in1 == piece_a.end()) continue;
      return Difference{fmt::format("byte {}", offset + static_cast<std::size_t>(found.in1 - piece_a.begin())), std::to_string(*found.in1),
                        std::to_string(*found.in2)};
    }
    return std::nullopt;
  }

  static bool IsSameMessage(const bus::LogEvent& a, const bus::LogEvent& b) {
    const auto header_a = bus::ReadHeader(a.bytes);
    const auto header_b = bus::ReadHeader(b.bytes);
    return header_a && header_b && header_a->fingerprint == header_b->fingerprint && header_a->utime_us == header_b->utime_us &&
           header_a->seq == header_b->seq;
  }

  // How many messages that are left in one log, when the other has come to its end, are not earlier than the other's last message (parts of a scan
  // have one time). 0 where this is not known, as pairs were not found or the other log has no message.
  std::int64_t NumBehind(Side& side, const Side& other) const {
    if (side.NumLeft() == 0 || num_in_vain_ > 0 || other.places == nullptr) return 0;
    const auto first = bus::ReadHeader(side.Read(0).bytes);
    const auto last = bus::ReadHeader(other.log.Read(other.places->back()).bytes);
    return first && last && first->utime_us >= last->utime_us ? side.NumLeft() : 0;
  }

  // Two messages with other times and numbers: where one log lacks some that the other has, steps over them. @return whether it did
  bool StepOverMissing(const bus::LogEvent& event_a, const bus::LogEvent& event_b) {
    if (IsSameMessage(event_a, event_b) || num_in_vain_ == kMaxSearchesInVain) return false;
    const auto num_ahead = std::min<std::size_t>(kMaxMissingInARow, static_cast<std::size_t>(std::max(a_.NumLeft(), b_.NumLeft()) - 1));
    for (std::size_t ahead = 1; ahead <= num_ahead; ++ahead) {
      if (static_cast<std::int64_t>(ahead) < a_.NumLeft() && IsSameMessage(a_.Read(ahead), event_b)) {
        StepOver(a_, static_cast<std::int64_t>(ahead), result_.num_only_a, "only in A");
        return true;
      }
      if (static_cast<std::int64_t>(ahead) < b_.NumLeft() && IsSameMessage(b_.Read(ahead), event_a)) {
        StepOver(b_, static_cast<std::int64_t>(ahead), result_.num_only_b, "only in B");
        return true;
      }
    }
    ++num_in_vain_;
    return false;
  }

  void StepOver(Side& side, std::int64_t count, std::int64_t& counter, const char* what) {
    if (count == 0) return;
    if (!result_.first) SetFirst(side, side.Read(0).time, {what, "", ""});
    side.next += static_cast<std::size_t>(count);
    counter += count;
  }

  void SetFirst(const Side& side, Utime time, Difference difference) {
    if (!result_.first) result_.first = FirstDifference{static_cast<std::int64_t>(side.next), time, std::move(difference)};
  }

  const Tolerances& tolerances_;
  Side a_;
  Side b_;
  const std::function<void(std::int64_t num_done)>& show_;
  ChannelResult result_;
  int num_in_vain_ = 0;
};

std::string FirstText(const FirstDifference& first) {
  const auto& difference = first.difference;
  return fmt::format("message {} at {}: {}{}", first.index, TimeText(first.time), difference.field,
                     difference.a.empty() && difference.b.empty() ? "" : ": " + difference.a + " | " + difference.b);
}

// Differences that come of where the logs were begun or cut.
class Cuts {
 public:
  Cuts(const IndexedLog& a, const IndexedLog& b) : a_(a), b_(b) {}

  void Add(const std::string& channel, const ChannelResult& result) {
    if (result.num_behind_a > 0) behind_a_.push_back(fmt::format("{} {}", channel, result.num_behind_a));
    if (result.num_behind_b > 0) behind_b_.push_back(fmt::format("{} {}", channel, result.num_behind_b));
    has_others_ = has_others_ || result.num_different > 0 || result.num_only_a > result.num_behind_a || result.num_only_b > result.num_behind_b;
    if (!result.first) return;
    const auto start = std::max(a_.first_time, b_.first_time);
    is_early_ = is_early_ || (start && result.first->time - *start < kSettling);
  }

  void Print(std::ostream& out) const {
    const auto end_a = a_.marks.WithoutEnd();
    const auto end_b = b_.marks.WithoutEnd();
    if (!end_a.empty() && !behind_b_.empty()) PrintCut(out, "A", end_a, "B", behind_b_);
    if (!end_b.empty() && !behind_a_.empty()) PrintCut(out, "B", end_b, "A", behind_a_);
    if (!is_early_) return;
    for (const auto& [name, log] : {std::pair("A", &a_), std::pair("B", &b_)}) {
      const auto channels = log->marks.WithoutStart();
      if (channels.empty()) continue;
      out << fmt::format("reason, perhaps: {} begins without a start mark of {}: what is computed first depends on what came before\n", name,
                         fmt::join(channels, ", "));
    }
  }

 private:
  // Filters have settled by then.
  static constexpr std::chrono::seconds kSettling{30};

  void PrintCut(std::ostream& out, const char* cut, const std::vector<std::string>& channels, const char* other,
                const std::vector<std::string>& behind) const {
    out << fmt::format("reason{}: {} ends without an end mark of {}: it was cut there, and lacks what was under way\n",
                       has_others_ ? ", perhaps" : "", cut, fmt::join(channels, ", "));
    out << fmt::format("behind the last message of the other log {} has: {}\n", other, fmt::join(behind, ", "));
  }

  const IndexedLog& a_;
  const IndexedLog& b_;
  std::vector<std::string> behind_a_;
  std::vector<std::string> behind_b_;
  bool is_early_ = false;
  bool has_others_ = false;  // differences that no cut explains
};

int Compare(const Request& request, std::ostream& out, std::ostream& errors) {
  runtime::Progress progress("lookout-diff", request.progress);
  // Reading both is about as long as comparing them.
  std::int64_t total_bytes = 1;
  for (const auto* file : {&request.a, &request.b}) {
    std::error_code error;
    const auto size = std::filesystem::file_size(*file, error);
    total_bytes += error ? 0 : static_cast<std::int64_t>(size);
  }
  const auto show_read = [&](std::int64_t done_bytes) {
    progress.Update(0.5 * static_cast<double>(done_bytes) / static_cast<double>(total_bytes), [] { return "reading"; });
  };
  IndexedLog a(request.a, show_read);
  const auto size_a = a.reader.size_bytes();
  IndexedLog b(request.b, [&](std::int64_t done_bytes) { show_read(size_a + done_bytes); });
  progress.Clear();
  for (const auto& [log, file] : {std::pair(&a, &request.a), std::pair(&b, &request.b)}) {
    if (log->reader.size_bytes() == 0) errors << fmt::format("{}: is empty\n", file->string());
    if (log->num_damaged > 0) errors << fmt::format("{}: {} damaged stretches were skipped\n", file->string(), log->num_damaged);
  }
  std::set<std::string> channels;
  std::set<std::string> left_out;
  for (const auto* log : {&a, &b}) {
    for (const auto& entry : log->places) (IsLeftOut(entry.first) ? left_out : channels).insert(entry.first);
  }
  if (!request.channels.empty()) {
    for (const auto& channel : request.channels) {
      if (!channels.contains(channel) && !left_out.contains(channel)) throw std::runtime_error(channel + ": no such channel in either log");
    }
    channels = {request.channels.begin(), request.channels.end()};
    left_out.clear();
  }
  auto unknown = request.tolerances.Unknown();
  for (const auto& [channel, tolerances] : request.channel_tolerances) {
    if (!channels.contains(channel)) throw std::runtime_error("--tolerance: channel " + channel + " is not compared");
    std::ranges::copy(tolerances.Unknown(), std::back_inserter(unknown));
  }
  if (!unknown.empty()) throw std::runtime_error("--tolerance: no number of any type is called " + unknown.front());

  std::int64_t num_different = 0;
  std::int64_t num_messages = 0;
  Cuts cuts(a, b);
  std::int64_t num_compared = 0;
  std::int64_t num_all = 1;
  for (const auto& [channel, places] : a.places) num_all += channels.contains(channel) ? static_cast<std::int64_t>(places.size()) : 0;
  const auto show_compared = [&](std::int64_t num_done) {
    progress.Update(0.5 + 0.5 * static_cast<double>(num_compared + num_done) / static_cast<double>(num_all), [] { return "comparing"; });
  };
  const std::function<void(std::int64_t)> show = show_compared;
  out << fmt::format("{:<20} {:>9} {:>9} {:>9} {:>9} {:>9}  first difference\n", "channel", "A", "B", "differ", "only_A", "only_B");
  for (const auto& channel : channels) {
    const auto own = request.channel_tolerances.find(channel);
    const auto& tolerances = own == request.channel_tolerances.end() ? request.tolerances : own->second;
    const auto result = ChannelComparison(channel, tolerances, a, b, show).Compare();
    num_compared += result.num_a;
    progress.Clear();  // lines of the table may go to the same terminal
    num_messages += std::max(result.num_a, result.num_b);
    cuts.Add(Printable(channel), result);
    if (result.first) ++num_different;
    out << fmt::format("{:<20} {:>9} {:>9} {:>9} {:>9} {:>9}{}\n", Printable(channel), result.num_a, result.num_b, result.num_different,
                       result.num_only_a, result.num_only_b, result.first ? "  " + FirstText(*result.first) : "");
  }
  for (const auto& [name, log] : {std::pair("A", &a), std::pair("B", &b)}) {
    const auto interleavings = log->publishers.Interleavings();
    for (const auto& interleaving : interleavings) out << fmt::format("{} holds {}\n", name, InWords(interleaving));
    if (!interleavings.empty()) out << log::kOutsideProof << "\n";
  }
  if (!left_out.empty()) out << fmt::format("left out: {}\n", fmt::join(left_out, ", "));
  const auto num_watch_alerts = a.num_watch_alerts + b.num_watch_alerts;
  if (num_watch_alerts > 0) out << fmt::format("left out: {} of ALERTS, which came without a scan\n", num_watch_alerts);
  if (num_different == 0) {
    out << fmt::format("equal: {} channels, {} messages\n", channels.size(), num_messages);
    return kExitEqual;
  }
  out << fmt::format("different: {} of {} channels\n", num_different, channels.size());
  cuts.Print(out);
  return kExitDifferent;
}

}  // namespace

void AddTolerance(const std::string& text, Request& request) {
  const auto equals = text.rfind('=');
  const auto colon = text.find(':');
  const bool has_channel = colon != std::string::npos && colon < equals;
  const auto start = has_channel ? colon + 1 : 0;
  const std::string fault = "--tolerance " + text + ": FIELD=VALUE or CHANNEL:FIELD=VALUE is needed, with a VALUE of 0 or more";
  if (equals == std::string::npos || equals == start || (has_channel && colon == 0)) throw std::runtime_error(fault);
  double value = -1.0;
  const char* const end = text.data() + text.size();
  const auto result = std::from_chars(text.data() + equals + 1, end, value);
  if (result.ec != std::errc() || result.ptr != end || !std::isfinite(value) || value < 0.0) throw std::runtime_error(fault);
  const std::string field = text.substr(start, equals - start);
  if (has_channel) {
    request.channel_tolerances.try_emplace(text.substr(0, colon), request.tolerances).first->second.Set(field, value);
  } else {
    request.tolerances.Set(field, value);
  }
}

int Run(const Request& request, std::ostream& out, std::ostream& errors) try {
  return Compare(request, out, errors);
} catch (const std::exception& error) {
  errors << "lookout-diff: " << PrintableLines(error.what()) << "\n";
  return kExitUnreadable;
}

}  // namespace lookout::diff
