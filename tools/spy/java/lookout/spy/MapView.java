package lookout.spy;

import java.awt.BasicStroke;
import java.awt.Color;
import java.awt.Font;
import java.awt.FontMetrics;
import java.awt.Graphics2D;
import java.awt.Rectangle;
import java.awt.RenderingHints;
import java.awt.Shape;
import java.awt.geom.Ellipse2D;
import java.awt.geom.Line2D;
import java.awt.geom.Path2D;
import java.util.ArrayList;
import java.util.List;
import lookout.obstacle_t;
import lookout.segment_t;

/** The scan from above, bow up, the vessel in the middle, with rings of range. */
final class MapView {
  private static final int MAX_LABELS = 24;
  private static final int MAX_TENTATIVE_MARKS = 40;
  private static final Color LABEL_BACKGROUND = new Color(255, 255, 255, 150);
  private static final double[] RING_STEPS_M = {1, 2, 5, 10, 20, 50, 100};

  private final Graphics2D g;
  private final Rectangle area;
  private final Picture picture;
  private final double radius_m;

  private MapView(Graphics2D g, Rectangle area, Picture picture, double radius_m) {
    this.g = g;
    this.area = area;
    this.picture = picture;
    this.radius_m = radius_m;
  }

  /** @param radius_m what fits between the middle and the nearer edge */
  static void paint(Graphics2D g, Rectangle area, Picture picture, double radius_m, long now_ms) {
    Shape clip = g.getClip();
    g.clipRect(area.x, area.y, area.width, area.height);
    MapView view = new MapView(g, area, picture, radius_m);
    view.grid();
    view.returns();
    view.outlines();
    if (picture.hasObstacles(now_ms)) view.obstacles();
    view.vessel();
    view.north();
    g.setClip(clip);
  }

  /** Of a point in the vessel frame (x forward, y port; before the mounting is known, the lidar's). */
  static double screenX(Rectangle area, double radius_m, double y_m) {
    return area.getCenterX() - y_m * scale(area, radius_m);
  }

  static double screenY(Rectangle area, double radius_m, double x_m) {
    return area.getCenterY() - x_m * scale(area, radius_m);
  }

  private static double scale(Rectangle area, double radius_m) {
    return 0.5 * Math.min(area.width, area.height) / radius_m;
  }

  private double toX(double y_m) {
    return screenX(area, radius_m, y_m);
  }

  private double toY(double x_m) {
    return screenY(area, radius_m, x_m);
  }

  private double vesselX(double x_m, double y_m) {
    return picture.mounting() == null ? x_m : picture.mounting().vesselX(x_m, y_m);
  }

  private double vesselY(double x_m, double y_m) {
    return picture.mounting() == null ? y_m : picture.mounting().vesselY(x_m, y_m);
  }

  private void grid() {
    g.setColor(Palette.BACKGROUND);
    g.fill(area);
    double step_m = RING_STEPS_M[RING_STEPS_M.length - 1];
    for (int i = RING_STEPS_M.length - 1; i >= 0 && radius_m / RING_STEPS_M[i] <= 7.0; --i) step_m = RING_STEPS_M[i];
    double corner_m = radius_m * Math.hypot(area.width, area.height) / Math.min(area.width, area.height);
    g.setStroke(new BasicStroke(1f));
    g.setColor(Palette.GRID);
    for (int degrees = 0; degrees < 360; degrees += 30) {
      double x_m = Math.cos(Math.toRadians(degrees)) * corner_m;
      double y_m = -Math.sin(Math.toRadians(degrees)) * corner_m;
      g.draw(new Line2D.Double(toX(0), toY(0), toX(y_m), toY(x_m)));
    }
    for (double r_m = step_m; r_m <= corner_m; r_m += step_m) {
      g.setColor(Palette.GRID);
      g.draw(new Ellipse2D.Double(toX(r_m), toY(r_m), toX(-r_m) - toX(r_m), toY(-r_m) - toY(r_m)));
      g.setColor(Palette.FAINT_INK);
      // Along 45 degrees on the starboard bow, where the bow's own line does not cross the numbers.
      double along_m = r_m * Math.sqrt(0.5);
      if (r_m < 1.2 * radius_m) g.drawString((int) r_m + " m", (float) toX(-along_m) + 2, (float) toY(along_m) - 2);
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
        double x_m = flat_m * Math.cos(azimuth_rad);
        double y_m = -flat_m * Math.sin(azimuth_rad);
        g.setColor(Palette.ofLabel(label));
        g.fillRect((int) Math.round(toX(vesselY(x_m, y_m))) - 1, (int) Math.round(toY(vesselX(x_m, y_m))) - 1, 3, 3);
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
        double x = toX(vesselY(x_m[i], y_m[i]));
        double y = toY(vesselX(x_m[i], y_m[i]));
        if (!Double.isFinite(x + y)) return;
        if (i == 0) path.moveTo(x, y);
        else path.lineTo(x, y);
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
    double x = toX(0);
    double y = toY(0);
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
    g.draw(new Ellipse2D.Double(x - 12, y - 12, 24, 24));
    g.drawString("N", (float) (x - 0.5 * metrics.stringWidth("N")), (float) (y + 0.37 * metrics.getAscent()));
  }

  // Tentative marks below sure ones, in rain the nearest only; then numbers beside the nearest, the sure ones first. A text that would lie on another
  // gives way to its number alone, then to nothing.
  private void obstacles() {
    List<obstacle_t> sure = new ArrayList<>();
    List<obstacle_t> tentative = new ArrayList<>();
    for (obstacle_t obstacle : picture.obstacles()) {
      List<obstacle_t> kin = obstacle.confidence == obstacle_t.CONFIDENCE_SURE ? sure : tentative;
      boolean is_in_sight = area.contains(toX(obstacle.nearest_vessel_m[1]), toY(obstacle.nearest_vessel_m[0]));
      if (is_in_sight && (kin == sure || kin.size() < MAX_TENTATIVE_MARKS)) kin.add(obstacle);
    }
    marks(tentative, Palette.FAINT_INK, 1f);
    marks(sure, Palette.INK, 1.6f);
    List<Rectangle> taken = new ArrayList<>();
    taken.add(new Rectangle((int) toX(0) - 8, (int) toY(0) - 12, 16, 22));
    g.setFont(g.getFont().deriveFont(Font.BOLD, 12f));
    labels(sure, Palette.INK, taken);
    g.setFont(g.getFont().deriveFont(Font.PLAIN, 11f));
    labels(tentative, Palette.FAINT_INK, taken);
  }

  private void marks(List<obstacle_t> obstacles, Color colour, float width) {
    g.setColor(colour);
    g.setStroke(new BasicStroke(width));
    for (obstacle_t obstacle : obstacles) {
      g.draw(new Ellipse2D.Double(toX(obstacle.nearest_vessel_m[1]) - 4, toY(obstacle.nearest_vessel_m[0]) - 4, 8, 8));
    }
  }

  private void labels(List<obstacle_t> obstacles, Color colour, List<Rectangle> taken) {
    FontMetrics metrics = g.getFontMetrics();
    for (obstacle_t obstacle : obstacles) {
      if (taken.size() > MAX_LABELS) return;
      double x = toX(obstacle.nearest_vessel_m[1]);
      double y = toY(obstacle.nearest_vessel_m[0]);
      for (String text : new String[] {Texts.obstacle(obstacle), Integer.toString(obstacle.id)}) {
        Rectangle box = new Rectangle((int) x + 7, (int) y - metrics.getAscent() / 2 - 2, metrics.stringWidth(text) + 4, metrics.getAscent() + 3);
        if (box.x + box.width > area.x + area.width) box.x = (int) x - 7 - box.width;
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
