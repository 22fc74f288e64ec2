// A server with a recording that a test can hold up.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <utility>

#include "services/page/core/recordings.hpp"
#include "tests/unit/page_io/peer.hpp"

namespace lookout::page::test {

/// Answers each question with as many messages of TRACKS as its time says; waits while it is held.
class FakeRecordings : public Recordings {
 public:
  std::string SourcesText() override { return R"([{"id":0,"num":)" + std::to_string(++num_told_) + "}]"; }

  Answer Find(const page::At& request) override {
    Wait();
    Answer answer;
    if (request.source != 0) answer.refusal = "no such source";
    if (!answer.refusal.empty()) return answer;
    answer.time = request.time.value_or(Utime{});
    for (std::int64_t i = 0; i < ToUtimeUs(answer.time); ++i)
      answer.messages.push_back(
          {IndexOf("TRACKS"), Utime(std::chrono::microseconds(i)), std::vector<std::uint8_t>(ToUtimeUs(answer.time) > 1000 ? 1000 : 10, 'r')});
    return answer;
  }
  Answer Find(const Range& request) override {
    Wait();
    if (request.max_messages == 13) throw std::runtime_error("the disk is broken");
    return {};
  }
  std::string Strip(const StripRequest& request) override {
    Wait();
    return R"({"type":"strip","id":)" + std::to_string(request.id) + "}";
  }

  void Hold(bool is_held) { is_held_ = is_held; }
  bool is_waiting() const { return is_waiting_; }

 private:
  void Wait() {
    is_waiting_ = true;
    Until([&] { return !is_held_; });
    is_waiting_ = false;
  }

  std::atomic<bool> is_held_ = false;
  std::atomic<bool> is_waiting_ = false;
  int num_told_ = 0;
};

class PageServerTest : public ::testing::Test {
 protected:
  PageServerTest() {
    ServerOptions options;
    options.token = "secret";
    options.version = "1.2";
    options.host = "boat";
    ServerParts parts;
    parts.recordings = recordings_;
    parts.acknowledge = [](const Acknowledgement&) {};
    parts.order = [](const Order&) {};
    parts.tile = [](int, int, int) -> std::optional<Tile> { return Tile{"image/png", {1}}; };
    server_ = std::make_unique<Server>(options, std::move(parts));
  }
  ~PageServerTest() override { recordings_->Hold(false); }

  Browser Open(int buffer_bytes = 0) const { return Browser(server_->port(), buffer_bytes); }
  /// One that watches TRACKS, and is known to.
  Browser OpenWatching(int buffer_bytes = 0) {
    auto browser = Open(buffer_bytes);
    browser.Watch(R"("TRACKS")");
    // What it says is handled in order: the answer comes after.
    browser.Say(R"({"op":"strip","id":999,"source":0,"from_utime_us":1,"to_utime_us":2,"buckets":1})");
    EXPECT_TRUE(browser.Next().Holds("999"));
    return browser;
  }
  void Publish(std::string_view channel, std::int64_t group, const std::string& message, int part = 0, const std::string& slot = "") {
    server_->Publish(IndexOf(channel), slot, group, part, Utime(std::chrono::microseconds(group)), BytesOf(message));
  }
  static std::string MessageOf(const FromServer& frame) { return frame.kind == 2 ? frame.bytes.substr(kFrameHeadBytes) : "none"; }
  static std::string AtText(int id, int num_messages) {
    return R"({"op":"at","id":)" + std::to_string(id) + R"(,"source":0,"utime_us":)" + std::to_string(num_messages) + R"(,"channels":["TRACKS"]})";
  }

  std::shared_ptr<FakeRecordings> recordings_ = std::make_shared<FakeRecordings>();
  std::unique_ptr<Server> server_;
};

}  // namespace lookout::page::test
