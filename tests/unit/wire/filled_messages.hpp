// One message of each channel's type with every array filled, for tests that cut and spoil the encoded bytes. A type whose counts or texts must fit
// together has a Fill of its own here; every other one is filled by FillArrays.
#pragma once

#include <string>
#include <vector>

#include "tests/support/wire_types.hpp"

namespace lookout {

inline void Fill(lidar_packets_t& m) {
  m.num_packets = 2;
  m.host_utime_us = {1, 2};
  m.udp_port = {2368, 8308};
  m.size_bytes = {3, 2};
  m.num_bytes = 5;
  m.payload = {1, 2, 3, 4, 5};
}

inline void Fill(lidar_scan_t& m) {
  m.model = "VLP-16";
  m.num_rings = 2;
  m.elevation_rad = {-0.1F, 0.1F};
  m.azimuth_offset_rad = {0.0F, 0.0F};
  m.time_offset_ns = {0, 2304};
  m.origin_height_m = {0.0F, 0.0F};
  m.num_returns = 1;
  m.return_kind = {lidar_scan_t::RETURN_STRONGEST};
  m.num_columns = 3;
  m.azimuth_rad = {0.0F, 0.1F, 0.2F};
  m.time_ns = {0, 55296, 110592};
  m.num_cells = 6;
  m.range = {1, 2, 3, 4, 5, 6};
  m.reflectivity = {1, 2, 3, 4, 5, 6};
}

inline void Fill(lidar_clock_t& m) { m.num_packets = 75; }

inline void Fill(lidar_nmea_t& m) { m.sentence = "$GPRMC,120000,A*00"; }

inline void Fill(segments_t& m) {
  m.num_cells = 4;
  m.label = {1, 0, -1, 2};
  m.num_labelled = 2;
  m.piece = {1, 3};
  m.num_segments = 2;
  m.segments.resize(2);
  for (auto& segment : m.segments) {
    segment.num_hull = 3;
    segment.hull_x_m = {0.0F, 1.0F, 0.0F};
    segment.hull_y_m = {0.0F, 0.0F, 1.0F};
    segment.hull_time_us = {1, 2, 3};
    segment.num_waterline = 2;
    segment.waterline_x_m = segment.waterline_y_m = {0.0F, 1.0F};
    segment.waterline_time_us = {1, 2};
  }
}

inline void Fill(nav_raw_t& m) {
  m.kind = nav_raw_t::KIND_IMU;
  m.source = "udp";
  m.sentence = "$HEHDT,12.3,T*00";
  m.num_imu = 1;
  m.imu.resize(1);
}

inline void Fill(gnss_fix_t& m) {
  m.source = "udp";
  m.sentence_type = "RMC";
}

inline void Fill(attitude_t& m) {
  m.source = "udp";
  m.sentence_type = "HDT";
}

inline void Fill(pose_t& m) { m.covariance[8][8] = 1.0; }

inline void Fill(obstacles_t& m) {
  m.num_obstacles = 2;
  m.obstacles.resize(2);
  for (auto& obstacle : m.obstacles) {
    obstacle.num_footprint = obstacle.num_map = 2;
    obstacle.footprint_vessel_x_m = obstacle.footprint_vessel_y_m = obstacle.footprint_east_m = obstacle.footprint_north_m = {1.0F, 2.0F};
    obstacle.num_waterline = obstacle.num_waterline_map = 1;
    obstacle.waterline_vessel_x_m = obstacle.waterline_vessel_y_m = obstacle.waterline_east_m = obstacle.waterline_north_m = {3.0F};
  }
}

inline void Fill(tracks_t& m) {
  m.num_tracks = 2;
  m.tracks.resize(2);
  for (auto& track : m.tracks) {
    track.num_outline = 2;
    track.outline_east_m = track.outline_north_m = {1.0F, 2.0F};
    track.num_segments = 1;
    track.segment_ids = {3};
    track.num_parents = track.num_children = 1;
    track.parents = track.children = {4};
  }
  m.num_land_segments = 2;
  m.land_segment_ids = {1, 2};
  m.first_piece = 1;
  m.num_pieces = 3;
  m.track_of_piece = {17, 0, -1};
  m.num_waterline = 2;
  m.waterline_east_m = m.waterline_north_m = {1.0F, 2.0F};
}

inline void Fill(alert_ack_t& m) { m.source = "page"; }

inline void Fill(order_t& m) {
  m.source = "page";
  m.name = "Kiosk pier";
}

inline void Fill(alerts_t& m) {
  m.num_alerts = 2;
  m.alerts.resize(2);
  m.alerts[0].name = "boat 17";
  m.alerts[0].text = "boat 17: closest approach 3 m in 21 s";
  m.num_acknowledged = 1;
  m.acknowledged.resize(1);
  Fill(m.acknowledged[0]);
  m.num_orders = 1;
  m.orders.resize(1);
  Fill(m.orders[0]);
  m.num_names = 2;
  m.named_track_id = {3, 17};
  m.given_name = {"Kiosk pier", "Anna's mooring buoy"};
}

inline void Fill(health_t& m) {
  m.process = "lidar";
  m.host = "boat";
  m.reason = "no PPS";
  m.num_channels = 1;
  m.channels.resize(1);
  m.channels[0].channel = "LIDAR_SCAN";
  m.num_counters = 2;
  m.counters.resize(2);
  m.counters[0].name = "bad_flag";
}

inline void Fill(run_info_t& m) {
  m.program = "recorder";
  m.num_files = 2;
  m.file_name = {"boat.txtpb", "lidar.txtpb"};
  m.file_text = {"name: \"x\"", ""};
}

inline void Fill(sim_truth_t& m) {
  m.num_packets = 1;
  m.packet_utime_us = {1};
  m.num_slots = 3;
  m.object_id = {-1, 0, 7};
  m.reason = {1, 255, 0};
  m.num_objects = 2;
  m.objects.resize(2);
  for (auto& object : m.objects) {
    object.name = "kayak";
    object.num_outline = 2;
    object.outline_east_m = object.outline_north_m = {1.0, 2.0};
  }
}

/// Calls `use(message)` with a filled message of each channel's type.
template <typename Use>
void ForEachFilledMessage(Use use) {
  ForEachChannelType([&use](auto message) {
    if constexpr (requires { Fill(message); }) {
      Fill(message);
    } else {
      FillArrays(message);
    }
    use(message);
  });
}

}  // namespace lookout
