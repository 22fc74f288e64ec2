#include "services/recorder/service.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "common/bus/header.hpp"

namespace lookout::recorder {

namespace {

// What LCM sends to itself when it opens UDP multicast.
constexpr std::string_view kLcmSelfTest = "LCM_SELF_TEST";

constexpr std::chrono::seconds kRunInfoPeriod(10);
// Channels outside of the table that are named in warnings.
constexpr std::size_t kMaxUnknownNames = 20;

// "20261121T134501Z"
std::string FileStem(Utime time) {
  const auto day = std::chrono::floor<std::chrono::days>(time);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss clock(std::chrono::floor<std::chrono::seconds>(time - day));
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%04d%02u%02uT%02d%02d%02dZ", static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                static_cast<unsigned>(date.day()), static_cast<int>(clock.hours().count()), static_cast<int>(clock.minutes().count()),
                static_cast<int>(clock.seconds().count()));
  return text.data();
}

// Makes an empty file under a name that no file had: of two recorders that start in the same second each gets its own.
std::filesystem::path MakeFile(const std::filesystem::path& folder, Utime time) {
  const std::string stem = FileStem(time);
  auto path = folder / (stem + ".lcmlog");
  for (int i = 1;; ++i) {
    if (std::FILE* file = std::fopen(path.c_str(), "wx")) {
      std::fclose(file);
      return path;
    }
    if (errno != EEXIST) throw std::runtime_error(path.string() + ": cannot be made: " + std::system_category().message(errno));
    path = folder / (stem + "-" + std::to_string(i) + ".lcmlog");
  }
}

// Channel names come from the network.
std::string Printable(std::string_view text) {
  std::string printable;
  for (const char letter : text) printable += letter >= ' ' && letter <= '~' ? letter : '?';
  return printable;
}

}  // namespace

Service::Service(bus::Bus& bus, const Params& params, run_info_t run_info, std::function<Utime()> clock)
    : bus_(bus), params_(params), run_info_(std::move(run_info)), clock_(std::move(clock)) {
  std::error_code error;
  std::filesystem::create_directories(params_.log_folder, error);
  if (!std::filesystem::is_directory(params_.log_folder)) {
    throw std::runtime_error(params_.log_folder.string() + ": the folder of the logs cannot be made: " + error.message());
  }
  BeginLog(clock_());
  if (!writer_) throw std::runtime_error(fault_);
  bus_.SubscribeAll([this](std::string_view channel, Bytes bytes) { OnEvent(channel, bytes); });
}

void Service::AdvanceTo(Utime now) {
  if (!writer_) {
    BeginLog(now);
  } else if (now - *last_run_info_ >= kRunInfoPeriod || now < *last_run_info_) {  // the host's clock may be set back
    Write(now, bus::kRunInfo.name, EncodeRunInfo(now));
    PublishRunInfo(now);
  }
  Flush();
}

void Service::OnEvent(std::string_view channel, Bytes bytes) {
  if (channel.empty()) {  // a log that holds one cannot be read on
    ++num_nameless_;
    return;
  }
  if (channel == bus::kRunInfo.name && std::ranges::equal(bytes, own_run_info_)) return;  // written when it was sent
  const bus::Channel* known = bus::FindChannel(channel);
  if (known == nullptr) {
    if (channel != kLcmSelfTest) WatchUnknown(channel);
  } else if (known->is_raw) {
    WatchGaps(channel, bytes);
  }
  Write(clock_(), channel, bytes);
}

void Service::BeginLog(Utime now) {
  std::filesystem::path file;
  try {
    file = MakeFile(params_.log_folder, now);
    auto writer = std::make_unique<bus::LogWriter>(file, /*overwrite=*/true);
    const auto run_info = EncodeRunInfo(now);
    writer->Write(now, bus::kRunInfo.name, run_info);
    writer->Flush();
    writer_ = std::move(writer);
  } catch (const std::exception& error) {
    // On a full disk there would be one more empty file with each attempt.
    std::error_code ignored;
    if (!file.empty()) std::filesystem::remove(file, ignored);
    Fail(error.what());
    return;
  }
  log_file_ = file;
  is_failing_ = false;
  ++num_events_;
  PublishRunInfo(now);
}

std::vector<std::uint8_t> Service::EncodeRunInfo(Utime now) {
  run_info_.utime_us = ToUtimeUs(now);
  return bus::Encode(run_info_);
}

void Service::PublishRunInfo(Utime now) {
  last_run_info_ = now;
  own_run_info_ = EncodeRunInfo(now);
  ++run_info_.seq;
  bus_.Publish(bus::kRunInfo, own_run_info_);
}

void Service::Write(Utime time, std::string_view channel, Bytes bytes) {
  if (!writer_) {
    ++num_lost_;
    return;
  }
  ++num_unflushed_;
  try {
    writer_->Write(time, channel, bytes);
    ++num_events_;
    num_bytes_ += static_cast<std::int64_t>(bytes.size());
  } catch (const std::exception& error) {
    Fail(error.what());
  }
}

void Service::Flush() {
  if (!writer_) return;
  try {
    writer_->Flush();
    num_unflushed_ = 0;
  } catch (const std::exception& error) {
    Fail(error.what());
  }
}

void Service::Fail(std::string_view reason) {
  fault_ = Printable(reason);
  if (!is_failing_) warnings_.push_back(fault_ + "; events are lost until it works again");
  is_failing_ = true;
  writer_.reset();
  ++num_faults_;
  num_lost_ += num_unflushed_;
  num_unflushed_ = 0;
}

void Service::WatchGaps(std::string_view channel, Bytes bytes) {
  const auto header = bus::ReadHeader(bytes);
  if (!header) return;  // its readers refuse it
  auto watch = raw_sequences_.find(channel);
  if (watch == raw_sequences_.end()) watch = raw_sequences_.emplace(channel, bus::SequenceWatch{}).first;
  num_raw_missing_ += watch->second.NumLostBefore(header->seq);
}

void Service::WatchUnknown(std::string_view channel) {
  ++num_unknown_;
  if (unknown_channels_.size() >= kMaxUnknownNames || unknown_channels_.contains(channel)) return;
  unknown_channels_.emplace(channel);
  warnings_.push_back("channel " + Printable(channel) + " is not in the channel table; it is recorded" +
                      (unknown_channels_.size() == kMaxUnknownNames ? "; further ones are not named here" : ""));
}

std::vector<std::string> Service::TakeWarnings() { return std::exchange(warnings_, {}); }

HealthReport Service::Report() const {
  HealthReport report;
  report.counters = {{"events", num_events_},
                     {"bytes", num_bytes_},
                     {"lost", num_lost_},
                     {"write_faults", num_faults_},
                     {"unknown_channel", num_unknown_},
                     {"nameless_channel", num_nameless_},
                     {"raw_missing", num_raw_missing_}};
  if (!writer_) {
    report.state = HealthState::kFailed;
    report.reason = "not recording: " + fault_;
  } else if (num_lost_ > 0) {
    report.state = HealthState::kDegraded;
    report.reason = "recording again; " + std::to_string(num_lost_) + " events lost: " + fault_;
  } else if (num_raw_missing_ > 0) {
    report.state = HealthState::kDegraded;
    report.reason = std::to_string(num_raw_missing_) + " raw messages did not arrive: the log cannot be computed again in full";
  }
  return report;
}

}  // namespace lookout::recorder
