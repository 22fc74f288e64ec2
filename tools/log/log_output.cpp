#include "tools/log/log_output.hpp"

#include <stdexcept>
#include <system_error>
#include <utility>

namespace lookout::log {

LogOutput::LogOutput(std::filesystem::path file, const std::vector<std::filesystem::path>& inputs) : file_(std::move(file)), partial_(file_) {
  partial_ += ".partial";
  std::error_code error;
  for (const auto& input : inputs) {
    if (std::filesystem::equivalent(input, file_, error)) throw std::runtime_error(file_.string() + ": is an input");
  }
  if (std::filesystem::exists(file_, error) && !std::filesystem::is_regular_file(file_, error)) {
    throw std::runtime_error(file_.string() + ": is no file");
  }
  writer_.emplace(partial_, /*overwrite=*/true);
}

LogOutput::~LogOutput() {
  if (!writer_) return;
  writer_.reset();
  std::error_code ignored;
  std::filesystem::remove(partial_, ignored);
}

void LogOutput::Write(Utime time, const bus::LogEvent& event) {
  writer_->Write(time, event.channel, event.bytes);
  ++num_events_;
}

void LogOutput::Commit() {
  writer_->Flush();
  std::filesystem::rename(partial_, file_);
  writer_.reset();
}

}  // namespace lookout::log
