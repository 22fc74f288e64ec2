// Position, heading, roll and pitch.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/core/angles.hpp"
#include "common/core/datum_check.hpp"
#include "common/core/utime.hpp"
#include "services/navigator/core/mavlink_lines.hpp"
#include "tools/doctor/findings.hpp"

namespace lookout::doctor {

namespace {

constexpr const char* kGnssSubject = "gnss";
constexpr const char* kHeadingSubject = "heading";
constexpr const char* kAttitudeSubject = "attitude";
constexpr const char* kInputSubject = "input";

constexpr double kFixSilenceS = 2.0;     // two periods of a receiver that gives one fix a second
constexpr double kPoorFixM = 5.0;        // twice GNSS without correction: position_sd_m of navigator.proto
constexpr int kFewSatellites = 5;        // four give a place in space; one to spare
constexpr double kPoorHeadingDeg = 5.0;  // max_heading_coast_sd_deg of navigator.proto: 0.9 m at 10 m
constexpr int kHeadingIndex = 8;         // of POSE.covariance

// By gnss_fix_t::QUALITY_...
constexpr std::array kQualityInWords{"no fix",     "GNSS",           "differential GNSS", "precise GNSS",          "RTK, fixed",
                                     "RTK, float", "dead reckoning", "entered by hand",   "a receiver's simulator"};
static_assert(kQualityInWords.size() == gnss_fix_t::QUALITY_SIMULATOR + 1);

std::string QualityInWords(int quality) {
  const bool is_known = quality >= 0 && quality < static_cast<int>(kQualityInWords.size());
  return kQualityInWords.at(is_known ? static_cast<std::size_t>(quality) : 0);
}

std::string FixInWords(const gnss_fix_t& fix, double age_s) {
  std::string words = QualityInWords(fix.quality) + " from input '" + fix.source + "' (" + fix.sentence_type + ")";
  if (fix.num_satellites >= 0) words += ", " + Count(fix.num_satellites, "satellite");
  if (std::isfinite(fix.horizontal_sd_m)) words += ", sd " + Fixed(fix.horizontal_sd_m, 2) + " m per axis";
  if (std::isfinite(fix.hdop)) words += ", HDOP " + Fixed(fix.hdop, 1);
  words += ", " + Fixed(age_s, 1) + " s old";
  if (std::isfinite(fix.latitude_deg) && std::isfinite(fix.longitude_deg))
    words += ", at " + PlaceInWords({fix.latitude_deg, fix.longitude_deg, 0.0});
  return words;
}

Finding CheckFix(const Observations& seen) {
  const auto& navigation = seen.navigation;
  if (navigation.num_by_source.empty()) {
    return Fault(
        kGnssSubject, "no sentence came from any input of navigator.txtpb",
        "switch the receiver on; compare it with the inputs that lookout-navigator --check lists: serial device and baud, UDP destination and port");
  }
  if (!navigation.fix) {
    std::vector<std::string> sources;
    for (const auto& [name, num_sentences] : navigation.num_by_source) sources.push_back("'" + name + "'");
    return Fault(kGnssSubject, "sentences come from " + Joined(sources) + ", but none with a position (RMC, GGA, GNS, GLL, VNINS)",
                 "turn RMC and GGA on in the receiver; role and checksum_required of the input in navigator.txtpb");
  }
  const auto& fix = *navigation.fix;
  const double age_s = ToSeconds(seen.end - navigation.fix_heard);
  const auto words = FixInWords(fix, age_s);
  if (fix.quality == gnss_fix_t::QUALITY_NONE) {
    return Fault(kGnssSubject, words, "the antenna needs a free view of the sky, and after a cold start some minutes; its cable");
  }
  if (age_s > kFixSilenceS) return Fault(kGnssSubject, words + ": it has stopped", "the receiver's power and cable");
  if (fix.quality >= gnss_fix_t::QUALITY_DEAD_RECKONING) {
    return Warning(kGnssSubject, words + ": not measured by satellites", "the antenna's view of the sky; the receiver's mode");
  }
  if (fix.num_satellites >= 0 && fix.num_satellites < kFewSatellites) {
    return Warning(kGnssSubject, words + ": few satellites", "a freer view of the sky for the antenna");
  }
  if (fix.horizontal_sd_m > kPoorFixM) return Warning(kGnssSubject, words + ": poor", "a freer view of the sky for the antenna; wait");
  return Ok(kGnssSubject, words);
}

std::string CourseInWords(double min_speed_mps) { return "the course over ground replaces it above " + Fixed(min_speed_mps, 1) + " m/s"; }

// gpsd 3.22 (Debian 12) gives its clients neither $HEHDT nor $HEROT.
std::string GpsdInWords(const Observations& seen) {
  const auto& connections = seen.config.navigation->connections;
  const auto is_gpsd = [&connections](const std::string& name) {
    return std::ranges::any_of(
        connections, [&name](const auto& connection) { return connection.name == name && connection.kind == navigator::Connection::Kind::kGpsd; });
  };
  const auto& sources = seen.navigation.num_by_source;
  const bool is_gpsd_alone = !sources.empty() && std::ranges::all_of(sources, [&is_gpsd](const auto& entry) { return is_gpsd(entry.first); });
  return is_gpsd_alone ? "; gpsd 3.22 does not pass $HEHDT and $HEROT: connect the compass to an input of its own" : "";
}

Finding CheckHeading(const Observations& seen) {
  const auto& pose = seen.navigation.pose;
  const auto& filter = seen.config.navigation->navigator.filter;
  const std::string cure = std::string(
                               "a GNSS compass, or an AHRS with heading (HDT, THS, PASHR, PTNTHTM, HDG with deviation and declination); its input "
                               "and role in navigator.txtpb") +
                           GpsdInWords(seen);
  if (pose && pose->status >= pose_t::STATUS_RELATIVE && pose->heading_source == pose_t::HEADING_NONE) {
    return Warning(kHeadingSubject, "none: POSE is relative, its bearings are from where the bow pointed at the start",
                   "connect a compass or an attitude sensor; without one tracks have no place on the earth and plotters get nothing");
  }
  if (!pose || pose->heading_source == pose_t::HEADING_NONE || !std::isfinite(pose->heading_rad)) {
    if (filter.use_course_as_heading) {
      return Warning(kHeadingSubject, "none: obstacles are placed in the vessel frame only; " + CourseInWords(filter.min_course_speed_mps), cure);
    }
    return Fault(kHeadingSubject, "none, and use_course_as_heading is off: obstacles are placed in the vessel frame only", cure);
  }
  const double sd_deg = RadToDeg(std::sqrt(std::max(0.0, pose->covariance[kHeadingIndex][kHeadingIndex])));
  const std::string value = Fixed(RadToDeg(pose->heading_rad), 1) + " deg from true north, sd " + Fixed(sd_deg, 1) + " deg";
  if (pose->heading_source == pose_t::HEADING_COURSE) {
    return Warning(kHeadingSubject, value + ", from the course over ground: it includes leeway and current, and at rest there is none", cure);
  }
  std::string words = value;
  if (const auto& heading = seen.navigation.heading) words += ", from input '" + heading->source + "' (" + heading->sentence_type + ")";
  if (sd_deg > kPoorHeadingDeg) {
    return Warning(kHeadingSubject, words + ": poor, at 10 m an obstacle is " + Fixed(10.0 * DegToRad(sd_deg), 1) + " m aside",
                   "the heading sensor's own state; wait for its alignment");
  }
  return Ok(kHeadingSubject, words);
}

Finding CheckAttitude(const pose_t& pose) {
  if (!pose.has_attitude) {
    return Warning(kAttitudeSubject,
                   "roll and pitch are not measured: in waves, heights over the water and far obstacles are off, as their covariance says",
                   "an AHRS or IMU (PASHR, PSAT,HPR, PTNTHTM, XDR, VNINS, VNYMR, VNIMU) as an input of navigator.txtpb");
  }
  const auto side = [](double angle_rad, const char* positive, const char* negative) {
    return Fixed(std::abs(RadToDeg(angle_rad)), 1) + " deg " + (angle_rad < 0.0 ? negative : positive);
  };
  return Ok(kAttitudeSubject, "now " + side(pose.pitch_rad, "bow up", "bow down") + " and " + side(pose.roll_rad, "starboard down", "port down") +
                                  ": if the boat does not lie so, a sign in navigator.txtpb is wrong");
}

std::optional<Finding> CheckDatum(const Observations& seen) {
  const auto& datum = seen.config.navigation->navigator.filter.datum;
  const auto& fix = seen.navigation.fix;
  if (!datum || !fix || fix->quality == gnss_fix_t::QUALITY_NONE || !std::isfinite(fix->latitude_deg) || !std::isfinite(fix->longitude_deg))
    return {};
  const auto complaint = DatumComplaint(*datum, {fix->latitude_deg, fix->longitude_deg, 0.0}, "the fix");
  if (complaint.empty()) return {};
  return Warning(kGnssSubject, complaint, "correct datum in boat.txtpb, or remove it: then the first fix is the datum");
}

// nullptr: the input is none.
const navigator::SourceParams* AutopilotOf(const Observations& seen, const std::string& name) {
  const auto& sources = seen.config.navigation->navigator.sources;
  const auto source = std::ranges::find(sources, name, &navigator::SourceParams::name);
  return source != sources.end() && source->protocol == navigator::Protocol::kMavlink ? &*source : nullptr;
}

// Each kind of message is switched on by itself, and another receiver or compass hides that one is missing.
Findings CheckAutopilots(const Observations& seen) {
  Findings findings;
  for (const auto& [name, num_messages] : seen.navigation.num_by_source) {
    const auto* autopilot = AutopilotOf(seen, name);
    if (autopilot == nullptr) continue;
    const auto found = seen.navigation.told_by_source.find(name);
    const auto told = found == seen.navigation.told_by_source.end() ? InputSeen{} : found->second;
    const auto role = autopilot->role;
    const bool gives_place = role == navigator::Role::kAll || role == navigator::Role::kGnss;
    const bool gives_heading = role == navigator::Role::kAll || role == navigator::Role::kHeading || role == navigator::Role::kAttitude;
    if (gives_place && told.num_places == 0) {
      findings.push_back(Warning(kInputSubject,
                                 fmt::format("'{}' gives no position: no GLOBAL_POSITION_INT with a place comes from the autopilot", name),
                                 "SRn_POSITION 10 for its port (ArduPilot), mavlink stream (PX4); the autopilot's own alignment"));
    } else if (gives_place && told.num_fixes == 0) {
      findings.push_back(Warning(kInputSubject,
                                 fmt::format("'{}' gives positions without a fix: no GPS_RAW_INT of three dimensions comes beside them, and they are "
                                             "not used",
                                             name),
                                 "SRn_EXT_STAT 2 for its port (ArduPilot), mavlink stream (PX4); the view of the sky of the autopilot's antenna"));
    }
    if (gives_heading && told.num_attitudes == 0) {
      findings.push_back(Warning(kInputSubject, fmt::format("'{}' gives no heading: no ATTITUDE comes from the autopilot", name),
                                 "SRn_EXTRA1 20 for its port (ArduPilot), mavlink stream (PX4)"));
    }
  }
  return findings;
}

// Finds silent inputs among those that the config names. "udp" does not count: it is open on many boats that send nothing there. An input that cannot
// be opened is told elsewhere.
Findings CheckSilence(const Observations& seen) {
  Findings findings;
  for (const auto& connection : seen.config.navigation->connections) {
    const auto& name = connection.name;
    const bool is_at_fault = std::ranges::count(seen.navigation.input_faults, name, &std::pair<std::string, std::string>::first) > 0;
    if (name == "udp" || connection.kind == navigator::Connection::Kind::kTextLog || is_at_fault || seen.navigation.num_by_source.contains(name)) {
      continue;
    }
    if (const auto* autopilot = AutopilotOf(seen, name)) {
      findings.push_back(Warning(kInputSubject,
                                 fmt::format("'{}' is silent: no ATTITUDE, GLOBAL_POSITION_INT or GPS_RAW_INT of system {}, component {} came from "
                                             "it in {:.0f} s",
                                             name, autopilot->mavlink_system_id, navigator::MavlinkCutter::kAutopilotComponent, seen.watched_s),
                                 "the autopilot's power and cable, baud or address and port; SERIALn_PROTOCOL 2 and SRn_EXTRA1, SRn_POSITION, "
                                 "SRn_EXT_STAT of its port; mavlink_system_id"));
      continue;
    }
    findings.push_back(Warning(kInputSubject, fmt::format("'{}' is silent: nothing came from it in {:.0f} s", name, seen.watched_s),
                               "its power, cable, baud, address and port; an AIS receiver says nothing where no ship is near"));
  }
  return findings;
}

}  // namespace

Findings CheckNavigation(const Observations& seen) {
  if (!seen.config.navigation) return {Warning(kGnssSubject, "not checked: navigator.txtpb or boat.txtpb is wrong", "correct it first")};
  if (seen.navigation.via == Via::kNothing) {
    return {Warning(kGnssSubject, "navigator.txtpb names NAV_RAW of a log: no receiver is checked", "source: LIVE for a receiver")};
  }
  Findings findings;
  for (const auto& [name, fault] : seen.navigation.input_faults) {
    findings.push_back(Fault(kInputSubject, fmt::format("'{}': {}", name, fault), "its entry in navigator.txtpb; its cable"));
  }
  findings.push_back(CheckFix(seen));
  if (seen.navigation.num_by_source.empty()) return findings;
  for (auto& silent : CheckSilence(seen)) findings.push_back(std::move(silent));
  for (auto& lack : CheckAutopilots(seen)) findings.push_back(std::move(lack));
  if (auto datum = CheckDatum(seen)) findings.push_back(std::move(*datum));
  findings.push_back(CheckHeading(seen));
  if (seen.navigation.pose) findings.push_back(CheckAttitude(*seen.navigation.pose));
  if (seen.navigation.complaint.find("clock of this computer is off") != std::string::npos) {
    findings.push_back(Warning("clock", seen.navigation.complaint, "set this computer's clock: chrony with the GNSS receiver or NTP"));
  }
  return findings;
}

}  // namespace lookout::doctor
