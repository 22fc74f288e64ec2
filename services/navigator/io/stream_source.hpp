// A source that may go and come back: a serial port that is unplugged, a server that is started again.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "common/io/source.hpp"

namespace lookout::navigator {

class StreamSource : public io::Source {
 public:
  /// A connection that is not there after this is given up.
  static constexpr std::chrono::seconds kConnectTimeout{5};
  /// Between two attempts: the first pause, doubled after each failure up to the last.
  static constexpr std::chrono::milliseconds kFirstPause{500};
  static constexpr std::chrono::milliseconds kLastPause{8000};

  /// @param name   of the input
  /// @param place  for people: "serial port /dev/ttyUSB0"
  StreamSource(const std::string& name, std::string place);
  ~StreamSource() override;

  int file_descriptor() const override { return epoll_; }
  std::string Poll(Utime now) override;
  std::optional<Piece> Receive(Utime now) override;
  std::string fault() const override { return fault_; }
  std::vector<Counter> counters() override;

 protected:
  static constexpr int kNone = -1;
  enum class Result { kSome, kNothing, kEnd };

  /// @return a descriptor that does not block, open or connecting; kNone with `fault`
  virtual int Open(std::string& fault) = 0;
  /// Whether Open() returns a connection that is still being made.
  virtual bool IsConnecting() const { return false; }
  /// The connection is made. @return the descriptor to read from, `descriptor` or another one for it; kNone with `fault`
  virtual int OnConnected(int descriptor, std::string& fault);
  /// Appends to `bytes`. @return kEnd with errno where there is one, else 0
  virtual Result Read(int descriptor, std::vector<std::uint8_t>& bytes);
  virtual void Close(int descriptor);

  /// For destructors: a base cannot call what its heirs override.
  void CloseNow();

 private:
  enum class State { kClosed, kConnecting, kOpen };

  void Attempt(Utime now);
  void Connect(Utime now);
  void Fail(const std::string& fault, Utime now);
  void Watch(int descriptor, bool for_writing) const;

  std::string place_;
  std::string opened_name_;
  std::string lost_name_;
  std::string bytes_name_;
  int epoll_ = kNone;
  int descriptor_ = kNone;
  State state_ = State::kClosed;
  std::optional<Utime> last_attempt_;
  std::chrono::milliseconds pause_{0};
  std::string fault_;
  std::string reported_fault_;  // by Poll()
  std::vector<std::uint8_t> buffer_;
  std::int64_t num_opened_ = 0;
  std::int64_t num_lost_ = 0;
  std::int64_t num_bytes_ = 0;
};

}  // namespace lookout::navigator
