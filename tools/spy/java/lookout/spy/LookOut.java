package lookout.spy;

import java.awt.geom.AffineTransform;
import java.util.List;
import lookout.alert_t;
import lookout.pose_t;
import lookout.track_t;

/**
 * What the tracker says, in the map frame (east, north): never changed once made.
 *
 * @param tracks of the newest whole scan, by id
 * @param waterline of land that is remembered: places {east, north}, of the last time that it came
 * @param alerts of the last ALERTS, the gravest first
 * @param own where the boat was at the end of that scan; null: not known, then nothing can be drawn
 * @param tracksTime_ms host time of the last tracks; 0 = none yet
 * @param alertsTime_ms of the last ALERTS; 0 = none yet
 */
record LookOut(List<track_t> tracks, List<float[]> waterline, List<alert_t> alerts, pose_t own, long tracksTime_ms, long alertsTime_ms) {
  static final LookOut NONE = new LookOut(List.of(), List.of(), List.of(), null, 0, 0);

  /** What is older says nothing about the water of now; ALERTS come with every scan, and where none comes twice a second. */
  static final long MAX_TRACKS_AGE_MS = 2000;
  static final long MAX_ALERTS_AGE_MS = 1000;

  boolean hasTracks(long now_ms) {
    return tracksTime_ms != 0 && now_ms - tracksTime_ms <= MAX_TRACKS_AGE_MS;
  }

  /** A tracker was heard, and says nothing any more. */
  boolean isSilent(long now_ms) {
    return alertsTime_ms != 0 && now_ms - alertsTime_ms > MAX_ALERTS_AGE_MS;
  }

  /** From the map to the vessel frame (x forward, y port); own is known. */
  AffineTransform toVessel() {
    double sine = Math.sin(own.heading_rad);
    double cosine = Math.cos(own.heading_rad);
    AffineTransform transform = new AffineTransform(sine, -cosine, cosine, sine, 0, 0);
    transform.translate(-own.position_map_m[0], -own.position_map_m[1]);
    return transform;
  }

  /** The gravest level of what is active of this track, as in alert_t; 0: none. */
  int levelOf(long track_id) {
    int level = 0;
    for (alert_t alert : alerts) {
      if (alert.track_id == track_id && alert.state == alert_t.STATE_ACTIVE) level = Math.max(level, alert.level);
    }
    return level;
  }
}
