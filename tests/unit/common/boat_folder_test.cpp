#include "common/config/boat_folder.hpp"

#include <gtest/gtest.h>

#include "tests/support/files.hpp"

namespace lookout::config {
namespace {

// "--config config" told eight files that cannot be read, and no boat.
TEST(BoatFolder, NamesTheBoatsBelow) {
  const support::TempDir folder;
  EXPECT_EQ(BoatFolderFault(folder.path().string()), "") << "nothing is known";
  for (const char* boat : {"swan", "heron"}) {
    std::filesystem::create_directory(folder / boat);
    support::WriteFile(folder / boat / "boat.txtpb", "");
  }
  std::filesystem::create_directory(folder / "scenes");
  EXPECT_EQ(BoatFolderFault(folder.path().string()), folder.path().string() + " is no boat's folder (it has no boat.txtpb), but holds boats: " +
                                                         (folder / "heron").string() + ", " + (folder / "swan").string());
  EXPECT_EQ(BoatFolderFault((folder / "swan").string()), "");
}

}  // namespace
}  // namespace lookout::config
