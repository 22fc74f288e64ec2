#include "tools/export/output.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

namespace lookout::exporter {

namespace {

std::runtime_error Fault(const std::filesystem::path& file) {
  return std::runtime_error(file.string() + ": cannot be written: " + std::system_category().message(errno));
}

}  // namespace

Output::Output(const std::optional<std::filesystem::path>& file) : file_(file) {
  std::signal(SIGPIPE, SIG_IGN);  // a broken pipe is then an error of write()
  if (!file_) {
    descriptor_ = STDOUT_FILENO;
    return;
  }
  std::error_code error;
  const bool is_device = std::filesystem::exists(*file_, error) && !std::filesystem::is_regular_file(*file_, error);
  if (!is_device) partial_ = file_->string() + ".partial";
  const auto& target = is_device ? *file_ : partial_;
  descriptor_ = ::open(target.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw Fault(target);
}

Output::~Output() {
  if (!file_ || descriptor_ < 0) return;
  ::close(descriptor_);
  std::error_code error;
  if (!partial_.empty()) std::filesystem::remove(partial_, error);
}

void Output::Write(std::string_view bytes) {
  while (!bytes.empty()) {
    const auto size = ::write(descriptor_, bytes.data(), bytes.size());
    if (size >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(size));
    } else if (errno == EPIPE) {
      throw BrokenPipe();
    } else if (errno != EINTR) {
      throw Fault(file_.value_or("standard output"));
    }
  }
}

void Output::Commit() {
  if (!file_) return;
  if (::close(std::exchange(descriptor_, -1)) != 0) {
    const auto fault = Fault(*file_);
    std::error_code error;
    if (!partial_.empty()) std::filesystem::remove(partial_, error);
    throw fault;
  }
  if (!partial_.empty()) std::filesystem::rename(partial_, *file_);
}

}  // namespace lookout::exporter
