// A port with one connection, which is opened again whenever it was lost.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "services/plotter/io/connection.hpp"
#include "services/plotter/io/port.hpp"

namespace lookout::plotter {

class ReopeningPort : public Port {
 public:
  /// @param place       for people: "serial port /dev/ttyUSB0"
  /// @param last_pause  between two attempts: 1 s after a connection that lasted longer than this, doubled up to this after each other one
  ReopeningPort(std::shared_ptr<Loop> loop, const std::string& name, std::string place, std::chrono::seconds last_pause)
      : Port(std::move(loop)),
        place_(std::move(place)),
        last_pause_(last_pause),
        names_(name, {"sent", "dropped", "unsent", "received", "refused", "openings"}),
        fault_(place_ + " is not open yet") {}
  ~ReopeningPort() override;

  void Send(std::string_view message) override;
  void Tick(SteadyTime now) override;
  bool is_open() const override { return is_open_ && connection_->is_open(); }
  std::size_t room_bytes() const override { return is_open() ? connection_->room_bytes() : 0; }
  std::string fault() const override { return fault_; }
  std::vector<Counter> counters() const override;

 protected:
  /// @return a connection that is open or being opened; nullptr with `fault`
  virtual std::shared_ptr<Connection> Open(std::string& fault) = 0;

 private:
  static constexpr std::chrono::seconds kFirstPause{1};

  void Fail(const std::string& why, SteadyTime now);

  std::string place_;
  std::chrono::seconds last_pause_;
  CounterNames names_;
  std::string fault_;
  std::shared_ptr<Connection> connection_;
  bool is_open_ = false;
  SteadyTime opened_{};
  SteadyTime next_attempt_{};
  std::chrono::seconds pause_ = kFirstPause;
};

}  // namespace lookout::plotter
