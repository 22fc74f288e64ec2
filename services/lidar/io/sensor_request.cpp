#include "services/lidar/io/sensor_request.hpp"

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http.hpp>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <utility>

namespace lookout::lidar {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using boost::system::error_code;

std::string Where(const SensorAddress& sensor) { return sensor.host + ", port " + std::to_string(sensor.port) + ": "; }

// One connection whose steps end together at the time limit.
class Exchange {
 public:
  Exchange(SensorAddress sensor, std::chrono::milliseconds time_limit, std::stop_token stop)
      : sensor_(std::move(sensor)), stop_(std::move(stop)), stream_(context_) {
    error_code error;
    const auto address = asio::ip::make_address(sensor_.host, error);
    if (error) throw std::runtime_error(Where(sensor_) + "no numeric address");
    // Counts from here on for every step: it is not set again.
    stream_.expires_after(time_limit);
    Do([&](const auto& handler) {
      stream_.async_connect(asio::ip::tcp::endpoint(address, static_cast<std::uint16_t>(sensor_.port)),
                            [handler](error_code result) { handler(result); });
    });
  }

  beast::tcp_stream& stream() { return stream_; }

  /// Runs one asynchronous step to its end.
  ///
  /// @return the number of bytes; nullopt at the end of the connection. @throws std::runtime_error where it fails
  template <typename Start>
  std::optional<std::size_t> Do(const Start& start) {
    error_code result;
    std::size_t num_bytes = 0;
    start([&](error_code error, std::size_t num = 0) {
      result = error;
      num_bytes = num;
    });
    context_.restart();
    {
      // Behind restart, which would take a stop back.
      const std::stop_callback on_stop(stop_, [this] { context_.stop(); });
      context_.run();
    }
    if (stop_.stop_requested()) Refuse("the request was given up");
    if (result == asio::error::eof) return std::nullopt;
    if (result == beast::error::timeout) throw std::runtime_error(Where(sensor_) + "no whole answer in time");
    if (result) throw std::runtime_error(Where(sensor_) + result.message());
    return num_bytes;
  }

  /// Do, where the connection must not end yet.
  template <typename Start>
  void DoWhole(const Start& start) {
    if (!Do(start)) Refuse("the answer is cut off");
  }

  [[noreturn]] void Refuse(const std::string& reason) const { throw std::runtime_error(Where(sensor_) + reason); }

 private:
  SensorAddress sensor_;
  std::stop_token stop_;
  asio::io_context context_;
  beast::tcp_stream stream_;
};

}  // namespace

std::string RequestOusterMetadata(const SensorAddress& sensor, std::chrono::milliseconds time_limit, const std::stop_token& stop) {
  constexpr int kHttp11 = 11;
  Exchange exchange(sensor, time_limit, stop);
  http::request<http::empty_body> request(http::verb::get, "/api/v1/sensor/metadata", kHttp11);
  request.set(http::field::host, sensor.host);
  request.set(http::field::accept, "application/json");
  request.set(http::field::connection, "close");
  exchange.DoWhole([&](const auto& handler) { http::async_write(exchange.stream(), request, handler); });
  // All bytes are counted here, whatever the answer says of its length.
  constexpr std::size_t kMaxHeadBytes = 8192;
  constexpr std::size_t kPieceBytes = 4096;
  beast::flat_buffer buffer;
  http::response_parser<http::string_body> answer;
  answer.eager(true);
  for (std::size_t num_bytes = 0; !answer.is_done();) {
    const auto num = exchange.Do([&](const auto& handler) { exchange.stream().async_read_some(buffer.prepare(kPieceBytes), handler); });
    error_code error;
    if (!num) {
      if (!answer.got_some()) exchange.Refuse("the connection was closed without an answer");  // put_eof would abort
      answer.put_eof(error);
      if (error || !answer.is_done()) exchange.Refuse("the answer is cut off");
      break;
    }
    num_bytes += *num;
    if (num_bytes > kMaxBeamBytes + kMaxHeadBytes) exchange.Refuse("an answer of more than 64 KiB");
    buffer.commit(*num);
    buffer.consume(answer.put(buffer.data(), error));
    if (error && error != http::error::need_more) exchange.Refuse("no answer of HTTP: " + error.message());
  }
  if (answer.get().body().size() > kMaxBeamBytes) exchange.Refuse("an answer of more than 64 KiB");
  if (answer.get().result() != http::status::ok) {
    exchange.Refuse("HTTP status " + std::to_string(answer.get().result_int()) + " for /api/v1/sensor/metadata");
  }
  return answer.get().body();
}

// The maker's PTC protocol: 'G', 't', command, return code, length of the body, highest byte first.
std::string RequestHesaiAngles(const SensorAddress& sensor, std::chrono::milliseconds time_limit, const std::stop_token& stop) {
  constexpr std::uint8_t kGetCalibration = 5;
  constexpr std::array<std::uint8_t, 8> kRequest{0x47, 0x74, kGetCalibration, 0, 0, 0, 0, 0};
  Exchange exchange(sensor, time_limit, stop);
  exchange.DoWhole([&](const auto& handler) { asio::async_write(exchange.stream(), asio::buffer(kRequest), handler); });
  std::array<std::uint8_t, 8> head{};
  exchange.DoWhole([&](const auto& handler) { asio::async_read(exchange.stream(), asio::buffer(head), handler); });
  if (head[0] != kRequest[0] || head[1] != kRequest[1] || head[2] != kGetCalibration) exchange.Refuse("the answer is not of a Hesai's control port");
  if (head[3] != 0) exchange.Refuse("the sensor refuses to tell its angles: return code " + std::to_string(head[3]));
  const std::size_t size = std::size_t{head[4]} << 24 | std::size_t{head[5]} << 16 | std::size_t{head[6]} << 8 | head[7];
  if (size == 0 || size > kMaxBeamBytes) exchange.Refuse("a table of angles of " + std::to_string(size) + " bytes");
  std::string text(size, '\0');
  exchange.DoWhole([&](const auto& handler) { asio::async_read(exchange.stream(), asio::buffer(text), handler); });
  return text;
}

}  // namespace lookout::lidar
