// This computer as a device of an NMEA 2000 network: behind a gateway that takes RAW text, or on a CAN interface.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "services/plotter/core/n2k_device.hpp"
#include "services/plotter/n2k_output.hpp"

namespace lookout::plotter {

class N2kDeviceOutput : public N2kOutput {
 public:
  /// A gateway reports at least the frames that it has sent for us. A gateway that is silent for this long does not speak RAW text, or accepts
  /// nothing.
  static constexpr std::chrono::seconds kMostSilence{10};

  N2kDeviceOutput(const OutputParams& params, std::unique_ptr<Link> link, std::chrono::microseconds target_period, N2kIdentity identity);

  std::string fault() const override;
  /// Counters of the link; output_NAME_address (-1: none is claimed), output_NAME_addresses_lost, output_NAME_unanswered.
  std::vector<Counter> counters() const override;

 private:
  void SendNotices(const Told& told) override;
  void SendAnew() override;
  Commands Read(const std::string& message, const Told& told) override;
  std::string Text(const N2kMessage& message, Utime time) override;
  bool IsReady() const override { return !owes_begin_ && device_.is_claimed(); }
  int most_read() const override { return 64; }  // all waiting messages: a busy network sends more than a thousand frames a second

  std::string TextFrom(const N2kMessage& message, std::uint8_t source);
  void SendOwed();
  void NoteOwnClaim(const N2kFrame& frame);

  std::uint64_t name_;
  N2kDevice device_;
  bool owes_begin_ = true;
  bool was_claimed_ = false;
  bool is_gateway_;
  std::chrono::microseconds now_{0};
  std::chrono::microseconds heard_{0};  // or begun
  int given_address_ = -1;              // that the gateway puts in place of ours
  std::string address_name_, lost_name_, unanswered_name_;
};

}  // namespace lookout::plotter
