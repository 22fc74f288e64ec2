// Right sentences with any numbers that may stand in them, at any time: poses stay numbers, and their covariance one that can be.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "services/navigator/core/navigator.hpp"
#include "tests/unit/navigator/filter_params.hpp"
#include "tests/unit/navigator/nmea_text.hpp"

namespace lookout::navigator {
namespace {

using namespace std::chrono_literals;

class Hostile {
 public:
  explicit Hostile(unsigned seed) : random_(seed) {}

  double Uniform(double min, double max) { return std::uniform_real_distribution<double>(min, max)(random_); }
  int Choice(int num) { return std::uniform_int_distribution<int>(0, num - 1)(random_); }
  // Of any size, and at times 0.
  std::string Sd() { return Choice(8) == 0 ? "0" : Print("%.100f", std::pow(10.0, Uniform(Choice(3) == 0 ? -90.0 : -6.0, 2.0))); }
  // Mostly where the boat is.
  double Degrees(double usual_deg, double max_deg) { return Choice(20) == 0 ? Uniform(-max_deg, max_deg) : usual_deg + Uniform(-1e-5, 1e-5); }

  std::string Sentence(Utime now) {
    const Utime time = now - std::chrono::milliseconds(Choice(3) == 0 ? Choice(900) - 400 : 50);
    const double latitude_deg = Degrees(43.63, 90.0);
    const double longitude_deg = Degrees(-72.15, 180.0);
    const double heading_deg = Choice(3) == 0 ? Uniform(0.0, 360.0) : 90.0;
    switch (Choice(8)) {
      case 0:
        return RmcLine(time, latitude_deg, longitude_deg, Choice(10) == 0 ? Uniform(0.0, 90.0) : 1.0, heading_deg);
      case 1:
        return GgaLine(time, latitude_deg, longitude_deg, 1 + Choice(6), Choice(5) == 0 ? Uniform(0.0, 99.0) : 1.0, Uniform(-100.0, 100.0), 40.0);
      case 2:
        return Line("GPGST," + TimeOfDay(time) + ",,,,," + Sd() + "," + Sd() + ",");
      case 3:
        return Line("PASHR," + TimeOfDay(time) +
                    Print(",%.3f,T,%.3f,%.3f,%.2f,", heading_deg, Degrees(1.0, 180.0), Degrees(1.0, 90.0), Uniform(-1, 1)) + ShortSd() + "," +
                    ShortSd() + "," + ShortSd() + ",1,1");
      case 4:
        return HdtLine(heading_deg);
      case 5:
        return Line(Print("GPVTG,%.2f,T,,M,%.3f,N,,K,A", heading_deg, Uniform(0.0, 3.0)));
      default: {
        const double size = Choice(20) == 0 ? 1.0 : 0.01;
        return Line(Print("VNIMU,0,0,0,%.3f,%.3f,%.3f,%.4f,%.4f,%.4f,20,101", size * Uniform(-900, 900), size * Uniform(-900, 900),
                          -9.8 + size * Uniform(-900, 900), size * Uniform(-99, 99), size * Uniform(-99, 99), size * Uniform(-99, 99)));
      }
    }
  }

 private:
  std::string ShortSd() { return Choice(8) == 0 ? "0" : Print("%.40f", std::pow(10.0, Uniform(Choice(3) == 0 ? -38.0 : -6.0, 2.0))); }

  std::mt19937 random_;
};

// How far a pair of rows is from one that can be: its correlation is 1 at most.
double WorstCorrelation(const PoseCovariance& covariance) {
  double worst = 0.0;
  for (int row = 0; row < covariance.rows(); ++row) {
    for (int column = 0; column < row; ++column) {
      const double product = covariance(row, row) * covariance(column, column);
      if (std::isnan(product)) continue;
      // Beside a nanometre, a nanoradian and the like nothing is said.
      worst = std::max(worst, std::abs(covariance(row, column)) / (std::sqrt(product) + 1e-9));
    }
  }
  return worst;
}

TEST(NavigatorProperty, PosesStayNumbersWhateverRightSentencesSay) {
  std::int64_t num_known = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    NavigatorParams params;
    params.max_sentence_latency = 500ms;
    params.position_sd_m = 2.5;
    params.filter = TestFilterParams();
    params.filter.p_vessel_antenna_m = {-0.8, 0.4, 2.9};
    params.filter.p_vessel_imu_m = {0.3, -0.2, 0.1};
    Navigator navigator(params);
    Hostile hostile(seed);
    double time_s = 0.0;
    std::int64_t seq = 0;
    navigator.Consume({NoonPlus(0), seq++, ItemKind::kStart, {}, {}});
    for (int i = 0; i < 4000; ++i) {
      time_s += hostile.Choice(500) == 0 ? hostile.Uniform(0.0, 100.0) : hostile.Uniform(0.0, 0.01);
      const Item item = i % 10 == 0 ? Item{NoonPlus(time_s), seq++, ItemKind::kTick, {}, {}}
                                    : Item{NoonPlus(time_s), seq++, ItemKind::kSentence, "udp", hostile.Sentence(NoonPlus(time_s))};
      for (const auto& pose : navigator.Consume(item).poses) {
        const bool has_position = pose.status != PoseStatus::kNoPosition && pose.status != PoseStatus::kUnknown;
        num_known += has_position ? 1 : 0;
        ASSERT_EQ(pose.p_map_m.allFinite(), has_position) << "seed " << seed << ", " << item.sentence;
        const bool is_of_boat = pose.status == PoseStatus::kRelativeToBoat;
        ASSERT_EQ(pose.velocity_map_mps.allFinite(), has_position && !is_of_boat) << "seed " << seed << ", " << item.sentence;
        ASSERT_TRUE(std::isfinite(pose.roll_rad) && std::isfinite(pose.pitch_rad)) << "seed " << seed;
        ASSERT_EQ(std::isfinite(pose.heading_rad), is_of_boat || pose.heading_source != HeadingSource::kNone) << "seed " << seed;
        ASSERT_TRUE(pose.covariance.diagonal().head<2>().allFinite() == has_position) << "seed " << seed;
        ASSERT_FALSE((pose.covariance.diagonal().array() < 0.0).any()) << "seed " << seed;
        ASSERT_LT(WorstCorrelation(pose.covariance), 1.0 + 1e-3) << "seed " << seed << " at " << time_s << " s\n" << pose.covariance;
      }
    }
  }
  EXPECT_GT(num_known, 10'000);
}

}  // namespace
}  // namespace lookout::navigator
