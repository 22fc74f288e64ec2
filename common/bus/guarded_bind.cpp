#include "common/bus/guarded_bind.hpp"

#include <linux/sock_diag.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

namespace lookout::bus {

namespace {

thread_local BindGuard* active_guard = nullptr;

}  // namespace

BindGuard::BindGuard(std::vector<sock_filter> program) : program_(std::move(program)), outer_(std::exchange(active_guard, this)) {}

BindGuard::~BindGuard() { active_guard = outer_; }

void BindGuard::OnBind(int descriptor) {
  int type = 0;
  socklen_t length = sizeof type;
  if (getsockopt(descriptor, SOL_SOCKET, SO_TYPE, &type, &length) != 0 || type != SOCK_DGRAM) return;
  const sock_fprog filter{static_cast<unsigned short>(program_.size()), program_.data()};
  const int yes = 1;
  if (setsockopt(descriptor, SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof filter) != 0 ||
      setsockopt(descriptor, SOL_SOCKET, SO_LOCK_FILTER, &yes, sizeof yes) != 0) {
    fault_ = "the kernel takes no filter for it: " + std::error_code(errno, std::generic_category()).message();
    return;
  }
  sockets_.push_back(descriptor);
}

std::int64_t NumDropped(int descriptor) {
  std::array<std::uint32_t, SK_MEMINFO_VARS> info{};
  socklen_t length = sizeof info;
  if (getsockopt(descriptor, SOL_SOCKET, SO_MEMINFO, info.data(), &length) != 0 || length <= SK_MEMINFO_DROPS * sizeof(std::uint32_t)) return -1;
  return info[SK_MEMINFO_DROPS];
}

}  // namespace lookout::bus

// Libraries that this program is linked with find it before that of the C library.
extern "C" __attribute__((visibility("default"))) int bind(int descriptor, const sockaddr* address, socklen_t length) noexcept {
  if (lookout::bus::active_guard != nullptr) lookout::bus::active_guard->OnBind(descriptor);
  return static_cast<int>(syscall(SYS_bind, descriptor, address, length));
}
