// Outputs of programs that are asked to stop, that reach a limit of the system, or whose reader went away.
#include "tests/unit/common/output_fixture.hpp"

namespace lookout::io {
namespace {

// @return its exit code; -1 when it was ended by a signal, also by this function after 10 s
int ExitCodeOf(pid_t child) {
  int status = 0;
  for (int i = 0; i < 1000; ++i) {
    if (waitpid(child, &status, WNOHANG) == child) return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  kill(child, SIGKILL);
  waitpid(child, &status, 0);
  return -1;
}

// In a process of its own, as signals and limits are of the whole process. @return as ExitCodeOf
template <typename Body>
int RunInChild(const Body& body) {
  const pid_t child = fork();
  if (child == 0) {
    CatchStopSignals();
    _exit(body());
  }
  return ExitCodeOf(child);
}

TEST_F(Output, ThatGrowsBeyondALimitOfTheSystemIsAnErrorAndLeavesNothing) {
  const int code = RunInChild([&] {
    const rlimit limit{1'000'000, 1'000'000};
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      OutputFile output(file_, Options());
      for (int i = 0; i < 100; ++i) output.Write(std::string(100'000, 'x'));
      output.Commit();
    } catch (const std::runtime_error& error) {
      return std::string(error.what()).find("out: write failed: File too large") != std::string::npos ? 1 : 2;
    }
    return 0;
  });
  EXPECT_EQ(code, 1);
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(Output, EndsWhenTheProgramIsAskedToStop) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const int code = RunInChild([&] {
      OutputFile output(file_, Options());
      output.Write(std::string(100'000, 'x'));
      raise(signal);
      try {
        output.Write(std::string(100'000, 'x'));
      } catch (const Stopped&) {
        return IsStopAsked() ? 1 : 2;
      }
      return 0;
    });
    EXPECT_EQ(code, 1);
  }
}

// Both calls block for good: the one because nobody opens the FIFO, the other because nobody reads.
TEST_F(Output, AFifoThatNobodyReadsDoesNotHoldUpTheEnd) {
  ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
  for (const bool has_reader : {false, true}) {
    const int reader = has_reader ? open(file_.c_str(), O_RDONLY | O_NONBLOCK) : -1;
    const pid_t child = fork();
    if (child == 0) {
      CatchStopSignals();
      try {
        OutputFile output(file_, Options());
        for (int i = 0; i < 100; ++i) output.Write(std::string(100'000, 'x'));
      } catch (const Stopped&) {
        _exit(1);
      }
      _exit(2);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    kill(child, SIGINT);
    EXPECT_EQ(ExitCodeOf(child), 1);
    if (reader >= 0) close(reader);
  }
}

TEST_F(Output, APipeThatNobodyReadsAnyMoreIsToldApart) {
  const int code = RunInChild([&] {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) return 3;
    close(ends[0]);
    try {
      OutputFile output("/dev/fd/" + std::to_string(ends[1]), Options());
      output.Write("text");
      output.Commit();
    } catch (const BrokenPipe&) {
      return 1;
    }
    return 0;
  });
  EXPECT_EQ(code, 1);
}

// An output would get the number of standard output, and the program's own lines with it.
TEST_F(Output, IsNoStandardStreamThatWasClosed) {
  const pid_t child = fork();
  if (child == 0) {
    for (const int i : {0, 1, 2}) close(i);
    CatchStopSignals();
    OutputFile output(file_, Options());
    output.Write("text");
    const bool is_mixed = write(STDOUT_FILENO, "words", 5) > 0 || output.descriptor() <= STDERR_FILENO;
    output.Commit();
    _exit(is_mixed ? 1 : 0);
  }
  EXPECT_EQ(ExitCodeOf(child), 0);
  EXPECT_EQ(Content(file_), "text");
}

// Work that does not look at the flag: a second signal ends it, if it does not follow at once (timeout(1) sends each twice).
TEST_F(Output, ASecondSignalASecondLaterIsDeadly) {
  const pid_t child = fork();
  if (child == 0) {
    CatchStopSignals();
    for (;;) pause();
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  kill(child, SIGINT);
  kill(child, SIGINT);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(waitpid(child, nullptr, WNOHANG), 0);
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  kill(child, SIGINT);
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGINT);
}

// The signal comes in the moment between the look at the flag and the call that blocks: the alarm ends the call.
TEST_F(Output, ASignalJustBeforeACallThatBlocksEndsItToo) {
  const int code = RunInChild([] {
    raise(SIGINT);
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) return 3;
    char byte = 0;
    return read(ends[0], &byte, 1) < 0 && errno == EINTR ? 1 : 2;
  });
  EXPECT_EQ(code, 1);
}

}  // namespace
}  // namespace lookout::io
