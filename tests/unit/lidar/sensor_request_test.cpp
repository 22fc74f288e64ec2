// A sensor is asked for its beams: fake sensors on loopback that answer well, badly, slowly, in part, or not at all.
#include "services/lidar/io/sensor_request.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <gtest/gtest.h>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <thread>

#include "services/lidar/io/beam_fetcher.hpp"

namespace lookout::lidar {
namespace {

using std::chrono::milliseconds;

// Accepts one connection, reads what is asked, and answers by `answer(socket)`.
class FakeSensor {
 public:
  explicit FakeSensor(std::function<void(int)> answer) : listener_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    EXPECT_EQ(bind(listener_, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(listen(listener_, 1), 0);
    getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this, answer = std::move(answer)] {
      const int connection = accept(listener_, nullptr, nullptr);
      if (connection < 0) return;
      char bytes[4096];
      const auto num = recv(connection, bytes, sizeof(bytes), 0);
      if (num > 0) asked_.assign(bytes, static_cast<std::size_t>(num));
      answer(connection);
      close(connection);
    });
  }
  ~FakeSensor() {
    shutdown(listener_, SHUT_RDWR);
    thread_.join();
    close(listener_);
  }
  SensorAddress address() const { return {"127.0.0.1", port_}; }
  const std::string& asked() const { return asked_; }

 private:
  int listener_;
  int port_ = 0;
  std::string asked_;
  std::thread thread_;
};

std::function<void(int)> Says(const std::string& bytes) {
  return [bytes](int connection) { send(connection, bytes.data(), bytes.size(), MSG_NOSIGNAL); };
}

std::string Http(const std::string& body, const std::string& status = "200 OK") {
  return "HTTP/1.1 " + status + "\r\nContent-Type: application/json\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
}

std::string Ptc(const std::string& body, int command = 5, int code = 0) {
  std::string bytes{'G', 't', static_cast<char>(command), static_cast<char>(code)};
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(body.size() >> shift & 0xFF);
  return bytes + body;
}

using Request = std::string (*)(const SensorAddress&, milliseconds, const std::stop_token&);
constexpr milliseconds kLimit(2000);

std::string FaultOf(Request request, std::function<void(int)> answer, milliseconds limit = kLimit) {
  const FakeSensor sensor(std::move(answer));
  try {
    request(sensor.address(), limit, {});
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(SensorRequest, GetsTheMetadataOfAnOuster) {
  const FakeSensor sensor(Says(Http("{\"a\": 1}")));
  EXPECT_EQ(RequestOusterMetadata(sensor.address(), kLimit), "{\"a\": 1}");
  EXPECT_EQ(sensor.asked().rfind("GET /api/v1/sensor/metadata HTTP/1.1\r\n", 0), 0U) << sensor.asked();
}

TEST(SensorRequest, GetsAnAnswerInChunksAndOneThatEndsWithTheConnection) {
  const FakeSensor chunks(Says("HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n3\r\n{\"a\r\n5\r\n\": 1}\r\n0\r\n\r\n"));
  EXPECT_EQ(RequestOusterMetadata(chunks.address(), kLimit), "{\"a\": 1}");
  const FakeSensor closing(Says("HTTP/1.0 200 OK\r\n\r\n{}"));
  EXPECT_EQ(RequestOusterMetadata(closing.address(), kLimit), "{}");
}

TEST(SensorRequest, RefusesBadAnswersOfAnOuster) {
  EXPECT_NE(FaultOf(&RequestOusterMetadata, Says(Http("no", "404 Not Found"))).find("HTTP status 404 for /api/v1/sensor/metadata"),
            std::string::npos);
  const auto of_long = FaultOf(&RequestOusterMetadata, Says(Http(std::string(70'000, ' '))));
  EXPECT_NE(of_long.find("an answer of more than 64 KiB"), std::string::npos) << of_long;
  EXPECT_NE(FaultOf(&RequestOusterMetadata, Says("SSH-2.0-OpenSSH_9.2\r\n\r\n\r\n")), "");
  EXPECT_NE(FaultOf(&RequestOusterMetadata, Says(Http("{\"a\": 1}").substr(0, 75))), "") << "cut off";
  EXPECT_NE(FaultOf(&RequestOusterMetadata, Says("")), "");
}

TEST(SensorRequest, GetsTheAnglesOfAHesai) {
  const FakeSensor sensor(Says(Ptc("Channel,Elevation,Azimuth\n1,15,0\n")));
  EXPECT_EQ(RequestHesaiAngles(sensor.address(), kLimit), "Channel,Elevation,Azimuth\n1,15,0\n");
  EXPECT_EQ(sensor.asked(), std::string("\x47\x74\x05\0\0\0\0\0", 8));
}

TEST(SensorRequest, RefusesBadAnswersOfAHesai) {
  EXPECT_NE(FaultOf(&RequestHesaiAngles, Says(Ptc("x", 5, 1))).find("return code 1"), std::string::npos);
  EXPECT_NE(FaultOf(&RequestHesaiAngles, Says(Ptc("x", 7))).find("not of a Hesai's control port"), std::string::npos);
  EXPECT_NE(FaultOf(&RequestHesaiAngles, Says("HTTP/1.1 400 Bad Request\r\n\r\n")).find("not of a Hesai's control port"), std::string::npos);
  EXPECT_NE(FaultOf(&RequestHesaiAngles, Says(Ptc(""))).find("0 bytes"), std::string::npos);
  EXPECT_NE(FaultOf(&RequestHesaiAngles, Says(std::string("Gt\x05\0\xFF\xFF\xFF\xFF", 8))).find("4294967295 bytes"), std::string::npos);
  EXPECT_NE(FaultOf(&RequestHesaiAngles, Says(Ptc("1,2,3\n").substr(0, 10))), "") << "cut off";
}

// Slow, byte by byte: the limit is of the whole exchange.
TEST(SensorRequest, EndsAtTheTimeLimit) {
  const auto drip = [](int connection) {
    for (int i = 0; i < 20; ++i) {
      if (send(connection, "G", 1, MSG_NOSIGNAL) < 0) return;
      std::this_thread::sleep_for(milliseconds(50));
    }
  };
  for (const auto request : {Request{&RequestOusterMetadata}, Request{&RequestHesaiAngles}}) {
    const auto start = std::chrono::steady_clock::now();
    const auto fault = FaultOf(
        request, [](int) { std::this_thread::sleep_for(milliseconds(600)); }, milliseconds(200));
    EXPECT_NE(fault.find("no whole answer in time"), std::string::npos) << fault;
    EXPECT_LT(std::chrono::steady_clock::now() - start, milliseconds(3000));
  }
  EXPECT_NE(FaultOf(&RequestOusterMetadata, drip, milliseconds(300)).find("no whole answer in time"), std::string::npos);
}

TEST(SensorRequest, NamesWhoIsNotThere) {
  SensorAddress nobody{"127.0.0.1", 1};
  EXPECT_THROW(RequestHesaiAngles(nobody, kLimit), std::runtime_error);
  nobody.host = "sensor";
  EXPECT_THROW(RequestHesaiAngles(nobody, kLimit), std::runtime_error);
}

// Until it is there: two failures, then the text, once.
TEST(BeamFetcher, TriesAgainAndGivesTheTextOnce) {
  std::atomic<int> num_asked = 0;
  BeamFetcher fetcher(
      [&num_asked](const std::stop_token&) -> std::string {
        if (++num_asked <= 2) throw std::runtime_error("not there");
        return "beams";
      },
      milliseconds(5));
  std::optional<std::string> text;
  for (int i = 0; i < 400 && !text; ++i) {
    std::this_thread::sleep_for(milliseconds(5));
    text = fetcher.Take();
  }
  EXPECT_EQ(text, "beams");
  EXPECT_EQ(fetcher.num_failures(), 2);
  EXPECT_EQ(fetcher.fault(), "");
  std::this_thread::sleep_for(milliseconds(50));
  EXPECT_EQ(num_asked, 3) << "nobody asked again";
  EXPECT_FALSE(fetcher.Take());
  fetcher.AskAgain();
  for (int i = 0; i < 400 && num_asked < 4; ++i) std::this_thread::sleep_for(milliseconds(5));
  EXPECT_EQ(num_asked, 4);
}

// A sensor that takes the request and says nothing holds up the end of no process.
TEST(BeamFetcher, GivesUpTheRequestThatRuns) {
  for (const auto request : {Request{&RequestOusterMetadata}, Request{&RequestHesaiAngles}}) {
    std::atomic<bool> is_asked = false;
    std::atomic<bool> is_over = false;
    const FakeSensor sensor([&](int) {
      is_asked = true;
      while (!is_over) std::this_thread::sleep_for(milliseconds(5));
    });
    std::optional<BeamFetcher> fetcher;
    fetcher.emplace([&](const std::stop_token& stop) { return request(sensor.address(), std::chrono::seconds(30), stop); });
    while (!is_asked) std::this_thread::sleep_for(milliseconds(5));
    const auto start = std::chrono::steady_clock::now();
    fetcher.reset();
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
    is_over = true;
  }
}

}  // namespace
}  // namespace lookout::lidar
