package lookout.spy;

import java.util.Locale;
import lookout.alert_t;
import lookout.obstacle_t;
import lookout.track_t;

/** Numbers in words for people. The locale of the computer has no say. */
final class Texts {
  private Texts() {}

  /** "7: 17.3 m 045°", tentative "7? 17.3 m 045°". */
  static String obstacle(obstacle_t obstacle) {
    return String.format(Locale.ROOT, "%d%s %.1f m %s", obstacle.id, obstacle.confidence == obstacle_t.CONFIDENCE_SURE ? ":" : "?", obstacle.range_m,
        degrees(obstacle.bearing_rad));
  }

  /** "17 2.5 m/s", a standing one "17". */
  static String track(track_t track) {
    return track.speed_mps > 0f ? String.format(Locale.ROOT, "%d %.1f m/s", track.id, track.speed_mps) : Long.toString(track.id);
  }

  /** "WARNING: ..." */
  static String alert(alert_t alert) {
    return (alert.level == alert_t.LEVEL_WARNING ? "WARNING: " : "CAUTION: ") + alert.text;
  }

  /** Whole degrees of the circle, three digits. */
  static String degrees(double angle_rad) {
    return String.format(Locale.ROOT, "%03d°", Math.floorMod(Math.round(Math.toDegrees(angle_rad)), 360L));
  }

  /** Whole per cent, rounded down: 100 is certain. "-" where it is not stated. */
  static String percent(float probability) {
    return probability >= 0f && probability <= 1f ? (int) Math.floor(100.0 * probability) + "%" : "-";
  }

  /** As common/messages/words.hpp. */
  static String confidence(obstacle_t obstacle) {
    String word = obstacle.confidence == obstacle_t.CONFIDENCE_SURE ? "sure" : "tentative";
    return obstacle.kind == obstacle_t.KIND_LAND ? "land" + (word.equals("sure") ? "" : " ?") : word;
  }
}
