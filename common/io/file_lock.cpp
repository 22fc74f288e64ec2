#include "common/io/file_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/io/output_file.hpp"
#include "common/io/stop_signal.hpp"

namespace lookout::io {

namespace {

void Wait(int descriptor, const std::filesystem::path& file, const std::function<void()>& on_wait) {
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return;
  if (errno == EWOULDBLOCK) {
    if (on_wait) on_wait();
    while (::flock(descriptor, LOCK_EX) != 0) {
      if (errno != EINTR) throw std::runtime_error(file.string() + ": cannot be locked: " + ErrnoText());
      ThrowIfStopAsked();
    }
    return;
  }
  throw std::runtime_error(file.string() + ": cannot be locked: " + ErrnoText());
}

}  // namespace

FileLock::FileLock(std::filesystem::path file, AtEnd at_end, const std::function<void()>& on_wait) : file_(std::move(file)), at_end_(at_end) {
  constexpr int kMode = 0666;
  for (;;) {
    descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, kMode);
    if (descriptor_ < 0) throw std::runtime_error(file_.string() + ": cannot be opened: " + ErrnoText());
    try {
      Wait(descriptor_, file_, on_wait);
    } catch (...) {
      ::close(descriptor_);
      throw;
    }
    if (IsNameOf(file_, descriptor_)) return;  // else its holder has removed it meanwhile
    ::close(descriptor_);
  }
}

FileLock::~FileLock() {
  if (at_end_ == AtEnd::kIsRemoved) ::unlink(file_.c_str());  // while it is locked: who waits for it sees that it is gone
  ::close(descriptor_);
}

}  // namespace lookout::io
