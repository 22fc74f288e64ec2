#include "common/runtime/source_reader.hpp"

#include <chrono>
#include <deque>
#include <gtest/gtest.h>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lookout::runtime {
namespace {

using io::Source;
using std::chrono::seconds;

// Holds what has arrived; what is refused is read and not returned.
struct Waiting : Source {
  struct Arrival {
    Utime time;
    bool is_refused = false;
    Kind kind = Kind::kDatagram;
  };
  std::string Poll(Utime) override {
    ++num_polls;
    return {};
  }
  std::optional<Piece> Receive(Utime) override {
    is_left_empty = arrivals.empty();
    if (is_left_empty) return std::nullopt;
    const auto arrival = arrivals.front();
    arrivals.pop_front();
    latest = arrival.time;
    if (arrival.is_refused) return std::nullopt;
    return Piece{.host_time = arrival.time, .bytes = {}, .kind = arrival.kind};
  }
  bool is_empty() const override { return is_left_empty; }
  Utime last_time() const override { return latest; }
  std::string fault() const override { return fault_text; }
  std::vector<Counter> counters() override { return sums; }

  std::deque<Arrival> arrivals;
  bool is_left_empty = true;
  Utime latest{};
  std::string fault_text;
  std::vector<Counter> sums;
  int num_polls = 0;
};

class LiveReaderTest : public ::testing::Test {
 protected:
  Waiting& Add(const std::string& name) {
    auto source = std::make_unique<Waiting>();
    auto& added = *source;
    sources_.push_back({name, std::move(source)});
    return added;
  }
  LiveReader Make(int max_pieces = 64) {
    return {std::move(sources_),
            {.period = std::chrono::milliseconds(5), .max_pieces = max_pieces},
            {.on_piece =
                 [this](const std::string& name, const Source::Piece& piece) {
                   pieces_.push_back({name, piece.kind});
                 },
             .on_round = [this](const LiveReader::Round& round) { rounds_.push_back(round); }}};
  }

  std::vector<LiveReader::NamedSource> sources_;
  std::vector<std::pair<std::string, Source::Kind>> pieces_;
  std::vector<LiveReader::Round> rounds_;
};

TEST_F(LiveReaderTest, ReadsAllThatWaitsAndSaysUntilWhen) {
  auto& first = Add("a");
  auto& second = Add("b");
  const auto now = HostNow();
  first.arrivals = {{now - seconds(3)}, {now - seconds(2), true}, {now - seconds(1), false, Source::Kind::kBreak}};
  second.arrivals = {{now + seconds(1000)}};
  auto reader = Make();
  EXPECT_TRUE(reader.Read());
  ASSERT_EQ(pieces_.size(), 3U);
  EXPECT_EQ(pieces_[1], std::pair(std::string("a"), Source::Kind::kBreak)) << "neither a refused datagram nor a break ends the reading";
  ASSERT_EQ(rounds_.size(), 1U);
  EXPECT_GE(rounds_[0].start, now);
  EXPECT_EQ(rounds_[0].read_before, rounds_[0].start);
  EXPECT_EQ(rounds_[0].latest, now + seconds(1000));
  EXPECT_EQ(first.num_polls, 1);
  EXPECT_TRUE(reader.Read());
  EXPECT_EQ(rounds_[1].latest, rounds_[1].start);
}

TEST_F(LiveReaderTest, ARoundThatIsCutShortSaysWhatWasRead) {
  auto& flood = Add("a");
  Add("b").arrivals = {{HostNow()}};
  const auto past = HostNow() - seconds(100);
  for (int i = 0; i < 10; ++i) flood.arrivals.push_back({past + seconds(i), i % 2 == 1});
  auto reader = Make(4);
  EXPECT_TRUE(reader.Read());
  ASSERT_EQ(pieces_.size(), 3U) << "the other one gets its turn";
  EXPECT_EQ(rounds_[0].read_before, past + seconds(3));
}

TEST_F(LiveReaderTest, NamesEachFaultOnceAndAddsCountersOfOneName) {
  // A counter's name outlives it, as a literal does.
  const std::pair<std::string, std::string_view> inputs[]{{"", "_lost"}, {"", "_lost"}, {"gnss", "gnss_lost"}};
  for (const auto& [name, counter] : inputs) {
    auto& source = Add(name);
    source.fault_text = "interface 'eth0' is down";
    source.sums = {{counter, 2}, {"sockets_reopened", 1}};
  }
  const auto reader = Make();
  EXPECT_EQ(reader.fault(), "input 'gnss': interface 'eth0' is down; interface 'eth0' is down");
  const auto counters = reader.counters();
  ASSERT_EQ(counters.size(), 3U);
  EXPECT_EQ(counters[0].count, 4);
  EXPECT_EQ(counters[1].name, "sockets_reopened");
  EXPECT_EQ(counters[1].count, 3);
  EXPECT_EQ(counters[2].name, "gnss_lost");
}

}  // namespace
}  // namespace lookout::runtime
