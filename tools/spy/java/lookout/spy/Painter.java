package lookout.spy;

import java.awt.Color;
import java.awt.Font;
import java.awt.Graphics2D;
import java.awt.Rectangle;
import java.awt.RenderingHints;
import java.util.ArrayList;
import java.util.Comparator;
import java.util.List;
import java.util.Locale;
import lookout.alert_t;
import lookout.obstacle_t;
import lookout.track_t;

/** Everything in its place: two range images on top, the map below, beside it the legend and the list of obstacles. No state, no clock. */
final class Painter {
  private static final int MARGIN = 12;
  private static final int CAPTION = 18;
  private static final int STRIP = 96;  // six pixels for each ring of a VLP-16
  private static final int SIDE = 374;
  private static final int MAX_ALERTS = 4;

  private Painter() {}

  static final class Layout {
    final Rectangle ranges;
    final Rectangle segments;
    final Rectangle map;
    final Rectangle side;

    Layout(int width, int height) {
      int inner = Math.max(1, width - 2 * MARGIN);
      ranges = new Rectangle(MARGIN, CAPTION + 4, inner, STRIP);
      segments = new Rectangle(MARGIN, ranges.y + STRIP + CAPTION + 4, inner, STRIP);
      int top = segments.y + STRIP + 2 * CAPTION + 4;
      int below = Math.max(1, height - top - MARGIN);
      // A narrow window has no room for the list.
      int side_width = width >= 2 * SIDE ? SIDE : 0;
      map = new Rectangle(MARGIN, top, Math.max(1, inner - side_width - (side_width > 0 ? MARGIN : 0)), below);
      side = new Rectangle(map.x + map.width + MARGIN, top, side_width, below);
    }
  }

  /** @param num_refused messages that did not decode or contradict themselves */
  static void paint(Graphics2D g, int width, int height, Picture picture, double radius_m, long now_ms, long num_refused) {
    Layout layout = new Layout(width, height);
    g.setRenderingHint(RenderingHints.KEY_ANTIALIASING, RenderingHints.VALUE_ANTIALIAS_ON);
    g.setRenderingHint(RenderingHints.KEY_TEXT_ANTIALIASING, RenderingHints.VALUE_TEXT_ANTIALIAS_ON);
    g.setFont(new Font(Font.SANS_SERIF, Font.PLAIN, 12));
    g.setColor(Palette.BACKGROUND);
    g.fillRect(0, 0, width, height);

    caption(g, layout.ranges, "LIDAR_SCAN: range, highest ring on top");
    caption(g, layout.segments, segmentsCaption(picture));
    rangeLegend(g, layout.ranges);
    RangeImage.paint(g, picture, layout.ranges, layout.segments);
    bearings(g, layout.segments);
    caption(g, layout.map, mapCaption(picture, radius_m));
    MapView.paint(g, layout.map, picture, radius_m, now_ms);
    g.setFont(new Font(Font.SANS_SERIF, Font.PLAIN, 12));
    g.setColor(Palette.GRID);
    g.draw(layout.map);
    if (layout.side.width > 0) side(g, layout.side, picture, now_ms, num_refused);
    banner(g, layout.map, picture, now_ms);
    alerts(g, layout.map, picture.lookOut(), now_ms);
  }

  private static void caption(Graphics2D g, Rectangle area, String text) {
    g.setColor(Palette.INK);
    g.drawString(text, area.x, area.y - 6);
  }

  private static String segmentsCaption(Picture picture) {
    if (picture.scan() == null || picture.scan().isLabelled()) return "SEGMENTS: a colour each; grey in none, brown own vessel";
    return "SEGMENTS: none for this scan";
  }

  private static String mapCaption(Picture picture, double radius_m) {
    String frame = picture.mounting() != null ? "From above, bow up" : "From above, the lidar's x axis up (where the bow is shows with OBSTACLES)";
    return String.format(Locale.ROOT, "%s; %.0f m to the edge (wheel or + and - change it)", frame, radius_m);
  }

  private static void rangeLegend(Graphics2D g, Rectangle ranges) {
    int width = 200;
    int x = ranges.x + ranges.width - width - 44;
    int y = ranges.y - 15;
    if (x < ranges.x + 300) return;
    for (int i = 0; i < width; ++i) {
      g.setColor(Palette.ofRange(Palette.NEAR_M * Math.pow(Palette.FAR_M / Palette.NEAR_M, (double) i / width)));
      g.fillRect(x + i, y, 1, 10);
    }
    g.setColor(Palette.INK);
    g.drawString("1 m", x - 26, y + 10);
    g.drawString("10", x + width / 2 - 7, y + 10);
    g.drawString("100 m", x + width + 4, y + 10);
  }

  // Below the strips: astern, port, ahead, starboard.
  private static void bearings(Graphics2D g, Rectangle strip) {
    for (int degrees = -180; degrees <= 150; degrees += 30) {
      int x = strip.x + RangeImage.xOf(Math.toRadians(degrees), strip.width);
      g.setColor(Palette.FAINT_INK);
      g.drawLine(x, strip.y + strip.height, x, strip.y + strip.height + 4);
      String text = degrees == 0 ? "ahead" : Texts.degrees(Math.toRadians(degrees));
      g.drawString(text, degrees == -180 ? x : x - g.getFontMetrics().stringWidth(text) / 2, strip.y + strip.height + 16);
    }
  }

  private static void side(Graphics2D g, Rectangle side, Picture picture, long now_ms, long num_refused) {
    int line_height = 17;
    int y = side.y + 12;
    Object[][] legend = {{Palette.ofSegment(1), "a segment; its outline dashed: tentative"}, {Palette.IN_NO_SEGMENT, "a return in no segment"},
        {Palette.OWN_VESSEL, "own vessel"}};
    for (Object[] entry : legend) {
      g.setColor((Color) entry[0]);
      g.fillRect(side.x, y - 9, 10, 10);
      g.setColor(Palette.INK);
      g.drawString((String) entry[1], side.x + 18, y);
      y += line_height;
    }
    boolean hasTracks = picture.lookOut().hasTracks(now_ms);
    if (hasTracks) {
      Object[][] marks = {{Palette.TRACK, String.format(Locale.ROOT, "a track; dashed: not seen now; its way of %.0f s", MapView.VECTOR_S)},
          {Palette.CAUTION, "with a caution"}, {Palette.ALERT, "with a warning"}, {Palette.WATERLINE, "land that is remembered"}};
      for (Object[] entry : marks) {
        g.setColor((Color) entry[0]);
        g.drawRect(side.x, y - 9, 9, 9);
        g.setColor(Palette.INK);
        g.drawString((String) entry[1], side.x + 18, y);
        y += line_height;
      }
      y += 8;
    } else {
      g.drawString("\u25cb obstacle: id, range, bearing; \"?\" tentative", side.x, y);
      y += line_height + 8;
    }

    if (hasTracks) {
      trackRows(g, side, y, picture.lookOut());
    } else {
      obstacleRows(g, side, y, picture, now_ms);
    }
    if (num_refused > 0) {
      g.setFont(new Font(Font.SANS_SERIF, Font.PLAIN, 12));
      g.setColor(Palette.ALERT);
      g.drawString(num_refused + " messages refused", side.x, side.y + side.height);
    }
  }

  private static void obstacleRows(Graphics2D g, Rectangle side, int top, Picture picture, long now_ms) {
    int line_height = 17;
    int y = top;
    long num_sure = picture.obstacles().stream().filter(obstacle -> obstacle.confidence == obstacle_t.CONFIDENCE_SURE).count();
    g.setFont(new Font(Font.SANS_SERIF, Font.BOLD, 12));
    String count = picture.obstacles().size() + ", " + num_sure + " of them sure";
    g.drawString("OBSTACLES: " + (picture.hasObstacles(now_ms) ? count : "none on the bus"), side.x, y);
    y += line_height;
    g.setFont(new Font(Font.MONOSPACED, Font.PLAIN, 12));
    g.setColor(Palette.FAINT_INK);
    g.drawString(String.format(Locale.ROOT, "%4s %8s %7s  %-9s %5s %s", "id", "range", "bearing", "", "thing", "size m"), side.x + 12, y);
    y += line_height;
    int rows = Math.max(0, (side.y + side.height - y - line_height) / line_height);
    if (picture.hasObstacles(now_ms)) {
      // Drops of spray near the boat would fill the list.
      Comparator<obstacle_t> sureFirst = Comparator.comparing(obstacle -> obstacle.confidence != obstacle_t.CONFIDENCE_SURE);
      for (obstacle_t obstacle : picture.obstacles().stream().sorted(sureFirst).limit(rows).toList()) {
        g.setColor(Palette.ofSegment(obstacle.id));
        g.fillRect(side.x, y - 9, 9, 9);
        g.setColor(obstacle.confidence == obstacle_t.CONFIDENCE_SURE ? Palette.INK : Palette.FAINT_INK);
        g.drawString(String.format(Locale.ROOT, "%4d %6.1f m %7s  %-9s %5s %.1fx%.1f", obstacle.id, obstacle.range_m, Texts.degrees(obstacle.bearing_rad),
            Texts.confidence(obstacle), Texts.percent(obstacle.thing_probability), obstacle.length_m, obstacle.width_m), side.x + 12, y);
        y += line_height;
      }
    }
  }

  // At the lower edge of the map, the gravest on top.
  private static void alerts(Graphics2D g, Rectangle map, LookOut lookOut, long now_ms) {
    List<String> lines = new ArrayList<>();
    List<Color> colours = new ArrayList<>();
    if (lookOut.isSilent(now_ms)) {
      lines.add(String.format(Locale.ROOT, "NO LOOK-OUT: no ALERTS for %.0f s", (now_ms - lookOut.alertsTime_ms()) / 1000.0));
      colours.add(Palette.ALERT);
    } else {
      for (alert_t alert : lookOut.alerts()) {
        if (alert.state != alert_t.STATE_ACTIVE || lines.size() == MAX_ALERTS) continue;
        lines.add(Texts.alert(alert));
        colours.add(alert.level == alert_t.LEVEL_WARNING ? Palette.ALERT : Palette.CAUTION);
      }
    }
    g.setFont(new Font(Font.SANS_SERIF, Font.BOLD, 13));
    int y = map.y + map.height - 24 * lines.size() - 4;
    for (int i = 0; i < lines.size(); ++i, y += 24) {
      g.setColor(colours.get(i));
      g.fillRect(map.x + 6, y, Math.min(map.width - 12, g.getFontMetrics().stringWidth(lines.get(i)) + 16), 21);
      g.setColor(Color.WHITE);
      g.drawString(lines.get(i), map.x + 14, y + 15);
    }
  }

  // Numbers of each track, the nearest first.
  private static void trackRows(Graphics2D g, Rectangle side, int top, LookOut lookOut) {
    int line_height = 17;
    int y = top;
    g.setFont(new Font(Font.SANS_SERIF, Font.BOLD, 12));
    long num_moving = lookOut.tracks().stream().filter(track -> track.speed_mps > 0f).count();
    g.drawString("TRACKS: " + lookOut.tracks().size() + ", " + num_moving + " of them moving", side.x, y);
    y += line_height;
    g.setFont(new Font(Font.MONOSPACED, Font.PLAIN, 12));
    g.setColor(Palette.FAINT_INK);
    g.drawString(String.format(Locale.ROOT, "%5s %7s %7s %6s %5s %5s %5s", "id", "range", "bearing", "course", "m/s", "CPA m", "TCPA"), side.x, y);
    y += line_height;
    int rows = Math.max(0, (side.y + side.height - y - line_height) / line_height);
    Comparator<track_t> nearest = Comparator.<track_t>comparingDouble(track -> track.range_m).thenComparingLong(track -> track.id);
    for (track_t track : lookOut.tracks().stream().sorted(nearest).limit(rows).toList()) {
      int level = lookOut.levelOf(track.id);
      g.setColor(level == alert_t.LEVEL_WARNING ? Palette.ALERT : level == alert_t.LEVEL_CAUTION ? Palette.CAUTION : Palette.INK);
      String course = track.speed_mps > 0f ? Texts.degrees(track.course_rad) : "-";
      g.drawString(String.format(Locale.ROOT, "%5d %5.1f m %7s %6s %5.1f %5.1f %5.0f", track.id, track.range_m, Texts.degrees(track.bearing_rad), course,
          track.speed_mps, track.cpa_m, track.tcpa_s), side.x, y);
      y += line_height;
    }
  }

  private static void banner(Graphics2D g, Rectangle map, Picture picture, long now_ms) {
    if (picture.hasScan(now_ms)) return;
    double age_s = (now_ms - picture.scanTime_ms()) / 1000.0;
    String text = picture.scan() == null ? "waiting for LIDAR_SCAN" : String.format(Locale.ROOT, "no LIDAR_SCAN for %.0f s: an old picture", age_s);
    g.setFont(new Font(Font.SANS_SERIF, Font.BOLD, 15));
    int width = g.getFontMetrics().stringWidth(text) + 20;
    g.setColor(Palette.ALERT);
    g.fillRect(map.x + (map.width - width) / 2, map.y + 8, width, 26);
    g.setColor(Color.WHITE);
    g.drawString(text, map.x + (map.width - width) / 2 + 10, map.y + 27);
  }
}
