// Who may ask, by the headers of a request.
#include "services/page/core/access.hpp"

#include <gtest/gtest.h>
#include <string>

namespace {

using namespace lookout::page;

const OwnHosts kOwn{{"localhost", "127.0.0.1", "[::1]", "boat.local"}, 8080};

TEST(Access, AHostOfOursIsANameWithOurPort) {
  for (const char* host : {"localhost:8080", "LocalHost:8080", "127.0.0.1:8080", "[::1]:8080", "boat.local:8080"})
    EXPECT_TRUE(IsOwnHost(host, kOwn)) << host;
  for (const char* host : {"",
                           ":8080",
                           "localhost",
                           "localhost:",
                           "localhost:80",
                           "localhost:80800",
                           "localhost:08080",
                           "localhost:8080 ",
                           " localhost:8080",
                           "localhost:8080:8080",
                           "localhost.:8080",
                           "localhost:8080.evil.example",
                           "localhost.evil.example:8080",
                           "evil.example:8080",
                           "x@localhost:8080",
                           "localhost:8080@x",
                           "127.0.0.1.:8080",
                           "::1:8080",
                           "[::1]",
                           "[::1",
                           "localhost:8080,evil.example"})
    EXPECT_FALSE(IsOwnHost(host, kOwn)) << host;
}

TEST(Access, ThePortMayBeMissingWhereItIs80) {
  const OwnHosts own{{"localhost"}, 80};
  EXPECT_TRUE(IsOwnHost("localhost", own));
  EXPECT_TRUE(IsOwnHost("localhost:80", own));
  EXPECT_FALSE(IsOwnHost("localhost:", own));
}

TEST(Access, AnOriginIsOursWhenItsHostIs) {
  EXPECT_TRUE(IsOwnOrigin("http://localhost:8080", kOwn));
  EXPECT_TRUE(IsOwnOrigin("http://[::1]:8080", kOwn));
  for (const char* origin : {"", "null", "http://", "https://localhost:8080", "http://localhost:8080/", "http://localhost:8081",
                             "http://evil.example:8080", "localhost:8080", "file://localhost:8080", "http://localhost:8080 http://evil.example"})
    EXPECT_FALSE(IsOwnOrigin(origin, kOwn)) << origin;
}

TEST(Access, ATokenIsTheWholeToken) {
  EXPECT_TRUE(HasToken("Bearer abc", "abc"));
  EXPECT_TRUE(HasToken("bearer abc", "abc"));
  for (const char* given : {"", "Bearer", "Bearer ", "Bearer ab", "Bearer abcd", "Bearer abcabc", "Bearer Abc", "Basic abc", "abc", "Bearer  abc"})
    EXPECT_FALSE(HasToken(given, "abc")) << given;
  EXPECT_FALSE(HasToken("Bearer ", ""));
  EXPECT_FALSE(HasToken("", ""));
}

TEST(Access, ThePageMayReachItsOwnServerOnly) {
  std::string policy;
  for (const auto& [name, value] : SecurityHeaders("localhost:8080")) {
    if (name == "Content-Security-Policy") policy = value;
  }
  for (const char* words : {"default-src 'none'", "script-src 'self';", "style-src 'self';", "img-src 'self' data: blob:;",
                            "connect-src 'self' ws://localhost:8080;", "frame-ancestors 'none'", "base-uri 'none'", "form-action 'none'"})
    EXPECT_NE(policy.find(words), std::string::npos) << words;
  EXPECT_EQ(policy.find("unsafe"), std::string::npos);
}

TEST(Access, GzipIsAcceptedWhereItIsNamedAndNotRefused) {
  for (const char* value : {"gzip", "deflate, gzip", "br;q=1.0, GZIP;q=0.5", "x-gzip"}) EXPECT_TRUE(AcceptsGzip(value)) << value;
  for (const char* value : {"", "identity", "gzip;q=0", "gzip; q=0.000", "br", "gzipped", ",,;;"}) EXPECT_FALSE(AcceptsGzip(value)) << value;
}

TEST(Access, AListHoldsWholeWords) {
  EXPECT_TRUE(HoldsWord("a, lookout.page.v1 ,b", "lookout.page.v1"));
  EXPECT_FALSE(HoldsWord("lookout.page.v11", "lookout.page.v1"));
  EXPECT_FALSE(HoldsWord("", "lookout.page.v1"));
}

TEST(Access, ATileHasThreeNumbersWithinItsZoom) {
  TileAddress address;
  ASSERT_TRUE(ParseTilePath("/tiles/3/7/0", address));
  EXPECT_EQ(address.z, 3);
  EXPECT_EQ(address.x, 7);
  EXPECT_EQ(address.y, 0);
  for (const char* path : {"/tiles", "/tiles/", "/tiles/3/7", "/tiles/3/8/0", "/tiles/3/-1/0", "/tiles/3/7/0/", "/tiles/3/7/0/1", "/tiles/03/7/0",
                           "/tiles/25/0/0", "/tiles/3/7/0.png", "/tiles/3//0", "/tiles/../3/7/0", "/tiles/99999999999/0/0", "/tile/3/7/0"})
    EXPECT_FALSE(ParseTilePath(path, address)) << path;
}

}  // namespace
