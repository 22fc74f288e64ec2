// WebSocket links and servers that take, refuse, say nothing, read nothing, or send what nobody asked for.
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "tests/support/counters.hpp"
#include "tests/unit/plotter_io/links_test.hpp"

namespace lookout::plotter {
namespace {

namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using boost::asio::ip::tcp;

// A connection to the server, with its handshake. It only reads what is there, so it needs no thread.
struct Peer {
  boost::asio::io_context context;
  websocket::stream<tcp::socket> stream{context};
  http::request<http::string_body> request;

  int descriptor() { return stream.next_layer().native_handle(); }
  bool IsReadable() {
    pollfd waiting{descriptor(), POLLIN, 0};
    return poll(&waiting, 1, 0) > 0;
  }
  std::string ReadText() {
    beast::flat_buffer bytes;
    stream.read(bytes);
    EXPECT_TRUE(stream.got_text());
    return beast::buffers_to_string(bytes.data());
  }
  void Write(const std::string& text) {
    stream.text(true);
    stream.write(boost::asio::buffer(text));
  }
};

class WebSocketTest : public LinksTest {
 protected:
  WebSocketTest() { EXPECT_TRUE(listener_.Bind(0) && listener_.Listen()); }

  void Open(const std::string& token = "") {
    link_ = links_.WebSocket(
        {.name = "sk", .address = "127.0.0.1", .port = listener_.port(), .path = "/signalk/v1/stream?subscribe=none", .token = token});
  }
  // The next connection, whose request is there.
  Socket Asked() {
    EXPECT_TRUE(Until([&] { return listener_.IsReadable(); }));
    auto socket = listener_.Accept();
    EXPECT_TRUE(Until([&] { return socket.IsReadable(); }));
    return socket;
  }
  std::unique_ptr<Peer> Accepted() {
    const auto socket = Asked();
    auto peer = std::make_unique<Peer>();
    peer->stream.next_layer().assign(tcp::v4(), dup(socket.descriptor()));
    beast::flat_buffer bytes;
    http::read(peer->stream.next_layer(), bytes, peer->request);
    peer->stream.accept(peer->request);
    EXPECT_TRUE(Until([&] { return link_->is_open(); })) << link_->fault();
    return peer;
  }
  std::string FaultAfter(const std::string& answer) {
    auto socket = Asked();
    socket.Read();
    socket.Write(answer);
    EXPECT_TRUE(Until([&] { return !Holds(link_->fault(), "is not open yet"); }));
    return link_->fault();
  }
  std::int64_t Of(const std::string& ending) const { return support::CountOf(*link_, "sk_" + ending); }

  Socket listener_{SOCK_STREAM};
  std::unique_ptr<Link> link_;
};

TEST_F(WebSocketTest, AsksWithItsTokenAndSendsTexts) {
  Open("abc.def-1");
  const auto peer = Accepted();
  EXPECT_EQ(peer->request.target(), "/signalk/v1/stream?subscribe=none");
  EXPECT_EQ(peer->request[http::field::host], "127.0.0.1:" + std::to_string(listener_.port()));
  EXPECT_EQ(peer->request[http::field::authorization], "Bearer abc.def-1");
  EXPECT_EQ(link_->fault(), "");
  EXPECT_EQ(link_->num_openings(), 1);
  const std::string large(20'000, 'a');
  link_->Send("{}");
  link_->Send(large);
  EXPECT_TRUE(Until([&] { return peer->IsReadable(); }));
  EXPECT_EQ(peer->ReadText(), "{}");
  PollFor(100ms);
  EXPECT_EQ(peer->ReadText(), large);
  EXPECT_TRUE(Until([&] { return Of("sent") == 2; }));
}

TEST_F(WebSocketTest, SendsNoAuthorizationWithoutAToken) {
  Open();
  EXPECT_EQ(Accepted()->request.count(http::field::authorization), 0U);
}

TEST_F(WebSocketTest, ReceivesTextsAndRefusesTheRest) {
  Open();
  const auto peer = Accepted();
  peer->Write("{\"a\":1}");
  peer->stream.binary(true);
  peer->stream.write(boost::asio::buffer(std::string("\x00\x01\xFF", 3)));
  ASSERT_TRUE(Until([&] { return Of("received") == 1 && Of("refused") == 1; }));
  EXPECT_EQ(link_->Receive(), "{\"a\":1}");
  peer->Write(std::string(65'536, 'b'));
  ASSERT_TRUE(Until([&] { return Of("received") == 2; }));
  EXPECT_EQ(link_->Receive(), std::string(65'536, 'b'));
  // Too long, in one frame and in several: refused, and what follows is received.
  peer->stream.auto_fragment(false);
  peer->Write(std::string(200'000, 'c'));
  peer->stream.auto_fragment(true);
  peer->Write(std::string(65'537, 'd'));
  peer->Write("{}");
  ASSERT_TRUE(Until([&] { return Of("received") == 3; }));
  EXPECT_EQ(Of("refused"), 3);
  EXPECT_EQ(link_->Receive(), "{}");
  EXPECT_TRUE(link_->is_open());
  for (int i = 0; i < 100; ++i) peer->Write("{}");
  EXPECT_TRUE(Until([&] { return Of("received") + Of("refused") == 106; }));
  EXPECT_EQ(Of("received"), 67);
}

TEST_F(WebSocketTest, SaysWithWhichStatusItWasRefused) {
  Open();
  const auto unauthorized = FaultAfter("HTTP/1.1 401 Unauthorized\r\nContent-Length: 0\r\n\r\n");
  EXPECT_TRUE(Holds(unauthorized, "refuses with status 401 (it asks for a token)")) << unauthorized;
  EXPECT_TRUE(Holds(unauthorized, "WebSocket server 127.0.0.1 port " + std::to_string(listener_.port()) + "/signalk")) << unauthorized;
  Open("old");
  EXPECT_TRUE(Holds(FaultAfter("HTTP/1.1 401 Unauthorized\r\nContent-Length: 0\r\n\r\n"), "status 401 (is the token right?)")) << link_->fault();
  Open();
  EXPECT_TRUE(Holds(FaultAfter("HTTP/1.1 404 Not Found\r\nContent-Length: 2\r\n\r\nno"), "status 404 (is the path right?)")) << link_->fault();
  Open();
  EXPECT_TRUE(Holds(FaultAfter("$GPHDT,1.0,T*00\r\n\r\n"), "is no WebSocket")) << link_->fault();
  Open();
  EXPECT_TRUE(Holds(FaultAfter("HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: x\r\n\r\n"),
                    "is no WebSocket: "))
      << link_->fault();
  EXPECT_FALSE(link_->is_open());
}

TEST_F(WebSocketTest, GivesUpAServerThatDoesNotAnswerAndTriesAgain) {
  Open();
  const auto begin = std::chrono::steady_clock::now();
  const auto silent = Asked();
  ASSERT_TRUE(Until([&] { return Holds(link_->fault(), "does not answer"); }, 6s)) << link_->fault();
  EXPECT_GT(std::chrono::steady_clock::now() - begin, 4900ms);
  link_->Send("{\"old\":1}");
  EXPECT_EQ(Of("unsent"), 1);
  const auto peer = Accepted();
  link_->Send("{}");
  EXPECT_TRUE(Until([&] { return peer->IsReadable(); }));
  EXPECT_EQ(peer->ReadText(), "{}");
}

// What waited while the server slept must not arrive as if it were new.
TEST_F(WebSocketTest, DropsWhatAServerThatDoesNotReadIsTooLateFor) {
  listener_.Set(SO_RCVBUF, 2048);
  Open();
  const auto sleeper = Accepted();
  ASSERT_TRUE(Until(
      [&] {
        link_->Send(std::string(40, 'a'));  // so slowly that no buffer fills before
        return !link_->is_open();
      },
      8s));
  EXPECT_TRUE(Until([&] { return Holds(link_->fault(), "is too slow"); }, 100ms)) << link_->fault();
  EXPECT_GT(Of("dropped"), 50);
  const auto awake = Accepted();
  link_->Send("{}");
  EXPECT_TRUE(Until([&] { return awake->IsReadable(); }));
  EXPECT_EQ(awake->ReadText(), "{}");
}

TEST_F(WebSocketTest, ClosesAtOnceWhenItsBufferIsFull) {
  Open();
  const auto sleeper = Accepted();
  for (int i = 0; i < 300; ++i) link_->Send(std::string(10'000, 'a'));
  EXPECT_FALSE(link_->is_open());
  EXPECT_TRUE(Until([&] { return Holds(link_->fault(), "is too slow"); }, 100ms)) << link_->fault();
  EXPECT_EQ(Of("sent") + Of("dropped"), 300);
}

TEST_F(WebSocketTest, ComesBackAfterACloseAndAReset) {
  Open();
  auto peer = Accepted();
  auto socket = Socket::Of(dup(peer->descriptor()));
  peer->stream.next_layer().close();
  socket.Reset();
  ASSERT_TRUE(Until([&] { return !link_->is_open(); }));
  peer = Accepted();
  EXPECT_EQ(link_->num_openings(), 2);
  // The frame of a server that ends: 1001, going away.
  auto head = Socket::Of(dup(peer->descriptor()));
  peer.reset();
  head.Write(std::string("\x88\x02\x03\xE9", 4));
  head.Close();
  ASSERT_TRUE(Until([&] { return Holds(link_->fault(), "ended the connection"); })) << link_->fault();
}

TEST_F(WebSocketTest, DoesNotLeaveAServerThatAnswersPingsAndLeavesOneThatFallsSilent) {
  Open();
  const auto peer = Accepted();
  // Reading answers the ping that comes after 5 s.
  boost::system::error_code ignored;
  peer->stream.next_layer().non_blocking(true, ignored);
  beast::flat_buffer bytes;
  EXPECT_FALSE(Until(
      [&] {
        if (peer->IsReadable()) peer->stream.read(bytes, ignored);
        return !link_->is_open();
      },
      11s))
      << link_->fault();
  EXPECT_TRUE(Until([&] { return !link_->is_open(); }, 11s));
  EXPECT_TRUE(Holds(link_->fault(), "does not answer any more")) << link_->fault();
}

TEST_F(WebSocketTest, LeavesAServerThatSaysThatItEndsAndDoesNot) {
  Open();
  const auto peer = Accepted();
  const auto head = Socket::Of(dup(peer->descriptor()));
  head.Write(std::string("\x88\x02\x03\xE9", 4));
  EXPECT_TRUE(Until([&] { return !link_->is_open(); }, 7s));
}

TEST_F(WebSocketTest, MayGoWhileItIsAtWork) {
  Open();
  const auto peer = Accepted();
  for (int i = 0; i < 20; ++i) link_->Send(std::string(10'000, 'a'));
  link_.reset();
  PollFor(20ms);
  Open();
  EXPECT_TRUE(Until([&] { return listener_.IsReadable(); }));
  link_.reset();
  PollFor(20ms);
}

TEST_F(WebSocketTest, RefusesWhatCannotStandInARequest) {
  const auto open = [this](const std::string& address, const std::string& path, const std::string& token) {
    links_.WebSocket({.name = "sk", .address = address, .port = 1, .path = path, .token = token});
  };
  EXPECT_THROW(open("boat.local", "/", ""), std::runtime_error);
  EXPECT_THROW(open("127.0.0.1", "signalk", ""), std::runtime_error);
  EXPECT_THROW(open("127.0.0.1", "/a b", ""), std::runtime_error);
  EXPECT_THROW(open("127.0.0.1", "/", "a\r\nX: y"), std::runtime_error);
  EXPECT_NO_THROW(open("::1", "/", ""));
}

}  // namespace
}  // namespace lookout::plotter
