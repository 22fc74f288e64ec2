#include "common/runtime/progress.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <gtest/gtest.h>
#include <string>

namespace lookout::runtime {
namespace {

using std::chrono::milliseconds;

// A terminal of so many columns, and what stands on its line.
class Terminal {
 public:
  explicit Terminal(unsigned short columns) {
    master_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0) return;
    SetColumns(columns);
    out_ = std::fopen(ptsname(master_), "w");
  }
  ~Terminal() {
    if (out_ != nullptr) std::fclose(out_);
    if (master_ >= 0) close(master_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  std::FILE* out() const { return out_; }
  void SetColumns(unsigned short columns) const {
    winsize size{};
    size.ws_row = 24;
    size.ws_col = columns;
    ioctl(master_, TIOCSWINSZ, &size);
  }
  // What is to be seen on the line, without blanks at its end.
  std::string Line() {
    std::array<char, 4096> bytes{};
    const auto size = read(master_, bytes.data(), bytes.size());
    for (ssize_t i = 0; i < size; ++i) {
      const char letter = bytes[static_cast<std::size_t>(i)];
      if (letter == '\r') {
        column_ = 0;
      } else {
        if (line_.size() <= column_) line_.resize(column_ + 1, ' ');
        line_[column_++] = letter;
        widest_ = std::max(widest_, column_);
      }
    }
    const auto end = line_.find_last_not_of(' ');
    return end == std::string::npos ? "" : line_.substr(0, end + 1);
  }
  std::size_t widest() const { return widest_; }

 private:
  int master_ = -1;
  std::FILE* out_ = nullptr;
  std::string line_;
  std::size_t column_ = 0;
  std::size_t widest_ = 0;
};

// A clock that stands still but for what a test lets pass.
class Watch {
 public:
  std::function<Progress::Clock::time_point()> Clock() const {
    return [this] { return now_; };
  }
  // As a program calls it: many times in each millisecond.
  void Update(Progress& progress, double share, const std::string& remark, milliseconds time) {
    const auto end = now_ + time;
    for (; now_ < end; now_ += milliseconds(1)) {
      for (int i = 0; i < 100; ++i) progress.Update(share, [&remark] { return remark; });
    }
  }

 private:
  Progress::Clock::time_point now_;
};

TEST(Progress, LeavesNothingOfALongerLineOnATerminal) {
  Terminal terminal(80);
  if (terminal.out() == nullptr) GTEST_SKIP() << "this computer gives no pseudo terminal";
  {
    Watch watch;
    Progress progress("replay", terminal.out(), true, milliseconds(1), watch.Clock());
    watch.Update(progress, 0.001, "123456 times real time", milliseconds(200));
    EXPECT_EQ(terminal.Line().find("replay: 0 %, 123456 times real time, "), 0U) << terminal.Line();
    watch.Update(progress, 0.999, "1 times real time", milliseconds(700));
    EXPECT_EQ(terminal.Line(), "replay: 100 %, 1 times real time, 0 s left");
    progress.Clear();
    EXPECT_EQ(terminal.Line(), "");
    watch.Update(progress, 0.5, "2 times real time", milliseconds(600));
    EXPECT_EQ(terminal.Line().find("replay: 50 %, 2 times real time, "), 0U) << terminal.Line();
  }
  EXPECT_EQ(terminal.Line(), "");
}

// A line that wraps cannot be written over: each would stay.
TEST(Progress, IsNoWiderThanTheTerminalAlsoWhenThatBecomesNarrower) {
  Terminal terminal(30);
  if (terminal.out() == nullptr) GTEST_SKIP() << "this computer gives no pseudo terminal";
  Watch watch;
  Progress progress("replay", terminal.out(), true, milliseconds(1), watch.Clock());
  watch.Update(progress, 0.5, "123456 times real time", milliseconds(200));
  EXPECT_EQ(terminal.Line(), "replay: 50 %, 123456 times re");
  EXPECT_EQ(terminal.widest(), 29U);
  terminal.SetColumns(10);
  watch.Update(progress, 0.5, "1 times real time", milliseconds(700));
  EXPECT_EQ(terminal.Line().substr(0, 9), "replay: 5");
}

TEST(Progress, ElsewhereIsALineNowAndThenAndNotAtOnce) {
  std::array<char, 4096> text{};
  std::FILE* out = fmemopen(text.data(), text.size(), "w");
  Watch watch;
  ASSERT_NE(out, nullptr);
  {
    Progress progress("sim", out, false, milliseconds(300), watch.Clock());
    watch.Update(progress, 0.25, "", milliseconds(200));
    EXPECT_STREQ(text.data(), "");
    watch.Update(progress, 0.5, "fast", milliseconds(200));
    EXPECT_EQ(std::string(text.data()), "sim: 50 %, fast, 0 s left\n");
  }
  EXPECT_EQ(std::string(text.data()), "sim: 50 %, fast, 0 s left\n") << "no blanks are written to a file";
  std::fclose(out);
}

// Of a comparison of 40 runs of a second each no line once came: the clock was looked at with every 64th step.
TEST(Progress, IsShownWhereStepsAreLong) {
  std::array<char, 4096> text{};
  std::FILE* out = fmemopen(text.data(), text.size(), "w");
  ASSERT_NE(out, nullptr);
  auto now = Progress::Clock::time_point();
  Progress progress("lookout-eval", out, false, milliseconds(3000), [&now] { return now; });
  for (int step = 0; step < 4; ++step, now += milliseconds(1000)) progress.Update(0.25 * step);  // at 0, 1, 2 and 3 s
  EXPECT_STREQ(text.data(), "lookout-eval: 75 %, 1 s left\n");
  std::fclose(out);
}

TEST(Progress, OnlyATerminalIsToldOfByTools) {
  EXPECT_EQ(OnlyTerminal(nullptr), nullptr);
  std::array<char, 16> text{};
  std::FILE* out = fmemopen(text.data(), text.size(), "w");
  EXPECT_EQ(OnlyTerminal(out), nullptr);
  std::fclose(out);
  Terminal terminal(80);
  if (terminal.out() == nullptr) GTEST_SKIP() << "this computer gives no pseudo terminal";
  EXPECT_EQ(OnlyTerminal(terminal.out()), terminal.out());
}

TEST(Progress, OfNothingIsSilent) {
  Progress progress("sim", nullptr);
  for (int i = 0; i < 1000; ++i) progress.Update(0.5);
  progress.Clear();
}

}  // namespace
}  // namespace lookout::runtime
