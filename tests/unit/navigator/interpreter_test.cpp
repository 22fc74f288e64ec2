
#include <cmath>
#include <gtest/gtest.h>

#include "common/core/angles.hpp"
#include "tests/unit/navigator/interpreter_fixture.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::navigator {
namespace {

using namespace std::chrono_literals;

TEST_F(InterpreterTest, MakesOneFixOfTheSentencesOfAnEpochInWhateverOrder) {
  const auto rmc = RmcLine(NoonPlus(0), 50.0, 8.0, 2.0, 30.0);
  const auto gga = GgaLine(NoonPlus(0), 50.0, 8.0, 4, 0.8, 100.0, 47.0);
  for (const bool is_rmc_first : {true, false}) {
    interpreter_ = Interpreter(TestParams());
    const auto first = Read(0.1, is_rmc_first ? rmc : gga).fix;
    const auto second = Read(0.11, is_rmc_first ? gga : rmc).fix;
    ASSERT_TRUE(first && second);
    EXPECT_EQ(second->quality, FixQuality::kRtkFixed) << "GGA tells more";
    EXPECT_NEAR(second->speed_mps, 2.0, 1e-5);
    EXPECT_NEAR(second->EllipsoidHeightM(), 147.0, 1e-9);
    EXPECT_LT(second->horizontal_sd_m, 0.05);
  }
}

TEST_F(InterpreterTest, DoesNotPairSourcesOrEpochs) {
  Read(0.1, RmcLine(NoonPlus(0), 50.0, 8.0, 2.0, 30.0), "a");
  EXPECT_TRUE(std::isnan(Read(0.1, GgaLine(NoonPlus(0), 50.0, 8.0, 4, 0.8, 100.0, 47.0), "b").fix->speed_mps));
  const auto next = Read(0.3, GgaLine(NoonPlus(0.2), 50.0, 8.0, 4, 0.8, 100.0, 47.0), "a").fix;
  EXPECT_TRUE(std::isnan(next->speed_mps));
}

TEST_F(InterpreterTest, UsesDeviationsOutOfGst) {
  Read(0.1, Line("GPGST," + TimeOfDay(NoonPlus(0)) + ",1,1,1,0,3.0,4.0,5.0"));
  const auto fix = Read(0.2, GgaLine(NoonPlus(0), 50.0, 8.0, 1, 0.8, 100.0, 47.0)).fix;
  EXPECT_NEAR(fix->horizontal_sd_m, std::sqrt(12.5), 1e-12);
  EXPECT_EQ(fix->vertical_sd_m, 5.0);
  EXPECT_EQ(Read(6.0, GgaLine(NoonPlus(5.9), 50.0, 8.0, 1, 1.0, 100.0, 47.0)).fix->horizontal_sd_m, 2.5) << "of old";
}

TEST_F(InterpreterTest, VtgHasTheInstantOfItsEpoch) {
  Read(0.2, GgaLine(NoonPlus(0), 50.0, 8.0, 1, 0.8, 100.0, 47.0));
  EXPECT_EQ(Read(0.21, Line("GPVTG,30.0,T,,M,4.0,N,,K")).velocity->time, NoonPlus(0));
  EXPECT_EQ(Read(0.4, Line("GPVTG,30.0,T,,M,4.0,N,,K")).velocity->time, NoonPlus(0.4));
  Read(1.2, RmcLine(NoonPlus(1.0), 50.0, 8.0, 2.0, 30.0));
  EXPECT_FALSE(Read(1.21, Line("GPVTG,30.0,T,,M,4.0,N,,K")).velocity) << "RMC has said it";
}

TEST_F(InterpreterTest, UsesTheDelayOfItsSourceFromASentenceWithoutATime) {
  SourceParams source;
  source.name = "nav";
  source.latency = 30ms;
  Configure(source);
  EXPECT_EQ(Read(1.0, HdtLine(10.0)).attitude->when.time, NoonPlus(0.97));
  EXPECT_EQ(Read(1.0, Line("TIROT,60.0,A")).turn_rate->time, NoonPlus(0.97));
  EXPECT_EQ(Read(1.0, HdtLine(10.0), "other").attitude->when.time, NoonPlus(1.0));
}

TEST_F(InterpreterTest, TurnsTheSignsOfASource) {
  SourceParams source;
  source.name = "nav";
  source.roll_sign = -1.0;
  source.pitch_sign = -1.0;
  Configure(source);
  const auto turned = Read(0.1, PashrLine(NoonPlus(0), 10.0, 2.0, 3.0, 0.0)).attitude;
  EXPECT_NEAR(turned->roll_rad, DegToRad(-2.0), 1e-12);
  EXPECT_NEAR(turned->pitch_rad, DegToRad(-3.0), 1e-12);
  EXPECT_NEAR(Read(0.1, PashrLine(NoonPlus(0), 10.0, 2.0, 3.0, 0.0), "other").attitude->roll_rad, DegToRad(2.0), 1e-12);
}

TEST_F(InterpreterTest, RefusesMagneticHeadingsThatCannotBeTurnedToTrue) {
  EXPECT_FALSE(Read(0, Line("HCHDM,100.0,M")).attitude);
  EXPECT_EQ(Count("no_deviation"), 1);
  EXPECT_FALSE(Read(0, Line("HCHDG,100.0,,,3.0,E")).attitude);
  EXPECT_EQ(Count("no_deviation"), 2);
  EXPECT_FALSE(Read(0, Line("HCHDG,100.0,1.0,W,,")).attitude);
  EXPECT_EQ(Count("no_declination"), 1);
  EXPECT_NEAR(Read(0, Line("HCHDG,100.0,1.0,W,3.0,E")).attitude->heading_rad, DegToRad(102.0), 1e-12);
  // A declination out of RMC of the same source.
  Read(0, Line("GPRMC," + TimeOfDay(NoonPlus(0)) + ",A,5000.0,N,00800.0,E,0.0,0.0,010626,5.0,W,A"));
  EXPECT_NEAR(Read(0, Line("HCHDG,2.0,1.0,W,,")).attitude->heading_rad, DegToRad(356.0), 1e-12);
  SourceParams source;
  source.name = "nav";
  source.deviation_rad = DegToRad(2.0);
  source.declination_rad = DegToRad(-3.0);
  Configure(source);
  EXPECT_NEAR(Read(0, "$04HDM,186.5,M*2C").attitude->heading_rad, DegToRad(185.5), 1e-12);
  EXPECT_NEAR(Read(0, Line("HCHDG,100.0,1.0,W,3.0,E")).attitude->heading_rad, DegToRad(102.0), 1e-12) << "what the sentence says counts";
}

TEST_F(InterpreterTest, UsesOfASourceWhatItsRoleIs) {
  const std::string ymr = Line("VNYMR,10.0,2.0,3.0,0,0,0,0.5,0.2,-9.8,0.1,0.2,0.3");
  const auto parts = [&](Role role) {
    SourceParams source;
    source.name = "nav";
    source.role = role;
    Configure(source);
    std::string text;
    if (Read(0.1, RmcLine(NoonPlus(0), 50.0, 8.0, 2.0, 30.0)).fix) text += "fix ";
    const auto reading = Read(0.1, ymr);
    if (reading.attitude) text += std::isnan(reading.attitude->roll_rad) ? "heading " : "attitude ";
    if (reading.imu) text += "imu ";
    return text + std::to_string(Count("outside_role"));
  };
  EXPECT_EQ(parts(Role::kAll), "fix attitude imu 0");
  EXPECT_EQ(parts(Role::kGnss), "fix 1");
  EXPECT_EQ(parts(Role::kHeading), "heading 1");
  EXPECT_EQ(parts(Role::kAttitude), "attitude 1");
  EXPECT_EQ(parts(Role::kImu), "imu 1");
  EXPECT_EQ(parts(Role::kNothing), "2");
}

TEST_F(InterpreterTest, TurnsAStrapdownSensorIntoTheVesselFrame) {
  const auto imu = Read(0.5, Line("VNIMU,0,0,0,0.5,0.2,-9.8,0.1,0.2,0.3,20.0,100.0")).imu;
  ASSERT_TRUE(imu);
  EXPECT_EQ(imu->time, NoonPlus(0.5));
  EXPECT_EQ(imu->specific_force_mps2, Eigen::Vector3d(0.5, -0.2, 9.8));
  EXPECT_EQ(imu->angular_velocity_radps, Eigen::Vector3d(0.1, -0.2, -0.3));
}

TEST_F(InterpreterTest, UsesPositionAndAttitudeOutOfVnins) {
  // 2026-06-01, noon: Monday of GPS week 2421, 18 s ahead of UTC.
  const auto line = [](const char* status, const char* time_of_week = "129618.000000") {
    return Line(std::string("VNINS,") + time_of_week + ",2421," + status + ",350.0,2.0,-3.0,50.0,8.0,147.0,3.0,-4.0,0.5,1.0,1.6,0.2");
  };
  const auto reading = Read(0.05, line("0006"));
  ASSERT_TRUE(reading.fix && reading.attitude);
  EXPECT_EQ(reading.fix->when.time, NoonPlus(0));
  EXPECT_TRUE(reading.fix->when.is_from_sentence);
  EXPECT_EQ(reading.fix->quality, FixQuality::kGnss);
  EXPECT_EQ(reading.fix->EllipsoidHeightM(), 147.0);
  EXPECT_EQ(reading.fix->horizontal_sd_m, 1.6);
  EXPECT_NEAR(reading.fix->speed_mps, 5.0, 1e-12);
  EXPECT_NEAR(reading.fix->course_rad, WrapTo2Pi(std::atan2(-4.0, 3.0)), 1e-12);
  EXPECT_NEAR(reading.attitude->heading_rad, DegToRad(350.0), 1e-12);
  EXPECT_NEAR(reading.attitude->heading_sd_rad, DegToRad(1.0), 1e-12);
  const auto not_tracking = Read(0.06, line("0004", "129618.020000"));
  EXPECT_EQ(not_tracking.fix->quality, FixQuality::kNone);
  EXPECT_TRUE(std::isnan(not_tracking.attitude->heading_rad));
  EXPECT_NEAR(not_tracking.attitude->roll_rad, DegToRad(-3.0), 1e-12);
}

TEST_F(InterpreterTest, CountsTimeThatRunsBackwards) {
  Read(100.0, RmcLine(NoonPlus(100), 50.0, 8.0, 2.0, 30.0));
  EXPECT_FALSE(Read(100.1, RmcLine(NoonPlus(40), 50.0, 8.0, 2.0, 30.0)).fix);
  EXPECT_EQ(Count("time_backwards"), 1);
}

// A receiver without satellites says the time of its own clock, which may begin anywhere: it told a right computer that it is 46 years off.
TEST_F(InterpreterTest, DoesNotTakeTheComputersClockForWrongBeforeAReceiverHasAFix) {
  for (int i = 0; i < 20; ++i) {
    Read(i, Line(Print("GPRMC,0000%02d.00,V,,,,,,,060180,,,N", i)));
    Read(i, Line(Print("GPGGA,0000%02d.00,,,,,0,00,99.99,,,,,,", i)));
  }
  EXPECT_EQ(interpreter_.host_minus_utc(), 0us);
  EXPECT_EQ(Read(20, Line("GPHDT,90.0,T")).attitude->when.utc, NoonPlus(20));
  for (int i = 21; i < 40; ++i) Read(i + 0.1 - 3600, RmcLine(NoonPlus(i), 50.0, 8.0, 2.0, 30.0));
  EXPECT_LT(interpreter_.host_minus_utc(), -3599s) << "with a fix it does";
}

// A multiplexer that repeats the last sentences of a receiver that has gone. Each was a new fix, and the time that stood still dragged the clock
// along.
TEST_F(InterpreterTest, UsesASentenceThatIsRepeatedForTheInstantThatItWas) {
  for (int i = 0; i < 300; ++i) {
    const auto fix = Read(0.1 + 0.1 * i, RmcLine(NoonPlus(0), 50.0, 8.0, 2.0, 30.0)).fix;
    ASSERT_TRUE(fix);
    EXPECT_EQ(fix->when.time, NoonPlus(0)) << i;
    EXPECT_EQ(Read(0.1 + 0.1 * i, PashrLine(NoonPlus(0), 90.0, 0.0, 0.0, 0.0)).attitude->when.time, NoonPlus(0)) << i;
  }
  EXPECT_EQ(interpreter_.host_minus_utc(), 0us);
}

TEST_F(InterpreterTest, DoesNotCorrectTheClockByASourceThatIsOnlyRecorded) {
  SourceParams recorded;
  recorded.name = "nav";
  recorded.role = Role::kNothing;
  Configure(recorded);
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(Read(i, RmcLine(NoonPlus(i - 3600), 50.0, 8.0, 2.0, 30.0)).fix);
  EXPECT_EQ(interpreter_.host_minus_utc(), 0us);
  EXPECT_EQ(Count("outside_role"), 20);
  EXPECT_EQ(Count("time_backwards"), 0);
}

TEST_F(InterpreterTest, CountsEachSource) {
  Read(0, HdtLine(1.0), "a");
  Read(0, "$GPHDT,1.0,T*00", "a");
  Read(0, HdtLine(1.0), "b");
  EXPECT_EQ(Count("a_understood"), 1);
  EXPECT_EQ(Count("a_refused"), 1);
  EXPECT_EQ(Count("b_understood"), 1);
}

// A multiplexer showed `$HEHDT,,T` of a compass that had lost its heading as an attitude, and "no heading" fell silent.
TEST_F(InterpreterTest, MakesNoAttitudeOfAnEmptyHeading) {
  EXPECT_FALSE(Read(0.0, Line("HEHDT,,T")).attitude);
  EXPECT_FALSE(Read(0.1, Line("HETHS,,A")).attitude);
  EXPECT_FALSE(Read(0.2, Line("PTNTHTM,,N,,N,,N,,")).attitude);
  EXPECT_FALSE(Read(0.3, Line("YXXDR,A,,D,PTCH,A,,D,ROLL")).attitude);
  EXPECT_EQ(Count("understood_sentence"), 4);
  EXPECT_TRUE(Read(0.4, Line("HEHDT,0.0,T")).attitude) << "north is a heading";
}

// 0.034 knots on the recording of a VLP-16 that stood on its tripod, with a course of 212.5 deg.
TEST_F(InterpreterTest, ABoatAtRestHasNoCourse) {
  const auto rmc = Read(0.1, Line("GPRMC,120000.00,A,3649.7478558,N,00224.4542928,W,0.034,212.5,010626,0.0,E,A")).fix;
  ASSERT_TRUE(rmc);
  EXPECT_NEAR(rmc->speed_mps, 0.0175, 1e-4);
  EXPECT_TRUE(std::isnan(rmc->course_rad));
  const auto vtg = Read(5.0, Line("GPVTG,212.5,T,,M,0.30,N,0.56,K,A")).velocity;
  ASSERT_TRUE(vtg);
  EXPECT_TRUE(std::isnan(vtg->course_rad));
  const auto under_way = Read(6.0, Line("GPVTG,212.5,T,,M,0.50,N,0.93,K,A")).velocity;
  ASSERT_TRUE(under_way);
  EXPECT_NEAR(under_way->course_rad, DegToRad(212.5), 1e-9);
}

// gpsd's example in its description of the sentence.
TEST_F(InterpreterTest, ReadsGns) {
  const auto fix = Read(0.1, Line("GPGNS,120000.00,3333.4268304,N,11153.3538273,W,D,19,0.6,406.110,-26.294,6.0,0138,S")).fix;
  ASSERT_TRUE(fix);
  EXPECT_EQ(fix->sentence_type, "GNS");
  EXPECT_EQ(fix->quality, FixQuality::kDifferential);
  EXPECT_EQ(fix->num_satellites, 19);
  EXPECT_NEAR(fix->hdop, 0.6, 1e-12);
  EXPECT_NEAR(fix->EllipsoidHeightM(), 406.110 - 26.294, 1e-9);
  EXPECT_NEAR(fix->position->latitude_deg, 33.55711384, 1e-8);
  EXPECT_TRUE(fix->when.is_from_sentence);
  // A letter for each system.
  const auto quality_of = [this](double time_s, const std::string& modes) {
    const auto read = Read(time_s, Line("GNGNS," + TimeOfDay(NoonPlus(time_s)) + ",3333.4,N,11153.3,W," + modes + ",19,0.6,406.1,-26.3,,,V")).fix;
    return read ? static_cast<int>(read->quality) : -1;
  };
  EXPECT_EQ(quality_of(1.0, "AAN"), static_cast<int>(FixQuality::kGnss));
  EXPECT_EQ(quality_of(2.0, "ARNNN"), static_cast<int>(FixQuality::kRtkFixed));
  EXPECT_EQ(quality_of(3.0, "NNNN"), static_cast<int>(FixQuality::kNone));
  EXPECT_EQ(quality_of(4.0, ""), static_cast<int>(FixQuality::kNone));
  EXPECT_EQ(quality_of(5.0, "AXN"), -1);
  EXPECT_EQ(quality_of(6.0, "AAAAAAAAAA"), -1);
  EXPECT_EQ(Count("bad_field"), 2);
}

// Saab's R4 leaves a field out.
TEST_F(InterpreterTest, UsesAShortGgaForWhatItHolds) {
  const auto last_left_out = Read(0.1, Line("GPGGA,120000.00,5012.790800,N,00806.879600,W,1,08,1.5,10.0,M,47.0,M,")).fix;
  ASSERT_TRUE(last_left_out && last_left_out->position);
  EXPECT_EQ(last_left_out->quality, FixQuality::kGnss);
  EXPECT_NEAR(last_left_out->position->latitude_deg, 50.21318, 1e-8);
  EXPECT_NEAR(last_left_out->EllipsoidHeightM(), 57.0, 1e-9);
  // The unit of the height is missing: what follows cannot be told from the height of the geoid.
  const auto unit_left_out = Read(1.1, Line("GPGGA,120001.00,5012.790800,N,00806.879600,W,1,08,1.5,10.0,47.0,M,,")).fix;
  ASSERT_TRUE(unit_left_out && unit_left_out->position);
  EXPECT_TRUE(std::isnan(unit_left_out->EllipsoidHeightM()));
  EXPECT_NEAR(unit_left_out->hdop, 1.5, 1e-12);
  EXPECT_FALSE(Read(2.1, Line("GPGGA,120002.00,5012.790800,N,00806.879600,W,1")).fix) << "too short to know its quality's worth";
  EXPECT_EQ(Count("bad_field"), 1);
}

// The height stood for the HDOP where that is missing: 0.3 m made a fix three times as good as it is.
TEST_F(InterpreterTest, AShortGgaNeverConfusesOneNumberWithAnother) {
  const std::vector<std::string> whole{"", "5012.790800", "N", "00806.879600", "W", "5", "08", "1.5", "0.3", "M", "47.0", "M", "", ""};
  const double usual_sd_m = Read(0.0, Line("GPGGA,120000.00,5012.790800,N,00806.879600,W,1,08,,0.3,M,47.0,M,,")).fix->horizontal_sd_m;
  for (std::size_t missing = 0; missing < whole.size(); ++missing) {
    SCOPED_TRACE(missing);
    const double time_s = 1.0 + static_cast<double>(missing);
    auto fields = whole;
    fields[0] = TimeOfDay(NoonPlus(time_s));
    fields.erase(fields.begin() + static_cast<std::ptrdiff_t>(missing));
    std::string body = "GPGGA";
    for (const auto& field : fields) body += "," + field;
    const auto fix = Read(time_s, Line(body)).fix;
    EXPECT_EQ(fix.has_value(), missing > 5);
    if (!fix) continue;
    ASSERT_TRUE(fix->position);
    EXPECT_NEAR(fix->position->latitude_deg, 50.21318, 1e-8);
    EXPECT_NEAR(fix->position->longitude_deg, -8.11466, 1e-8);
    const bool is_told = missing > 8;
    EXPECT_EQ(fix->quality, is_told ? FixQuality::kRtkFloat : FixQuality::kGnss);
    EXPECT_EQ(fix->num_satellites, is_told ? 8 : -1);
    if (is_told) {
      EXPECT_NEAR(fix->hdop, 1.5, 1e-12);
    } else {
      EXPECT_TRUE(std::isnan(fix->hdop));
      EXPECT_NEAR(fix->horizontal_sd_m, usual_sd_m, 1e-12);
    }
    EXPECT_TRUE(std::isnan(fix->msl_height_m) || fix->msl_height_m == 0.3);
    EXPECT_TRUE(std::isnan(fix->geoid_separation_m) || fix->geoid_separation_m == 47.0);
    EXPECT_EQ(std::isnan(fix->EllipsoidHeightM()), missing < 12);
  }
}

TEST_F(InterpreterTest, ReadsPitchAndRollOfXdrByTheNamesOfSeveralMakers) {
  const auto expect = [this](double time_s, const std::string& body, double pitch_deg, double roll_deg) {
    const auto attitude = Read(time_s, Line(body)).attitude;
    ASSERT_TRUE(attitude) << body;
    EXPECT_EQ(attitude->sentence_type, "XDR");
    EXPECT_TRUE(std::isnan(attitude->heading_rad));
    EXPECT_NEAR(attitude->pitch_rad, DegToRad(pitch_deg), 1e-12) << body;
    EXPECT_NEAR(attitude->roll_rad, DegToRad(roll_deg), 1e-12) << body;
  };
  expect(0.0, "YXXDR,A,-2.5,D,PTCH,A,7.25,D,ROLL", -2.5, 7.25);
  expect(0.1, "IIXDR,P,1.02421,B,Barometer,A,29.0,D,Roll,A,10.1,D,Pitch", 10.1, 29.0);
  expect(0.2, "HCXDR,A,-0.8,D,PITCH,A,0.9,D,ROLL,G,122,,MAGX,G,1838,,MAGY", -0.8, 0.9);
  expect(0.3, "MLXDR,A,-42.42,D,PTCH#CAL,A,30.07,D,ROLL#CAL", -42.42, 30.07);
  expect(0.4, "IIXDR,A,3.0,D,HEEL,A,1.0,D,Pitch", 1.0, 3.0);
  EXPECT_FALSE(Read(0.5, Line("IIXDR,C,19.52,C,TempAir")).attitude);
  EXPECT_FALSE(Read(0.6, Line("IIXDR,A,5.0,D,Rudder,A,5.0,P,ROLL")).attitude);
  EXPECT_EQ(Count("other_sentence"), 2);
  EXPECT_FALSE(Read(0.7, Line("YXXDR,A,95.0,D,PTCH,A,0.0,D,ROLL")).attitude);
  EXPECT_EQ(Count("implausible_value"), 1);
  EXPECT_FALSE(Read(0.8, Line("YXXDR,A,x,D,PTCH,A,0.0,D,ROLL")).attitude);
  EXPECT_EQ(Count("bad_field"), 1);
  Read(0.9, Line("YXXDR,A,1.0,D,PTCH,A,1.0"));  // cut off: the whole group counts
  Read(1.0, Line("YXXDR"));
}

TEST_F(InterpreterTest, TurnsTheSignsOfXdrAsConfigSays) {
  SourceParams source;
  source.name = "nav";
  source.pitch_sign = -1.0;
  Configure(source);
  const auto attitude = Read(0.0, Line("YXXDR,A,-2.5,D,PTCH,A,7.25,D,ROLL")).attitude;
  ASSERT_TRUE(attitude);
  EXPECT_NEAR(attitude->pitch_rad, DegToRad(2.5), 1e-12);
  EXPECT_NEAR(attitude->roll_rad, DegToRad(7.25), 1e-12);
}

// gpsd's example, in turns / 65536 (78.13 deg, and a dip of 74.9 deg), and one in degrees.
TEST_F(InterpreterTest, ReadsTheCompassOfTrueNorth) {
  const auto counts = Read(0.0, "$PTNTHTM,14223,N,169,N,-43,N,13641,2454*15").attitude;
  ASSERT_TRUE(counts);
  EXPECT_EQ(counts->sentence_type, "PTNTHTM");
  EXPECT_NEAR(RadToDeg(counts->heading_rad), 14223.0 * 360.0 / 65536.0, 1e-9);
  EXPECT_NEAR(RadToDeg(counts->pitch_rad), 0.928, 1e-3);
  EXPECT_NEAR(RadToDeg(counts->roll_rad), -0.236, 1e-3);
  const auto degrees = Read(0.1, Line("PTNTHTM,306.9,N,-2.4,N,10.7,N,59.1,3844")).attitude;
  ASSERT_TRUE(degrees);
  EXPECT_NEAR(RadToDeg(degrees->heading_rad), 306.9, 1e-9);
  EXPECT_NEAR(RadToDeg(degrees->pitch_rad), -2.4, 1e-9);
  const auto alarm = Read(0.2, Line("PTNTHTM,306.9,C,-2.4,N,10.7,M,59.1,3844")).attitude;
  ASSERT_TRUE(alarm);
  EXPECT_TRUE(std::isnan(alarm->heading_rad)) << "calibration alarm";
  EXPECT_NEAR(RadToDeg(alarm->roll_rad), 10.7, 1e-9);
  EXPECT_FALSE(Read(0.3, Line("PTNTHTM,306.9,N,-92.4,N,10.7,N,59.1,3844")).attitude);
  EXPECT_FALSE(Read(0.4, Line("PTNTHTM,306.9,N,-2.4")).attitude);
  EXPECT_EQ(Count("implausible_value") + Count("bad_field"), 2);
}

// Both were read, and then nothing: no counter moved.
TEST_F(InterpreterTest, CountsAttitudesThatSayNothing) {
  Read(0.0, Line("IIXDR,A, ,D,PTCH,A,,D,ROLL"));
  Read(0.1, Line("HEHDT,,T"));
  EXPECT_EQ(Count("empty_attitude"), 2);
  for (const char* xdr : {"IIXDR,A,2.5,D,RUDDER", "IIXDR, , , , ", "IIXDR,,,,", "IIXDR,A,2.5,D,", "IIXDR"}) Read(0.2, Line(xdr));
  EXPECT_EQ(Count("xdr_not_used"), 5);
}

// It was counted as one whose UTC is too far from the arrival: look at the host's clock.
TEST_F(InterpreterTest, UsesAPositionWithoutATimeAtItsArrival) {
  const auto fix = Read(0.5, Line("BMGLL,5430.0000,N,1012.0000,E,,A,D")).fix;
  ASSERT_TRUE(fix && fix->position);
  EXPECT_EQ(fix->when.time, NoonPlus(0.5));
  EXPECT_EQ(fix->when.utc, NoonPlus(0.5));
  EXPECT_EQ(Count("sentence_time_unusable"), 0);
}

TEST_F(InterpreterTest, CountsAnHdopThatNoSkyGivesAsOne) {
  EXPECT_DOUBLE_EQ(Read(0.1, GgaLine(NoonPlus(0), 50.0, 8.0, 1, 0.01, 100.0, 47.0)).fix->horizontal_sd_m, 2.5);
}

TEST_F(InterpreterTest, CountsAWrongDateOfZda) {
  EXPECT_TRUE(Read(0.1, GgaLine(NoonPlus(0), 50.0, 8.0, 1, 0.8, 3.0, 40.0)).fix);
  Read(1.1, Line("GPZDA,120001.00,02,06,2026,00,00"));
  EXPECT_EQ(Count("date_unusable"), 1);
  EXPECT_EQ(Read(2.1, GgaLine(NoonPlus(2), 50.0, 8.0, 1, 0.8, 3.0, 40.0)).fix->when.utc, NoonPlus(2));
  Read(3.1, Line("GPZDA,120003.00,01,06,2026,00,00"));
  EXPECT_EQ(Count("date_unusable"), 1);
}

}  // namespace
}  // namespace lookout::navigator
