// A result holds as long as its sidecar and every byte of its files do.
#include <gtest/gtest.h>
#include <stdexcept>

#include "tests/unit/archive/support.hpp"

namespace {

using namespace lookout;
using archive_test::AnyRecipe;
using archive_test::WriteResult;
using support::ReadFile;
using support::WriteFile;

class ArchiveSidecar : public ::testing::Test {
 protected:
  support::TempDir dir_;
  archive::ArchiveFolder folder_{dir_.path()};
};

TEST_F(ArchiveSidecar, HoldsAndSaysHowTheUnitEnded) {
  const auto key = WriteResult(folder_, AnyRecipe(), "a,b\n1,2\n");
  const auto validity = archive::Verify(folder_, key);
  EXPECT_TRUE(validity.is_valid);
  EXPECT_TRUE(validity.is_done);
  EXPECT_EQ(archive::StampOfResult(folder_, key, validity.stamp), validity.stamp);
}

TEST_F(ArchiveSidecar, IsNoResultWithoutIt) {
  const auto key = WriteResult(folder_, AnyRecipe(), "a,b\n");
  std::filesystem::remove(folder_.Sidecar(key));
  const auto validity = archive::Verify(folder_, key);
  EXPECT_FALSE(validity.is_valid);
  EXPECT_EQ(validity.reason, "");
}

TEST_F(ArchiveSidecar, NoticesAFileThatIsCutChangedMissingOrMore) {
  const auto key = WriteResult(folder_, AnyRecipe(), "a,b\n1,2\n");
  const auto file = folder_.Result(key) / "tracks.csv";
  const auto stamp = archive::Verify(folder_, key).stamp;
  WriteFile(file, "a,b\n1,2");
  EXPECT_NE(archive::Verify(folder_, key).reason.find("size"), std::string::npos);
  WriteFile(file, "a,b\n1,3\n");
  EXPECT_NE(archive::Verify(folder_, key).reason.find("digest"), std::string::npos);
  EXPECT_NE(archive::StampOfResult(folder_, key, stamp), stamp);
  std::filesystem::remove(file);
  EXPECT_NE(archive::Verify(folder_, key).reason.find("missing"), std::string::npos);
  EXPECT_EQ(archive::StampOfResult(folder_, key, stamp), "");
  WriteFile(file, "a,b\n1,2\n");
  EXPECT_TRUE(archive::Verify(folder_, key).is_valid);
  WriteFile(folder_.Result(key) / "more.csv", "");
  EXPECT_FALSE(archive::Verify(folder_, key).is_valid);
}

// A program can set the time of modification of a file, but not that of its change.
TEST_F(ArchiveSidecar, NoticesAChangeThatKeepsSizeAndTime) {
  const auto key = WriteResult(folder_, AnyRecipe(), "a,b\n1,2\n");
  const auto file = folder_.Result(key) / "tracks.csv";
  const auto stamp = archive::Verify(folder_, key).stamp;
  const auto time = std::filesystem::last_write_time(file);
  WriteFile(file, "a,b\n1,3\n");
  std::filesystem::last_write_time(file, time);
  EXPECT_NE(archive::StampOfResult(folder_, key, stamp), stamp);
}

TEST_F(ArchiveSidecar, IsRefusedAtEachPlaceWhereItIsTorn) {
  const auto key = WriteResult(folder_, AnyRecipe(), "a,b\n");
  const auto text = ReadFile(folder_.Sidecar(key));
  for (std::size_t size = 0; size + 2 < text.size(); ++size) EXPECT_THROW(archive::SidecarOfText(text.substr(0, size)), std::runtime_error) << size;
}

TEST_F(ArchiveSidecar, IsRefusedWhereAWordOfItWasChanged) {
  const auto key = WriteResult(folder_, AnyRecipe(), "a,b\n");
  auto text = ReadFile(folder_.Sidecar(key));
  text.replace(text.find("\"done\""), 6, "\"fail\"");
  EXPECT_THROW(archive::SidecarOfText(text), std::runtime_error);
}

TEST_F(ArchiveSidecar, OfAnotherUnitIsNotThatOfThisOne) {
  const auto key = WriteResult(folder_, AnyRecipe(), "a,b\n");
  auto other = AnyRecipe();
  other.config_digest = "other";
  const auto other_key = archive::KeyOf(other);
  std::filesystem::create_directories(folder_.Sidecar(other_key).parent_path());
  std::filesystem::copy(folder_.Result(key), folder_.Result(other_key));
  std::filesystem::copy_file(folder_.Sidecar(key), folder_.Sidecar(other_key));
  EXPECT_NE(archive::Verify(folder_, other_key).reason.find("another unit"), std::string::npos);
}

// A forged name must not lead out of the folder of the result.
TEST_F(ArchiveSidecar, NamesNoFileOutsideOfItsFolder) {
  archive::Sidecar sidecar;
  sidecar.recipe = AnyRecipe();
  for (const auto* name : {"../x", "/etc/passwd", "..", ".hidden", "a b", "", "a\nb"}) {
    sidecar.files = {{name, {0, ""}}};
    EXPECT_THROW(archive::SidecarOfText(archive::SidecarText(sidecar)), std::runtime_error) << name;
  }
}

}  // namespace
