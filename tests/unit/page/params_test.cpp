#include "services/page/params.hpp"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>

#include "common/config/text_config.hpp"
#include "tests/support/files.hpp"

namespace lookout::page {
namespace {

namespace fs = std::filesystem;

class PageParams : public ::testing::Test {
 protected:
  PageParams() { fs::copy(support::kDemoConfig, folder_ / "config"); }

  Params Load(const std::string& text) {
    std::ofstream(folder_ / "config/page.txtpb") << text;
    return LoadParams(folder_ / "config");
  }
  // All faults, or nothing.
  std::string FaultOf(const std::string& text) {
    try {
      Load(text);
      return {};
    } catch (const config::ConfigError& error) {
      return error.what();
    }
  }
  void ExpectFault(const std::string& text, const std::string& words) { EXPECT_NE(FaultOf(text).find(words), std::string::npos) << FaultOf(text); }

  support::TempDir folder_;
};

TEST_F(PageParams, AreForThisComputerAloneWithoutAFile) {
  fs::remove(folder_ / "config/page.txtpb");
  const auto params = LoadParams(folder_ / "config");
  EXPECT_EQ(params.bind_address, "127.0.0.1");
  EXPECT_EQ(params.port, 7668);
  EXPECT_EQ(params.boat, "demo");
  EXPECT_FALSE(IsForOthers(params.bind_address));
  EXPECT_EQ(InWords(params),
            "# page.txtpb: the picture is for browsers of this computer alone (127.0.0.1), TCP port 7668\n"
            "# page.txtpb: who has the token acknowledges alerts\n");
}

TEST_F(PageParams, SayWhoSeesThePictureWhereOthersMay) {
  const auto params = Load("bind_address: '0.0.0.0' port: 80 allows_acknowledgements: false host_name: 'boat.lan'");
  EXPECT_EQ(InWords(params),
            "# page.txtpb: the picture is for everybody in each network of this computer (0.0.0.0), without a password, TCP port 80\n"
            "# page.txtpb: nobody acknowledges alerts\n");
  EXPECT_EQ(params.host_names, std::vector<std::string>{"boat.lan"});
  EXPECT_TRUE(IsForOthers("192.0.2.7"));
  EXPECT_TRUE(IsForOthers("::"));
  EXPECT_FALSE(IsForOthers("127.0.0.53"));
  EXPECT_FALSE(IsForOthers("::1"));
}

TEST_F(PageParams, FindFilesBesideTheConfig) {
  const auto params = Load("token_file: 'token' map_file: '/maps/lake.mbtiles' look_back_folder: 'spool'");
  EXPECT_EQ(params.token_file, folder_ / "config/token");
  EXPECT_EQ(params.map_file, "/maps/lake.mbtiles");
  EXPECT_EQ(params.spool_folder, folder_ / "config/spool");
}

TEST_F(PageParams, RefuseWhatCannotBe) {
  ExpectFault("bind_address: 'localhost'", "page.txtpb:1: bind_address: 'localhost' is no numeric address");
  ExpectFault("bind_address: '239.1.2.3'", "is no address of a computer");
  ExpectFault("host_name: 'http://boat'", "is no name of a computer");
  ExpectFault("host_name: ''", "is no name of a computer");
  ExpectFault("max_clients: 17", "max_clients");
  ExpectFault("port: 0", "port");
  ExpectFault("token_file: ''", "must not be empty");
}

TEST_F(PageParams, ServeFoxgloveOnlyWhereTold) {
  EXPECT_FALSE(Load("").foxglove);
  const auto local = Load("foxglove {}").foxglove;
  ASSERT_TRUE(local);
  EXPECT_EQ(local->bind_address, "127.0.0.1");
  EXPECT_EQ(local->port, 8765);
  EXPECT_EQ(local->max_clients, 4);
  EXPECT_TRUE(local->allowed_origins.empty());
  const auto params = Load("foxglove { bind_address: '0.0.0.0' port: 9000 allowed_origin: 'https://app.foxglove.dev' allowed_origin: 'file://' }");
  EXPECT_EQ(params.foxglove->allowed_origins, (std::vector<std::string>{"https://app.foxglove.dev", "file://"}));
  EXPECT_NE(InWords(params).find("# page.txtpb: Foxglove and Lichtblick see it, too: everybody in each network of this computer (0.0.0.0), without a "
                                 "password, TCP port 9000\n"),
            std::string::npos)
      << InWords(params);
}

TEST_F(PageParams, RefuseWhatCannotBeOfFoxglove) {
  ExpectFault("foxglove { bind_address: 'lo' }", "foxglove.bind_address: 'lo' is no numeric address");
  ExpectFault("foxglove { port: 7668 }", "foxglove.port: must differ from port");
  ExpectFault("foxglove { port: 0 }", "port");
  ExpectFault("foxglove { max_clients: 17 }", "max_clients");
  for (const char* origin : {"*", "", "app.foxglove.dev", "https://app.foxglove.dev/", "https://*.foxglove.dev", "://a", "http://a b"})
    ExpectFault("foxglove { allowed_origin: '" + std::string(origin) + "' }", "is no origin: https://HOST or http://HOST:PORT, without a path");
}

TEST_F(PageParams, FollowTheRecorderUnlessTold) {
  EXPECT_TRUE(Load("").recorder_folder.has_value());
  EXPECT_FALSE(Load("follows_recorder: false").recorder_folder.has_value());
}

TEST(PageAddress, IsOneThatABrowserTakes) {
  EXPECT_EQ(AddressOnThisComputer("127.0.0.1", 7668), "http://localhost:7668/");
  EXPECT_EQ(AddressOnThisComputer("0.0.0.0", 80), "http://localhost:80/");
  EXPECT_EQ(AddressOnThisComputer("::1", 80), "http://[::1]:80/");
  EXPECT_EQ(AddressesForOthers("192.0.2.7", 81), std::vector<std::string>{"http://192.0.2.7:81/"});
  EXPECT_TRUE(AddressesForOthers("127.0.0.1", 81).empty());
}

}  // namespace
}  // namespace lookout::page
