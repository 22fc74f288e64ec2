#include <fcntl.h>
#include <sys/ioctl.h>
#include <termios.h>

#include <algorithm>
#include <boost/asio/posix/stream_descriptor.hpp>

#include "common/io/serial_device.hpp"
#include "services/plotter/io/ports.hpp"
#include "services/plotter/io/reopening_port.hpp"
#include "services/plotter/io/stream_connection.hpp"

namespace lookout::plotter {

namespace {

using boost::asio::posix::stream_descriptor;

class SerialConnection final : public StreamConnection<stream_descriptor> {
 public:
  SerialConnection(stream_descriptor stream, std::shared_ptr<Traffic> traffic, bool is_binary)
      : StreamConnection(std::move(stream), std::move(traffic)), is_binary_(is_binary) {}

  std::size_t num_waiting() { return num_waiting_bytes(); }

 private:
  void OnEnd() override { Close("was unplugged"); }
  void Take(std::string_view bytes) override {
    if (!is_binary_) return StreamConnection::Take(bytes);
    if (!bytes.empty()) traffic().Add(std::string(bytes));
  }
  // Closing waits for unsent bytes of the port, for seconds.
  void PrepareClose() override { tcflush(stream().native_handle(), TCOFLUSH); }

  bool is_binary_;
};

class SerialPort final : public ReopeningPort {
 public:
  SerialPort(std::shared_ptr<Loop> loop, const SerialOptions& options)
      : ReopeningPort(std::move(loop), options.name, "serial port " + options.device, std::chrono::seconds(1)),
        device_(options.device),
        baud_(options.baud),
        is_binary_(options.is_binary),
        max_room_bytes_(std::max(kMaxLineBytes, static_cast<double>(options.baud) / kBitsPerByte / 2)) {}

  // Bytes beyond the speed of the line would only make all later ones late.
  void Send(std::string_view message) override {
    if (is_open() && message.size() > room_bytes()) {
      ++traffic_->num_dropped;
      return;
    }
    room_bytes_ -= is_open() ? static_cast<double>(message.size()) : 0.0;
    ReopeningPort::Send(message);
  }

  void Tick(SteadyTime now) override {
    const double elapsed_s = std::chrono::duration<double>(now - last_tick_).count();
    room_bytes_ = std::min(max_room_bytes_, room_bytes_ + elapsed_s * baud_ / kBitsPerByte);
    last_tick_ = now;
    ReopeningPort::Tick(now);
  }

  std::size_t room_bytes() const override {
    if (!is_open()) return 0;
    return static_cast<std::size_t>(std::max(max_room_bytes_ - unsent_bytes(), 0.0));
  }

  std::chrono::microseconds delay() const override {
    if (!is_open()) return {};
    return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::duration<double>(unsent_bytes() * kBitsPerByte / baud_));
  }

 private:
  static constexpr double kBitsPerByte = 10;  // 8N1: a start bit, 8 data bits, a stop bit
  // Room for half a second; at the lowest speeds for the longest line (a line of NMEA 2000; a sentence of NMEA 0183 has at most 82 bytes).
  static constexpr double kMaxLineBytes = 256;

  // Unsent bytes by the port's speed, and, where the port is slower in fact, by the bytes that it holds.
  double unsent_bytes() const { return std::max(max_room_bytes_ - room_bytes_, static_cast<double>(serial_->num_waiting())); }

  std::shared_ptr<Connection> Open(std::string& fault) override {
    const int descriptor = io::OpenSerialDevice(device_, baud_, O_RDWR, fault);
    if (descriptor < 0) return nullptr;
    serial_ = std::make_shared<SerialConnection>(stream_descriptor(context(), descriptor), traffic_, is_binary_);
    serial_->Start();
    return serial_;
  }

  std::string device_;
  int baud_;
  bool is_binary_;
  double max_room_bytes_;
  double room_bytes_ = 0;
  SteadyTime last_tick_ = std::chrono::steady_clock::now();
  std::shared_ptr<SerialConnection> serial_;
};

}  // namespace

std::unique_ptr<Port> MakeSerialPort(std::shared_ptr<Loop> loop, const SerialOptions& options) {
  return std::make_unique<SerialPort>(std::move(loop), options);
}

}  // namespace lookout::plotter
