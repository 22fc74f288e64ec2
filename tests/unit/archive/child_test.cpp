// How a program ended, and whether another try may end otherwise.
#include "tools/archive/child.hpp"

#include <gtest/gtest.h>

namespace {

using namespace lookout;

archive::ChildEnd Shell(const char* commands) { return archive::RunChild({"/bin/sh", "-c", commands}, "/"); }

TEST(ArchiveChild, WasStoppedWhereItSaysSo) {
  EXPECT_EQ(Shell("echo 'lookout-replay: stopped by SIGTERM' >&2; echo 'x.partial: removed' >&2; exit 1").StoppedBy(), "SIGTERM");
  EXPECT_EQ(Shell("echo 'stopped by SIGXCPU' >&2; exit 1").StoppedBy(), "SIGXCPU");
  EXPECT_EQ(Shell("echo 'lookout-replay: stopped by SIGTERM' >&2").StoppedBy(), "") << "it ended well";
  EXPECT_EQ(Shell("echo 'x: not stopped by SIGTERM-2.lcmlog: is no log' >&2; exit 1").StoppedBy(), "");
  EXPECT_EQ(Shell("exit 1").StoppedBy(), "");
}

TEST(ArchiveChild, FailedByItsComputerWhereItNamesAnErrorOfIt) {
  for (const auto* fault : {"No space left on device", "Permission denied", "Connection timed out", "Remote I/O error", "File too large"}) {
    EXPECT_EQ(Shell((std::string("echo 'x: cannot be read: ") + fault + "' >&2; exit 1").c_str()).FaultOfComputer(), fault);
  }
  EXPECT_EQ(Shell("echo 'x: is no log' >&2; exit 1").FaultOfComputer(), "");
  EXPECT_EQ(archive::RunChild({"/nowhere/program"}, "/").FaultOfComputer(), "a program of --programs cannot be started");
}

TEST(ArchiveChild, WasKilledBySignalsOfOthersAlone) {
  EXPECT_TRUE(Shell("kill -TERM $$").WasKilled());
  EXPECT_FALSE(Shell("kill -ABRT $$").WasKilled());
  EXPECT_NE(Shell("kill -ABRT $$").signal, 0);
}

}  // namespace
