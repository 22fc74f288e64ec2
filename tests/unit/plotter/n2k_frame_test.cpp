#include "services/plotter/core/n2k_frame.hpp"

#include <gtest/gtest.h>

namespace lookout::plotter {
namespace {

TEST(PlotterN2kFrame, HasADestinationInItsIdentifierOnlyWherePgnHasOne) {
  const N2kHeader request{.pgn = 59904, .priority = 6, .source = 254, .destination = 35};
  EXPECT_EQ(CanIdOf(request), 0x18EA23FEU);
  EXPECT_EQ(HeaderOf(0x18EA23FEU), request);
  const N2kHeader position{.pgn = 129025, .priority = 2, .source = 35};
  EXPECT_EQ(CanIdOf(position), 0x09F80123U);
  EXPECT_EQ(HeaderOf(0x09F80123U), position);
  // The destination of a PDU2 is no part of it.
  EXPECT_EQ(CanIdOf({.pgn = 129025, .priority = 2, .source = 35, .destination = 7}), 0x09F80123U);
}

TEST(PlotterN2kFrame, IsALineOfRawText) {
  EXPECT_EQ(RawLine({0x18EEFF23, {1, 0xAB}}), "18EEFF23 01 AB\r\n");
  EXPECT_EQ(RawLine({0x18EEFF23, {}}), "18EEFF23\r\n");
  EXPECT_EQ(ReadRawLine("18EEFF23 01 aB"), (N2kFrame{0x18EEFF23, {1, 0xAB}}));
  EXPECT_EQ(ReadRawLine("18EEFF23 "), (N2kFrame{0x18EEFF23, {}}));
}

TEST(PlotterN2kFrame, IsReadFromWhatAGatewayTells) {
  EXPECT_EQ(ReadHeardLine("17:33:21.107 R 19F51323 01 2F 30 70 00 2F 30 70"),
            (HeardFrame{{0x19F51323, {0x01, 0x2F, 0x30, 0x70, 0x00, 0x2F, 0x30, 0x70}}, false}));
  EXPECT_EQ(ReadHeardLine("17:33:21.108 T 19F51323 01 02"), (HeardFrame{{0x19F51323, {1, 2}}, true}));
}

TEST(PlotterN2kFrame, RefusesOtherLines) {
  for (const char* line :
       {"", "$GPRMC,1,2", "17:33:21.107 R", "17:33:21.107 X 19F51323 01", "17:33:21,107 R 19F51323 01", "7:33:21.107 R 19F51323 01 02",
        "17:33:21.107 R 39F51323 01", "17:33:21.107 R 19F5132 01", "17:33:21.107 R 19F51323 1", "17:33:21.107 R 19F51323 01  02",
        "17:33:21.107 R 19F51323 01 02 03 04 05 06 07 08 09", "17:33:21.107 R 19F51323 0x", "17:33:21.107 R 19F51323-01"}) {
    EXPECT_FALSE(ReadHeardLine(line)) << line;
  }
}

TEST(PlotterN2kFrame, CutsAFastPacketAtItsLimits) {
  const auto frames_of = [](std::size_t num_bytes) {
    return FramesOf({.pgn = 126996, .priority = 6, .is_fast_packet = true, .payload = std::vector<std::uint8_t>(num_bytes, 0x11)}, 35, 7);
  };
  EXPECT_EQ(frames_of(0).size(), 1U);
  EXPECT_EQ(frames_of(6).size(), 1U);
  EXPECT_EQ(frames_of(7).size(), 2U);
  EXPECT_EQ(frames_of(13).size(), 2U);
  const auto longest = frames_of(kMostFastPacketBytes);
  ASSERT_EQ(longest.size(), 32U);
  EXPECT_EQ(longest.front().bytes.at(0), 0xE0);
  EXPECT_EQ(longest.front().bytes.at(1), 223);
  EXPECT_EQ(longest.back().bytes.at(0), 0xFF);
  EXPECT_EQ(longest.back().bytes.at(7), 0x11);
}

}  // namespace
}  // namespace lookout::plotter
