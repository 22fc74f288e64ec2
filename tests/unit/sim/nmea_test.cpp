#include "lab/sim/nmea.hpp"

#include <gtest/gtest.h>

namespace lookout::sim {
namespace {

using namespace std::chrono_literals;

GnssMeasurement Somewhere() {
  GnssMeasurement measurement{};
  measurement.time = Utime(1'781'532'600s) + 100ms;
  measurement.latitude_deg = 43.5;
  measurement.longitude_deg = -72.25;
  measurement.msl_height_m = 229.1234;
  measurement.geoid_separation_m = -28.0;
  measurement.speed_mps = 1852.0 / 3600.0;
  measurement.course_deg = 45.678;
  measurement.quality = 4;
  measurement.sd_m = 0.02;
  return measurement;
}

TEST(Nmea, SentenceEndsWithItsChecksum) {
  // The textbook sentence, with the checksum that every text gives for it.
  EXPECT_EQ(Sentence("GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W"),
            "$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A\r\n");
}

TEST(Nmea, RmcSaysTimePlaceSpeedCourseAndDate) {
  EXPECT_EQ(Rmc(Somewhere()).rfind("$GPRMC,141000.100,A,4330.0000000,N,07215.0000000,W,1.000,45.68,150626,,,R*", 0), 0U);
}

TEST(Nmea, GgaSaysQualityAndHeights) {
  EXPECT_EQ(Gga(Somewhere()).rfind("$GPGGA,141000.100,4330.0000000,N,07215.0000000,W,4,14,0.7,229.123,M,-28.000,M,,*", 0), 0U);
}

TEST(Nmea, VtgSaysSpeedTwice) { EXPECT_EQ(Vtg(Somewhere()).rfind("$GPVTG,45.68,T,,M,1.000,N,1.852,K,R*", 0), 0U); }

TEST(Nmea, PashrSaysSignedTiltAndDeviations) {
  const AttitudeMeasurement measurement{Utime(0s), 271.5, -3.25, 1.5, 0.04, true};
  EXPECT_EQ(Pashr(measurement, 0.05, 0.1).rfind("$PASHR,000000.000,271.50,T,-3.25,+1.50,+0.04,0.050,0.050,0.100,2,1*", 0), 0U);
  auto without_rtk = measurement;
  without_rtk.has_rtk = false;  // it used to claim RTK in any case
  EXPECT_NE(Pashr(without_rtk, 0.05, 0.1).find(",0.100,1,1*"), std::string::npos);
}

// Heights used to be told as twice as bad as they are.
TEST(Nmea, GstSaysDeviations) { EXPECT_EQ(Gst(Somewhere()).rfind("$GPGST,141000.100,0.020,0.020,0.020,0.0,0.020,0.020,0.020*", 0), 0U); }

TEST(Nmea, ZdaSaysTimeAndDate) { EXPECT_EQ(Zda(Somewhere().time).rfind("$GPZDA,141000.100,15,06,2026,00,00*", 0), 0U); }

TEST(Nmea, RotIsNegativeToPort) {
  EXPECT_EQ(Rot(-123.44).rfind("$GPROT,-123.4,A*", 0), 0U);
  EXPECT_EQ(Rot(7.0).rfind("$GPROT,7.0,A*", 0), 0U);
}

TEST(Nmea, VnImuHasTheWidthsAndTheChecksumOfTheDevice) {
  // A line of a real VN-200, as published with a reader for it.
  const ImuMeasurement measurement{{-0.0350, 0.4222, -0.6643}, {-0.015, 0.019, 9.948}, {0.002066, -0.008442, -0.044656}, 20.7, 84.322};
  EXPECT_EQ(VnImu(measurement), "$VNIMU,-00.0350,+00.4222,-00.6643,-00.015,+00.019,+09.948,+00.002066,-00.008442,-00.044656,+20.7,+084.322*66\r\n");
}

TEST(Nmea, WithoutFixOnlyTheTimeIsSaid) {
  auto measurement = Somewhere();
  measurement.quality = 0;
  EXPECT_EQ(Rmc(measurement).rfind("$GPRMC,141000.100,V,,,,,,,150626,,,N*", 0), 0U);
  EXPECT_EQ(Gga(measurement).rfind("$GPGGA,141000.100,,,,,0,00,99.9,,M,,M,,*", 0), 0U);
  EXPECT_EQ(Vtg(measurement).rfind("$GPVTG,,,,,,,,,N*", 0), 0U);
  EXPECT_EQ(Gst(measurement).rfind("$GPGST,141000.100,,,,,,,*", 0), 0U);
}

TEST(Nmea, MinutesNeverReachSixty) {
  auto measurement = Somewhere();
  measurement.latitude_deg = 43.0 - 1e-12;
  measurement.longitude_deg = 9.0 - 1e-12;
  EXPECT_NE(Gga(measurement).find(",4300.0000000,N,00900.0000000,E,"), std::string::npos);
}

TEST(Nmea, SouthAndWestHaveTheirLettersAndNoSign) {
  auto measurement = Somewhere();
  measurement.latitude_deg = -0.5;
  measurement.longitude_deg = -0.25;
  EXPECT_NE(Gga(measurement).find(",0030.0000000,S,00015.0000000,W,"), std::string::npos);
}

TEST(Nmea, CourseNeverReaches360) { EXPECT_EQ(Hdt(359.996).rfind("$GPHDT,0.00,T*", 0), 0U); }

}  // namespace
}  // namespace lookout::sim
