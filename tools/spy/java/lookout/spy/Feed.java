package lookout.spy;

import java.io.IOException;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import lcm.lcm.LCMSubscriber;
import lookout.alerts_t;
import lookout.lidar_scan_t;
import lookout.obstacles_t;
import lookout.pose_t;
import lookout.segments_t;
import lookout.tracks_t;

/** Listens on a bus of its own (LCM_DEFAULT_URL, as the spy), since the spy keeps only the last message of a channel, and scans come in parts. */
final class Feed implements LCMSubscriber, AutoCloseable {
  /** As common/bus/channels.hpp; LCM takes them as one regular expression. */
  private static final String CHANNELS = "LIDAR_SCAN|SEGMENTS|OBSTACLES|POSE|TRACKS|ALERTS";

  private final Scans scans = new Scans();
  private final LCM lcm;

  /** @throws IOException when LCM cannot be opened */
  Feed() throws IOException {
    lcm = new LCM();
    lcm.subscribe(CHANNELS, this);
  }

  synchronized Picture picture() {
    return scans.picture();
  }

  synchronized long num_refused() {
    return scans.num_refused();
  }

  @Override
  public synchronized void messageReceived(LCM unused, String channel, LCMDataInputStream bytes) {
    decode(scans, channel, bytes, System.currentTimeMillis());
  }

  /** Decodes a message and hands it on; what does not decode is counted. Never throws. */
  static void decode(Scans scans, String channel, LCMDataInputStream bytes, long now_ms) {
    try {
      switch (channel) {
        case "LIDAR_SCAN" -> scans.add(new lidar_scan_t(bytes), now_ms);
        case "SEGMENTS" -> scans.add(new segments_t(bytes), now_ms);
        case "OBSTACLES" -> scans.add(new obstacles_t(bytes), now_ms);
        case "POSE" -> scans.add(new pose_t(bytes));
        case "TRACKS" -> scans.add(new tracks_t(bytes), now_ms);
        case "ALERTS" -> scans.add(new alerts_t(bytes), now_ms);
        default -> { }
      }
    } catch (IOException | RuntimeException corrupt) {
      scans.refuse();
    }
  }

  @Override
  public void close() {
    lcm.close();
  }
}
