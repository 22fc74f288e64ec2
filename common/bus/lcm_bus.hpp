// The live bus: LCM over UDP multicast (or any other LCM provider).
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "common/bus/bus.hpp"

namespace lookout::bus {

/// Receive buffer asked of the kernel, which gives at most net.core.rmem_max: two seconds of every channel at its greatest rate fit.
inline constexpr int kReceiveBufferBytes = 4 * 1024 * 1024;

struct MulticastAddress {
  std::string group;
  int port = 0;
  int time_to_live = 0;  // 0 = this computer only
};

/// @param url  "udpm://239.255.76.67:7667?ttl=1"; what is left out has LCM's default
/// @return nullopt when it is no multicast address
std::optional<MulticastAddress> ParseMulticast(const std::string& url);

/// Whether the kernel has a way to the group. LCM cannot be opened without.
bool HasRoute(const MulticastAddress& address);

/// The address in the environment variable LCM_DEFAULT_URL, else LCM's default group with a time-to-live of 0 (this computer only).
std::string DefaultLcmUrl();

class LcmBus final : public Bus {
 public:
  /// @param url  LCM address; "udpm://..." is completed with a large receive buffer unless it names one
  /// @throws std::runtime_error when LCM cannot be opened; where no multicast route exists the text holds the `ip route` line that mends it
  explicit LcmBus(const std::string& url);
  ~LcmBus() override;

  bool HandleOnce(std::chrono::milliseconds timeout) override;
  int QueueDepth(std::string_view channel) const override;

  /// File descriptor that is readable while a message waits.
  int file_descriptor() const;

 protected:
  bool Send(const Channel& channel, Bytes bytes) override;
  void Attach(const Channel* channel, RawHandler handler) override;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lookout::bus
