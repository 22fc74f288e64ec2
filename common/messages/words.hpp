// The words that stand for the codes of the wire in tables and on screens. Defined here only; lcmtypes/README.md lists them (a test compares).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "lookout/ais_ship_t.hpp"
#include "lookout/alert_t.hpp"
#include "lookout/gnss_fix_t.hpp"
#include "lookout/health_t.hpp"
#include "lookout/lidar_clock_t.hpp"
#include "lookout/obstacle_t.hpp"
#include "lookout/pose_t.hpp"
#include "lookout/segment_t.hpp"
#include "lookout/segments_t.hpp"
#include "lookout/track_t.hpp"

namespace lookout::words {

struct Word {
  int code;
  std::string_view text;
};

/// Why a return is in no segment; the code is minus its label.
inline constexpr std::array kReason{Word{segments_t::REASON_RANGE, "range"}, Word{segments_t::REASON_OWN_VESSEL, "own_vessel"},
                                    Word{segments_t::REASON_FIELD_OF_VIEW, "field_of_view"}, Word{segments_t::REASON_SHADOWED, "shadowed"},
                                    Word{segments_t::REASON_TOO_SMALL, "too_small"}};

inline constexpr std::array kObstacleStatus{Word{obstacle_t::STATUS_OK, "ok"}, Word{obstacle_t::STATUS_VESSEL_FRAME_ONLY, "vessel_frame_only"},
                                            Word{obstacle_t::STATUS_POSE_TIMEOUT, "pose_timeout"}};

// Of segments; georeferencer holds by static_assert that those of obstacles are the same.
inline constexpr std::array kConfidence{Word{segment_t::CONFIDENCE_TENTATIVE, "tentative"}, Word{segment_t::CONFIDENCE_SURE, "sure"}};

/// Bits: see WordsOf.
inline constexpr std::array kGround{Word{segment_t::GROUND_FEW_RETURNS, "few_returns"}, Word{segment_t::GROUND_SCATTERED, "scattered"},
                                    Word{segment_t::GROUND_AT_SURFACE, "at_surface"}};

inline constexpr std::array kKind{Word{segment_t::KIND_OBSTACLE, "obstacle"}, Word{segment_t::KIND_LAND, "land"}};

inline constexpr std::array kTrackStatus{Word{track_t::STATUS_TENTATIVE, "tentative"}, Word{track_t::STATUS_CONFIRMED, "confirmed"},
                                         Word{track_t::STATUS_COASTING, "coasting"}, Word{track_t::STATUS_LOST, "lost"}};

inline constexpr std::array kTrackKind{Word{track_t::KIND_OBSTACLE, "obstacle"}, Word{track_t::KIND_BUOY, "buoy"}, Word{track_t::KIND_BOAT, "boat"},
                                       Word{track_t::KIND_STRUCTURE, "structure"}, Word{track_t::KIND_UNKNOWN, "unknown"}};

/// As in COLREGs rules 13 to 15.
inline constexpr std::array kEncounter{Word{track_t::ENCOUNTER_NONE, "none"},
                                       Word{track_t::ENCOUNTER_HEAD_ON, "head_on"},
                                       Word{track_t::ENCOUNTER_CROSSING_GIVE_WAY, "crossing_give_way"},
                                       Word{track_t::ENCOUNTER_CROSSING_STAND_ON, "crossing_stand_on"},
                                       Word{track_t::ENCOUNTER_OVERTAKING, "overtaking"},
                                       Word{track_t::ENCOUNTER_OVERTAKEN, "overtaken"}};

inline constexpr std::array kAisSender{Word{ais_ship_t::SENDER_UNKNOWN, "unknown"}, Word{ais_ship_t::SENDER_CLASS_A, "class_a"},
                                       Word{ais_ship_t::SENDER_CLASS_B, "class_b"}, Word{ais_ship_t::SENDER_AID, "aid"},
                                       Word{ais_ship_t::SENDER_BASE, "base"},       Word{ais_ship_t::SENDER_AIRCRAFT, "aircraft"}};

/// Whether the lidar sees a ship of AIS.
inline constexpr std::array kAisState{Word{ais_ship_t::STATE_NOT_IN_SIGHT, "not_in_sight"}, Word{ais_ship_t::STATE_TRACKED, "tracked"},
                                      Word{ais_ship_t::STATE_UNSURE, "unsure"}, Word{ais_ship_t::STATE_AIS_ONLY, "ais_only"}};

inline constexpr std::array kAlertCause{Word{alert_t::CAUSE_GUARD_ZONE, "guard_zone"}, Word{alert_t::CAUSE_CLOSEST_APPROACH, "closest_approach"},
                                        Word{alert_t::CAUSE_WATCH, "watch"}};

inline constexpr std::array kAlertLevel{Word{alert_t::LEVEL_CAUTION, "caution"}, Word{alert_t::LEVEL_WARNING, "warning"}};

inline constexpr std::array kAlertSight{Word{alert_t::SIGHT_SEEN, "seen"}, Word{alert_t::SIGHT_JUST_SEEN, "just_seen"},
                                        Word{alert_t::SIGHT_LOST, "lost"}};

inline constexpr std::array kAlertEnd{Word{alert_t::END_NONE, ""},     Word{alert_t::END_CLEAR, "clear"},   Word{alert_t::END_PASSED, "passed"},
                                      Word{alert_t::END_GONE, "gone"}, Word{alert_t::END_HIDDEN, "hidden"}, Word{alert_t::END_MERGED, "merged"}};

inline constexpr std::array kAlertState{Word{alert_t::STATE_ACTIVE, "active"}, Word{alert_t::STATE_ACKNOWLEDGED, "acknowledged"},
                                        Word{alert_t::STATE_RECTIFIED, "rectified"}, Word{alert_t::STATE_CLEARED, "cleared"}};

inline constexpr std::array kPoseStatus{Word{pose_t::STATUS_OK, "ok"},
                                        Word{pose_t::STATUS_NO_HEADING, "no_heading"},
                                        Word{pose_t::STATUS_NO_POSITION, "no_position"},
                                        Word{pose_t::STATUS_UNKNOWN, "unknown"},
                                        Word{pose_t::STATUS_COASTING, "coasting"},
                                        Word{pose_t::STATUS_RELATIVE, "relative"},
                                        Word{pose_t::STATUS_RELATIVE_COASTING, "relative_coasting"},
                                        Word{pose_t::STATUS_RELATIVE_TO_BOAT, "relative_to_boat"}};

/// The source of POSE's heading: a compass, an attitude sensor, or only the course over ground.
inline constexpr std::array kHeadingSource{Word{pose_t::HEADING_NONE, "none"}, Word{pose_t::HEADING_HDT, "hdt"}, Word{pose_t::HEADING_PASHR, "pashr"},
                                           Word{pose_t::HEADING_COURSE, "course"}};

inline constexpr std::array kTimeSource{Word{lidar_clock_t::TIME_HOST, "host"}, Word{lidar_clock_t::TIME_SENSOR, "sensor"}};

inline constexpr std::array kClockState{
    Word{lidar_clock_t::STATE_UNKNOWN, "unknown"},     Word{lidar_clock_t::STATE_NO_PPS, "no_pps"},
    Word{lidar_clock_t::STATE_ACQUIRING, "acquiring"}, Word{lidar_clock_t::STATE_LOCKED_WITHOUT_TIME, "locked_without_time"},
    Word{lidar_clock_t::STATE_LOCKED, "locked"},       Word{lidar_clock_t::STATE_FREE_RUNNING, "free_running"},
    Word{lidar_clock_t::STATE_ERROR, "error"}};

inline constexpr std::array kFixQuality{Word{gnss_fix_t::QUALITY_NONE, "none"},
                                        Word{gnss_fix_t::QUALITY_GNSS, "gnss"},
                                        Word{gnss_fix_t::QUALITY_DIFFERENTIAL, "differential"},
                                        Word{gnss_fix_t::QUALITY_PPS, "pps"},
                                        Word{gnss_fix_t::QUALITY_RTK_FIXED, "rtk_fixed"},
                                        Word{gnss_fix_t::QUALITY_RTK_FLOAT, "rtk_float"},
                                        Word{gnss_fix_t::QUALITY_DEAD_RECKONING, "dead_reckoning"},
                                        Word{gnss_fix_t::QUALITY_MANUAL, "manual"},
                                        Word{gnss_fix_t::QUALITY_SIMULATOR, "simulator"}};

inline constexpr std::array kHealthState{Word{health_t::STATE_OK, "ok"}, Word{health_t::STATE_DEGRADED, "degraded"},
                                         Word{health_t::STATE_FAILED, "failed"}, Word{health_t::STATE_STARTING, "starting"}};

/// @return the word of `code`; "undefined" for a code that is not of this version
constexpr std::string_view WordOf(std::span<const Word> words, int code) {
  for (const auto& word : words) {
    if (word.code == code) return word.text;
  }
  return "undefined";
}

/// @return the words of the bits that are set, in the order of `words`, joined with "+"; "" for none; "undefined" stands last for bits that are not
///         of this version
inline std::string WordsOf(std::span<const Word> words, int bits) {
  std::string text;
  const auto add = [&text](std::string_view word) { text.append(text.empty() ? "" : "+").append(word); };
  for (const auto& word : words) {
    if ((bits & word.code) != 0) add(word.text);
    bits &= ~word.code;
  }
  if (bits != 0) add("undefined");
  return text;
}

/// Nine digits.
inline std::string MmsiText(std::int32_t mmsi) {
  constexpr std::size_t kDigits = 9;
  auto text = std::to_string(mmsi);
  text.insert(0, text.size() < kDigits ? kDigits - text.size() : 0, '0');
  return text;
}

}  // namespace lookout::words
