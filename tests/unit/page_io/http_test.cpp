// What the server answers by HTTP, and whom it does not.
#include <sys/resource.h>
#include <zlib.h>

#include <atomic>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "tests/unit/page_io/peer.hpp"

namespace {

using namespace lookout;
using namespace lookout::page;
using namespace lookout::page::test;

std::vector<std::uint8_t> Gzip(const std::string& text) {
  z_stream stream{};
  EXPECT_EQ(deflateInit2(&stream, 9, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::vector<std::uint8_t> bytes(deflateBound(&stream, text.size()));
  std::string source = text;
  stream.next_in = reinterpret_cast<Bytef*>(source.data());
  stream.avail_in = static_cast<uInt>(source.size());
  stream.next_out = bytes.data();
  stream.avail_out = static_cast<uInt>(bytes.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  bytes.resize(stream.total_out);
  deflateEnd(&stream);
  return bytes;
}

const std::string kPageText = "<!doctype html>" + std::string(100'000, 'x');

class PageHttp : public ::testing::Test {
 protected:
  PageHttp() { Restart({}); }

  void Restart(ServerOptions options, bool has_map = true) {
    options.token = "secret";
    ServerParts parts;
    parts.assets = {{"/", "text/html; charset=utf-8", page_}};
    if (has_map) parts.tiles_text = [] { return std::string(R"({"name":"chart"})"); };
    parts.tile = [](int z, int x, int y) -> std::optional<Tile> {
      if (z != 3) return std::nullopt;
      if (x == 7) throw std::runtime_error("the disk is broken");
      return Tile{"image/png", {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y)}};
    };
    parts.acknowledge = [this](const Acknowledgement& acknowledgement) { acknowledged_ = acknowledgement.alert_id; };
    parts.order = [this](const Order&) { ++num_orders_; };
    server_.reset();
    server_ = std::make_unique<Server>(std::move(options), std::move(parts));
  }

  Peer Connect() const { return Peer(server_->port()); }
  std::string Get(const std::string& path, const std::string& more = {}) const { return Connect().Get(path, more); }
  std::string Post(const std::string& more, const std::string& body, const std::string& path = "/acknowledge") const {
    auto peer = Connect();
    return peer.Ask("POST " + path + " HTTP/1.1\r\nHost: " + peer.host() + more, body);
  }
  std::string OriginLine() const { return "\r\nOrigin: http://127.0.0.1:" + std::to_string(server_->port()); }

  static bool IsStatus(const std::string& answer, int status) { return answer.starts_with("HTTP/1.1 " + std::to_string(status) + " "); }
  static std::string Value(const std::string& answer, const std::string& name) {
    const auto begin = answer.find("\r\n" + name + ": ");
    if (begin == std::string::npos) return {};
    const auto from = begin + name.size() + 4;
    return answer.substr(from, answer.find("\r\n", from) - from);
  }
  static std::string Body(const std::string& answer) { return answer.substr(answer.find("\r\n\r\n") + 4); }

  const std::vector<std::uint8_t> page_ = Gzip(kPageText);
  std::atomic<std::int64_t> acknowledged_ = 0;
  std::atomic<int> num_orders_ = 0;
  std::unique_ptr<Server> server_;
};

TEST_F(PageHttp, AnAssetIsSentAsItIsStoredWhereTheBrowserTakesIt) {
  const auto answer = Get("/?x=1", "\r\nAccept-Encoding: gzip, deflate, br");
  EXPECT_TRUE(IsStatus(answer, 200)) << answer.substr(0, 400);
  EXPECT_EQ(Value(answer, "Content-Encoding"), "gzip");
  EXPECT_EQ(Value(answer, "Content-Type"), "text/html; charset=utf-8");
  EXPECT_EQ(Value(answer, "Cache-Control"), "no-cache");
  EXPECT_EQ(Body(answer), std::string(page_.begin(), page_.end()));
}

TEST_F(PageHttp, AnAssetIsInflatedForWhoeverDoesNot) {
  const auto answer = Get("/");
  EXPECT_TRUE(IsStatus(answer, 200));
  EXPECT_EQ(Value(answer, "Content-Encoding"), "");
  EXPECT_EQ(Body(answer), kPageText);
}

TEST_F(PageHttp, WhatABrowserHoldsIsNotSentAgain) {
  const auto tag = Value(Get("/", "\r\nAccept-Encoding: gzip"), "ETag");
  ASSERT_NE(tag, "");
  const auto answer = Get("/", "\r\nAccept-Encoding: gzip\r\nIf-None-Match: \"other\", " + tag);
  EXPECT_TRUE(IsStatus(answer, 304)) << answer;
  EXPECT_EQ(Body(answer), "");
  EXPECT_TRUE(IsStatus(Get("/", "\r\nIf-None-Match: " + tag), 200)) << "another representation";
}

TEST_F(PageHttp, HeadHasTheHeadOfGet) {
  auto peer = Connect();
  const auto head = peer.Ask("HEAD / HTTP/1.1\r\nHost: " + peer.host() + "\r\nAccept-Encoding: gzip");
  EXPECT_TRUE(IsStatus(head, 200));
  EXPECT_EQ(Value(head, "Content-Length"), std::to_string(page_.size()));
  EXPECT_EQ(Body(head), "");
  EXPECT_EQ(Body(peer.Get("/tiles.json")), R"({"name":"chart"})") << "the connection goes on with the next request";
}

TEST_F(PageHttp, EveryAnswerTellsTheBrowserWhatThePageMayDo) {
  for (const auto& answer : {Get("/"), Get("/none"), Get("/tiles/3/1/2"), Post("", "x"), Connect().Ask("GET / HTTP/1.1\r\nHost: evil.example")}) {
    EXPECT_NE(Value(answer, "Content-Security-Policy").find("default-src 'none'"), std::string::npos) << answer.substr(0, 200);
    EXPECT_EQ(Value(answer, "X-Content-Type-Options"), "nosniff");
    EXPECT_EQ(Value(answer, "Cross-Origin-Resource-Policy"), "same-origin");
    EXPECT_EQ(Value(answer, "Cross-Origin-Opener-Policy"), "same-origin");
    EXPECT_EQ(Value(answer, "Referrer-Policy"), "no-referrer");
    EXPECT_EQ(answer.find("evil"), std::string::npos);
    EXPECT_EQ(Value(answer, "Access-Control-Allow-Origin"), "");
  }
}

// A foreign page can let a name of its own point at this computer.
TEST_F(PageHttp, AHostThatIsNoneOfOursIs421) {
  const auto port = std::to_string(server_->port());
  for (const std::string& host : {"Host: evil.example:" + port, std::string("Host: 127.0.0.1"), "Host: 127.0.0.1:1" + port, std::string("X: y"),
                                  "Host: localhost:" + port + "\r\nHost: localhost:" + port})
    EXPECT_TRUE(IsStatus(Connect().Ask("GET / HTTP/1.1\r\n" + host), 421)) << host;
  EXPECT_TRUE(IsStatus(Connect().Ask("GET / HTTP/1.1\r\nHost: LOCALHOST:" + port), 200));
  EXPECT_EQ(CountOf(*server_, "refused_host"), 5);
}

TEST_F(PageHttp, ANameOfTheConfigIsAHost) {
  ServerOptions options;
  options.host_names = {"boat.local"};
  Restart(options);
  EXPECT_TRUE(IsStatus(Connect().Ask("GET / HTTP/1.1\r\nHost: boat.local:" + std::to_string(server_->port())), 200));
}

TEST_F(PageHttp, WhereItListensEverywhereTheAddressThatWasReachedIsAHost) {
  ServerOptions options;
  options.bind_address = "0.0.0.0";
  Restart(options);
  EXPECT_TRUE(IsStatus(Get("/"), 200));
  EXPECT_TRUE(IsStatus(Connect().Ask("GET / HTTP/1.1\r\nHost: 10.1.2.3:" + std::to_string(server_->port())), 421));
}

TEST_F(PageHttp, APageOfAnotherServerIs403) {
  EXPECT_TRUE(IsStatus(Get("/", "\r\nOrigin: http://evil.example"), 403));
  EXPECT_TRUE(IsStatus(Get("/", "\r\nOrigin: null"), 403));
  EXPECT_TRUE(IsStatus(Get("/", OriginLine()), 200));
  const std::string body = R"({"alert_id":7,"raised_utime_us":5})";
  EXPECT_TRUE(IsStatus(Post("\r\nAuthorization: Bearer secret", body), 403)) << "a write needs an origin";
  EXPECT_TRUE(IsStatus(Post("\r\nOrigin: http://evil.example\r\nAuthorization: Bearer secret", body), 403));
  EXPECT_EQ(CountOf(*server_, "refused_origin"), 4);
  EXPECT_EQ(acknowledged_, 0);
}

TEST_F(PageHttp, WhoHasTheTokenAcknowledges) {
  const std::string body = R"({"alert_id":7,"raised_utime_us":5})";
  EXPECT_TRUE(IsStatus(Post(OriginLine(), body), 401));
  EXPECT_TRUE(IsStatus(Post(OriginLine() + "\r\nAuthorization: Bearer wrong!", body), 401));
  EXPECT_EQ(acknowledged_, 0);
  EXPECT_TRUE(IsStatus(Post(OriginLine() + "\r\nAuthorization: Bearer secret", "{}"), 400));
  EXPECT_EQ(acknowledged_, 0);
  EXPECT_TRUE(IsStatus(Post(OriginLine() + "\r\nAuthorization: Bearer secret", body), 202));
  EXPECT_EQ(acknowledged_, 7);
  EXPECT_EQ(CountOf(*server_, "refused_token"), 2);
}

TEST_F(PageHttp, WhoHasTheTokenOrders) {
  const std::string body = R"({"kind":"silence"})";
  EXPECT_TRUE(IsStatus(Post(OriginLine(), body, "/order"), 401));
  EXPECT_TRUE(IsStatus(Post("\r\nAuthorization: Bearer secret", body, "/order"), 403));
  EXPECT_TRUE(IsStatus(Post(OriginLine() + "\r\nAuthorization: Bearer secret", "{}", "/order"), 400));
  EXPECT_TRUE(IsStatus(Get("/order"), 405));
  EXPECT_EQ(num_orders_, 0);
  EXPECT_TRUE(IsStatus(Post(OriginLine() + "\r\nAuthorization: Bearer secret", body, "/order"), 202));
  EXPECT_EQ(num_orders_, 1);
  EXPECT_EQ(acknowledged_, 0);
}

TEST_F(PageHttp, ALogTakesNoAcknowledgement) {
  ServerOptions options;
  options.is_log = true;
  Restart(options);
  EXPECT_TRUE(IsStatus(Post(OriginLine() + "\r\nAuthorization: Bearer secret", R"({"alert_id":7,"raised_utime_us":5})"), 409));
  EXPECT_EQ(acknowledged_, 0);
}

TEST_F(PageHttp, TilesComeFromTheDisk) {
  const auto tile = Get("/tiles/3/1/2");
  EXPECT_TRUE(IsStatus(tile, 200));
  EXPECT_EQ(Value(tile, "Content-Type"), "image/png");
  EXPECT_EQ(Body(tile), "\x01\x02");
  // A chart that lacks a tile is no fault: each 404 would stand as one in the browser's console.
  const auto lacking = Get("/tiles/4/1/2");
  EXPECT_TRUE(IsStatus(lacking, 204));
  EXPECT_EQ(Body(lacking), "");
  EXPECT_EQ(Value(lacking, "Content-Length"), "");
  EXPECT_TRUE(IsStatus(Get("/tiles/3/1/8"), 404));
  EXPECT_TRUE(IsStatus(Get("/tiles/3/7/2"), 500));
  EXPECT_TRUE(IsStatus(Get("/"), 200)) << "goes on";
}

TEST_F(PageHttp, APageWithoutAMapIsNoFault) {
  // A boat without chart tiles had a red line in the console of each browser that showed the map.
  Restart({}, false);
  auto peer = Connect();
  const auto answer = peer.Get("/tiles.json");
  EXPECT_TRUE(IsStatus(answer, 204)) << answer;
  EXPECT_EQ(Value(answer, "Content-Length"), "") << "RFC 9110, 8.6: none in a 204";
  EXPECT_TRUE(IsStatus(peer.Get("/"), 200)) << "the connection goes on with the next request";
}

TEST_F(PageHttp, OtherPathsAndMethodsAreRefused) {
  EXPECT_TRUE(IsStatus(Get("/none"), 404));
  EXPECT_TRUE(IsStatus(Get("/../etc/passwd"), 404));
  EXPECT_TRUE(IsStatus(Get("/acknowledge"), 405));
  auto peer = Connect();
  EXPECT_TRUE(IsStatus(peer.Ask("DELETE / HTTP/1.1\r\nHost: " + peer.host()), 405));
  EXPECT_TRUE(IsStatus(peer.Ask("POST / HTTP/1.1\r\nHost: " + peer.host() + OriginLine(), "x"), 405));
  EXPECT_TRUE(IsStatus(Get("/socket", OriginLine()), 426));
}

TEST_F(PageHttp, WhatIsTooLargeIsRefused) {
  EXPECT_TRUE(IsStatus(Get("/", "\r\nX: " + std::string(9000, 'x')), 431));
  EXPECT_TRUE(IsStatus(Post(OriginLine(), std::string(5000, 'x')), 413));
  EXPECT_TRUE(IsStatus(Post(OriginLine() + "\r\nContent-Length: 100000000", ""), 413)) << "before it comes";
}

TEST_F(PageHttp, WhatIsNoRequestIsRefused) {
  for (const std::string text : {"\x16\x03\x01\x02", "GET\r\n\r\n", "GET / HTTP/9.9\r\n\r\n", "GET / HTTP/1.1\r\nHost\r\n\r\n",
                                 "POST /acknowledge HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n"}) {
    auto peer = Connect();
    peer.Write(text + "\r\n\r\n");
    EXPECT_TRUE(IsStatus(peer.ReadAnswer(), 400)) << text;
    EXPECT_TRUE(peer.Ends());
  }
}

TEST_F(PageHttp, AHalfRequestIsClosedAfterAWhileAndHoldsNobodyUp) {
  auto silent = Connect();
  auto half = Connect();
  half.Write("GET / HTTP/1.1\r\nHo");
  // A byte now and then does not keep the connection.
  auto slow = Connect();
  slow.Write("GET / HTTP/1.1\r\nX: ");
  const auto begin = std::chrono::steady_clock::now();
  while (std::chrono::steady_clock::now() - begin < 4s) {
    slow.Write("x");
    EXPECT_TRUE(IsStatus(Get("/"), 200));
    std::this_thread::sleep_for(200ms);
  }
  EXPECT_TRUE(silent.Ends(4s));
  EXPECT_TRUE(half.Ends(4s));
  EXPECT_TRUE(slow.Ends(4s));
}

TEST_F(PageHttp, AThousandConnectionsLeaveRoomOnceTheyAreGone) {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  if (limit.rlim_max < 2000) GTEST_SKIP() << "skipped: the system lets a process open " << limit.rlim_max << " files";
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
  {
    std::vector<Peer> peers;
    for (int i = 0; i < 1000; ++i) peers.push_back(Connect());
    EXPECT_TRUE(Until([&] { return CountOf(*server_, "connections_let_go") == 1000 - 64; }));
    EXPECT_TRUE(Until([&] { return CountOf(*server_, "connections") == 64; }));
    EXPECT_TRUE(peers.front().Ends());
    EXPECT_TRUE(IsStatus(peers.back().Get("/"), 200)) << "those that are in are served";
  }
  EXPECT_TRUE(Until([&] { return CountOf(*server_, "connections") == 0; }));
  EXPECT_TRUE(IsStatus(Get("/"), 200));
}

// 64 connections that asked for nothing kept every new browser out, and nothing said so.
TEST_F(PageHttp, ConnectionsThatDoNotAskKeepNobodyOut) {
  std::vector<Peer> silent;
  for (int i = 0; i < 64; ++i) {
    silent.push_back(Connect());
    if (i % 3 == 0) silent.back().Write("GET / HTTP/1.1\r\nHo");  // half a request
    if (i % 3 == 1) {
      EXPECT_TRUE(IsStatus(silent.back().Get("/"), 200)) << "and no second request";
    }
  }
  EXPECT_TRUE(Until([&] { return CountOf(*server_, "connections") == 64; }));
  EXPECT_TRUE(server_->Faults().empty());
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(IsStatus(Get("/"), 200)) << i;
  EXPECT_EQ(CountOf(*server_, "connections_refused"), 0);
  EXPECT_GE(CountOf(*server_, "connections_let_go"), 1);
  ASSERT_EQ(server_->Faults().size(), 1U);
  EXPECT_TRUE(server_->Faults()[0].starts_with("64 connections at one time, 64 of them from 127.0.0.1: ")) << server_->Faults()[0];
  EXPECT_TRUE(silent[0].Ends(1s)) << "the oldest that has asked for nothing";
  EXPECT_TRUE(IsStatus(silent[1].Get("/"), 200)) << "one that has asked is worth more";
}

// A port that was taken ended the process, and lookout-up did not start the look-out for it.
TEST_F(PageHttp, WaitsForItsPortAndSaysWhoHasIt) {
  const int port = server_->port();
  ServerOptions options;
  options.port = port;
  EXPECT_THROW(Server(options, {}), std::runtime_error) << "where it is not told to wait";
  auto holder = std::move(server_);
  options.waits_for_port = true;
  Server waiting(options, {});
  EXPECT_EQ(waiting.port(), 0);
  ASSERT_EQ(waiting.Faults().size(), 1U);
  EXPECT_TRUE(waiting.Faults()[0].starts_with("the page cannot be served on 127.0.0.1 port " + std::to_string(port) + ": the port is taken by "))
      << waiting.Faults()[0];
  EXPECT_NE(waiting.Faults()[0].find("(pid " + std::to_string(getpid()) + ")"), std::string::npos) << waiting.Faults()[0];
  holder.reset();
  EXPECT_TRUE(Until([&] { return waiting.port() == port; }));
  EXPECT_TRUE(waiting.Faults().empty());
  EXPECT_TRUE(IsStatus(Peer(port).Get("/none"), 404));
}

// What looks at the page stays.
TEST_F(PageHttp, AWebSocketIsNotClosedForOthers) {
  Browser browser(server_->port());
  ASSERT_TRUE(browser.hello().Holds("hello"));
  std::vector<Peer> silent;
  for (int i = 0; i < 200; ++i) silent.push_back(Connect());
  EXPECT_TRUE(Until([&] { return CountOf(*server_, "connections_let_go") == 200 - 63; }));
  EXPECT_EQ(CountOf(*server_, "clients"), 1);
  EXPECT_FALSE(browser.Ends(200ms));
}

// The listener must not stop, nor turn round as fast as it can.
TEST_F(PageHttp, WhereNoDescriptorIsLeftOthersAreAcceptedLater) {
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  const int next = dup(0);
  close(next);
  const rlimit narrow{static_cast<rlim_t>(next) + 1, limit.rlim_max};
  setrlimit(RLIMIT_NOFILE, &narrow);
  auto peer = Connect();  // has the last one
  EXPECT_TRUE(Until([&] { return CountOf(*server_, "accept_faults") >= 2; }));
  EXPECT_LT(CountOf(*server_, "accept_faults"), 10);
  setrlimit(RLIMIT_NOFILE, &limit);
  EXPECT_TRUE(IsStatus(peer.Get("/"), 200));
}

TEST_F(PageHttp, AnAddressInUseIsSaid) {
  ServerOptions options;
  options.port = server_->port();
  try {
    const Server second(options, {});
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("127.0.0.1 port " + std::to_string(options.port)), std::string::npos) << error.what();
  }
}

}  // namespace
