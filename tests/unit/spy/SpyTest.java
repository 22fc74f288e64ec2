package lookout.spy;

import java.awt.Color;
import java.awt.Graphics2D;
import java.awt.geom.Point2D;
import java.awt.image.BufferedImage;
import java.io.IOException;
import java.nio.file.Files;
import java.nio.file.Path;
import java.util.ArrayList;
import java.util.List;
import java.util.Random;
import lcm.lcm.LCMDataInputStream;
import lcm.lcm.LCMDataOutputStream;
import lcm.lcm.LCMEncodable;
import lcm.spy.SpyPlugin;
import lookout.alert_t;
import lookout.alerts_t;
import lookout.lidar_scan_t;
import lookout.obstacle_t;
import lookout.obstacles_t;
import lookout.pose_t;
import lookout.segment_t;
import lookout.segments_t;
import lookout.track_t;
import lookout.tracks_t;

/** The plugin without a display: what it handles, what it draws where, and that no message ends it. Exit code 1 and a line for each failure. */
public final class SpyTest {
  private static final int WIDTH = 1240;
  private static final int HEIGHT = 940;
  private static final double RADIUS_M = 50.0;
  private static final long NOW_MS = 1_000_000;
  private static int num_failures = 0;

  private SpyTest() {}

  private static void expect(boolean is_true, String sentence) {
    if (is_true) return;
    ++num_failures;
    System.out.println("FAILED: " + sentence);
  }

  private static void expectColour(BufferedImage image, double x, double y, Color expected, String what) {
    Color actual = new Color(image.getRGB((int) x, (int) y));
    expect(actual.equals(expected), what + ": " + actual + " instead of " + expected);
  }

  // Two rings, four columns (ahead, starboard, astern, port); one return: starboard, lower ring, 20 m.
  private static lidar_scan_t scanOf(long seq) {
    lidar_scan_t scan = new lidar_scan_t();
    scan.utime_us = 1000 + seq;
    scan.seq = seq;
    scan.num_parts = 1;
    scan.model = "VLP-16";
    scan.range_unit_m = 0.002;
    scan.num_rings = 2;
    scan.elevation_rad = new float[] {0f, 0.03f};
    scan.azimuth_offset_rad = new float[2];
    scan.time_offset_ns = new int[2];
    scan.origin_height_m = new float[2];
    scan.num_returns = 1;
    scan.return_kind = new int[] {1};
    scan.num_turn_columns = 4;
    scan.num_columns = 4;
    scan.azimuth_rad = new float[] {0f, (float) (0.5 * Math.PI), (float) Math.PI, (float) (1.5 * Math.PI)};
    scan.time_ns = new int[4];
    scan.num_cells = 8;
    scan.range = new short[8];
    scan.range[2] = 10_000;
    scan.reflectivity = new byte[8];
    return scan;
  }

  private static segments_t segmentsOf(long seq) {
    segments_t segments = new segments_t();
    segments.utime_us = 1000 + seq;
    segments.seq = seq;
    segments.num_parts = 1;
    segments.num_rings = 2;
    segments.num_returns = 1;
    segments.num_columns = 4;
    segments.num_cells = 8;
    segments.label = new short[8];
    segments.label[2] = 3;
    segments.num_segments = 1;
    segments.segments = new segment_t[] {segmentOf(3, 0f, -20f)};
    return segments;
  }

  private static segment_t segmentOf(int id, float x_m, float y_m) {
    segment_t segment = new segment_t();
    segment.id = id;
    segment.confidence = segment_t.CONFIDENCE_SURE;
    segment.nearest_m[0] = x_m;
    segment.nearest_m[1] = y_m;
    segment.hull_x_m = new float[0];
    segment.hull_y_m = new float[0];
    segment.hull_time_us = new int[0];
    segment.waterline_x_m = new float[0];
    segment.waterline_y_m = new float[0];
    segment.waterline_time_us = new int[0];
    return segment;
  }

  private static obstacle_t obstacleOf(int id, float x_m, float y_m) {
    obstacle_t obstacle = new obstacle_t();
    obstacle.id = id;
    obstacle.confidence = obstacle_t.CONFIDENCE_SURE;
    obstacle.nearest_vessel_m[0] = x_m;
    obstacle.nearest_vessel_m[1] = y_m;
    obstacle.range_m = (float) Math.hypot(x_m, y_m);
    obstacle.bearing_rad = (float) Math.atan2(-y_m, x_m);
    obstacle.footprint_vessel_x_m = new float[0];
    obstacle.footprint_vessel_y_m = new float[0];
    obstacle.footprint_east_m = new float[0];
    obstacle.footprint_north_m = new float[0];
    obstacle.waterline_vessel_x_m = new float[0];
    obstacle.waterline_vessel_y_m = new float[0];
    obstacle.waterline_east_m = new float[0];
    obstacle.waterline_north_m = new float[0];
    return obstacle;
  }

  private static obstacles_t obstaclesOf(long seq, obstacle_t... obstacles) {
    obstacles_t message = new obstacles_t();
    message.utime_us = 1000 + seq;
    message.seq = seq;
    message.num_parts = 1;
    message.num_obstacles = obstacles.length;
    message.obstacles = obstacles;
    return message;
  }

  // At 300 m east and 200 m north, heading east.
  private static pose_t poseOf(long utime_us) {
    pose_t pose = new pose_t();
    pose.utime_us = utime_us;
    pose.heading_rad = 0.5 * Math.PI;
    pose.position_map_m[0] = 300.0;
    pose.position_map_m[1] = 200.0;
    pose.heading_source = 0;
    return pose;
  }

  // 4 m x 2 m, so far from the boat of poseOf, with 1 m/s to the north.
  private static track_t trackOf(long id, double ahead_m, double port_m) {
    track_t track = new track_t();
    track.id = id;
    track.status = track_t.STATUS_CONFIRMED;
    track.position_map_m[0] = 300.0 + ahead_m;
    track.position_map_m[1] = 200.0 + port_m;
    track.velocity_map_mps[1] = 1.0;
    track.speed_mps = 1f;
    track.num_outline = 4;
    float east_m = (float) track.position_map_m[0];
    float north_m = (float) track.position_map_m[1];
    track.outline_east_m = new float[] {east_m - 2f, east_m + 2f, east_m + 2f, east_m - 2f};
    track.outline_north_m = new float[] {north_m - 1f, north_m - 1f, north_m + 1f, north_m + 1f};
    track.segment_ids = new int[0];
    track.parents = new long[0];
    track.children = new long[0];
    return track;
  }

  private static tracks_t tracksOf(long utime_us, track_t... tracks) {
    tracks_t message = new tracks_t();
    message.utime_us = utime_us - 100;
    message.end_utime_us = utime_us;
    message.num_parts = 1;
    message.num_tracks = message.num_scan_tracks = tracks.length;
    message.tracks = tracks;
    message.land_segment_ids = new int[0];
    message.num_waterline = 1;
    message.waterline_east_m = new float[] {280f};
    message.waterline_north_m = new float[] {200f};
    return message;
  }

  private static alerts_t alertsOf(long track_id) {
    alert_t alert = new alert_t();
    alert.cause = alert_t.CAUSE_CLOSEST_APPROACH;
    alert.level = alert_t.LEVEL_WARNING;
    alert.state = alert_t.STATE_ACTIVE;
    alert.track_id = track_id;
    alert.name = "boat " + track_id;
    alert.text = "boat: closest approach 3 m in 21 s";
    alerts_t message = new alerts_t();
    message.num_alerts = 1;
    message.alerts = new alert_t[] {alert};
    message.summary = "";
    message.acknowledged = new lookout.alert_ack_t[0];
    message.orders = new lookout.order_t[0];
    return message;
  }

  private static boolean has(BufferedImage image, Point2D near, Color colour) {
    for (int x = (int) near.getX() - 2; x <= near.getX() + 2; ++x) {
      for (int y = (int) near.getY() - 2; y <= near.getY() + 2; ++y) {
        if (new Color(image.getRGB(x, y)).equals(colour)) return true;
      }
    }
    return false;
  }

  private static byte[] encoded(LCMEncodable message) throws Exception {
    LCMDataOutputStream bytes = new LCMDataOutputStream();
    message.encode(bytes);
    return bytes.toByteArray();
  }

  private static BufferedImage painted(Scans scans, int width, int height, long now_ms) {
    BufferedImage image = new BufferedImage(width, height, BufferedImage.TYPE_INT_RGB);
    Graphics2D g = image.createGraphics();
    Painter.paint(g, width, height, scans.picture(), RADIUS_M, now_ms, scans.num_refused());
    g.dispose();
    return image;
  }

  private static Point2D onMap(Painter.Layout layout, double x_m, double y_m) {
    return MapView.toScreen(layout.map, RADIUS_M).transform(new Point2D.Double(x_m, y_m), null);
  }

  private static void theSpyFindsThePluginWhichHandlesItsTypes() {
    List<String> found = new ArrayList<>();
    lcm.util.ClassDiscoverer.findClasses((jar, type) -> {
      if (List.of(type.getInterfaces()).contains(SpyPlugin.class)) found.add(type.getName());
    });
    expect(found.equals(List.of("lookout.spy.SpyView")), "scanning the class path finds the plugin: " + found);
    SpyPlugin plugin = new SpyView();
    expect(plugin.canHandle(lidar_scan_t.LCM_FINGERPRINT), "handles lidar_scan_t");
    expect(plugin.canHandle(segments_t.LCM_FINGERPRINT), "handles segments_t");
    expect(plugin.canHandle(obstacles_t.LCM_FINGERPRINT), "handles obstacles_t");
    expect(plugin.canHandle(tracks_t.LCM_FINGERPRINT), "handles tracks_t");
    expect(plugin.canHandle(alerts_t.LCM_FINGERPRINT), "handles alerts_t");
    expect(!plugin.canHandle(pose_t.LCM_FINGERPRINT), "leaves pose_t to the spy");
    // So the spy asks for the name first.
    expect("Range image and map".equals(plugin.getAction(null, null).getValue(javax.swing.Action.NAME)), "the action has a name");
  }

  private static void aReturnIsDrawnWhereItIs() {
    Scans scans = new Scans();
    scans.add(scanOf(1), NOW_MS);
    scans.add(segmentsOf(1), NOW_MS);
    BufferedImage image = painted(scans, WIDTH, HEIGHT, NOW_MS);
    Painter.Layout layout = new Painter.Layout(WIDTH, HEIGHT);
    int x = layout.ranges.x + RangeImage.xOf(0.5 * Math.PI, layout.ranges.width) + 5;
    int low = layout.ranges.y + 3 * layout.ranges.height / 4;
    int high = layout.ranges.y + layout.ranges.height / 4;
    expectColour(image, x, low, Palette.ofRange(20.0), "range to starboard in the lower ring");
    expectColour(image, x, high, Palette.NOTHING, "nothing in the upper ring");
    expectColour(image, layout.ranges.x + layout.ranges.width / 2 + 5, low, Palette.NOTHING, "nothing ahead");
    expectColour(image, x, low + layout.segments.y - layout.ranges.y, Palette.ofSegment(3), "segment 3 to starboard in the lower ring");
    Point2D place = onMap(layout, 0.0, -20.0);
    expectColour(image, Math.round(place.getX()), Math.round(place.getY()), Palette.ofSegment(3), "segment 3 on the map, 20 m to starboard");
    // Between the rings of 20 and 30 m, off the line at 270 degrees.
    expectColour(image, Math.round(onMap(layout, 0.0, 25.0).getX()), Math.round(place.getY()) + 30, Palette.BACKGROUND, "nothing to port");
  }

  private static void obstaclesGiveTheBowAndTheirMarks() {
    // The lidar is turned by 90 degrees: its x axis looks to port.
    Scans scans = new Scans();
    scans.add(scanOf(1), NOW_MS);
    segments_t segments = segmentsOf(1);
    segments.num_segments = 2;
    segments.segments = new segment_t[] {segmentOf(3, 0f, -20f), segmentOf(4, 10f, 0f)};
    scans.add(segments, NOW_MS);
    scans.add(obstaclesOf(1, obstacleOf(3, 20f, 0f), obstacleOf(4, 0f, 10f)), NOW_MS);
    Mounting mounting = scans.picture().mounting();
    expect(mounting != null && Math.abs(mounting.yaw_rad() - 0.5 * Math.PI) < 1e-6, "the mounting is found");
    expect(scans.picture().obstacles().get(0).id == 4, "the nearest obstacle stands first");
    Painter.Layout layout = new Painter.Layout(WIDTH, HEIGHT);
    BufferedImage image = painted(scans, WIDTH, HEIGHT, NOW_MS);
    double x = onMap(layout, 20.0, 0.0).getX();
    double y = onMap(layout, 20.0, 0.0).getY();
    expectColour(image, Math.round(x), Math.round(y), Palette.ofSegment(3), "segment 3 is now ahead");
    expect(new Color(image.getRGB((int) Math.floor(x), (int) Math.floor(y - 4))).getRed() < 128, "a dark ring around the obstacle");
    BufferedImage later = painted(scans, WIDTH, HEIGHT, NOW_MS + 2001);
    expect(new Color(later.getRGB((int) Math.floor(x), (int) Math.floor(y - 4))).getRed() > 128, "after 2 s the ring is gone");
    expectColour(later, layout.map.getCenterX() - 80, layout.map.y + 12, Palette.ALERT, "and the picture says that it is old");
  }

  private static void tracksAreDrawnFromTheMap() {
    Scans scans = new Scans();
    scans.add(poseOf(1_000_000));
    scans.add(tracksOf(1_000_000, trackOf(7, 30.0, 0.0), trackOf(8, -20.0, 15.0)), NOW_MS);
    scans.add(alertsOf(7), NOW_MS);
    Painter.Layout layout = new Painter.Layout(WIDTH, HEIGHT);
    BufferedImage image = painted(scans, WIDTH, HEIGHT, NOW_MS);
    expect(has(image, onMap(layout, 28.0, 0.5), Palette.ALERT), "the near side of track 7, which has a warning, is ahead");
    expect(has(image, onMap(layout, 30.0, 9.9), Palette.ALERT), "its vector goes 10 m to port in 10 s");
    expect(has(image, onMap(layout, -18.0, 14.5), Palette.TRACK), "track 8 is astern to port");
    expect(has(image, onMap(layout, -20.0, 0.0), Palette.WATERLINE), "land is astern");
    expect(has(image, new Point2D.Double(layout.map.x + 8, layout.map.getMaxY() - 10), Palette.ALERT), "the alert stands below");
    BufferedImage silent = painted(scans, WIDTH, HEIGHT, NOW_MS + 1500);
    expect(has(silent, onMap(layout, -18.0, 14.5), Palette.TRACK), "tracks stay for 2 s");
    expect(has(silent, new Point2D.Double(layout.map.x + 8, layout.map.getMaxY() - 10), Palette.ALERT), "that nobody looks stands below");
    expect(!has(painted(scans, WIDTH, HEIGHT, NOW_MS + 2500), onMap(layout, -18.0, 14.5), Palette.TRACK), "then they go");

    tracks_t elsewhere = tracksOf(2_000_000, trackOf(7, 30.0, 0.0));
    elsewhere.datum_latitude_deg = 1.0;
    scans.add(elsewhere, NOW_MS);
    expect(!has(painted(scans, WIDTH, HEIGHT, NOW_MS), onMap(layout, 28.0, 0.5), Palette.ALERT), "of another map nothing is drawn");
    tracks_t half = tracksOf(3_000_000, trackOf(9, 10.0, 0.0));
    half.num_parts = 2;
    scans.add(half, NOW_MS);
    expect(scans.picture().lookOut().tracks().get(0).id == 7, "half a scan is not drawn");
  }

  private static void theMountingIsNotGuessed() {
    List<segment_t> segments = new ArrayList<>();
    List<obstacle_t> obstacles = new ArrayList<>();
    List<obstacle_t> mirrored = new ArrayList<>();
    Mounting truth = new Mounting(Math.toRadians(5.0), 0.5, -0.1);
    float[][] places = {{10f, 3f}, {-7f, 12f}, {4f, -20f}};
    for (int i = 0; i < places.length; ++i) {
      float[] p = places[i];
      segments.add(segmentOf(i + 1, p[0], p[1]));
      Point2D place = truth.toVessel().transform(new Point2D.Float(p[0], p[1]), null);
      obstacles.add(0, obstacleOf(i + 1, (float) place.getX(), (float) place.getY()));
      mirrored.add(obstacleOf(i + 1, p[0], -p[1]));
    }
    Mounting found = Mounting.estimate(segments, obstacles);
    expect(found != null && Math.abs(found.yaw_rad() - truth.yaw_rad()) < 1e-5 && Math.abs(found.x_m() - 0.5) < 1e-4 && Math.abs(found.y_m() + 0.1) < 1e-4,
        "three obstacles give the mounting");
    expect(Mounting.estimate(segments, mirrored) == null, "a lidar upside down fits no rotation in the plane");
    expect(Mounting.estimate(segments.subList(0, 1), obstacles) == null, "one obstacle is too few");
    expect(Mounting.estimate(List.of(segmentOf(1, 10f, 3f), segmentOf(2, 11f, 3f)), List.of(obstacleOf(1, 10f, 3f), obstacleOf(2, 11f, 3f))) == null,
        "two obstacles side by side are too few");
  }

  private static void scansAreDrawnWhole() {
    Scans scans = new Scans();
    lidar_scan_t second = scanOf(1);
    second.num_parts = 2;
    second.part_index = 1;
    second.first_column = 4;
    lidar_scan_t first = scanOf(1);
    first.num_parts = 2;
    segments_t labels = segmentsOf(1);
    labels.num_parts = 2;
    segments_t more_labels = segmentsOf(1);
    more_labels.num_parts = 2;
    more_labels.part_index = 1;
    scans.add(second, NOW_MS);
    scans.add(more_labels, NOW_MS);
    scans.add(labels, NOW_MS);
    expect(scans.picture().scan() == null, "half a scan is not drawn");
    scans.add(first, NOW_MS);
    expect(scans.picture().scan() != null && scans.picture().scan().scanParts.get(0) == first, "both parts are, in their order, however they came");

    Scans unlabelled = new Scans();
    for (long seq = 1; seq <= 3; ++seq) unlabelled.add(scanOf(seq), NOW_MS);
    expect(unlabelled.picture().scan() != null && !unlabelled.picture().scan().isLabelled(), "without a segmenter scans are drawn nevertheless");
  }

  // The same cases as tests/unit/messages/scan_collector_test.cpp.
  private static void sharedCasesCompleteTheirScans() throws Exception {
    int num_cases = 0;
    for (String line : Files.readAllLines(Path.of("tests/unit/messages/scan_parts.txt"))) {
      if (line.isEmpty() || line.startsWith("#")) continue;
      String[] sides = line.split(" -> ");
      List<String> completed = new ArrayList<>();
      Scans scans = new Scans();
      for (String part : sides[0].split(" ")) {
        String[] numbers = part.substring(1).split("[:/]");
        Scan before = scans.picture().scan();
        if (part.charAt(0) == 'C') {
          lidar_scan_t scan = scanOf(Long.parseLong(numbers[0]));
          scan.part_index = Integer.parseInt(numbers[1]);
          scan.num_parts = Integer.parseInt(numbers[2]);
          scans.add(scan, NOW_MS);
        } else {
          segments_t segments = segmentsOf(Long.parseLong(numbers[0]));
          segments.part_index = Integer.parseInt(numbers[1]);
          segments.num_parts = Integer.parseInt(numbers[2]);
          scans.add(segments, NOW_MS);
        }
        Scan after = scans.picture().scan();
        if (after != before && after.isLabelled()) completed.add(numbers[0]);
      }
      expect(String.join(" ", completed).equals(sides[1]), line + ", but " + completed);
      ++num_cases;
    }
    expect(num_cases >= 8, "the shared cases are read");
  }

  private static void noMessageEndsIt() throws Exception {
    Random random = new Random(1);
    String[] channels = {"LIDAR_SCAN", "SEGMENTS", "OBSTACLES", "TRACKS", "ALERTS"};
    byte[][] good = {encoded(scanOf(1)), encoded(segmentsOf(1)), encoded(obstaclesOf(1, obstacleOf(3, 20f, 0f), obstacleOf(4, 0f, 10f))),
        encoded(tracksOf(1_000_000, trackOf(7, 30.0, 0.0))), encoded(alertsOf(7))};
    Scans scans = new Scans();
    scans.add(poseOf(1_000_000));
    for (int i = 0; i < channels.length; ++i) Feed.decode(scans, channels[i], new LCMDataInputStream(good[i]), NOW_MS);
    expect(scans.num_refused() == 0 && scans.picture().scan() != null && scans.picture().obstacles().size() == 2, "the good ones are taken");
    long num_cut = 0;
    for (int i = 0; i < channels.length; ++i) {
      for (int size = 0; size < good[i].length; ++size, ++num_cut) {
        Feed.decode(scans, channels[i], new LCMDataInputStream(good[i], 0, size), NOW_MS);
      }
    }
    expect(scans.num_refused() == num_cut, "each message that is cut short is counted");
    for (int round = 0; round < 3000; ++round) {
      int i = round % channels.length;
      byte[] bytes = good[i].clone();
      int extreme = round % 4 == 1 ? 0xFF : 0x7F;
      for (int k = 0; k < 3; ++k) bytes[8 + random.nextInt(bytes.length - 8)] = (byte) (round % 2 == 0 ? random.nextInt() : extreme);
      Feed.decode(scans, channels[i], new LCMDataInputStream(bytes), NOW_MS);
      if (round % 100 == 0) painted(scans, 400 + round / 10, 500, NOW_MS);
    }
    expect(scans.num_refused() > num_cut + 100, "spoiled ones are counted");
    Feed.decode(scans, "LIDAR_SCAN", new LCMDataInputStream(good[0]), NOW_MS);
    for (int[] size : new int[][] {{1, 1}, {50, 900}, {900, 50}, {300, 200}}) painted(scans, size[0], size[1], NOW_MS);
  }

  private static void refuses(String what, java.util.function.Consumer<lidar_scan_t> spoil) {
    lidar_scan_t scan = scanOf(1);
    spoil.accept(scan);
    Scans scans = new Scans();
    scans.add(scan, NOW_MS);
    scans.add(segmentsOf(1), NOW_MS);
    expect(scans.num_refused() == 1 && scans.picture().scan() == null, "a scan is refused: " + what);
  }

  private static void whatContradictsItselfIsRefused() {
    refuses("fewer cells than columns times rings", scan -> {
      scan.num_cells = 6;
      scan.range = new short[6];
    });
    refuses("no ring", scan -> scan.num_rings = 0);
    refuses("an azimuth that is no number", scan -> scan.azimuth_rad[1] = Float.NaN);
    refuses("an elevation that is no number", scan -> scan.elevation_rad[1] = Float.POSITIVE_INFINITY);
    refuses("a unit of range of 0", scan -> scan.range_unit_m = 0.0);
    refuses("a part beyond the last", scan -> scan.part_index = 1);
    refuses("more parts than a scan can have", scan -> scan.num_parts = 1_000_000);
    Scans scans = new Scans();
    segments_t segments = segmentsOf(1);
    segments.num_columns = 5;
    scans.add(segments, NOW_MS);
    obstacles_t obstacles = obstaclesOf(1);
    obstacles.num_parts = 0;
    scans.add(obstacles, NOW_MS);
    expect(scans.num_refused() == 2, "segments and obstacles too");
  }

  private static void aCountThatCannotBeIsRefusedBeforeItIsTaken() throws Exception {
    byte[] good = encoded(scanOf(1));
    // Fingerprint, four times, five counts and flags, the model with its length, the unit of range: then the number of rings.
    int num_rings_at = 8 + 4 * 8 + 5 * 4 + 4 + "VLP-16".length() + 1 + 8;
    expect(good[num_rings_at + 3] == 2, "the number of rings is where this test looks for it");
    for (byte first : new byte[] {0x7F, 0x01, (byte) 0xFF}) {
      byte[] bytes = good.clone();
      bytes[num_rings_at] = first;
      String reason = "nothing";
      try {
        new lidar_scan_t(new LCMDataInputStream(bytes));
      } catch (IOException | RuntimeException | OutOfMemoryError error) {
        reason = String.valueOf(error.getMessage());
      }
      expect(reason.endsWith("does not fit"), "a count that begins with " + first + " is refused: " + reason);
    }
  }

  private static void coloursAreThoseOfTheExport() {
    // As lookout-export draws them: ColourOfSegment of tools/export/colour.cpp.
    expect(Palette.ofSegment(1).equals(new Color(138, 163, 27)), "colour of segment 1");
    expect(Palette.ofSegment(2).equals(new Color(140, 19, 154)), "colour of segment 2");
    expect(Palette.ofSegment(3).equals(new Color(24, 191, 125)), "colour of segment 3");
    expect(Palette.ofSegment(7).equals(new Color(228, 37, 145)), "colour of segment 7");
    expect(Palette.ofSegment(60).equals(new Color(24, 28, 191)), "colour of segment 60");
    expect(Palette.ofSegment(1000).equals(new Color(37, 97, 228)), "colour of segment 1000");
  }

  private static void onlyWhatIsCertainIsAHundredPerCent() {
    expect(Texts.percent(1f).equals("100%") && Texts.percent(0.9999f).equals("99%") && Texts.percent(0f).equals("0%"), "rounded down");
    expect(Texts.percent(Float.NaN).equals("-"), "a probability that is not stated is a dash");
  }

  public static void main(String[] arguments) throws Exception {
    theSpyFindsThePluginWhichHandlesItsTypes();
    aReturnIsDrawnWhereItIs();
    obstaclesGiveTheBowAndTheirMarks();
    tracksAreDrawnFromTheMap();
    theMountingIsNotGuessed();
    scansAreDrawnWhole();
    sharedCasesCompleteTheirScans();
    noMessageEndsIt();
    whatContradictsItselfIsRefused();
    aCountThatCannotBeIsRefusedBeforeItIsTaken();
    coloursAreThoseOfTheExport();
    onlyWhatIsCertainIsAHundredPerCent();
    System.out.println(num_failures == 0 ? "all passed" : num_failures + " failed");
    System.exit(num_failures == 0 ? 0 : 1);
  }
}
