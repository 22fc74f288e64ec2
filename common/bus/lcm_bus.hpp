// The live bus: LCM over UDP multicast (or any other LCM provider).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/lcm_url.hpp"

namespace lookout::bus {

/// Receive buffer asked of the kernel, which gives at most net.core.rmem_max: two seconds of every channel at its greatest rate fit.
inline constexpr int kReceiveBufferBytes = 4 * 1024 * 1024;

/// Whether the kernel has a way to the group. LCM cannot be opened without.
bool HasRoute(const MulticastAddress& address);

/// On udpm:// its socket takes only datagrams that LCM's receiver is safe with (common/bus/datagram_filter.hpp), and with a time-to-live of 0 only
/// those of this computer, from the first one on.
class LcmBus final : public Bus {
 public:
  /// @param url  LCM address; "udpm://..." is completed with a large receive buffer unless it names one. memq:// is for tests.
  /// @throws std::runtime_error when it is wrong, or LCM cannot be opened; the text holds the `ip route` line that mends a missing multicast route
  explicit LcmBus(const std::string& url);
  ~LcmBus() override;

  bool HandleOnce(std::chrono::milliseconds timeout) override;
  int QueueDepth(std::string_view channel) const override;

  std::optional<std::int64_t> NumDatagramsDropped() const override;
  std::string GuardFault() const override;

  /// File descriptor that is readable while a message waits.
  int file_descriptor() const;

 protected:
  bool Send(const Channel& channel, std::vector<std::uint8_t>&& bytes) override;
  void Attach(const Channel* channel, RawHandler handler) override;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lookout::bus
