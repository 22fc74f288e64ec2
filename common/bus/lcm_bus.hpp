// The live bus: LCM over UDP multicast (or any other LCM provider).
#pragma once

#include <memory>
#include <string>

#include "common/bus/bus.hpp"

namespace lookout::bus {

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
