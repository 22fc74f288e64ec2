#include "tools/setup/answers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <google/protobuf/descriptor.h>

#include "common/config/text_config.hpp"
#include "config/schema/options.pb.h"

namespace lookout::setup {

namespace {

constexpr double kBesideHullM = 0.2;       // fenders, and what hangs over the rail
constexpr double kBelowWaterM = 1.0;       // glints of the own hull
constexpr double kAboveLidarM = 0.9;       // a mast or an antenna on top
constexpr double kAroundLidarM = 0.2;      // a lidar on a boom beyond the hull
constexpr double kOutsideM = 2.0;          // for a stern arch or a boom: lookout-doctor doubts a greater distance
constexpr double kLeastGuardZoneM = 10.0;  // as of config/catabot

double Half(double length_m) { return length_m / 2.0; }

// No minus zero, and no digits beyond a millimetre.
double Rounded(double value) {
  constexpr double kPerMetre = 1000.0;
  return std::round(value * kPerMetre) / kPerMetre + 0.0;
}

Place ToPlace(const config::Answers& answers, const config::MeasuredPlace& measured) {
  return {Rounded(Half(answers.hull_length_m()) - measured.behind_bow_m()), Rounded(measured.to_port_m()), Rounded(measured.above_water_m())};
}

void CheckPlace(const config::Answers& answers, const std::string& field, const config::MeasuredPlace& measured, std::vector<AnswerFault>& faults) {
  const auto fault = [&](const char* member, const std::string& reason) { faults.push_back({field + "." + member, reason}); };
  if (measured.behind_bow_m() < -kOutsideM || measured.behind_bow_m() > answers.hull_length_m() + kOutsideM) {
    fault("behind_bow_m",
          fmt::format("is more than {} m outside of a hull of {} m (is {})", kOutsideM, answers.hull_length_m(), measured.behind_bow_m()));
  }
  if (std::abs(measured.to_port_m()) > Half(answers.hull_beam_m()) + kOutsideM) {
    fault("to_port_m", fmt::format("is more than {} m outside of a hull {} m wide (is {})", kOutsideM, answers.hull_beam_m(), measured.to_port_m()));
  }
  if (measured.above_water_m() <= 0.0)
    fault("above_water_m", fmt::format("must be above the water, greater than 0 (is {})", measured.above_water_m()));
}

}  // namespace

std::vector<AnswerFault> FaultsOf(const config::Answers& answers, const Heard& heard) {
  std::vector<AnswerFault> faults;
  if (answers.name().empty()) faults.push_back({"name", "must not be empty"});
  if (answers.has_hull_length_m() && answers.has_hull_beam_m()) {
    if (answers.hull_beam_m() > answers.hull_length_m()) {
      faults.push_back(
          {"hull_beam_m", fmt::format("must not be greater than the length ({} against {} m)", answers.hull_beam_m(), answers.hull_length_m())});
    }
    if (answers.has_lidar()) CheckPlace(answers, "lidar", answers.lidar(), faults);
    if (answers.has_gnss_antenna()) CheckPlace(answers, "gnss_antenna", answers.gnss_antenna(), faults);
    if (answers.has_lidar() && answers.guard_zone_m() > 0.0) {
      // Wholly inside of the box all is own boat; a zone that ends at the bow is of no use either.
      const double bow_m = BoxOf(answers).max.x_m;
      if (answers.guard_zone_m() <= bow_m) {
        faults.push_back(
            {"guard_zone_m", fmt::format("must reach beyond the bow, which is {} m ahead of the middle (is {})", bow_m, answers.guard_zone_m())});
      }
    }
  }
  if (heard.lidars.size() > 1 || !answers.lidar_address().empty()) {
    const auto has_address = [&](const lidar::Speaker& speaker) { return speaker.source_address == answers.lidar_address(); };
    std::string addresses;
    for (const auto& speaker : heard.lidars) addresses += (addresses.empty() ? "" : ", ") + speaker.source_address + " (" + speaker.name + ")";
    if (answers.lidar_address().empty()) {
      faults.push_back({"lidar_address", "must be set: several lidars speak: " + addresses});
    } else if (std::ranges::none_of(heard.lidars, has_address)) {
      faults.push_back(
          {"lidar_address", "no lidar speaks from '" + answers.lidar_address() + "'" + (addresses.empty() ? "" : "; those that do: " + addresses)});
    }
  }
  return faults;
}

std::string RangeFault(const google::protobuf::Message& message, const std::string& field, double value) {
  const auto* descriptor = message.GetDescriptor()->FindFieldByName(field);
  const auto& options = descriptor->options();
  if (!std::isfinite(value)) return "must be a finite number";
  if (options.HasExtension(config::min) && value < options.GetExtension(config::min)) {
    return fmt::format("must be at least {} (is {})", options.GetExtension(config::min), value);
  }
  if (options.HasExtension(config::max) && value > options.GetExtension(config::max)) {
    return fmt::format("must be at most {} (is {})", options.GetExtension(config::max), value);
  }
  return {};
}

config::Answers LoadAnswers(const std::filesystem::path& file, const Heard& heard) {
  config::Answers answers;
  config::LoadText(file, answers);
  config::FaultList faults;
  for (const auto& fault : FaultsOf(answers, heard)) {
    // Both places have members of the same names: the line is the place's.
    const auto dot = fault.field.find('.');
    const auto member = dot == std::string::npos ? std::string() : fault.field.substr(dot + 1) + " ";
    faults.Add(config::FaultLine(file, fault.field.substr(0, dot), member + fault.reason));
  }
  faults.ThrowIfAny();
  return answers;
}

Place LidarPlace(const config::Answers& answers) { return ToPlace(answers, answers.lidar()); }

Place AntennaPlace(const config::Answers& answers) {
  return answers.has_gnss_antenna() ? ToPlace(answers, answers.gnss_antenna()) : LidarPlace(answers);
}

OwnBox BoxOf(const config::Answers& answers) {
  const auto lidar = LidarPlace(answers);
  const double x_m = Half(answers.hull_length_m()) + kBesideHullM;
  const double y_m = Half(answers.hull_beam_m()) + kBesideHullM;
  return {{Rounded(std::min(-x_m, lidar.x_m - kAroundLidarM)), Rounded(std::min(-y_m, lidar.y_m - kAroundLidarM)), -kBelowWaterM},
          {Rounded(std::max(x_m, lidar.x_m + kAroundLidarM)), Rounded(std::max(y_m, lidar.y_m + kAroundLidarM)), Rounded(lidar.z_m + kAboveLidarM)}};
}

double GuardZoneM(const config::Answers& answers) {
  if (answers.has_guard_zone_m()) return answers.guard_zone_m();
  return std::max(kLeastGuardZoneM, Rounded(std::ceil(Half(answers.hull_length_m())) + kLeastGuardZoneM - 2.0));
}

const lidar::Speaker* ChosenLidar(const config::Answers& answers, const Heard& heard) {
  if (heard.lidars.empty()) return nullptr;
  if (answers.lidar_address().empty()) return &heard.lidars.front();
  const auto found = std::ranges::find(heard.lidars, answers.lidar_address(), &lidar::Speaker::source_address);
  return found == heard.lidars.end() ? nullptr : &*found;
}

}  // namespace lookout::setup
