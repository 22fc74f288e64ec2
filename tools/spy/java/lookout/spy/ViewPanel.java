package lookout.spy;

import java.awt.Dimension;
import java.awt.Graphics;
import java.awt.Graphics2D;
import java.awt.event.KeyAdapter;
import java.awt.event.KeyEvent;
import javax.swing.JPanel;
import javax.swing.Timer;

/** The picture in a window, drawn anew ten times a second, as often as the lidar turns. */
final class ViewPanel extends JPanel {
  private static final long serialVersionUID = 1L;
  private static final int FRAME_PERIOD_MS = 100;
  private static final double MIN_RADIUS_M = 5.0;
  private static final double MAX_RADIUS_M = 200.0;
  private static final double ZOOM_STEP = 1.25;

  private final transient Feed feed;
  private final Timer timer = new Timer(FRAME_PERIOD_MS, event -> repaint());
  private double radius_m = 50.0;

  ViewPanel(Feed feed) {
    this.feed = feed;
    setPreferredSize(new Dimension(1240, 940));
    setFocusable(true);
    addMouseWheelListener(event -> zoom(event.getPreciseWheelRotation()));
    addKeyListener(new KeyAdapter() {
      @Override
      public void keyTyped(KeyEvent event) {
        if (event.getKeyChar() == '+') zoom(-1.0);
        if (event.getKeyChar() == '-') zoom(1.0);
      }
    });
    timer.start();
  }

  void stop() {
    timer.stop();
    feed.close();
  }

  private void zoom(double steps) {
    radius_m = Math.max(MIN_RADIUS_M, Math.min(MAX_RADIUS_M, radius_m * Math.pow(ZOOM_STEP, steps)));
    repaint();
  }

  @Override
  protected void paintComponent(Graphics g) {
    Graphics2D copy = (Graphics2D) g.create();
    Painter.paint(copy, getWidth(), getHeight(), feed.picture(), radius_m, System.currentTimeMillis(), feed.num_refused());
    copy.dispose();
  }
}
