#include "services/recorder/service.hpp"

#include <array>
#include <ctime>
#include <stdexcept>
#include <utility>

namespace lookout::recorder {

namespace {

constexpr std::chrono::seconds kRunInfoPeriod(10);
constexpr std::chrono::seconds kFlushPeriod(1);
constexpr int kMaxLogsOfOneSecond = 1000;

// "20261121T123456Z"
std::string FileStem(Utime time) {
  const std::time_t seconds = std::chrono::floor<std::chrono::seconds>(time).time_since_epoch().count();
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y%m%dT%H%M%SZ", &parts);
  return text.data();
}

// A name that is free: a log is never overwritten.
std::filesystem::path FreeName(const std::filesystem::path& folder, Utime time) {
  const std::string stem = FileStem(time);
  for (int i = 0; i < kMaxLogsOfOneSecond; ++i) {
    const auto file = folder / (stem + (i == 0 ? "" : "-" + std::to_string(i)) + ".lcmlog");
    if (!std::filesystem::exists(file)) return file;
  }
  throw std::runtime_error(folder.string() + ": no free name for a log of " + stem);
}

}  // namespace

Service::Service(bus::Bus& bus, const Params& params, run_info_t run_info, std::function<Utime()> clock)
    : bus_(bus), clock_(std::move(clock)), run_info_(std::move(run_info)) {
  const Utime now = clock_();
  std::error_code error;
  std::filesystem::create_directories(params.log_folder, error);
  if (error) throw std::runtime_error(params.log_folder.string() + ": cannot be made: " + error.message());
  log_file_ = FreeName(params.log_folder, now);
  log_ = std::make_unique<bus::LogWriter>(log_file_);
  SendRunInfo(now);
  bus_.SubscribeAll([this](std::string_view channel, Bytes bytes) { OnMessage(channel, bytes); });
}

// RUN_INFO is written when it is sent, not when it comes back.
void Service::OnMessage(std::string_view channel, Bytes bytes) {
  if (channel == bus::kRunInfo.name) return;
  if (bus::FindChannel(channel) == nullptr) ++num_unknown_channel_;
  Write(clock_(), channel, bytes);
}

void Service::AdvanceTo(Utime now) {
  // Periods also end when the host's clock was set back.
  if (now - last_run_info_ >= kRunInfoPeriod || now < last_run_info_) SendRunInfo(now);
  if (now - last_flush_ < kFlushPeriod && now >= last_flush_) return;
  last_flush_ = now;
  try {
    log_->Flush();
    write_error_.clear();
  } catch (const std::runtime_error& error) {
    write_error_ = error.what();
  }
}

void Service::SendRunInfo(Utime now) {
  last_run_info_ = now;
  run_info_.utime_us = ToUtimeUs(now);
  const auto bytes = bus::Encode(run_info_);
  ++run_info_.seq;
  Write(now, bus::kRunInfo.name, bytes);
  bus_.Publish(bus::kRunInfo, bytes);
}

void Service::Write(Utime time, std::string_view channel, Bytes bytes) {
  try {
    log_->Write(time, channel, bytes);
    ++num_events_;
  } catch (const std::runtime_error& error) {
    ++num_not_written_;
    write_error_ = error.what();
  }
}

HealthReport Service::Report() const {
  HealthReport report;
  report.counters = {
      {"events", num_events_}, {"bytes", log_->num_bytes()}, {"unknown_channel", num_unknown_channel_}, {"not_written", num_not_written_}};
  if (!write_error_.empty()) {
    report.state = HealthState::kError;
    report.reason = write_error_;
  }
  return report;
}

}  // namespace lookout::recorder
