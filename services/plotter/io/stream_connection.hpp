// A connection over a stream of Asio (a TCP socket, a serial port): bytes go out in their order, lines come in.
#pragma once

#include <sys/ioctl.h>

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/system/error_code.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "services/plotter/io/connection.hpp"
#include "services/plotter/io/line_cutter.hpp"

namespace lookout::plotter {

template <class Stream>
class StreamConnection : public Connection, public std::enable_shared_from_this<StreamConnection<Stream>> {
 public:
  StreamConnection(Stream stream, std::shared_ptr<Traffic> traffic) : Connection(std::move(traffic)), stream_(std::move(stream)) {}

  /// The stream is open: begins to read, and Send may be called.
  void Start() {
    Open();
    Read();
  }

 protected:
  /// The other side sends no more. Closes the connection unless the other side may still receive.
  virtual void OnEnd() { Close("ended"); }
  virtual void PrepareClose() {}
  virtual void Take(std::string_view bytes) { cutter_.Cut(bytes, traffic()); }

  Stream& stream() { return stream_; }

  std::size_t num_waiting_bytes() override {
    int num_in_kernel = 0;  // TIOCOUTQ is SIOCOUTQ: of TCP, unacknowledged bytes
    if (ioctl(stream_.native_handle(), TIOCOUTQ, &num_in_kernel) < 0) num_in_kernel = 0;
    return num_queued_bytes() + static_cast<std::size_t>(num_in_kernel);
  }

 private:
  void Read() {
    stream_.async_read_some(boost::asio::buffer(bytes_), [self = this->shared_from_this()](boost::system::error_code error, std::size_t num_bytes) {
      if (self->state() == State::kClosed) return;
      self->Take({self->bytes_.data(), num_bytes});
      if (!error) return self->Read();
      if (error == boost::asio::error::eof) return self->OnEnd();
      self->Close(error.message());
    });
  }

  void Write(std::string_view message) override {
    queue_ += message;
    if (sending_.empty()) SendOn();
  }

  // A handler may come after the connection was closed, so it owns the connection, and with it the bytes that the kernel reads from.
  void SendOn() {
    if (is_late()) return;  // the connection is to be closed, and its unsent messages are old
    if (num_gone_ == sending_.size()) {
      sending_.clear();
      num_gone_ = 0;
      std::swap(sending_, queue_);
      if (sending_.empty()) return;
    }
    stream_.async_write_some(boost::asio::buffer(sending_) + num_gone_,
                             [self = this->shared_from_this()](boost::system::error_code error, std::size_t num_bytes) {
                               if (self->state() == State::kClosed) return;
                               self->num_gone_ += num_bytes;
                               if (error) return self->Close(error.message());
                               self->SendOn();
                             });
  }

  std::size_t num_queued_bytes() const override { return sending_.size() - num_gone_ + queue_.size(); }

  void CloseNow() override {
    PrepareClose();
    boost::system::error_code ignored;
    stream_.close(ignored);
  }

  Stream stream_;
  LineCutter cutter_;
  std::array<char, 4096> bytes_{};
  std::string sending_;       // the kernel is being given
  std::size_t num_gone_ = 0;  // of sending_
  std::string queue_;         // waits behind sending_
};

}  // namespace lookout::plotter
