#include <gtest/gtest.h>

#include "common/io/network.hpp"

namespace lookout::io {
namespace {

TEST(IpAddress, IsTheSameInEachOfItsTexts) {
  EXPECT_EQ(ParseIpAddress("fe80::1"), ParseIpAddress("FE80:0:0:0:0:0:0:1"));
  EXPECT_EQ(ParseIpAddress("192.168.1.201"), ParseIpAddress("::ffff:192.168.1.201"));
  EXPECT_NE(ParseIpAddress("192.168.1.201"), ParseIpAddress("192.168.1.202"));
  EXPECT_EQ(ToText(*ParseIpAddress("::ffff:10.0.0.7")), "10.0.0.7");
  EXPECT_EQ(ToText(*ParseIpAddress("FE80:0:0:0:0:0:0:1")), "fe80::1");
}

TEST(IpAddress, IsNumeric) {
  for (const char* text : {"", "localhost", "1.2.3", "1.2.3.256", "1.2.3.4 ", "1.2.3.4/24", "fe80::1%eth0", ":::"}) {
    EXPECT_FALSE(ParseIpAddress(text)) << text;
  }
}

TEST(IpAddress, KnowsMulticast) {
  for (const char* text : {"224.0.0.1", "239.255.255.255", "ff02::1"}) EXPECT_TRUE(ParseIpAddress(text)->is_multicast()) << text;
  for (const char* text : {"223.255.255.255", "240.0.0.1", "255.255.255.255", "fe80::1", "::"}) {
    EXPECT_FALSE(ParseIpAddress(text)->is_multicast()) << text;
  }
}

TEST(IpAddress, KnowsThatItIsNone) {
  for (const char* text : {"0.0.0.0", "::", "0:0::0"}) EXPECT_TRUE(ParseIpAddress(text)->is_any()) << text;
  for (const char* text : {"0.0.0.1", "::1", "127.0.0.1", "255.255.255.255"}) EXPECT_FALSE(ParseIpAddress(text)->is_any()) << text;
}

TEST(IpAddress, KnowsWhatLeadsToThisComputerAlone) {
  for (const char* text : {"127.0.0.1", "127.9.9.9", "::1", "::ffff:127.0.0.1"}) EXPECT_TRUE(IsLoopback(*ParseIpAddress(text))) << text;
  for (const char* text : {"0.0.0.0", "10.0.0.7", "128.0.0.1", "::", "fe80::1"}) EXPECT_FALSE(IsLoopback(*ParseIpAddress(text))) << text;
}

TEST(OwnAddresses, AreEachToldOnceAndNoneIsTheAddressOfAll) {
  const auto addresses = OwnAddresses();
  if (addresses.empty()) GTEST_SKIP() << "no interface is up";
  for (std::size_t i = 0; i < addresses.size(); ++i) {
    EXPECT_FALSE(addresses[i].is_any());
    EXPECT_EQ(std::count(addresses.begin(), addresses.end(), addresses[i]), 1) << ToText(addresses[i]);
  }
}

}  // namespace
}  // namespace lookout::io
