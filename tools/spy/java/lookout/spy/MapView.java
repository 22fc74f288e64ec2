package lookout.spy;

import java.awt.BasicStroke;
import java.awt.Color;
import java.awt.Font;
import java.awt.FontMetrics;
import java.awt.Graphics2D;
import java.awt.Rectangle;
import java.awt.RenderingHints;
import java.awt.Shape;
import java.awt.geom.AffineTransform;
import java.awt.geom.Ellipse2D;
import java.awt.geom.Line2D;
import java.awt.geom.Path2D;
import java.awt.geom.Point2D;
import java.util.ArrayList;
import java.util.List;
import lookout.alert_t;
import lookout.obstacle_t;
import lookout.segment_t;
import lookout.track_t;

/** The scan from above, bow up, the vessel in the middle, with rings of range. */
final class MapView {
  private static final int MAX_LABELS = 24;
  private static final int MAX_TENTATIVE_MARKS = 40;
  private static final Color LABEL_BACKGROUND = new Color(255, 255, 255, 150);
  /** How far ahead the vector of a track reaches. */
  static final double VECTOR_S = 10.0;
  private static final double[] RING_STEPS_M = {1, 2, 5, 10, 20, 50, 100};

  private final Graphics2D g;
  private final Rectangle area;
  private final Picture picture;
  private final double radius_m;
  private final AffineTransform vesselToScreen;
  private final AffineTransform lidarToScreen;

  private MapView(Graphics2D g, Rectangle area, Picture picture, double radius_m) {
    this.g = g;
    this.area = area;
    this.picture = picture;
    this.radius_m = radius_m;
    vesselToScreen = toScreen(area, radius_m);
    lidarToScreen = toScreen(area, radius_m);
    if (picture.mounting() != null) lidarToScreen.concatenate(picture.mounting().toVessel());
  }

  /** @param radius_m what fits between the middle and the nearer edge */
  static void paint(Graphics2D g, Rectangle area, Picture picture, double radius_m, long now_ms) {
    Shape clip = g.getClip();
    g.clipRect(area.x, area.y, area.width, area.height);
    MapView view = new MapView(g, area, picture, radius_m);
    view.grid();
    view.returns();
    view.outlines();
    if (picture.lookOut().hasTracks(now_ms)) view.lookOut();
    else if (picture.hasObstacles(now_ms)) view.obstacles();
    view.vessel();
    view.north();
    g.setClip(clip);
  }

  /** From the vessel frame (x forward, y port; before the mounting is known, the lidar's). */
  static AffineTransform toScreen(Rectangle area, double radius_m) {
    double scale = 0.5 * Math.min(area.width, area.height) / radius_m;
    return new AffineTransform(0, -scale, -scale, 0, area.getCenterX(), area.getCenterY());
  }

  private static Point2D at(AffineTransform toScreen, double x_m, double y_m) {
    return toScreen.transform(new Point2D.Double(x_m, y_m), null);
  }

  private Point2D at(obstacle_t obstacle) {
    return at(vesselToScreen, obstacle.nearest_vessel_m[0], obstacle.nearest_vessel_m[1]);
  }

  private void circle(Point2D middle, double radius) {
    g.draw(new Ellipse2D.Double(middle.getX() - radius, middle.getY() - radius, 2 * radius, 2 * radius));
  }

  private void grid() {
    g.setColor(Palette.BACKGROUND);
    g.fill(area);
    double step_m = RING_STEPS_M[RING_STEPS_M.length - 1];
    for (int i = RING_STEPS_M.length - 1; i >= 0 && radius_m / RING_STEPS_M[i] <= 7.0; --i) step_m = RING_STEPS_M[i];
    double corner_m = radius_m * Math.hypot(area.width, area.height) / Math.min(area.width, area.height);
    Point2D middle = at(vesselToScreen, 0, 0);
    g.setStroke(new BasicStroke(1f));
    g.setColor(Palette.GRID);
    for (int degrees = 0; degrees < 360; degrees += 30) {
      double bearing_rad = Math.toRadians(degrees);
      g.draw(new Line2D.Double(middle, at(vesselToScreen, Math.cos(bearing_rad) * corner_m, -Math.sin(bearing_rad) * corner_m)));
    }
    for (double r_m = step_m; r_m <= corner_m; r_m += step_m) {
      g.setColor(Palette.GRID);
      circle(middle, at(vesselToScreen, r_m, 0).distance(middle));
      g.setColor(Palette.FAINT_INK);
      // Along 45 degrees on the starboard bow, where the bow's own line does not cross the numbers.
      Point2D place = at(vesselToScreen, r_m * Math.sqrt(0.5), -r_m * Math.sqrt(0.5));
      if (r_m < 1.2 * radius_m) g.drawString((int) r_m + " m", (float) place.getX() + 2, (float) place.getY() - 2);
    }
  }

  private void returns() {
    if (picture.scan() == null) return;
    // Squares of three pixels have no edges to smooth, and smoothing takes most of the time.
    g.setRenderingHint(RenderingHints.KEY_ANTIALIASING, RenderingHints.VALUE_ANTIALIAS_OFF);
    // Those in no segment lie below.
    for (boolean in_segment : new boolean[] {false, true}) {
      picture.scan().forEachReturn((ring, azimuth_rad, elevation_rad, range_m, label) -> {
        if (label > 0 != in_segment) return;
        double flat_m = range_m * Math.cos(elevation_rad);
        Point2D place = at(lidarToScreen, flat_m * Math.cos(azimuth_rad), -flat_m * Math.sin(azimuth_rad));
        g.setColor(Palette.ofLabel(label));
        g.fillRect((int) Math.round(place.getX()) - 1, (int) Math.round(place.getY()) - 1, 3, 3);
      });
    }
    g.setRenderingHint(RenderingHints.KEY_ANTIALIASING, RenderingHints.VALUE_ANTIALIAS_ON);
  }

  private void outlines() {
    if (picture.scan() == null) return;
    for (segment_t segment : picture.scan().segments()) {
      boolean is_land = segment.num_waterline > 0;
      float[] x_m = is_land ? segment.waterline_x_m : segment.hull_x_m;
      float[] y_m = is_land ? segment.waterline_y_m : segment.hull_y_m;
      if (x_m.length < 2) continue;
      Path2D path = new Path2D.Double();
      for (int i = 0; i < x_m.length; ++i) {
        Point2D corner = at(lidarToScreen, x_m[i], y_m[i]);
        if (!Double.isFinite(corner.getX() + corner.getY())) return;
        if (i == 0) path.moveTo(corner.getX(), corner.getY());
        else path.lineTo(corner.getX(), corner.getY());
      }
      if (!is_land) path.closePath();
      Color colour = Palette.ofSegment(segment.id);
      g.setColor(new Color(colour.getRed(), colour.getGreen(), colour.getBlue(), 150));
      boolean is_sure = segment.confidence == segment_t.CONFIDENCE_SURE;
      g.setStroke(is_sure ? new BasicStroke(1.2f) : new BasicStroke(1f, BasicStroke.CAP_BUTT, BasicStroke.JOIN_BEVEL, 1f, new float[] {3f, 3f}, 0f));
      g.draw(path);
    }
  }

  // A mark of fixed size: the boat's own measures are in its config, not on the bus.
  private void vessel() {
    Path2D hull = new Path2D.Double();
    double x = area.getCenterX();
    double y = area.getCenterY();
    hull.moveTo(x, y - 11);
    hull.lineTo(x + 6, y + 7);
    hull.lineTo(x, y + 4);
    hull.lineTo(x - 6, y + 7);
    hull.closePath();
    g.setColor(Palette.INK);
    g.fill(hull);
  }

  private void north() {
    if (!Double.isFinite(picture.heading_rad()) || picture.mounting() == null) return;
    double reach = 0.5 * Math.min(area.width, area.height) - 16;
    double x = area.getCenterX() - Math.sin(picture.heading_rad()) * reach;
    double y = area.getCenterY() - Math.cos(picture.heading_rad()) * reach;
    g.setColor(Palette.INK);
    g.setFont(g.getFont().deriveFont(Font.BOLD, 16f));
    FontMetrics metrics = g.getFontMetrics();
    g.setStroke(new BasicStroke(1.2f));
    circle(new Point2D.Double(x, y), 12);
    g.drawString("N", (float) (x - 0.5 * metrics.stringWidth("N")), (float) (y + 0.37 * metrics.getAscent()));
  }

  // Land that is remembered, outlines of tracks, and where they will be in VECTOR_S; a number beside each, that of a moving one with its speed.
  private void lookOut() {
    LookOut lookOut = picture.lookOut();
    if (lookOut.own() == null) return;
    AffineTransform mapToScreen = new AffineTransform(vesselToScreen);
    mapToScreen.concatenate(lookOut.toVessel());
    g.setColor(Palette.WATERLINE);
    for (float[] place : lookOut.waterline()) {
      Point2D at = at(mapToScreen, place[0], place[1]);
      g.fillRect((int) Math.round(at.getX()) - 1, (int) Math.round(at.getY()) - 1, 3, 3);
    }
    List<Rectangle> taken = new ArrayList<>();
    taken.add(new Rectangle((int) area.getCenterX() - 8, (int) area.getCenterY() - 12, 16, 22));
    for (track_t track : lookOut.tracks()) {
      Point2D middle = at(mapToScreen, track.position_map_m[0], track.position_map_m[1]);
      int level = lookOut.levelOf(track.id);
      g.setColor(level == alert_t.LEVEL_WARNING ? Palette.ALERT : level == alert_t.LEVEL_CAUTION ? Palette.CAUTION : Palette.TRACK);
      boolean isCoasting = track.status == track_t.STATUS_COASTING;
      g.setStroke(isCoasting ? new BasicStroke(1.6f, BasicStroke.CAP_BUTT, BasicStroke.JOIN_BEVEL, 1f, new float[] {5f, 4f}, 0f) : new BasicStroke(1.6f));
      outline(track, mapToScreen);
      if (track.speed_mps > 0f) vector(middle, at(mapToScreen, track.position_map_m[0] + VECTOR_S * track.velocity_map_mps[0],
          track.position_map_m[1] + VECTOR_S * track.velocity_map_mps[1]));
      label(Texts.track(track), middle, taken);
    }
  }

  private void outline(track_t track, AffineTransform mapToScreen) {
    if (track.num_outline < 2) {
      circle(at(mapToScreen, track.position_map_m[0], track.position_map_m[1]), 3);
      return;
    }
    Path2D path = new Path2D.Double();
    for (int i = 0; i < track.num_outline; ++i) {
      Point2D corner = at(mapToScreen, track.outline_east_m[i], track.outline_north_m[i]);
      if (i == 0) path.moveTo(corner.getX(), corner.getY());
      else path.lineTo(corner.getX(), corner.getY());
    }
    path.closePath();
    g.draw(path);
  }

  private void vector(Point2D from, Point2D to) {
    g.setStroke(new BasicStroke(2f));
    g.draw(new Line2D.Double(from, to));
    double direction_rad = Math.atan2(to.getY() - from.getY(), to.getX() - from.getX());
    for (double side_rad : new double[] {2.6, -2.6}) {
      double angle_rad = direction_rad + side_rad;
      g.draw(new Line2D.Double(to.getX(), to.getY(), to.getX() + 8 * Math.cos(angle_rad), to.getY() + 8 * Math.sin(angle_rad)));
    }
  }

  // In the colour that is set; a text that would lie on another is left out.
  private void label(String text, Point2D place, List<Rectangle> taken) {
    Color colour = g.getColor();
    FontMetrics metrics = g.getFontMetrics();
    Rectangle box = new Rectangle((int) place.getX() + 7, (int) place.getY() - metrics.getAscent() / 2 - 2, metrics.stringWidth(text) + 4,
        metrics.getAscent() + 3);
    if (taken.size() > MAX_LABELS || taken.stream().anyMatch(box::intersects) || !area.intersects(box)) return;
    g.setColor(LABEL_BACKGROUND);
    g.fill(box);
    g.setColor(colour);
    g.drawString(text, box.x + 2, box.y + metrics.getAscent());
    taken.add(box);
  }

  // Tentative marks below sure ones, in rain the nearest only; then numbers beside the nearest, the sure ones first. A text that would lie on another
  // gives way to its number alone, then to nothing.
  private void obstacles() {
    List<obstacle_t> sure = new ArrayList<>();
    List<obstacle_t> tentative = new ArrayList<>();
    for (obstacle_t obstacle : picture.obstacles()) {
      List<obstacle_t> kin = obstacle.confidence == obstacle_t.CONFIDENCE_SURE ? sure : tentative;
      boolean is_in_sight = area.contains(at(obstacle));
      if (is_in_sight && (kin == sure || kin.size() < MAX_TENTATIVE_MARKS)) kin.add(obstacle);
    }
    marks(tentative, Palette.FAINT_INK, 1f);
    marks(sure, Palette.INK, 1.6f);
    List<Rectangle> taken = new ArrayList<>();
    taken.add(new Rectangle((int) area.getCenterX() - 8, (int) area.getCenterY() - 12, 16, 22));
    g.setFont(g.getFont().deriveFont(Font.BOLD, 12f));
    labels(sure, Palette.INK, taken);
    g.setFont(g.getFont().deriveFont(Font.PLAIN, 11f));
    labels(tentative, Palette.FAINT_INK, taken);
  }

  private void marks(List<obstacle_t> obstacles, Color colour, float width) {
    g.setColor(colour);
    g.setStroke(new BasicStroke(width));
    for (obstacle_t obstacle : obstacles) circle(at(obstacle), 4);
  }

  private void labels(List<obstacle_t> obstacles, Color colour, List<Rectangle> taken) {
    FontMetrics metrics = g.getFontMetrics();
    for (obstacle_t obstacle : obstacles) {
      if (taken.size() > MAX_LABELS) return;
      int x = (int) at(obstacle).getX();
      int y = (int) at(obstacle).getY();
      for (String text : new String[] {Texts.obstacle(obstacle), Integer.toString(obstacle.id)}) {
        Rectangle box = new Rectangle(x + 7, y - metrics.getAscent() / 2 - 2, metrics.stringWidth(text) + 4, metrics.getAscent() + 3);
        if (box.x + box.width > area.x + area.width) box.x = x - 7 - box.width;
        if (taken.stream().anyMatch(box::intersects)) continue;
        g.setColor(LABEL_BACKGROUND);
        g.fill(box);
        g.setColor(colour);
        g.drawString(text, box.x + 2, box.y + metrics.getAscent());
        taken.add(box);
        break;
      }
    }
  }
}
