// TCP links and receivers as they are: some read nothing, some send garbage, some vanish.
#include <netinet/tcp.h>

#include <algorithm>
#include <vector>

#include "tests/support/counters.hpp"
#include "tests/unit/plotter_io/links_test.hpp"

namespace lookout::plotter {
namespace {

class TcpServerTest : public LinksTest {
 protected:
  void Open(int max_clients = 8) {
    port_ = FreePort();
    link_ = links_.TcpServer({.name = "ipad", .bind_address = "127.0.0.1", .port = port_, .max_clients = max_clients});
  }
  Socket Join(int receive_buffer_bytes = 0) {
    const auto num_openings = link_->num_openings();
    Socket client(SOCK_STREAM);
    if (receive_buffer_bytes > 0) client.Set(SO_RCVBUF, receive_buffer_bytes);
    EXPECT_TRUE(client.Connect(port_));
    EXPECT_TRUE(Until([&] { return link_->num_openings() > num_openings; }));
    return client;
  }
  std::int64_t Of(const std::string& ending) const { return support::CountOf(*link_, "ipad_" + ending); }

  int port_ = 0;
  std::unique_ptr<Link> link_;
};

TEST_F(TcpServerTest, SendsToAllAndCountsWhatNobodyTook) {
  Open();
  EXPECT_EQ(link_->fault(), "");
  EXPECT_FALSE(link_->is_open());
  link_->Send("$A\r\n");
  EXPECT_EQ(Of("unsent"), 1);
  auto first = Join();
  EXPECT_TRUE(link_->is_open());
  auto second = Join();
  EXPECT_EQ(link_->num_openings(), 2);
  link_->Send("$B\r\n");
  link_->Send("$C\r\n");
  ASSERT_TRUE(Until([&] { return Of("sent") == 4; }));
  EXPECT_EQ(first.Read(), "$B\r\n$C\r\n");
  EXPECT_EQ(second.Read(), "$B\r\n$C\r\n");
  EXPECT_EQ(Of("clients"), 2);
}

TEST_F(TcpServerTest, ReceivesLinesOfAllClientsWhole) {
  Open();
  const auto first = Join();
  const auto second = Join();
  first.Write("$RAACK,0");
  PollFor(50ms);
  second.Write("$B\r\n\r\n\n");
  ASSERT_TRUE(Until([&] { return Of("received") == 1; }));
  first.Write("01*00\r\n$C\r");
  ASSERT_TRUE(Until([&] { return Of("received") == 3; }));
  EXPECT_EQ(link_->Receive(), "$B");
  EXPECT_EQ(link_->Receive(), "$RAACK,001*00");
  EXPECT_EQ(link_->Receive(), "$C");
  EXPECT_EQ(link_->Receive(), std::nullopt);
}

TEST_F(TcpServerTest, RefusesLongLinesAndMoreThanItHolds) {
  Open();
  const auto client = Join();
  client.Write(std::string(100'000, '\x03') + "\r\n" + std::string(1024, 'a') + "\r\n" + std::string(1025, 'b') + "\n");
  ASSERT_TRUE(Until([&] { return Of("refused") == 2; }));
  EXPECT_EQ(link_->Receive(), std::string(1024, 'a'));
  EXPECT_EQ(link_->Receive(), std::nullopt);
  std::string lines;
  for (int i = 0; i < 100; ++i) lines += std::to_string(i) + "\n";
  client.Write(lines);
  ASSERT_TRUE(Until([&] { return Of("refused") == 38; }));
  EXPECT_EQ(Of("received"), 65);
  EXPECT_EQ(link_->Receive(), "0");
  EXPECT_TRUE(link_->is_open());
}

// A client that does not read must cost the others nothing, and must not get old targets when it reads again.
TEST_F(TcpServerTest, CutsOffWhoDoesNotReadAndServesTheOthers) {
  Open();
  auto sleeper = Join(2048);
  auto reader = Join();
  const std::string line = "$RATTM,00,1.0000*00" + std::string(60, ' ') + "\r\n";
  std::string read;
  int num_lines = 0;
  const auto begin = std::chrono::steady_clock::now();
  std::chrono::steady_clock::duration longest_send{};
  ASSERT_TRUE(Until(
      [&] {
        if (Of("clients") == 1) return true;
        // So slowly that no buffer fills within the time of the test.
        const auto before = std::chrono::steady_clock::now();
        link_->Send(line);
        longest_send = std::max(longest_send, std::chrono::steady_clock::now() - before);
        ++num_lines;
        read += reader.Read();
        return false;
      },
      10s));
  EXPECT_GT(std::chrono::steady_clock::now() - begin, 1900ms);
  EXPECT_LT(longest_send, 500ms);
  EXPECT_EQ(Of("clients_dropped"), 1);
  EXPECT_GT(Of("dropped"), 0);
  ASSERT_TRUE(Until([&] {
    read += reader.Read();
    return read.size() == line.size() * static_cast<std::size_t>(num_lines);
  }));
  EXPECT_FALSE(reader.has_ended());
  EXPECT_TRUE(Until([&] { return Of("sent") + Of("dropped") == 2 * num_lines; }));
  // What was in its computer when it was cut off, and then the end.
  EXPECT_LT(sleeper.Read().size(), 64'000U);
  EXPECT_TRUE(sleeper.was_reset());
}

TEST_F(TcpServerTest, CutsOffWhoseBufferIsFull) {
  Open();
  const auto sleeper = Join(2048);
  const auto begin = std::chrono::steady_clock::now();
  const std::string line(1000, 'a');
  for (int i = 0; i < 1000; ++i) link_->Send(line);
  EXPECT_FALSE(link_->is_open());
  ASSERT_TRUE(Until([&] { return Of("clients") == 0; }, 1500ms));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 2s);
  EXPECT_EQ(Of("clients_dropped"), 1);
  EXPECT_EQ(Of("sent") + Of("dropped"), 1000);
}

TEST_F(TcpServerTest, SendsOnToWhoSendsNoMoreUntilItIsGone) {
  Open();
  auto client = Join();
  shutdown(client.descriptor(), SHUT_WR);
  PollFor(100ms);
  link_->Send("$A\r\n");
  ASSERT_TRUE(Until([&] { return Of("sent") == 1; }));
  EXPECT_EQ(client.Read(), "$A\r\n");
  EXPECT_EQ(Of("clients"), 1);
  client.Close();
  PollFor(50ms);
  link_->Send("$B\r\n");
  EXPECT_TRUE(Until([&] { return Of("clients") == 0; }));
  EXPECT_EQ(Of("clients_dropped"), 0);
  EXPECT_EQ(Of("dropped"), 1);
}

TEST_F(TcpServerTest, ForgetsWhoIsReset) {
  Open();
  auto stays = Join();
  auto goes = Join();
  goes.Reset();
  EXPECT_TRUE(Until([&] { return Of("clients") == 1; }));
  link_->Send("$A\r\n");
  EXPECT_TRUE(Until([&] { return stays.Read() == "$A\r\n"; }));
  EXPECT_TRUE(link_->is_open());
}

TEST_F(TcpServerTest, ClosesMoreThanMayConnect) {
  Open(2);
  auto first = Join();
  const auto second = Join();
  Socket third(SOCK_STREAM);
  ASSERT_TRUE(third.Connect(port_));
  ASSERT_TRUE(Until([&] { return Of("clients_refused") == 1; }));
  third.Read();
  EXPECT_TRUE(third.has_ended());
  EXPECT_EQ(Of("clients"), 2);
  EXPECT_EQ(link_->num_openings(), 2);
  first.Reset();
  ASSERT_TRUE(Until([&] { return Of("clients") == 1; }));
  const auto fourth = Join();
  EXPECT_EQ(Of("clients"), 2);
}

// A port that was taken ended the process, and lookout-up did not start the look-out for it.
TEST_F(TcpServerTest, SaysWhoHasItsPortAndTakesItWhenItIsFree) {
  port_ = FreePort();
  std::optional<Socket> holder(std::in_place, SOCK_STREAM);
  ASSERT_TRUE(holder->Bind(port_));
  ASSERT_EQ(listen(holder->descriptor(), 1), 0);
  link_ = links_.TcpServer({.name = "ipad", .bind_address = "127.0.0.1", .port = port_});
  const auto fault = link_->fault();
  EXPECT_TRUE(Holds(fault, "TCP server at 127.0.0.1 port " + std::to_string(port_) + ": the port is taken by ")) << fault;
  EXPECT_TRUE(Holds(fault, "(pid " + std::to_string(getpid()) + ")")) << fault;
  link_->Send("$A\r\n");
  EXPECT_EQ(Of("unsent"), 1);
  EXPECT_FALSE(link_->is_open());
  holder.reset();
  ASSERT_TRUE(Until([&] { return link_->fault().empty(); }, 7s)) << link_->fault();
  auto client = Join();
  link_->Send("$B\r\n");
  EXPECT_TRUE(Until([&] { return client.Read() == "$B\r\n"; }));
}

// The address of an interface that comes later.
TEST_F(TcpServerTest, WaitsForItsAddress) {
  link_ = links_.TcpServer({.name = "ipad", .bind_address = "192.0.2.1", .port = FreePort()});
  EXPECT_TRUE(Holds(link_->fault(), "no interface of this computer has that address now")) << link_->fault();
}

TEST_F(TcpServerTest, RefusesAName) { EXPECT_THROW(links_.TcpServer({.name = "ipad", .bind_address = "tablet", .port = 10110}), std::runtime_error); }

// 127.0.0.2 is this computer, too.
TEST_F(TcpServerTest, ListensAtItsAddressAlone) {
  port_ = FreePort();
  link_ = links_.TcpServer({.name = "ipad", .bind_address = "127.0.0.2", .port = port_});
  EXPECT_FALSE(Socket(SOCK_STREAM).Connect(port_));
  const auto other = links_.TcpServer({.name = "other", .bind_address = "127.0.0.1", .port = port_});
  EXPECT_TRUE(Socket(SOCK_STREAM).Connect(port_));
}

TEST_F(TcpServerTest, AndItsClientSpeakIpv6) {
  port_ = FreePort();
  link_ = links_.TcpServer({.name = "ipad", .bind_address = "::1", .port = port_});
  if (!link_->fault().empty()) GTEST_SKIP() << "no IPv6 here: " << link_->fault();
  const auto client = links_.TcpClient({.name = "client", .address = "::1", .port = port_});
  ASSERT_TRUE(Until([&] { return client->is_open() && link_->is_open(); })) << client->fault();
  client->Send("$A\r\n");
  std::optional<std::string> line;
  EXPECT_TRUE(Until([&] { return (line = link_->Receive()).has_value(); }));
  EXPECT_EQ(line, "$A");
  EXPECT_FALSE(Socket(SOCK_STREAM).Connect(port_));
}

TEST_F(TcpServerTest, MayGoWhileItsClientsAreAtWork) {
  Open();
  auto client = Join();
  client.Write("$half");
  for (int i = 0; i < 1000; ++i) link_->Send(std::string(100, 'a'));
  link_.reset();
  PollFor(20ms);
  Until([&] {
    client.Read();
    return client.has_ended();
  });
  EXPECT_TRUE(client.has_ended());
}

class TcpClientTest : public LinksTest {
 protected:
  std::unique_ptr<Link> Client(int port) { return links_.TcpClient({.name = "sk", .address = "127.0.0.1", .port = port}); }
};

TEST_F(TcpClientTest, SendsWhatItIsGivenAndReceivesLines) {
  Socket server(SOCK_STREAM);
  ASSERT_TRUE(server.Bind(0) && server.Listen());
  const auto link = Client(server.port());
  EXPECT_TRUE(Holds(link->fault(), "is not open yet")) << link->fault();
  ASSERT_TRUE(Until([&] { return link->is_open(); }));
  EXPECT_EQ(link->fault(), "");
  auto peer = server.Accept();
  link->Send("$A\r\n");
  peer.Write("$B\r\n");
  ASSERT_TRUE(Until([&] { return support::CountOf(*link, "sk_received") == 1 && support::CountOf(*link, "sk_sent") == 1; }));
  EXPECT_EQ(peer.Read(), "$A\r\n");
  EXPECT_EQ(link->Receive(), "$B");
}

TEST_F(TcpClientTest, ConnectsAgainWhenTheServerWasAway) {
  const int port = FreePort();
  const auto link = Client(port);
  ASSERT_TRUE(Until([&] { return Holds(link->fault(), "Connection refused"); })) << link->fault();
  link->Send("$old\r\n");
  EXPECT_EQ(support::CountOf(*link, "sk_unsent"), 1);
  Socket server(SOCK_STREAM);
  ASSERT_TRUE(server.Bind(port) && server.Listen());
  ASSERT_TRUE(Until([&] { return link->is_open(); }));
  auto peer = server.Accept();
  link->Send("$A\r\n");
  ASSERT_TRUE(Until([&] { return support::CountOf(*link, "sk_sent") == 1; }));
  EXPECT_EQ(peer.Read(), "$A\r\n");
  peer.Reset();
  ASSERT_TRUE(Until([&] { return !link->is_open(); }));
  EXPECT_TRUE(Holds(link->fault(), "TCP server 127.0.0.1 port " + std::to_string(port) + ": ")) << link->fault();
  ASSERT_TRUE(Until([&] { return link->is_open(); }, 6s));
  EXPECT_EQ(link->num_openings(), 2);
}

TEST_F(TcpClientTest, SaysThatTheServerEnded) {
  Socket server(SOCK_STREAM);
  ASSERT_TRUE(server.Bind(0) && server.Listen());
  const auto link = Client(server.port());
  ASSERT_TRUE(Until([&] { return link->is_open(); }));
  server.Accept().Close();
  ASSERT_TRUE(Until([&] { return Holds(link->fault(), "ended the connection"); })) << link->fault();
}

// What waited while the server slept must not arrive as if it were new.
TEST_F(TcpClientTest, DropsWhatAServerThatDoesNotReadIsTooLateFor) {
  Socket server(SOCK_STREAM);
  server.Set(SO_RCVBUF, 2048);
  ASSERT_TRUE(server.Bind(0) && server.Listen());
  const auto link = Client(server.port());
  ASSERT_TRUE(Until([&] { return link->is_open(); }));
  auto sleeper = server.Accept();
  const std::string line = "$RATTM,00*00" + std::string(70, ' ') + "\r\n";
  ASSERT_TRUE(Until(
      [&] {
        link->Send(line);
        return !link->is_open();
      },
      10s));
  EXPECT_TRUE(Until([&] { return Holds(link->fault(), "is too slow"); }, 100ms)) << link->fault();
  EXPECT_GT(support::CountOf(*link, "sk_dropped"), 100);
  ASSERT_TRUE(Until([&] { return link->is_open(); }));
  auto awake = server.Accept();
  link->Send("$new\r\n");
  std::string read;
  EXPECT_TRUE(Until([&] { return !(read += awake.Read()).empty(); }));
  EXPECT_EQ(read, "$new\r\n");
}

// 192.0.2.1 is nobody's (RFC 5737): no route, a refusal, or silence.
TEST_F(TcpClientTest, GivesUpAServerThatDoesNotAnswer) {
  const auto link = links_.TcpClient({.name = "sk", .address = "192.0.2.1", .port = 9});
  EXPECT_TRUE(Until([&] { return Holds(link->fault(), "TCP server 192.0.2.1 port 9: "); }, 7s)) << link->fault();
  EXPECT_FALSE(link->is_open());
}

TEST_F(TcpClientTest, RefusesAName) { EXPECT_THROW(links_.TcpClient({.name = "sk", .address = "boat.local", .port = 1}), std::runtime_error); }

class UdpTest : public LinksTest {};

TEST_F(UdpTest, SendsADatagramForEachMessage) {
  Socket receiver(SOCK_DGRAM);
  ASSERT_TRUE(receiver.Bind(0));
  const auto link = links_.Udp({.name = "plotter", .address = "127.0.0.1", .port = receiver.port()});
  EXPECT_TRUE(link->is_open());
  EXPECT_EQ(link->num_openings(), 1);
  link->Send("$A\r\n");
  link->Send("$B\r\n");
  char bytes[100];
  ASSERT_EQ(recv(receiver.descriptor(), bytes, sizeof bytes, MSG_DONTWAIT), 4);
  EXPECT_EQ(std::string(bytes, 4), "$A\r\n");
  ASSERT_EQ(recv(receiver.descriptor(), bytes, sizeof bytes, MSG_DONTWAIT), 4);
  EXPECT_EQ(std::string(bytes, 4), "$B\r\n");
  EXPECT_EQ(support::CountOf(*link, "plotter_sent"), 2);
  EXPECT_EQ(link->Receive(), std::nullopt);
  EXPECT_EQ(link->fault(), "");
}

TEST_F(UdpTest, ReceivesWhatComesBackWhereThatIsWanted) {
  Socket receiver(SOCK_DGRAM);
  ASSERT_TRUE(receiver.Bind(0));
  for (const bool receives : {true, false}) {
    const auto link = links_.Udp({.name = "pilot", .address = "127.0.0.1", .port = receiver.port(), .receives = receives});
    link->Send("to");
    char bytes[100];
    sockaddr_in sender{};
    socklen_t size = sizeof sender;
    ASSERT_TRUE(receiver.IsReadable(1000));
    ASSERT_EQ(recvfrom(receiver.descriptor(), bytes, sizeof bytes, 0, reinterpret_cast<sockaddr*>(&sender), &size), 2);
    // An empty datagram, one that is too long, and more than may wait.
    const std::vector<std::uint8_t> long_one(3000, 0xFD);
    for (int i = 0; i < 200; ++i) EXPECT_TRUE(receiver.SendTo(sender, std::span(long_one).first(i == 0 ? 0 : i == 1 ? 3000 : 5)));
    PollFor(100ms);
    int num_received = 0;
    while (const auto message = link->Receive()) num_received += message->size() <= 2048 ? 1 : 0;
    EXPECT_EQ(num_received > 0, receives);
    EXPECT_LE(num_received, 64);
    link->Send("on");
    EXPECT_TRUE(receiver.IsReadable(1000));
    receiver.Read();
  }
}

// A receiver that is off kept the plotter degraded for good.
TEST_F(UdpTest, SaysThatNobodyListensAndSendsOnWithoutAFault) {
  const int port = FreePort(SOCK_DGRAM);
  const auto link = links_.Udp({.name = "plotter", .address = "127.0.0.1", .port = port});
  ASSERT_TRUE(Until([&] {
    link->Send("$A\r\n");
    return !link->remark().empty();
  }));
  EXPECT_EQ(link->remark(), "nobody listens at 127.0.0.1 port " + std::to_string(port) + ": Connection refused");
  EXPECT_EQ(link->fault(), "");
  EXPECT_GE(support::CountOf(*link, "plotter_unheard"), 1);
  EXPECT_EQ(support::CountOf(*link, "plotter_unsent"), 0);
  link->Send("$A\r\n");
  // The error of the message before must not cost this one.
  Socket receiver(SOCK_DGRAM);
  ASSERT_TRUE(receiver.Bind(port));
  link->Send("$B\r\n");
  EXPECT_TRUE(receiver.IsReadable(1000));
  EXPECT_EQ(receiver.IsReadable() ? recv(receiver.descriptor(), nullptr, 0, MSG_TRUNC | MSG_DONTWAIT) : -1, 4);
  EXPECT_TRUE(Until([&] { return link->remark().empty(); }, 7s));
}

TEST_F(UdpTest, CountsWhatIsTooLongForADatagram) {
  Socket receiver(SOCK_DGRAM);
  ASSERT_TRUE(receiver.Bind(0));
  const auto link = links_.Udp({.name = "plotter", .address = "127.0.0.1", .port = receiver.port()});
  link->Send(std::string(70'000, 'a'));
  EXPECT_EQ(support::CountOf(*link, "plotter_unsent"), 1);
  EXPECT_TRUE(Holds(link->fault(), "Message too long")) << link->fault();
  link->Send("$A\r\n");
  EXPECT_TRUE(receiver.IsReadable(1000));
}

TEST_F(UdpTest, SendsToGroupsAndBroadcastsByAnInterface) {
  Socket receiver(SOCK_DGRAM);
  ASSERT_TRUE(receiver.Bind(0));
  Socket member(SOCK_DGRAM);
  sockaddr_in any{};
  any.sin_family = AF_INET;
  ASSERT_EQ(bind(member.descriptor(), reinterpret_cast<const sockaddr*>(&any), sizeof any), 0);
  ip_mreqn group{.imr_multiaddr = {inet_addr("239.2.1.1")}, .imr_address = {htonl(INADDR_LOOPBACK)}, .imr_ifindex = 0};
  ASSERT_EQ(setsockopt(member.descriptor(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof group), 0);
  const auto multicast = links_.Udp({.name = "group", .address = "239.2.1.1", .port = member.port(), .interface = "lo"});
  multicast->Send("$A\r\n");
  EXPECT_TRUE(member.IsReadable(1000)) << multicast->fault();
  const auto broadcast = links_.Udp({.name = "all", .address = "127.255.255.255", .port = member.port(), .interface = "lo"});
  EXPECT_EQ(member.Read(), "$A\r\n");
  broadcast->Send("$B\r\n");
  EXPECT_TRUE(member.IsReadable(1000)) << broadcast->fault();
}

TEST_F(UdpTest, WaitsForItsInterface) {
  const auto link = links_.Udp({.name = "plotter", .address = "239.2.1.1", .port = 10110, .interface = "boat0"});
  EXPECT_TRUE(Holds(link->fault(), "there is no interface 'boat0'")) << link->fault();
  EXPECT_FALSE(link->is_open());
  link->Send("$A\r\n");
  EXPECT_EQ(support::CountOf(*link, "plotter_unsent"), 1);
  PollFor(1200ms);
  EXPECT_FALSE(link->fault().empty());
}

TEST_F(UdpTest, RefusesAName) { EXPECT_THROW(links_.Udp({.name = "plotter", .address = "plotter", .port = 1}), std::runtime_error); }

}  // namespace
}  // namespace lookout::plotter
