#include "services/page/film/spool.hpp"

#include <sys/resource.h>

#include <csignal>
#include <gtest/gtest.h>

#include "tests/unit/page_film/scene.hpp"

namespace lookout::page {
namespace {

// No file takes a byte while it stands: as on a full disk, on which files can be made but not written.
class NoRoom {
 public:
  NoRoom() : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    auto none = before_;
    none.rlim_cur = 0;
    setrlimit(RLIMIT_FSIZE, &none);
  }
  ~NoRoom() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  NoRoom(const NoRoom&) = delete;
  NoRoom& operator=(const NoRoom&) = delete;

 private:
  void (*handler_)(int);
  rlimit before_{};
};

std::vector<SpooledMessage> Messages(std::int64_t seq) { return {{At_us(kBeginUs + seq * kScanUs), bus::kHealth.name, {1, 2, 3}}}; }

// Each attempt left an empty file and its descriptor behind, until the process had none left.
TEST(Spool, LeavesNoFilesBehindWhereTheDiskIsFull) {
  support::TempDir folder;
  Spool spool(folder / "spool");
  EXPECT_TRUE(spool.Write(Messages(0), 1'000'000));
  {
    const NoRoom no_room;
    for (int i = 1; i < 10; ++i) spool.Write(Messages(i), 1'000'000);
  }
  EXPECT_FALSE(spool.fault().empty());
  EXPECT_EQ(spool.num_files(), 1U);
  EXPECT_TRUE(spool.Write(Messages(10), 1'000'000));
  EXPECT_EQ(spool.num_files(), 2U);
  EXPECT_EQ(spool.fault(), "");
}

}  // namespace
}  // namespace lookout::page
