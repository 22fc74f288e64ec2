// The lidar process without its sources: datagrams or LIDAR_PACKETS in; LIDAR_PACKETS, LIDAR_NMEA, LIDAR_CLOCK and LIDAR_SCAN out.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/core/bytes.hpp"
#include "common/core/health.hpp"
#include "common/core/utime.hpp"
#include "lookout/lidar_beams_t.hpp"
#include "lookout/lidar_packets_t.hpp"
#include "services/lidar/core/driver/bundler.hpp"
#include "services/lidar/core/driver/decoder.hpp"
#include "services/lidar/core/driver/sender_lock.hpp"
#include "services/lidar/params.hpp"

namespace lookout::lidar {

class Service {
 public:
  Service(bus::Bus& bus, const Params& params);

  /// A datagram from outside. Datagrams of the right port and size from the lidar that holds the lock (SenderLock) are collected; when a bundle is
  /// full or a scan ends, it is published as LIDAR_PACKETS and then exactly that bundle is decoded. Input::kOutside only.
  void OnDatagram(Utime host_time, int udp_port, Bytes payload, const Sender& sender = {});

  /// Host time has come so far: a bundle does not wait for more than 100 ms, and silence of the lidar shows in Report().
  ///
  /// @param taken_until  before it all datagrams are taken; nullopt = host_time. Bundles go by it, silence and rates by `host_time`, so that a flood
  ///                     that never ends cannot hide them
  void AdvanceTo(Utime host_time, std::optional<Utime> taken_until = std::nullopt);

  /// End of input. kOutside: publishes the END mark, if anything ever came, and consumes it. kLog: flushes, unless an END mark did.
  void Finish(Utime host_time);

  /// The sensor told its beams. Where they are not those in use, the run ends and the next begins with them.
  ///
  /// @return what is wrong with the text, which then changes nothing; empty = nothing. Precondition: Params::other
  std::string UseBeams(Utime host_time, const std::string& text, const std::string& origin);

  /// Whether the sensor should be asked for its beams: there are none, or its packets are refused.
  bool WantsBeams() const;

  HealthReport Report() const;

  /// Called with a line for the journal each time that the state of the sensor's clock, or the clock that stamps the scans, changes, and when another
  /// lidar is accepted or packets of other senders are refused: about refusals at most one line a second.
  void OnNotice(std::function<void(const std::string&)> handler) { on_notice_ = std::move(handler); }

 private:
  // All that depends on the model and its beams.
  struct Reading {
    explicit Reading(const Params& params, Service& service);

    Bundler bundler;
    SenderLock lock;
    std::unique_ptr<Decoder> decoder;
  };

  void OnMessage(const lidar_packets_t& message);
  void OnBeams(const lidar_beams_t& message);
  void PublishBeams(const PacketBundle& bundle);
  bool NeedsBeams() const { return params_.other && params_.other->beam_text.empty() && RowOf(params_.other->model).needs_beam_file; }
  void PublishAndConsume(const PacketBundle& bundle);
  void Consume(const PacketBundle& bundle);
  void AppendReading(std::vector<Counter>& counters) const;
  void PublishScan(const Scan& scan);
  void PublishSentence(const SentenceOfLidar& sentence);
  void NoteClock(const ClockReading& clock);
  bool IsTaken(Utime host_time, int udp_port, const Sender& sender, Bytes payload);
  void NoteHolder(Utime host_time, Stream stream, const std::optional<Sender>& before);
  void NoteRefused(Utime host_time, Stream stream, const Sender& sender, bool is_valid);
  std::string ForeignComplaint() const;
  std::string SameAddressComplaint(const Sender& holder, int port, const std::string& refused) const;
  std::string Complaint() const;
  std::string OwnComplaint() const;

  bus::Bus& bus_;
  Params params_;
  std::optional<Reading> reading_;  // nullopt: the beams are not known yet
  std::int64_t raw_seq_ = 0;        // of the bundle that is being consumed
  std::int64_t sentence_seq_ = 0;
  std::int64_t num_refused_messages_ = 0;
  std::int64_t num_beams_refused_ = 0;
  std::int64_t num_beams_of_log_ = 0;      // beam tables of a log that differ from the config's
  std::int64_t num_waited_for_beams_ = 0;  // packets that came before the beams were known
  std::int64_t beams_seq_ = 0;
  std::optional<Utime> beams_sent_;      // packets of that time followed
  std::string beams_complaint_;          // of the last refused message
  std::int64_t num_other_port_ = 0;      // payloads in a log that were recorded on ports other than the config says
  std::optional<Utime> silent_since_;    // host time of the last usable data packet, or at which waiting began
  std::optional<Utime> scanless_since_;  // host time of the last scan, or of the first packet behind silence
  bool has_scan_ = false;                // since the last packet
  Utime now_{};                          // host time so far
  std::int64_t num_data_packets_ = 0;    // in the second that runs
  std::int64_t data_packets_per_s_ = 0;
  std::int64_t num_out_of_stream_ = 0;  // until the last second
  std::int64_t out_of_stream_per_s_ = 0;
  std::optional<Utime> second_began_;
  std::function<void(const std::string&)> on_notice_;
  // The last refused sender, the reason, and the last line of the journal about it.
  struct Refusal {
    Sender sender;
    Stream stream = Stream::kData;
    bool is_valid = false;
    Utime time{};
    Utime began{};  // begin of the uninterrupted refusals of this address
  };
  std::optional<Refusal> refusal_;
  std::array<std::int64_t, 2> num_sender_refused_{};  // by stream
  std::int64_t num_lidar_changes_ = 0;
  std::optional<Refusal> told_refusal_;
  std::optional<ClockState> noted_state_;
  std::optional<TimeSource> noted_source_;
};

}  // namespace lookout::lidar
