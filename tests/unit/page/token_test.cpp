#include "services/page/token.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <stdexcept>
#include <string>

#include "services/page/announcement.hpp"
#include "tests/support/files.hpp"

namespace lookout::page {
namespace {

namespace fs = std::filesystem;

std::string FaultOf(const fs::path& file) {
  try {
    ReadOrMakeToken(file);
    return {};
  } catch (const std::exception& error) {
    return error.what();
  }
}

void Write(const fs::path& file, const std::string& text, fs::perms permissions = fs::perms::owner_read | fs::perms::owner_write) {
  std::ofstream(file) << text;
  fs::permissions(file, permissions);
}

TEST(Token, IsMadeOnceForItsOwnerAlone) {
  const support::TempDir folder;
  const auto file = folder / "state/lookout/page-token";
  const auto token = ReadOrMakeToken(file);
  EXPECT_EQ(token.size(), 32U);
  EXPECT_EQ(token.find_first_not_of("0123456789abcdef"), std::string::npos) << token;
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(ReadOrMakeToken(file), token);
  EXPECT_NE(ReadOrMakeToken(folder / "another"), token);
}

TEST(Token, IsTheFirstLineOfItsFile) {
  const support::TempDir folder;
  Write(folder / "token", "correct-horse_battery\r\nmore\n");
  EXPECT_EQ(ReadToken(folder / "token"), "correct-horse_battery");
}

TEST(Token, IsRefusedWhereOthersKnowItOrItIsNone) {
  const support::TempDir folder;
  Write(folder / "open", "0123456789abcdef0123456789abcdef\n", fs::perms::owner_all | fs::perms::others_read);
  EXPECT_NE(FaultOf(folder / "open").find("is not private: chmod 640"), std::string::npos);
  Write(folder / "short", "0123456789abcde\n");
  EXPECT_NE(FaultOf(folder / "short").find("16 to 128"), std::string::npos);
  Write(folder / "long", std::string(129, 'a'));
  EXPECT_NE(FaultOf(folder / "long").find("16 to 128"), std::string::npos);
  Write(folder / "odd", "0123456789abcdef<script>\n");
  EXPECT_NE(FaultOf(folder / "odd").find("16 to 128"), std::string::npos);
  fs::create_directory(folder / "folder");
  EXPECT_NE(FaultOf(folder / "folder").find("is no file"), std::string::npos);
  fs::create_symlink("nowhere", folder / "link");
  EXPECT_NE(FaultOf(folder / "link").find("is no file"), std::string::npos);
}

TEST(Token, LiesInTheFolderThatSystemdGives) {
  setenv("STATE_DIRECTORY", "/var/lib/lookout:/var/lib/other", 1);
  EXPECT_EQ(StateFolder(), "/var/lib/lookout");
  unsetenv("STATE_DIRECTORY");
  setenv("XDG_STATE_HOME", "/state", 1);
  EXPECT_EQ(StateFolder(), "/state/lookout");
  unsetenv("XDG_STATE_HOME");
  setenv("HOME", "/home/skipper", 1);
  EXPECT_EQ(StateFolder(), "/home/skipper/.local/state/lookout");
}

TEST(Link, HoldsTheTokenAndACodeForATablet) {
  const auto text = LinkText("http://localhost:7668/", {"http://192.0.2.7:7668/"}, "secret");
  EXPECT_NE(text.find("http://localhost:7668/#token=secret\n"), std::string::npos);
  EXPECT_NE(text.find("http://192.0.2.7:7668/#token=secret\n"), std::string::npos);
  EXPECT_NE(text.find(QrCode("http://192.0.2.7:7668/#token=secret")), std::string::npos);
  EXPECT_EQ(LinkText("http://localhost:1/", {}, "").find("token"), std::string::npos);
}

// Version 1 has 21 modules and 4 of quiet zone on each side, two of them in a line.
TEST(Link, CodeIsAsLargeAsItsVersion) {
  const auto code = QrCode("A");
  EXPECT_EQ(std::count(code.begin(), code.end(), '\n'), 15);
  EXPECT_EQ(QrCode(std::string(5000, 'a')), "");
}

}  // namespace
}  // namespace lookout::page
