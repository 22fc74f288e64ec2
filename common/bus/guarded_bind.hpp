// Filters on sockets that a library opens for itself, in place before the first datagram.
#pragma once

#include <linux/filter.h>

#include <cstdint>
#include <string>
#include <vector>

namespace lookout::bus {

/// While it lives, a UDP socket that this thread binds has `program` attached and locked first: no datagram reaches it unasked, not even before
/// bind() returns. (A socket that is not bound to a port gets none.) For LCM, which gives out no descriptor of its socket and reads it in a thread of
/// its own from the start. It works by a bind() in the program itself, which the libraries' calls reach before that of the C library.
class BindGuard {
 public:
  explicit BindGuard(std::vector<sock_filter> program);
  ~BindGuard();
  BindGuard(const BindGuard&) = delete;
  BindGuard& operator=(const BindGuard&) = delete;

  /// Called by bind().
  void OnBind(int descriptor);

  /// Sockets with the filter.
  const std::vector<int>& sockets() const { return sockets_; }
  /// Why a socket has none; empty when all have.
  const std::string& fault() const { return fault_; }

 private:
  std::vector<sock_filter> program_;
  std::vector<int> sockets_;
  std::string fault_;
  BindGuard* outer_;
};

/// Datagrams that the kernel has dropped at this socket since it was made: refused by its filter, damaged, or without room. -1 when it does not tell.
std::int64_t NumDropped(int descriptor);

}  // namespace lookout::bus
