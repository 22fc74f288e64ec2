// Sentences of NMEA 0183 for alerts: ALR and ACK; ALF, ALC, HBT, ACN and ARC as IEC 61162-1 and IEC 62923-1 have them. Each ends with CR LF and has
// at most 82 characters.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "services/plotter/core/notice_schedule.hpp"
#include "services/plotter/core/scene.hpp"

namespace lookout::plotter {

/// Number of an alert in ALR and ACK: 001 to 997; 000: no look-out, from the tracker's watch; 998: no look-out, from the plotter; 999: no position.
int AlarmNumber(const Notice& notice);
/// Alarm: threshold exceeded (A) while it holds, acknowledged (A) or not (V).
std::string Alr(std::string_view talker, const Notice& notice, Utime time);

/// How an alert stands in ALF.
///
/// @return A: active and acknowledged, or a caution, which wants none; V: active, not acknowledged; S: the same, silenced; U: over, not acknowledged;
///   N: over
char AlfStateOf(const Notice& notice);
/// Alert: two sentences, the title and the text.
///
/// @param sequence  0 to 9, one more for each alert that is sent
/// @param revision  1 to 99, one more with each change of the alert
std::string Alf(std::string_view talker, const Notice& notice, Utime time, int sequence, int revision);
/// Cyclic list of the alerts that are not over, each with its revision: as many sentences as it takes, one without an alert where there is none.
///
/// @param sequence  0 to 99, one more for each list that is sent
std::string Alc(std::string_view talker, std::span<const ToldNotice> notices, int sequence);
/// Heartbeat.
///
/// @param period  after which the next one comes
/// @param is_well  false: there is no look-out
/// @param sequence  0 to 9, one more for each that is sent
std::string Hbt(std::string_view talker, std::chrono::seconds period, bool is_well, int sequence);

/// The command in a received sentence.
struct AlertCommand {
  // ACK can only acknowledge; ACN has the letters A, Q, O and S.
  enum class Kind : char { kAcknowledge = 'A', kTellAgain = 'Q', kHandOver = 'O', kSilence = 'S' };
  Kind kind = Kind::kAcknowledge;
  bool is_alarm_number = false;  // ACK
  std::int64_t number = 0;       // AlarmNumber, or the instance
  int identifier = 0;            // of ACN

  bool operator==(const AlertCommand&) const = default;
};

/// Answer that refuses a command of ACN.
std::string Arc(std::string_view talker, const AlertCommand& command, Utime time);

enum class LineKind { kCommand, kOther, kWrong };

/// @param line  without CR LF
/// @return kWrong: no sentence, or an ACK or ACN that cannot be read; kOther: another sentence, or an ACN to another maker's alert
LineKind ReadLine(std::string_view line, AlertCommand& command);

/// Whether the command means this alert.
bool Means(const AlertCommand& command, const Notice& notice);

}  // namespace lookout::plotter
