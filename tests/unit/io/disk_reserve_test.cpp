#include "common/io/disk_reserve.hpp"

#include <gtest/gtest.h>

#include "tests/support/files.hpp"

namespace lookout::io {
namespace {

constexpr std::int64_t kGigabyte = 1'000'000'000;

// The recorder stopped at its reserve, and the page began to write two gigabytes of its own into it.
TEST(DiskReserve, LeavesNothingToOthersWhereTheRecorderHasStopped) {
  const DiskReserve reserve(kGigabyte);
  EXPECT_LT(reserve.BytesForOthers(kGigabyte, 0), 0);
  // What the recorder needs to go on is not taken away from it.
  EXPECT_LT(reserve.BytesForOthers(reserve.bytes_to_go_on() - 1, 0), 0);
  EXPECT_EQ(reserve.BytesForOthers(reserve.bytes_to_go_on() + 1000, 0), 1000);
}

TEST(DiskReserve, TakesBackWhatOthersHoldAsTheDiskFills) {
  const DiskReserve reserve(kGigabyte);
  EXPECT_EQ(reserve.BytesForOthers(reserve.bytes_to_go_on(), 500), 500);
  EXPECT_EQ(reserve.BytesForOthers(reserve.bytes_to_go_on() - 300, 500), 200);
}

TEST(DiskReserve, SaysWhatIsFreeAndWhatIsKept) {
  EXPECT_EQ(DiskReserve(kGigabyte).Text(12'345'678), "12 MB are free, 1000 MB of the disk are kept in reserve");
}

TEST(DiskReserve, IsThatOfTheRecorderOnItsDiskAndATenthOfAnother) {
  const support::TempDir folder;
  EXPECT_EQ(ReserveAt(folder / "spool/that/comes", folder / "logs", 123'456).bytes(), 123'456);
  const auto other = ReserveAt("/proc", folder.path() / "logs", 123'456);  // a file system without any bytes
  EXPECT_EQ(other.bytes(), 0);
  EXPECT_LE(ReserveAt(folder / "spool", std::nullopt, std::int64_t{1} << 60).bytes(), DiskBytes(folder.path()) / 10);
}

TEST(DiskReserve, LooksAtTheFolderAboveWhatIsNotThereYet) {
  const support::TempDir folder;
  EXPECT_GT(FreeBytes(folder / "not/yet"), 0);
  EXPECT_EQ(DiskBytes(folder / "not/yet"), DiskBytes(folder.path()));
}

}  // namespace
}  // namespace lookout::io
