#include "services/navigator/core/odometry.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "common/core/angles.hpp"
#include "common/core/sentence.hpp"

namespace lookout::navigator {

namespace {

constexpr std::string_view kAddress = "PLKODO";
constexpr double kMaxWayM = 100.0;  // from one scan to the next
constexpr double kMaxVariance = 1e4;
constexpr double kMaxTimeUs = 7.3e15;  // the year 2200

// Above the diagonal, row by row.
constexpr std::array<std::pair<int, int>, 6> kUpper{{{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}};

// ",-0.123456"
std::string Field(double value, int decimals) {
  std::array<char, 48> text{};
  const int length = std::snprintf(text.data(), text.size(), ",%.*f", decimals, value);
  return {text.data(), static_cast<std::size_t>(length)};
}

// Positive definite but for the rounding of the text (Sylvester's criterion).
bool IsCovariance(const Eigen::Matrix3d& covariance) {
  constexpr double kRounding = 1e-12;
  Eigen::Matrix3d inflated = covariance;
  inflated.diagonal() *= kInflatedVariance;
  inflated.diagonal().array() += kRounding;
  return inflated(0, 0) > 0.0 && inflated.topLeftCorner<2, 2>().determinant() > 0.0 && inflated.determinant() > 0.0;
}

}  // namespace

std::string ToSentence(const OdometryMotion& motion) {
  std::string body(kAddress);
  body += "," + std::to_string(ToUtimeUs(motion.begin)) + "," + std::to_string(ToUtimeUs(motion.end)) + (motion.is_known ? ",K" : ",U");
  if (motion.is_known) {
    body += Field(motion.displacement_m.x(), 6) + Field(motion.displacement_m.y(), 6) + Field(motion.turn_rad, 9);
    for (const auto& [row, column] : kUpper) body += Field(motion.covariance(row, column), 12);
  }
  return WithChecksum(body);
}

std::optional<OdometryMotion> ParseOdometry(std::string_view line) {
  const auto framed = Frame(line);
  if (framed.fault != SentenceFault::kNone || framed.sentence.address != kAddress) return std::nullopt;
  FieldReader fields(framed.sentence.fields);
  const double begin_us = fields.Number(0, 0.0, kMaxTimeUs);
  const double end_us = fields.Number(1, 0.0, kMaxTimeUs);
  const char known = fields.Letter(2, "KU");
  if (fields.fault() != SentenceFault::kNone || std::isnan(begin_us) || std::isnan(end_us) || known == '\0' || end_us < begin_us) return std::nullopt;
  OdometryMotion motion{Utime(std::chrono::microseconds(static_cast<std::int64_t>(begin_us))),
                        Utime(std::chrono::microseconds(static_cast<std::int64_t>(end_us))), known == 'K'};
  if (!motion.is_known) return motion;
  motion.displacement_m = {fields.Number(3, -kMaxWayM, kMaxWayM), fields.Number(4, -kMaxWayM, kMaxWayM)};
  motion.turn_rad = fields.Number(5, -kPi, kPi);
  for (std::size_t i = 0; i < kUpper.size(); ++i) {
    const auto [row, column] = kUpper[i];
    motion.covariance(row, column) = motion.covariance(column, row) = fields.Number(6 + i, -kMaxVariance, kMaxVariance);
  }
  const bool is_whole = motion.displacement_m.allFinite() && std::isfinite(motion.turn_rad) && motion.covariance.allFinite();
  if (fields.fault() != SentenceFault::kNone || !is_whole || end_us <= begin_us) return std::nullopt;
  // A covariance: no variance below 0, no correlation above 1.
  for (int i = 0; i < 3; ++i) {
    if (motion.covariance(i, i) < 0.0) return std::nullopt;
    for (int k = 0; k < i; ++k) {
      const double bound = std::sqrt(motion.covariance(i, i) * motion.covariance(k, k));
      if (std::abs(motion.covariance(i, k)) > bound * 1.001 + 1e-9) return std::nullopt;
    }
  }
  if (!IsCovariance(motion.covariance)) return std::nullopt;
  return motion;
}

}  // namespace lookout::navigator
