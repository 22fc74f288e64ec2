package lookout.spy;

import java.util.ArrayList;
import java.util.List;
import java.util.Map;
import java.util.TreeMap;
import lookout.alert_t;
import lookout.alerts_t;
import lookout.pose_t;
import lookout.track_t;
import lookout.tracks_t;

/** Merges the messages of the tracker, which come in parts. What cannot be drawn is left out. Not for several threads. */
final class Tracks {
  // Two seconds of POSE.
  private static final int MAX_POSES = 100;

  private final TreeMap<Integer, tracks_t> parts = new TreeMap<>();
  private final TreeMap<Long, pose_t> poses = new TreeMap<>();
  private List<float[]> waterline = List.of();
  private LookOut lookOut = LookOut.NONE;

  LookOut lookOut() {
    return lookOut;
  }

  void add(pose_t pose) {
    // The navigator began anew in the past.
    if (!poses.isEmpty() && pose.utime_us < poses.firstKey()) poses.clear();
    poses.put(pose.utime_us, pose);
    while (poses.size() > MAX_POSES) poses.pollFirstEntry();
  }

  void add(tracks_t part, long now_ms) {
    if (!parts.isEmpty()) {
      tracks_t first = parts.firstEntry().getValue();
      if (first.utime_us != part.utime_us || first.seq != part.seq || first.num_parts != part.num_parts) parts.clear();
    }
    parts.put(part.part_index, part);
    if (parts.size() < part.num_parts) return;

    List<track_t> tracks = new ArrayList<>();
    for (tracks_t each : parts.values()) {
      for (track_t track : each.tracks) {
        boolean isThere = track.status == track_t.STATUS_CONFIRMED || track.status == track_t.STATUS_COASTING;
        if (isThere && isDrawable(track)) tracks.add(track);
      }
      if (each.num_waterline > 0) waterline = placesOf(each);
    }
    parts.clear();
    Map.Entry<Long, pose_t> own = poses.floorEntry(part.end_utime_us);
    boolean isPlaced = own != null && isInFrameOf(own.getValue(), part);
    lookOut = new LookOut(List.copyOf(tracks), waterline, lookOut.alerts(), isPlaced ? own.getValue() : null, now_ms, lookOut.alertsTime_ms());
  }

  void add(alerts_t message, long now_ms) {
    List<alert_t> alerts = List.of(message.alerts);
    lookOut = new LookOut(lookOut.tracks(), lookOut.waterline(), alerts, lookOut.own(), lookOut.tracksTime_ms(), now_ms);
  }

  private static boolean isDrawable(track_t track) {
    double sum = track.position_map_m[0] + track.position_map_m[1] + track.velocity_map_mps[0] + track.velocity_map_mps[1];
    for (int i = 0; i < track.num_outline; ++i) sum += track.outline_east_m[i] + track.outline_north_m[i];
    return Double.isFinite(sum);
  }

  private static boolean isInFrameOf(pose_t own, tracks_t tracks) {
    return Double.isFinite(own.heading_rad + own.position_map_m[0] + own.position_map_m[1]) && own.datum_latitude_deg == tracks.datum_latitude_deg
        && own.datum_longitude_deg == tracks.datum_longitude_deg;
  }

  private static List<float[]> placesOf(tracks_t tracks) {
    List<float[]> places = new ArrayList<>();
    for (int i = 0; i < tracks.num_waterline; ++i) {
      float[] place = {tracks.waterline_east_m[i], tracks.waterline_north_m[i]};
      if (Float.isFinite(place[0] + place[1])) places.add(place);
    }
    return List.copyOf(places);
  }
}
