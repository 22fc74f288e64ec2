#include "tools/replay/input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <map>
#include <numeric>
#include <set>
#include <spdlog/spdlog.h>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "common/bus/decode.hpp"
#include "common/bus/log_file.hpp"
#include "common/io/file_kind.hpp"
#include "common/io/stop_signal.hpp"
#include "services/lidar/io/capture_reader.hpp"
#include "services/navigator/io/text_log_reader.hpp"
#include "tools/replay/live_run.hpp"

namespace lookout::replay {

namespace {

namespace fs = std::filesystem;

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

// Reads the files, one after the other, into the chain.
class Feeder {
 public:
  Feeder(const std::vector<fs::path>& files, const Inspection& inspection, Chain& chain, runtime::Progress& progress)
      : files_(files),
        inspection_(inspection),
        chain_(chain),
        progress_(progress),
        total_bytes_(std::max<std::int64_t>(1, std::accumulate(inspection.sizes_bytes.begin(), inspection.sizes_bytes.end(), std::int64_t{0}))),
        one_publisher_([this](Utime time, const bus::Channel& channel, Bytes bytes) {
          summary_.marks.Add(time, channel.name, bytes);
          ++summary_.num_events;
          chain_.OnLogged(time, channel, bytes);
        }) {}

  InputSummary Run() {
    const auto is_text_log = [](const auto& file) { return KindOf(file) == InputKind::kTextLog; };
    if (inspection_.day && std::ranges::none_of(files_, is_text_log)) Warn("the input holds no text log; --date is not used");
    for (std::size_t i = 0; i < files_.size(); ++i) {
      before_ = last_time_;
      const auto kind = KindOf(files_[i]);
      if (kind == InputKind::kLog) {
        FeedLog(files_[i]);
      } else if (kind == InputKind::kTextLog) {
        FeedTextLog(files_[i]);
      } else {
        FeedCapture(files_[i]);
      }
      num_bytes_ += inspection_.sizes_bytes[i];  // not asked for again: a file that is open may be moved or deleted
    }
    one_publisher_.Finish();
    summary_.interleavings = one_publisher_.Interleavings();
    Count(summary_.refused, "log.second_publisher", one_publisher_.num_left_out());
    return std::move(summary_);
  }

 private:
  // A line of the log, beside which no progress stands.
  template <typename... Values>
  void Warn(fmt::format_string<Values...> form, Values&&... values) {
    progress_.Clear();
    spdlog::warn(form, std::forward<Values>(values)...);
  }

  // Before an event is handed in.
  void CheckOrder(const fs::path& file, Utime time) {
    if (before_ && time < *before_) {
      Warn("{}: begins {:.3f} s before the file before it ends; are the files in their order?", file.string(), ToSeconds(*before_ - time));
    }
    before_.reset();
    last_time_ = time;
  }

  void Show(std::int64_t num_bytes_of_file) {
    io::ThrowIfStopAsked();
    progress_.Update(static_cast<double>(num_bytes_ + num_bytes_of_file) / static_cast<double>(total_bytes_), [this] {
      return fmt::format("{:.0f} times real time", ToSeconds(chain_.span()) / ToSeconds(std::chrono::steady_clock::now() - start_));
    });
  }

  void FeedTextLog(const fs::path& file) {
    const auto& day = inspection_.day;
    navigator::TextLogReader reader(file, day);
    if (!reader.has_date() && !day) {
      Warn("{}: no sentence tells a date; its times are taken as those of 1970-01-01, give --date", file.string());
    }
    if (reader.has_date() && day) Warn("{}: its {} tell a date; --date is not used", file.string(), reader.is_csv() ? "rows" : "sentences");
    while (const auto line = reader.Next()) {
      CheckOrder(file, line->time);
      ++summary_.num_events;
      chain_.OnTextLine(line->time, line->bytes);
      Show(reader.position());
    }
    if (!reader.fault().empty()) Warn("{}: {}; read as far as it goes", file.string(), reader.fault());
    Count(summary_.refused, "text_log.other_rows", reader.num_other_rows());
    Count(summary_.refused, "text_log.rows_without_time", reader.num_rows_without_time());
  }

  void FeedCapture(const fs::path& file) {
    lidar::CaptureReader reader(file);
    while (const auto datagram = reader.Next()) {
      CheckOrder(file, datagram->host_time);
      ++summary_.num_events;
      chain_.OnDatagram({datagram->host_time, datagram->destination_port, datagram->payload, {datagram->source_address, datagram->source_port}});
      Show(reader.position_bytes());
    }
    if (reader.num_damaged() > 0) Warn("{}: {}", file.string(), reader.damage());
    for (const auto& counter : reader.counters()) {
      if (counter.name == "frames_read" || counter.name == "frames_datagram") continue;  // work done, no refusal
      Count(summary_.refused, "capture." + std::string(counter.name), counter.count);
    }
  }

  // A publisher goes on from one log to the next.
  void FeedLog(const fs::path& file) {
    const auto& plan = inspection_.plan;
    bus::LogReader reader(file, io::ThrowIfStopAsked);
    std::int64_t num_oversize = 0;
    const auto is_wanted = [&plan](std::string_view channel) { return plan.Reads(channel) || log::RunMarks::IsMarked(channel); };
    for (; const auto event = reader.NextView(is_wanted); ++num_events_) {
      Show(reader.position_bytes());
      if (!plan.Reads(event->channel)) {
        summary_.marks.Add(event->time, event->channel, event->bytes);
        const auto* known = bus::FindChannel(event->channel);
        Count(summary_.left, known != nullptr ? known->name : "of other channels", 1);
      } else if (event->bytes.size() > bus::kMaxMessageBytes) {
        ++num_oversize;
      } else {
        CheckOrder(file, event->time);
        one_publisher_.Add(num_events_, event->time, *bus::FindChannel(event->channel), event->bytes);
      }
    }
    Count(summary_.refused, "log.damaged", reader.num_damaged());
    Count(summary_.refused, "log.oversize_message", num_oversize);
  }

  const std::vector<fs::path>& files_;
  const Inspection& inspection_;
  Chain& chain_;
  runtime::Progress& progress_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::int64_t total_bytes_;
  std::int64_t num_bytes_ = 0;  // of the files before this one
  OnePublisher one_publisher_;
  std::int64_t num_events_ = 0;     // of logs
  std::optional<Utime> last_time_;  // of an event
  std::optional<Utime> before_;     // last_time_ of the file before, until the first event of this file
  InputSummary summary_;
};

// Reads until all that is looked for was found.
void Look(const std::filesystem::path& file, const std::set<std::string, std::less<>>& candidates, std::set<std::string, std::less<>>& present,
          std::optional<run_info_t>& recorded, const std::function<void(std::int64_t)>& show) {
  const auto is_found = [&] { return std::ranges::all_of(candidates, [&](const auto& channel) { return present.contains(channel); }); };
  bus::LogReader reader(file, io::ThrowIfStopAsked);
  while (!is_found()) {
    io::ThrowIfStopAsked();
    if (show) show(reader.position_bytes());
    const auto event = reader.NextView([](std::string_view channel) { return channel == bus::kRunInfo.name; });
    if (!event) return;
    if (!recorded && event->channel == bus::kRunInfo.name) recorded = bus::Decode<run_info_t>(event->bytes);
    if (bus::FindChannel(event->channel) != nullptr) present.emplace(event->channel);
  }
}

}  // namespace

InputKind KindOf(const std::filesystem::path& file) {
  if (const auto reason = io::WhyNot(file, io::Wanted::kRecording); !reason.empty()) throw std::runtime_error(reason);
  const auto kind = io::FileKindOf(file);
  if (io::WhyNot(file, io::Wanted::kCapture).empty() && kind != io::FileKind::kUnknown) return InputKind::kCapture;
  if (kind == io::FileKind::kLcmLog) return InputKind::kLog;
  // A log may be damaged at its start.
  if ((kind == io::FileKind::kUnknown || kind == io::FileKind::kText) && bus::LogReader(file, io::ThrowIfStopAsked).Next()) return InputKind::kLog;
  // Last: sentences stand in captures and logs too.
  return navigator::IsTextLog(file) ? InputKind::kTextLog : InputKind::kCapture;
}

Inspection Inspect(const std::vector<std::filesystem::path>& files, const Request& request, const std::function<void(double)>& show_share) {
  const auto candidates = Candidates(request);
  Inspection inspection;
  std::set<std::string, std::less<>> present;
  std::size_t num_logs = 0;
  std::size_t num_text_logs = 0;
  // Logs are looked at, and then read for the actions of the tracker.
  std::int64_t total_bytes = 1;
  for (const auto& file : files) {
    std::error_code error;
    const auto size_bytes = std::filesystem::file_size(file, error);
    total_bytes += error ? 0 : 2 * static_cast<std::int64_t>(size_bytes);
  }
  std::int64_t done_bytes = 0;
  const std::function<void(std::int64_t)> show = [&](std::int64_t position_bytes) {
    if (show_share) show_share(static_cast<double>(done_bytes + position_bytes) / static_cast<double>(total_bytes));
  };
  for (const auto& file : files) {
    const auto kind = KindOf(file);
    const bool is_log = kind == InputKind::kLog;
    num_text_logs += kind == InputKind::kTextLog ? 1 : 0;
    inspection.sizes_bytes.push_back(static_cast<std::int64_t>(std::filesystem::file_size(file)));
    if (is_log) Look(file, candidates, present, inspection.recorded, show);
    done_bytes += inspection.sizes_bytes.back();
    num_logs += is_log ? 1 : 0;
  }
  if (num_logs != 0 && num_logs != files.size()) throw std::runtime_error("captures and lcm-logs cannot be replayed together");
  inspection.is_logs = num_logs != 0;
  inspection.is_text_logs = num_text_logs == files.size();
  try {
    inspection.plan = num_logs == 0 ? MakeCapturePlan(request) : MakeLogPlan(request, present);
    if (inspection.is_logs && inspection.plan.Publishes(bus::kAlerts)) inspection.plan.script = ReadScript(files, show);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(files.front().string() + ": " + error.what());
  }
  return inspection;
}

InputSummary Feed(const std::vector<std::filesystem::path>& files, const Inspection& inspection, Chain& chain, runtime::Progress& progress) {
  return Feeder(files, inspection, chain, progress).Run();
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
  std::map<std::string, std::array<std::optional<std::string>, 2>> texts_of_file;
  for (const std::size_t side : {0, 1}) {
    const auto& info = side == 0 ? a : b;
    for (std::size_t i = 0; i < info.file_name.size(); ++i) {
      if (std::filesystem::path(info.file_name[i]).extension() == ".txtpb") texts_of_file[info.file_name[i]].at(side) = info.file_text[i];
    }
  }
  // An absent file has the defaults; RUN_INFO of before did not hold its text.
  const auto is_default = [](const std::optional<std::string>& text) {
    std::istringstream lines(text.value_or(""));
    for (std::string line; std::getline(lines, line);) {
      if (!line.ends_with("  # default")) return false;
    }
    return true;
  };
  std::vector<std::string> differing;
  for (const auto& [name, texts] : texts_of_file) {
    const bool is_in_one_alone = !texts[0] || !texts[1];
    if (texts[0] != texts[1] && !(is_in_one_alone && is_default(texts[0]) && is_default(texts[1]))) differing.push_back(name);
  }
  return differing;
}

}  // namespace lookout::replay
