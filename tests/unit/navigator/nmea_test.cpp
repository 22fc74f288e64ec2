#include "services/navigator/core/nmea.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::navigator {
namespace {

using namespace std::chrono_literals;

Sentence Parsed(SentenceType type, const std::string& line) {
  const auto result = ParseSentence(line);
  EXPECT_EQ(result.fault, SentenceFault::kNone) << line;
  EXPECT_EQ(result.sentence.type, type) << line;
  return result.sentence;
}

SentenceFault FaultOf(const std::string& body) { return ParseSentence(Line(body)).fault; }

bool IsOther(const std::string& line) {
  const auto result = ParseSentence(line);
  return result.fault == SentenceFault::kNone && result.sentence.type == SentenceType::kOther;
}

// The recording of a real VLP-16 with a receiver (MRPT's sample).
TEST(Rmc, HasAllItsValues) {
  const auto rmc = Parsed(SentenceType::kRmc, "$GPRMC,081802.00,A,3649.7478558,N,00224.4542928,W,0.034,212.5,210116,0.0,E,A*2E");
  EXPECT_EQ(rmc.time_of_day, 8h + 18min + 2s);
  EXPECT_EQ(rmc.date, std::chrono::sys_days(std::chrono::year(2016) / 1 / 21));
  EXPECT_EQ(rmc.quality, FixQuality::kGnss);
  ASSERT_TRUE(rmc.position);
  EXPECT_NEAR(rmc.position->latitude_deg, 36.82913093, 1e-8);
  EXPECT_NEAR(rmc.position->longitude_deg, -2.40757155, 1e-8);
  EXPECT_NEAR(rmc.speed_mps, 0.0175, 1e-4);
  EXPECT_NEAR(rmc.course_rad, DegToRad(212.5), 1e-12);
}

TEST(Rmc, OfZedF9pHasItsFixAlthoughTheNavigationalStatusIsV) {
  const auto rmc = Parsed(SentenceType::kRmc, "$GNRMC,003956.00,A,4552.65403,S,17030.00668,E,0.025,,120419,,,A,V*07");
  EXPECT_EQ(rmc.quality, FixQuality::kGnss);
  EXPECT_NEAR(rmc.position->latitude_deg, -45.877567167, 1e-9);
  EXPECT_TRUE(std::isnan(rmc.course_rad)) << "an empty field is unknown, not 0";
}

TEST(Rmc, WithoutAFixSaysNothing) {
  const auto rmc = Parsed(SentenceType::kRmc, "$GPRMC,,V,,,,,,,,,,N*53");
  EXPECT_EQ(rmc.quality, FixQuality::kNone);
  EXPECT_FALSE(rmc.time_of_day || rmc.date || rmc.position);
  EXPECT_TRUE(std::isnan(rmc.speed_mps) && std::isnan(rmc.course_rad));
}

TEST(Rmc, OfOldReceiversHasNoMode) {
  EXPECT_EQ(Parsed(SentenceType::kRmc, Line("GPRMC,195719,A,5310.8115,N,00525.7025,E,0.0,0.0,160414,0.7,E")).quality, FixQuality::kGnss);
}

TEST(Rmc, UsesItsQualityFromTheMode) {
  const auto quality = [](const std::string& status, const std::string& mode) {
    return Parsed(SentenceType::kRmc, Line("GPRMC,000000," + status + ",0000.0,N,00000.0,E,0.0,0.0,010126,,," + mode)).quality;
  };
  EXPECT_EQ(quality("A", "D"), FixQuality::kDifferential);
  EXPECT_EQ(quality("A", "P"), FixQuality::kPps);
  EXPECT_EQ(quality("A", "R"), FixQuality::kRtkFixed);
  EXPECT_EQ(quality("A", "F"), FixQuality::kRtkFloat);
  EXPECT_EQ(quality("A", "E"), FixQuality::kDeadReckoning);
  EXPECT_EQ(quality("A", "M"), FixQuality::kManual);
  EXPECT_EQ(quality("A", "S"), FixQuality::kSimulator);
  EXPECT_EQ(quality("A", "N"), FixQuality::kNone);
  EXPECT_EQ(quality("V", "A"), FixQuality::kNone);
  EXPECT_EQ(quality("", "A"), FixQuality::kNone);
}

TEST(Gga, HasAllItsValues) {
  const auto gga = Parsed(SentenceType::kGga, "$GNGGA,132819.60,4134.49795459,N,09345.03431408,W,2,10,0.9,278.161,M,-31.442,M,6.6,0133*6A");
  EXPECT_EQ(gga.time_of_day, 13h + 28min + 19600ms);
  EXPECT_EQ(gga.quality, FixQuality::kDifferential);
  EXPECT_NEAR(gga.position->latitude_deg, 41.574965910, 1e-9);
  EXPECT_NEAR(gga.position->longitude_deg, -93.750571901, 1e-9);
  EXPECT_EQ(gga.num_satellites, 10);
  EXPECT_DOUBLE_EQ(gga.hdop, 0.9);
  EXPECT_DOUBLE_EQ(gga.msl_height_m, 278.161);
  EXPECT_DOUBLE_EQ(gga.geoid_separation_m, -31.442);
}

TEST(Gga, WithoutAFixSaysNothing) {
  const auto gga = Parsed(SentenceType::kGga, "$GPGGA,,,,,,0,,,,M,,M,,*66");
  EXPECT_EQ(gga.quality, FixQuality::kNone);
  EXPECT_FALSE(gga.position);
  EXPECT_EQ(gga.num_satellites, -1);
  EXPECT_TRUE(std::isnan(gga.hdop) && std::isnan(gga.msl_height_m) && std::isnan(gga.geoid_separation_m));
}

TEST(Gga, OfNovatelNinesIsDifferential) {
  EXPECT_EQ(Parsed(SentenceType::kGga, Line("GPGGA,000000,0000.0,N,00000.0,E,9,08,1.0,1.0,M,1.0,M,,")).quality, FixQuality::kDifferential);
}

TEST(Vtg, HasCourseAndSpeed) {
  const auto vtg = Parsed(SentenceType::kVtg, "$GPVTG,251.34,T,,M,0.58,N,1.07,K,A*37");
  EXPECT_NEAR(vtg.course_rad, DegToRad(251.34), 1e-12);
  EXPECT_NEAR(vtg.speed_mps, 0.58 * 1852.0 / 3600.0, 1e-12);
}

TEST(Vtg, UsesKilometresPerHourWhereThereAreNoKnots) {
  EXPECT_NEAR(Parsed(SentenceType::kVtg, Line("GPVTG,1.0,T,,M,,N,36.0,K")).speed_mps, 10.0, 1e-12);
}

TEST(Vtg, WithoutAFixSaysNothing) {
  for (const char* line : {"$GPVTG,,T,,M,,N,,K,N*2C"}) {
    const auto vtg = Parsed(SentenceType::kVtg, line);
    EXPECT_TRUE(std::isnan(vtg.speed_mps) && std::isnan(vtg.course_rad));
  }
  EXPECT_TRUE(std::isnan(Parsed(SentenceType::kVtg, Line("GPVTG,1.0,T,,M,2.0,N,,K,N")).speed_mps));
}

TEST(Hdt, HasTheHeading) {
  EXPECT_NEAR(Parsed(SentenceType::kHdt, "$GPHDT,274.07,T*03").heading_rad, DegToRad(274.07), 1e-12);
  EXPECT_TRUE(std::isnan(Parsed(SentenceType::kHdt, "$GPHDT,,T*1B").heading_rad));
  EXPECT_EQ(Parsed(SentenceType::kHdt, Line("HEHDT,360.0,T")).heading_rad, 0.0);
}

// NovAtel's example (OEM7 manual, PASHR).
TEST(Pashr, HasAllItsValues) {
  const auto pashr = Parsed(SentenceType::kPashr, "$PASHR,163029.000,158.09,T,-0.30,+0.31,+0.01,0.029,0.029,0.059,1,1*3B");
  EXPECT_EQ(pashr.time_of_day, 16h + 30min + 29s);
  EXPECT_NEAR(pashr.heading_rad, DegToRad(158.09), 1e-12);
  EXPECT_NEAR(pashr.roll_rad, DegToRad(-0.30), 1e-12);
  EXPECT_NEAR(pashr.pitch_rad, DegToRad(0.31), 1e-12);
  EXPECT_DOUBLE_EQ(pashr.heave_m, 0.01);
  EXPECT_NEAR(pashr.roll_sd_rad, DegToRad(0.029), 1e-12);
  EXPECT_NEAR(pashr.pitch_sd_rad, DegToRad(0.029), 1e-12);
  EXPECT_NEAR(pashr.heading_sd_rad, DegToRad(0.059), 1e-12);
}

TEST(Pashr, MayLackTheLastFieldAndAnyValue) {
  const auto pashr = Parsed(SentenceType::kPashr, Line("PASHR,,,T,,,,,,,0"));
  EXPECT_FALSE(pashr.time_of_day);
  EXPECT_TRUE(std::isnan(pashr.heading_rad) && std::isnan(pashr.roll_rad) && std::isnan(pashr.heave_m) && std::isnan(pashr.heading_sd_rad));
}

TEST(Rmc, HasItsDeclinationAndIsNotRefusedForIt) {
  EXPECT_NEAR(Parsed(SentenceType::kRmc, Line("GPRMC,000000,A,0000.0,N,00000.0,E,0.0,0.0,010126,2.5,W,A")).declination_rad, DegToRad(-2.5), 1e-12);
  EXPECT_TRUE(std::isnan(Parsed(SentenceType::kRmc, Line("GPRMC,000000,A,0000.0,N,00000.0,E,0.0,0.0,010126,-2.5,E,A")).declination_rad));
  EXPECT_TRUE(std::isnan(Parsed(SentenceType::kRmc, Line("GPRMC,000000,A,0000.0,N,00000.0,E,0.0,0.0,010126,,,A")).declination_rad));
}

TEST(Gst, HasTheDeviations) {
  const auto gst = Parsed(SentenceType::kGst, "$GPGST,172814.0,0.006,0.023,0.020,273.6,0.023,0.020,0.031*6A");
  EXPECT_EQ(gst.time_of_day, 17h + 28min + 14s);
  EXPECT_DOUBLE_EQ(gst.horizontal_sd_m, std::sqrt((0.023 * 0.023 + 0.020 * 0.020) / 2.0));
  EXPECT_DOUBLE_EQ(gst.vertical_sd_m, 0.031);
  const auto zeros = Parsed(SentenceType::kGst, Line("GPGST,172814.0,,,,,0,0,0"));
  EXPECT_TRUE(std::isnan(zeros.horizontal_sd_m) && std::isnan(zeros.vertical_sd_m)) << "a receiver does not know its place exactly";
}

TEST(Gll, HasPositionTimeAndQuality) {
  const auto gll = Parsed(SentenceType::kGll, "$ECGLL,5119.881,N,00125.169,E,164326,A,D*52");
  EXPECT_EQ(gll.time_of_day, 16h + 43min + 26s);
  EXPECT_EQ(gll.quality, FixQuality::kDifferential);
  EXPECT_NEAR(gll.position->latitude_deg, 51.33135, 1e-9);
  EXPECT_NEAR(gll.position->longitude_deg, 1.419483333, 1e-9);
  EXPECT_EQ(Parsed(SentenceType::kGll, Line("GPGLL,,,,,164326,V,N")).quality, FixQuality::kNone);
  const auto old = Parsed(SentenceType::kGll, Line("LCGLL,4728.31,N,12254.25,W"));
  EXPECT_EQ(old.quality, FixQuality::kGnss) << "before NMEA 0183 2.0";
  EXPECT_FALSE(old.time_of_day);
}

TEST(Zda, HasDateAndTime) {
  const auto zda = Parsed(SentenceType::kZda, "$GPZDA,193913.00,07,09,2018,00,00*63");
  EXPECT_EQ(zda.time_of_day, 19h + 39min + 13s);
  EXPECT_EQ(zda.date, std::chrono::sys_days(std::chrono::year(2018) / 9 / 7));
  EXPECT_FALSE(Parsed(SentenceType::kZda, Line("GPZDA,,,,,,")).date);
}

TEST(Ths, CountsWhereItWasMeasured) {
  EXPECT_NEAR(Parsed(SentenceType::kHdt, Line("GPTHS,77.52,A")).heading_rad, DegToRad(77.52), 1e-12);
  for (const char* mode : {"E", "M", "S", "V", ""}) {
    EXPECT_TRUE(std::isnan(Parsed(SentenceType::kHdt, Line(std::string("GPTHS,77.52,") + mode)).heading_rad)) << mode;
  }
}

TEST(MagneticHeading, HasSidesThatAreSigns) {
  const auto hdg = Parsed(SentenceType::kMagnetic, Line("HCHDG,98.3,1.5,W,12.6,E"));
  EXPECT_NEAR(hdg.heading_rad, DegToRad(98.3), 1e-12);
  EXPECT_NEAR(hdg.deviation_rad, DegToRad(-1.5), 1e-12);
  EXPECT_NEAR(hdg.declination_rad, DegToRad(12.6), 1e-12);
  const auto bare = Parsed(SentenceType::kMagnetic, Line("HCHDG,98.3,,,,"));
  EXPECT_TRUE(std::isnan(bare.deviation_rad) && std::isnan(bare.declination_rad));
  const auto hdm = Parsed(SentenceType::kMagnetic, "$04HDM,186.5,M*2C");
  EXPECT_NEAR(hdm.heading_rad, DegToRad(186.5), 1e-12);
  EXPECT_TRUE(std::isnan(hdm.deviation_rad));
}

TEST(Rot, IsPositiveToStarboardAndVoidWhereItSaysSo) {
  EXPECT_NEAR(Parsed(SentenceType::kRot, Line("TIROT,-60.0,A")).turn_rate_radps, DegToRad(-1.0), 1e-12);
  EXPECT_NEAR(Parsed(SentenceType::kRot, "$APROT,0.013,A*35").turn_rate_radps, DegToRad(0.013 / 60.0), 1e-12);
  EXPECT_TRUE(std::isnan(Parsed(SentenceType::kRot, Line("TIROT,-60.0,V")).turn_rate_radps));
}

TEST(PsatHpr, HasItsAngles) {
  const auto hpr = Parsed(SentenceType::kPsatHpr, Line("PSAT,HPR,201400.00,74.58,-2.33,1.10,N"));
  EXPECT_EQ(hpr.time_of_day, 20h + 14min);
  EXPECT_NEAR(hpr.heading_rad, DegToRad(74.58), 1e-12);
  EXPECT_NEAR(hpr.pitch_rad, DegToRad(-2.33), 1e-12);
  EXPECT_NEAR(hpr.roll_rad, DegToRad(1.10), 1e-12);
  EXPECT_TRUE(std::isnan(Parsed(SentenceType::kPsatHpr, Line("PSAT,HPR,201400.00,,,,")).heading_rad));
}

// VectorNav's own examples (user manuals UM001 and UM005).
TEST(VectorNav, HasWhatItsSensorsMeasure) {
  const auto with_status = [](const char* status) {
    return Parsed(SentenceType::kVnIns,
                  Line(std::string("VNINS,333733.000159,1694,") + status +
                       ",+009.500,-004.754,-000.225,+32.95602815,-096.71424297,+00171.195,-000.840,-000.396,-000.109,07.8,01.6,0.23"));
  };
  const auto ins = with_status("0006");
  // 333733 s into week 1694 (2012-06-24), 15 s ahead of UTC then: three days and 20 h 42 min 13 s, less 15 s.
  EXPECT_EQ(*ins.date + *ins.time_of_day, std::chrono::sys_days(std::chrono::year(2012) / 6 / 27) + 20h + 41min + 58s + 159us);
  EXPECT_EQ(ins.quality, FixQuality::kGnss);
  EXPECT_NEAR(ins.heading_rad, DegToRad(9.5), 1e-12);
  EXPECT_NEAR(ins.pitch_rad, DegToRad(-4.754), 1e-12);
  EXPECT_NEAR(ins.position->longitude_deg, -96.71424297, 1e-12);
  EXPECT_DOUBLE_EQ(ins.direct_ellipsoid_height_m, 171.195);
  EXPECT_NEAR(ins.speed_mps, std::hypot(0.840, 0.396), 1e-12);
  EXPECT_NEAR(ins.course_rad, WrapTo2Pi(std::atan2(-0.396, -0.840)), 1e-12);
  EXPECT_NEAR(ins.heading_sd_rad, DegToRad(7.8), 1e-12);
  EXPECT_DOUBLE_EQ(ins.horizontal_sd_m, 1.6);
  EXPECT_DOUBLE_EQ(ins.velocity_sd_mps, 0.23);
  EXPECT_EQ(with_status("0007").quality, FixQuality::kDeadReckoning) << "GNSS is lost";
  for (const char* status : {"0004", "000E", "0046"}) {
    const auto void_ins = with_status(status);
    EXPECT_EQ(void_ins.quality, FixQuality::kNone) << "does not track, or has a fault: " << status;
    EXPECT_FALSE(void_ins.position);
    EXPECT_TRUE(std::isnan(void_ins.heading_rad) && std::isnan(void_ins.speed_mps));
    EXPECT_NEAR(void_ins.pitch_rad, DegToRad(-4.754), 1e-12) << "comes from gravity";
  }
  const auto ymr = Parsed(SentenceType::kVnYmr,
                          Line("VNYMR,+006.380,+000.023,-001.953,+1.0640,-0.2531,+3.0614,+00.005,+00.344,-09.758,-0.001222,-0.000450,-0.001218"));
  EXPECT_NEAR(ymr.roll_rad, DegToRad(-1.953), 1e-12);
  EXPECT_NEAR(ymr.imu->specific_force_mps2.z(), -9.758, 1e-12);
  EXPECT_NEAR(ymr.imu->angular_velocity_radps.x(), -0.001222, 1e-12);
  EXPECT_NEAR(Parsed(SentenceType::kVnYmr, Line("VNYMR,-090.000,0,0,0,0,0,0,0,0,0,0,0")).heading_rad, DegToRad(270.0), 1e-12);
  const auto imu =
      Parsed(SentenceType::kVnImu, Line("VNIMU,-00.7703,-01.0250,+03.0614,-00.129,+00.344,-09.757,+00.001320,-00.000450,-00.001218,+20.6,+098.921"));
  EXPECT_NEAR(imu.imu->specific_force_mps2.y(), 0.344, 1e-12);
}

TEST(VectorNav, HasGpsTimeThatTurnsIntoUtcAcrossALeapSecond) {
  const auto utc = [](const char* time_of_week, int week) {
    const auto ins = Parsed(SentenceType::kVnIns, Line(Print("VNINS,%s,%d,0002,0,0,0,1,1,0,0,0,0,1,1,1", time_of_week, week)));
    return *ins.date + *ins.time_of_day;
  };
  // Week 1930 began on 2017-01-01, 00:00 GPS time. The leap second came between 16.999 and 18 s of it.
  const auto new_year = std::chrono::sys_days(std::chrono::year(2017) / 1 / 1);
  EXPECT_EQ(utc("16.5", 1930), new_year - 500ms);
  EXPECT_EQ(utc("18.0", 1930), new_year);
  EXPECT_FALSE(Parsed(SentenceType::kVnIns, Line("VNINS,5.0,0,0000,0,0,0,0,0,0,0,0,0,0,0,0")).date) << "week 0: not known yet";
  EXPECT_FALSE(Parsed(SentenceType::kVnIns, Line("VNINS,5.0,0,0000,0,0,0,0,0,0,0,0,0,0,0,0")).position);
}

TEST(ParseSentence, MayDoWithoutAChecksumWhereThatIsAllowed) {
  EXPECT_EQ(ParseSentence("$GPHDT,1.0,T", false).fault, SentenceFault::kNone);
  EXPECT_EQ(ParseSentence("$GPHDT,1.0,T*00", false).fault, SentenceFault::kBadChecksum) << "a wrong one is still wrong";
  EXPECT_EQ(ParseSentence("", false).fault, SentenceFault::kNoChecksum);
  EXPECT_EQ(ParseSentence("$", false).fault, SentenceFault::kNone);
}

TEST(ParseSentence, DoesNotAskWhoTalks) {
  for (const char* talker : {"GP", "GN", "GL", "GA", "BD", "HE", "II", "04"}) Parsed(SentenceType::kHdt, Line(std::string(talker) + "HDT,1.0,T"));
}

TEST(ParseSentence, LeavesOtherTypesAlone) {
  EXPECT_TRUE(IsOther("!AIVDM,1,1,1,,13aI8e?P00PGpU:NR6s00?vT2000,0,0*1C"));
  EXPECT_TRUE(IsOther(Line("IIXDR,C,19.52,C,TempAir")));
  for (const char* body : {"", ",", "P", "PUBX,00", "GPHDTX,1", "HDT,1.0,T", "XGPHDT,x", "PASHR,POS,0,05", "PHDT,1", "PSAT", "PSAT,GBS,1", "VNXYZ,1",
                           "PGHDT,nonsense"}) {
    EXPECT_TRUE(IsOther(Line(body))) << body;
  }
  EXPECT_TRUE(IsOther(Line("GPHDT,nonsense", '!'))) << "an encapsulated sentence";
}

struct Refused {
  const char* body;
  SentenceFault fault;
};

class RefusedSentence : public ::testing::TestWithParam<Refused> {};

TEST_P(RefusedSentence, IsRefusedForItsReason) { EXPECT_EQ(FaultOf(GetParam().body), GetParam().fault) << GetParam().body; }

constexpr auto kBadField = SentenceFault::kBadField;
constexpr auto kImplausible = SentenceFault::kImplausible;

INSTANTIATE_TEST_SUITE_P(
    Rmc, RefusedSentence,
    ::testing::Values(Refused{"GPRMC,000231.099,A,4829.0005,N,00022.0015,E,0.15,212.28,2208-1,,,A", kBadField},  // a real one: gpsd april6_2019.log
                      Refused{"GPRMC,000000,A,0000.0,N,00000.0,E,0.0,0.0,010126,", kBadField},                   // too few fields
                      Refused{"GPRMC", kBadField},                                                               //
                      Refused{"GPRMC,000000,B,0000.0,N,00000.0,E,0.0,0.0,010126,,,A", kBadField},                // status
                      Refused{"GPRMC,000000,A,0000.0,N,00000.0,E,0.0,0.0,010126,,,Q", kBadField},                // mode
                      Refused{"GPRMC,00000,A,0000.0,N,00000.0,E,0.0,0.0,010126,,,A", kBadField},                 // time
                      Refused{"GPRMC,0000-1,A,0000.0,N,00000.0,E,0.0,0.0,010126,,,A", kBadField},                //
                      Refused{"GPRMC,000000.0x,A,0000.0,N,00000.0,E,0.0,0.0,010126,,,A", kBadField},             //
                      Refused{"GPRMC,240000,A,0000.0,N,00000.0,E,0.0,0.0,010126,,,A", kImplausible},             //
                      Refused{"GPRMC,236000,A,0000.0,N,00000.0,E,0.0,0.0,010126,,,A", kImplausible},             //
                      Refused{"GPRMC,120060,A,0000.0,N,00000.0,E,0.0,0.0,010126,,,A", kImplausible},             // 60 in the last minute only
                      Refused{"GPRMC,000000,A,0000.0,N,00000.0,E,0.0,0.0,300226,,,A", kImplausible},             // 30 February
                      Refused{"GPRMC,000000,A,0000.0,N,00000.0,E,0.0,0.0,000000,,,A", kImplausible},             //
                      Refused{"GPRMC,000000,A,0000.0,N,00000.0,E,-1.0,0.0,010126,,,A", kImplausible},            // speed
                      Refused{"GPRMC,000000,A,0000.0,N,00000.0,E,999.9,0.0,010126,,,A", kImplausible},           //
                      Refused{"GPRMC,000000,A,0000.0,N,00000.0,E,1e1,0.0,010126,,,A", kBadField},                //
                      Refused{"GPRMC,000000,A,0000.0,N,00000.0,E,nan,0.0,010126,,,A", kBadField},                //
                      Refused{"GPRMC,000000,A,0000.0,N,00000.0,E,0.0,360.1,010126,,,A", kImplausible}));         // course

INSTANTIATE_TEST_SUITE_P(Position, RefusedSentence,
                         ::testing::Values(Refused{"GPGGA,000000,9000.1,N,00000.0,E,1,,,,,,,,", kImplausible},   //
                                           Refused{"GPGGA,000000,0060.0,N,00000.0,E,1,,,,,,,,", kImplausible},   //
                                           Refused{"GPGGA,000000,0000.0,N,18000.1,E,1,,,,,,,,", kImplausible},   //
                                           Refused{"GPGGA,000000,0000.0,N,00060.0,E,1,,,,,,,,", kImplausible},   //
                                           Refused{"GPGGA,000000,060.0,N,00000.0,E,1,,,,,,,,", kImplausible},    //
                                           Refused{"GPGGA,000000,0000.0,N,18100.0,E,1,,,,,,,,", kImplausible},   //
                                           Refused{"GPGGA,000000,0000000100.0,N,0.0,E,1,,,,,,,,", kBadField},    //
                                           Refused{"GPGGA,000000,0000.0,N,.,E,1,,,,,,,,", kBadField},            //
                                           Refused{"GPGGA,000000,54 30.0,N,00000.0,E,1,,,,,,,,", kBadField},     // a space within
                                           Refused{"GPGGA,000000,-000.0,N,00000.0,E,1,,,,,,,,", kBadField},      //
                                           Refused{"GPGGA,000000,0000.0,E,00000.0,N,1,,,,,,,,", kBadField},      //
                                           Refused{"GPGGA,000000,0000.0,,00000.0,E,1,,,,,,,,", kBadField},       // half a position
                                           Refused{"GPGGA,000000,0000.0,N,,,1,,,,,,,,", kBadField},              //
                                           Refused{"GPGGA,000000,0000.0.0,N,00000.0,E,1,,,,,,,,", kBadField}));  //

INSTANTIATE_TEST_SUITE_P(Gga, RefusedSentence,
                         ::testing::Values(Refused{"GPGGA,000000,0000.0,N,00000.0,E,10,,,,,,,,", kImplausible},          //
                                           Refused{"GPGGA,000000,0000.0,N,00000.0,E,x,,,,,,,,", kBadField},              //
                                           Refused{"GPGGA,000000,0000.0,N,00000.0,E,9999999999,,,,,,,,", kBadField},     //
                                           Refused{"GPGGA,000000,0000.0,N,00000.0,E,1,100,,,,,,,", kImplausible},        //
                                           Refused{"GPGGA,000000,0000.0,N,00000.0,E,1,,-1,,,,,,", kImplausible},         //
                                           Refused{"GPGGA,000000,0000.0,N,00000.0,E,1,,,10.0,,,,,", kBadField},          // no unit
                                           Refused{"GPGGA,000000,0000.0,N,00000.0,E,1,,,10.0,F,,,,", kBadField},         // feet
                                           Refused{"GPGGA,000000,0000.0,N,00000.0,E,1,,,99999,M,,,,", kImplausible},     //
                                           Refused{"GPGGA,000000,0000.0,N,00000.0,E,1,,,10.0,M,500,M,,", kImplausible},  //
                                           Refused{"GPGGA,000000,0000.0,N,00000.0,E,1,", kBadField}));                   // too few

INSTANTIATE_TEST_SUITE_P(OtherTypes, RefusedSentence,
                         ::testing::Values(Refused{"GPHDT,1.0", kBadField}, Refused{"GPHDT,1.0,M", kBadField}, Refused{"GPHDT,1.0,", kBadField},
                                           Refused{"GPHDT,360.5,T", kImplausible}, Refused{"GPHDT,-1.0,T", kImplausible},
                                           Refused{"GPHDT,.,T", kBadField}, Refused{"GPHDT,+-1,T", kBadField},
                                           Refused{"GPVTG,1.0,M,,M,0.0,N,0.0,K", kBadField}, Refused{"GPVTG,1.0,2.0,0.5,1.0", kBadField},
                                           Refused{"PASHR,000000,1.0,T,181.0,0.0,0.0,0.1,0.1,0.1,1,1", kImplausible},
                                           Refused{"PASHR,000000,1.0,T,0.0,91.0,0.0,0.1,0.1,0.1,1,1", kImplausible},
                                           Refused{"PASHR,000000,1.0,T,0.0,0.0,0.0,-0.1,0.1,0.1,1,1", kImplausible},
                                           Refused{"PASHR,000000,1.0,T,0.0,0.0,0.0,0.1,0.1,0.1", kBadField},
                                           Refused{"PASHR,000000,1.0,,0.0,0.0,0.0,0.1,0.1,0.1,1,1", kBadField}));

INSTANTIATE_TEST_SUITE_P(
    LaterTypes, RefusedSentence,
    ::testing::Values(Refused{"GPGST,000000,1,1,1,0,-1,1,1", kImplausible}, Refused{"GPGST,000000,1,1,1,0,1,1", kBadField},
                      Refused{"GPGLL,0000.0,N,00000.0,E,000000,Q", kBadField}, Refused{"GPGLL,0000.0,N,00000.0", kBadField},
                      Refused{"GPGLL,0000.0,N,00000.0,E,000000", kBadField}, Refused{"GPZDA,000000,31,02,2026,00,00", kImplausible},
                      Refused{"GPZDA,000000,31,,2026,00,00", kBadField}, Refused{"GPZDA,000000,01,01,1979,00,00", kImplausible},
                      Refused{"GPZDA,000000,01,01,2026", kBadField}, Refused{"GPTHS,361,A", kImplausible}, Refused{"GPTHS,1", kBadField},
                      Refused{"HCHDG,1.0,1.0,,,", kBadField}, Refused{"HCHDG,1.0,-1.0,E,,", kImplausible}, Refused{"HCHDG,1.0,,", kBadField},
                      Refused{"HCHDM,1.0,T", kBadField}, Refused{"TIROT,x,A", kBadField}, Refused{"TIROT,1,B", kBadField},
                      Refused{"PSAT,HPR,000000,361,0,0,N", kImplausible}, Refused{"PSAT,HPR,000000,1,0,0", kBadField},
                      Refused{"VNINS,604801,1694,0002,0,0,0,1,1,0,0,0,0,1,1,1", kImplausible},
                      Refused{"VNINS,1,1694,00GZ,0,0,0,1,1,0,0,0,0,1,1,1", kBadField}, Refused{"VNINS,1,1694,0002,0,0,0,1,1", kBadField},
                      Refused{"VNINS,1,1694,0002,0,0,0,91,1,0,0,0,0,1,1,1", kImplausible}, Refused{"VNYMR,0,0,0", kBadField},
                      Refused{"VNYMR,0,0,0,0,0,0,0,0,2000,0,0,0", kImplausible}, Refused{"VNIMU,0,0,0,0,0,0,0,0,0", kBadField}));

TEST(TimeOfDay, MayBeTheLeapSecond) {
  EXPECT_EQ(Parsed(SentenceType::kRmc, Line("GPRMC,235960.50,A,0000.0,N,00000.0,E,0.0,0.0,311216,,,A")).time_of_day, 24h + 500ms);
}

TEST(TimeOfDay, DropsPartsOfAMicrosecond) {
  EXPECT_EQ(Parsed(SentenceType::kRmc, Line("GPRMC,000000.123456789,A,0000.0,N,00000.0,E,0.0,0.0,311216,,,A")).time_of_day, 123456us);
}

TEST(Date, TurnsTheCenturyAtEighty) {
  const auto year = [](const std::string& short_year) {
    const auto date = Parsed(SentenceType::kRmc, Line("GPRMC,000000,A,0000.0,N,00000.0,E,0.0,0.0,0101" + short_year + ",,,A")).date;
    return static_cast<int>(std::chrono::year_month_day(*date).year());
  };
  EXPECT_EQ(year("79"), 2079);
  EXPECT_EQ(year("80"), 1980);
  EXPECT_EQ(year("99"), 1999);
  EXPECT_EQ(year("00"), 2000);
}

TEST(Position, ReachesThePolesAndTheDateLine) {
  const auto rmc = Parsed(SentenceType::kRmc, Line("GPRMC,000000,A,9000.0000,S,18000.0000,W,0.0,0.0,010126,,,A"));
  EXPECT_EQ(rmc.position->latitude_deg, -90.0);
  EXPECT_EQ(rmc.position->longitude_deg, -180.0);
}

// Of plotters, gateways and hobby programs: all were refused as bad_field.
TEST(Position, HasDegreesPaddedToAnyWidthOrNot) {
  const auto place = [](const std::string& latitude, const std::string& longitude) {
    return *Parsed(SentenceType::kGll, Line("GPGLL," + latitude + ",N," + longitude + ",E,000000,A")).position;
  };
  for (const char* longitude : {"01012.000", "1012.000", "001012.000", "0001012", "1012"}) {
    EXPECT_DOUBLE_EQ(place("5430.000", longitude).longitude_deg, 10.2) << longitude;
  }
  for (const char* longitude : {"00000.840", "0.840000", ".84", "00.84", "000.840"}) {
    EXPECT_DOUBLE_EQ(place("5042.000", longitude).longitude_deg, 0.014) << longitude;
  }
  for (const char* latitude : {"5430.0", "05430.0", "005430.0"}) EXPECT_DOUBLE_EQ(place(latitude, "01012.0").latitude_deg, 54.5) << latitude;
  for (const char* latitude : {"0130.0", "130.0", "00130.0"}) EXPECT_DOUBLE_EQ(place(latitude, "10312.0").latitude_deg, 1.5) << latitude;
  EXPECT_DOUBLE_EQ(place("30.0", "10312.0").latitude_deg, 0.5);
}

// 54.5 N 10.2 E would be taken for 0 deg 54.5 min N 0 deg 10.2 min E.
TEST(Position, InDegreesAndTheirFractionIsRefused) {
  for (const char* place : {"54.5,N,10.2,E", "54.5000000,N,010.2,E", "4.5,S,102.5,W", "0.5,N,.2,W"}) {
    EXPECT_EQ(FaultOf("GPGLL," + std::string(place) + ",000000,A"), SentenceFault::kBadField) << place;
  }
}

// A plotter fills courses below 100 with a space: bad_field, and no fix.
TEST(Fields, MayBeFilledWithSpaces) {
  const auto rmc = Parsed(SentenceType::kRmc, Line("GNRMC,100000.00 ,A , 5430.0000000,N,01012.0000000 ,E,3.890, 90.0, 290826,  ,E,A "));
  EXPECT_NEAR(rmc.course_rad, DegToRad(90.0), 1e-12);
  EXPECT_DOUBLE_EQ(rmc.position->latitude_deg, 54.5);
  EXPECT_TRUE(std::isnan(rmc.declination_rad)) << "nothing but spaces is nothing";
  EXPECT_NEAR(Parsed(SentenceType::kHdt, Line("HEHDT,   9.0, T")).heading_rad, DegToRad(9.0), 1e-12);
  EXPECT_EQ(FaultOf("HEHDT,9 .0,T"), SentenceFault::kBadField) << "within a number it is damage";
}

// A gateway writes 0.01 where it knows none: the fix was good to 0.025 m.
TEST(Gga, BelowTheHdopOfAnySkyHasNone) {
  const auto hdop = [](const std::string& text) {
    return Parsed(SentenceType::kGga, Line("GPGGA,000000,5430.0,N,01012.0,E,1,10," + text + ",1.0,M,1.0,M,,")).hdop;
  };
  for (const char* text : {"0", "0.0", "0.01", "0.1", "0.34"}) EXPECT_TRUE(std::isnan(hdop(text))) << text;
  EXPECT_DOUBLE_EQ(hdop("0.4"), 0.4) << "receivers of four systems";
  EXPECT_TRUE(std::isnan(Parsed(SentenceType::kGns, Line("GNGNS,000000,5430.0,N,01012.0,E,AA,10,0.01,1.0,1.0,,")).hdop));
}

// With spaces around its words such a sentence was one of other types, and nobody was told.
TEST(Xdr, MayBeFilledWithSpaces) {
  const auto xdr = Parsed(SentenceType::kXdr, Line("IIXDR, A , 2.5,D , PTCH,A,-1.0 ,D,ROLL #2 "));
  EXPECT_NEAR(xdr.pitch_rad, DegToRad(2.5), 1e-12);
  EXPECT_NEAR(xdr.roll_rad, DegToRad(-1.0), 1e-12);
}

}  // namespace
}  // namespace lookout::navigator
