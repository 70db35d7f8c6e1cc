package luminav.spy;

import java.awt.BasicStroke;
import java.awt.Color;
import java.awt.Graphics2D;
import java.awt.geom.Arc2D;
import java.awt.geom.Ellipse2D;
import java.awt.geom.Line2D;
import java.io.IOException;
import java.util.List;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import lcm.lcm.LCMDataInputStream;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;
import luminav.sonar_t;

/**
 * The sonar ring from above, the robot's nose up: red cones end at an echo, grey ones had none. Where the discs stand is
 * read from the robot's file that $LUMINAV_ROBOT names; without one they are bars.
 */
public class SonarViewer implements SpyPlugin {
  @Override
  public boolean canHandle(long fingerprint) {
    return fingerprint == sonar_t.LCM_FINGERPRINT;
  }

  @Override
  public Action getAction(JDesktopPane pane, ChannelData channel) {
    return Viewer.action("Sonar ring", pane, Panel::new);
  }

  private static class Panel extends Viewer {
    private static final double CONE = 30.0;  // [deg] as wide as a Polaroid transducer hears
    private static final double VIEW = 5.5;  // [m] from the robot to the panel's edge
    private static final double RING_STEP = 1.0;  // [m]
    private static final Color ECHO = new Color(220, 40, 40, 130);
    private static final Color NO_ECHO = new Color(150, 150, 150, 60);

    private final List<SonarRing.Disc> discs = SonarRing.of(System.getenv("LUMINAV_ROBOT"));
    private sonar_t sonar;

    Panel() {
      super(320, 320, "SONAR");
    }

    @Override
    Runnable take(String channel, LCMDataInputStream data) throws IOException {
      final sonar_t message = new sonar_t(data);
      return () -> sonar = message;
    }

    @Override
    void draw(Graphics2D g) {
      if (sonar == null) {
        label(g, "no SONAR yet");
      } else if (discs.size() != sonar.count) {
        drawBars(g);
      } else {
        drawRing(g);
      }
    }

    private void drawRing(Graphics2D g) {
      final double scale = Math.min(getWidth(), getHeight()) / 2.0 / VIEW;  // [px/m]
      g.translate(getWidth() / 2.0, getHeight() / 2.0);
      g.setColor(new Color(225, 225, 225));
      g.setStroke(new BasicStroke(1.0f));
      for (double radius = RING_STEP; radius < VIEW; radius += RING_STEP) {
        g.draw(new Ellipse2D.Double(-radius * scale, -radius * scale, 2.0 * radius * scale, 2.0 * radius * scale));
      }
      for (int i = 0; i < sonar.count; i++) {
        final SonarRing.Disc disc = discs.get(i);
        final double radius = scale * sonar.range[i];
        // x forward is up, y left is left; Swing's arcs run counter-clockwise from the right, in degrees
        final double across = -disc.y * scale;
        final double down = -disc.x * scale;
        final double direction = Math.toDegrees(disc.theta) + 90.0;
        g.setColor(sonar.has_echo[i] ? ECHO : NO_ECHO);
        g.fill(new Arc2D.Double(across - radius, down - radius, 2.0 * radius, 2.0 * radius, direction - CONE / 2.0, CONE,
            Arc2D.PIE));
      }
      g.setColor(Color.BLACK);
      g.draw(new Ellipse2D.Double(-0.22 * scale, -0.22 * scale, 0.44 * scale, 0.44 * scale));
      g.draw(new Line2D.Double(0.0, 0.0, 0.0, -0.22 * scale));
    }

    private void drawBars(Graphics2D g) {
      final double step = (double) getWidth() / Math.max(1, sonar.count);
      for (int i = 0; i < sonar.count; i++) {
        final int height = (int) (getHeight() * Math.min(1.0, sonar.range[i] / VIEW));
        g.setColor(sonar.has_echo[i] ? ECHO : NO_ECHO);
        g.fillRect((int) (i * step) + 1, getHeight() - height, Math.max(1, (int) step - 2), height);
      }
    }
  }
}
