#include "tools/replay/input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <functional>
#include <map>
#include <numeric>
#include <set>
#include <spdlog/spdlog.h>
#include <stdexcept>

#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "common/io/stop_signal.hpp"
#include "services/navigator/io/text_log_reader.hpp"
#include "services/vlp16/io/capture_reader.hpp"

namespace lookout::replay {

namespace {

using Magic = std::array<unsigned char, 4>;

constexpr Magic kLogSyncWord{0xED, 0xA1, 0xDA, 0x01};
// pcap with microseconds and with nanoseconds, in both byte orders, and pcapng.
constexpr std::array<Magic, 5> kCaptureMagics{
    {{0xA1, 0xB2, 0xC3, 0xD4}, {0xD4, 0xC3, 0xB2, 0xA1}, {0xA1, 0xB2, 0x3C, 0x4D}, {0x4D, 0x3C, 0xB2, 0xA1}, {0x0A, 0x0D, 0x0D, 0x0A}}};

void Count(std::vector<std::pair<std::string, std::int64_t>>& refused, std::string_view reason, std::int64_t count) {
  if (count == 0) return;
  for (auto& [known_reason, known_count] : refused) {
    if (known_reason == reason) {
      known_count += count;
      return;
    }
  }
  refused.emplace_back(reason, count);
}

// A line of the log, beside which no progress stands.
template <typename... Values>
void Warn(runtime::Progress& progress, fmt::format_string<Values...> form, Values&&... values) {
  progress.Clear();
  spdlog::warn(form, std::forward<Values>(values)...);
}

// Where the events of one file are, in time.
class Order {
 public:
  /// @param before  time of the last event of the files before it
  Order(std::filesystem::path file, std::optional<Utime> before, runtime::Progress& progress)
      : file_(std::move(file)), before_(before), progress_(progress) {}

  /// Before an event is handed in.
  void Check(Utime time) {
    if (before_ && time < *before_) {
      Warn(progress_, "{}: begins {:.3f} s before the file before it ends; are the files in their order?", file_.string(),
           ToSeconds(*before_ - time));
    }
    before_.reset();
  }

 private:
  std::filesystem::path file_;
  std::optional<Utime> before_;
  runtime::Progress& progress_;
};

// One file on its way into the chain.
struct Feeding {
  const std::filesystem::path& file;
  Chain& chain;
  InputSummary& summary;
  runtime::Progress& progress;
  const std::function<void(std::int64_t num_bytes_of_file)>& show;
};

void FeedTextLog(const Feeding& feeding, std::optional<std::chrono::sys_days> day) {
  const auto& [file, chain, summary, progress, show] = feeding;
  navigator::TextLogReader reader(file, day);
  Order order(file, chain.time(), progress);
  if (!reader.has_date() && !day) {
    Warn(progress, "{}: no sentence tells a date; its times are taken as those of 1970-01-01, give --date", file.string());
  }
  if (reader.has_date() && day) Warn(progress, "{}: its sentences tell a date; --date is not used", file.string());
  while (const auto line = reader.Next()) {
    order.Check(line->time);
    ++summary.num_events;
    chain.OnTextLine(line->time, line->bytes);
    show(reader.position());
  }
}

void FeedCapture(const Feeding& feeding) {
  const auto& [file, chain, summary, progress, show] = feeding;
  // Of a frame beside its payload: headers of pcap, Ethernet, IPv4 and UDP. For the progress only.
  constexpr std::size_t kFrameBytes = 16 + 14 + 20 + 8;
  vlp16::CaptureReader reader(file);
  Order order(file, chain.time(), progress);
  std::size_t num_bytes = 0;
  while (const auto datagram = reader.Next()) {
    order.Check(datagram->host_time);
    ++summary.num_events;
    chain.OnDatagram({datagram->host_time, datagram->destination_port, datagram->payload, {datagram->source_address, datagram->source_port}});
    num_bytes += kFrameBytes + datagram->payload.size();
    show(static_cast<std::int64_t>(num_bytes));
  }
  if (reader.num_damaged() > 0) Warn(progress, "{}: {}", file.string(), reader.damage());
  for (const auto& counter : reader.counters()) {
    if (counter.name == "frames_read" || counter.name == "frames_datagram") continue;  // work done, no refusal
    Count(summary.refused, "capture." + std::string(counter.name), counter.count);
  }
}

// One log after the other: a publisher goes on from one to the next.
class LogFeeder {
 public:
  LogFeeder(const Plan& plan, Chain& chain, InputSummary& summary)
      : plan_(plan), chain_(chain), summary_(summary), one_publisher_([this](Utime time, const bus::Channel& channel, Bytes bytes) {
          summary_.marks.Add(time, channel.name, bytes);
          ++summary_.num_events;
          chain_.OnLogged(time, channel, bytes);
        }) {}

  void Feed(const Feeding& feeding) {
    const auto& [file, chain, summary, progress, show] = feeding;
    bus::LogReader reader(file, io::ThrowIfStopAsked);
    Order order(file, last_time_, progress);
    std::int64_t num_oversize = 0;
    const auto is_wanted = [this](std::string_view channel) { return plan_.Reads(channel) || log::RunMarks::IsMarked(channel); };
    for (; const auto event = reader.NextView(is_wanted); ++num_events_) {
      show(reader.position_bytes());
      if (!plan_.Reads(event->channel)) {
        summary.marks.Add(event->time, event->channel, event->bytes);
        const auto* known = bus::FindChannel(event->channel);
        Count(summary.left, known != nullptr ? known->name : "of other channels", 1);
      } else if (event->bytes.size() > bus::kMaxMessageBytes) {
        ++num_oversize;
      } else {
        order.Check(event->time);
        last_time_ = event->time;
        one_publisher_.Add(num_events_, event->time, *bus::FindChannel(event->channel), event->bytes);
      }
    }
    Count(summary.refused, "log.damaged", reader.num_damaged());
    Count(summary.refused, "log.oversize_message", num_oversize);
  }

  void Finish() {
    one_publisher_.Finish();
    summary_.interleavings = one_publisher_.Interleavings();
    Count(summary_.refused, "log.second_publisher", one_publisher_.num_left_out());
  }

 private:
  const Plan& plan_;
  Chain& chain_;
  InputSummary& summary_;
  OnePublisher one_publisher_;
  std::optional<Utime> last_time_;
  std::int64_t num_events_ = 0;
};

// Reads until all that is looked for was found.
void Look(const std::filesystem::path& file, const std::set<std::string, std::less<>>& candidates, std::set<std::string, std::less<>>& present,
          std::optional<run_info_t>& recorded) {
  const auto is_found = [&] { return std::ranges::all_of(candidates, [&](const auto& channel) { return present.contains(channel); }); };
  bus::LogReader reader(file, io::ThrowIfStopAsked);
  while (!is_found()) {
    io::ThrowIfStopAsked();
    const auto event = reader.NextView([](std::string_view channel) { return channel == bus::kRunInfo.name; });
    if (!event) return;
    if (!recorded && event->channel == bus::kRunInfo.name) recorded = bus::Decode<run_info_t>(event->bytes);
    if (bus::FindChannel(event->channel) != nullptr) present.emplace(event->channel);
  }
}

}  // namespace

InputKind KindOf(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) throw std::runtime_error(file.string() + ": is not a file that can be read twice");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw std::runtime_error(file.string() + ": cannot be read");
  if (in.peek() == std::ifstream::traits_type::eof()) throw std::runtime_error(file.string() + ": is empty");
  Magic start{};
  in.read(reinterpret_cast<char*>(start.data()), start.size());
  if (std::ranges::find(kCaptureMagics, start) != kCaptureMagics.end()) return InputKind::kCapture;
  // A log may be damaged at its start.
  if (start == kLogSyncWord || bus::LogReader(file, io::ThrowIfStopAsked).Next()) return InputKind::kLog;
  // Last: sentences stand in captures and logs too.
  return navigator::IsTextLog(file) ? InputKind::kTextLog : InputKind::kCapture;
}

Inspection Inspect(const std::vector<std::filesystem::path>& files, const Request& request) {
  const auto candidates = Candidates(request);
  Inspection inspection;
  std::set<std::string, std::less<>> present;
  std::size_t num_logs = 0;
  for (const auto& file : files) {
    const bool is_log = KindOf(file) == InputKind::kLog;
    inspection.sizes_bytes.push_back(static_cast<std::int64_t>(std::filesystem::file_size(file)));
    if (is_log) Look(file, candidates, present, inspection.recorded);
    num_logs += is_log ? 1 : 0;
  }
  if (num_logs != 0 && num_logs != files.size()) throw std::runtime_error("captures and lcm-logs cannot be replayed together");
  inspection.is_logs = num_logs != 0;
  try {
    inspection.plan = num_logs == 0 ? MakeCapturePlan(request) : MakeLogPlan(request, present);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(files.front().string() + ": " + error.what());
  }
  return inspection;
}

InputSummary Feed(const std::vector<std::filesystem::path>& files, const Inspection& inspection, Chain& chain, runtime::Progress& progress) {
  InputSummary summary;
  const auto start = std::chrono::steady_clock::now();
  const auto& sizes_bytes = inspection.sizes_bytes;
  const auto total_bytes = static_cast<double>(std::max<std::int64_t>(1, std::accumulate(sizes_bytes.begin(), sizes_bytes.end(), std::int64_t{0})));
  std::int64_t num_bytes = 0;
  const auto is_text_log = [](const auto& file) { return KindOf(file) == InputKind::kTextLog; };
  if (inspection.day && std::ranges::none_of(files, is_text_log)) Warn(progress, "the input holds no text log; --date is not used");
  const auto speed = [&] {
    return fmt::format("{:.0f} times real time", ToSeconds(chain.span()) / ToSeconds(std::chrono::steady_clock::now() - start));
  };
  LogFeeder logs(inspection.plan, chain, summary);
  for (std::size_t i = 0; i < files.size(); ++i) {
    const auto& file = files[i];
    const auto show = [&](std::int64_t num_bytes_of_file) {
      io::ThrowIfStopAsked();
      progress.Update(static_cast<double>(num_bytes + num_bytes_of_file) / total_bytes, speed);
    };
    const Feeding feeding{file, chain, summary, progress, show};
    const auto kind = KindOf(file);
    if (kind == InputKind::kLog) {
      logs.Feed(feeding);
    } else if (kind == InputKind::kTextLog) {
      FeedTextLog(feeding, inspection.day);
    } else {
      FeedCapture(feeding);
    }
    num_bytes += sizes_bytes[i];  // not asked for again: a file that is open may be moved or deleted
  }
  logs.Finish();
  return summary;
}

std::int64_t Finish(const InputSummary& summary, const Inspection& inspection, Chain& chain) {
  // A navigator that ended long before the lidar: live the wait for it was given up, scan by scan.
  constexpr std::chrono::seconds kGivenUp(2);
  if (!inspection.is_logs) {
    chain.Finish();
    return 0;
  }
  const auto lidar = summary.marks.LastTime(bus::kLidarPackets.name);
  const auto navigation = summary.marks.LastTime(bus::kNavRaw.name);
  const bool is_navigation_gone = lidar && navigation && *lidar - *navigation > kGivenUp;
  return chain.FinishLogs(summary.marks.WithoutEnd().empty() || is_navigation_gone);
}

std::vector<std::string> DifferingConfigFiles(const run_info_t& a, const run_info_t& b) {
  const auto texts = [](const run_info_t& info) {
    std::map<std::string, std::string> text_of_file;
    for (std::size_t i = 0; i < info.file_name.size(); ++i) {
      if (std::filesystem::path(info.file_name[i]).extension() == ".txtpb") text_of_file[info.file_name[i]] = info.file_text[i];
    }
    return text_of_file;
  };
  const auto texts_a = texts(a);
  const auto texts_b = texts(b);
  std::set<std::string> names;
  for (const auto* side : {&texts_a, &texts_b}) {
    for (const auto& entry : *side) names.insert(entry.first);
  }
  std::vector<std::string> differing;
  for (const auto& name : names) {
    const auto in_a = texts_a.find(name);
    const auto in_b = texts_b.find(name);
    if (in_a == texts_a.end() || in_b == texts_b.end() || in_a->second != in_b->second) differing.push_back(name);
  }
  return differing;
}

}  // namespace lookout::replay
