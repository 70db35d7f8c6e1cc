package luminav.spy;

import java.awt.BasicStroke;
import java.awt.Color;
import java.awt.Graphics2D;
import java.awt.Shape;
import java.awt.geom.AffineTransform;
import java.awt.geom.Ellipse2D;
import java.awt.geom.Line2D;
import java.awt.geom.Path2D;
import java.io.IOException;
import java.util.ArrayList;
import java.util.List;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;
import luminav.grid_tile_t;
import luminav.hypotheses_t;
import luminav.path_t;
import luminav.pose_t;
import luminav.sim_truth_t;
import luminav.tile_request_t;

/** Pose and path over the map: blue while TRACKING, green before, the planned way red, the simulator's truth grey. */
public class MapViewer implements SpyPlugin {
  @Override
  public boolean canHandle(long fingerprint) {
    return fingerprint == pose_t.LCM_FINGERPRINT || fingerprint == path_t.LCM_FINGERPRINT
        || fingerprint == grid_tile_t.LCM_FINGERPRINT || fingerprint == hypotheses_t.LCM_FINGERPRINT
        || fingerprint == sim_truth_t.LCM_FINGERPRINT;
  }

  @Override
  public Action getAction(JDesktopPane pane, ChannelData channel) {
    return Viewer.action("Pose and path over the map", pane, Panel::new);
  }

  private static class Panel extends Viewer {
    private static final Color TRACKING = new Color(20, 90, 220);
    private static final Color SEARCHING = new Color(40, 170, 60);
    private static final Color TRUTH = new Color(150, 150, 150);
    private static final Color WAY = new Color(220, 40, 40);
    private static final double TRAIL_STEP = 0.05;  // [m] between its points
    private static final int LONGEST_TRAIL = 20000;  // points
    private static final double LONGEST_LINE = 1.0;  // [m] a longer step is a jump and not drawn

    private static class TrailPoint {
      final double x;
      final double y;
      final boolean tracking;

      TrailPoint(double x, double y, boolean tracking) {
        this.x = x;
        this.y = y;
        this.tracking = tracking;
      }
    }

    private GridImage grid;
    private pose_t pose;
    private path_t path;
    private hypotheses_t hypotheses;
    private sim_truth_t truth;
    private final List<TrailPoint> believed = new ArrayList<>();
    private final List<TrailPoint> driven = new ArrayList<>();

    Panel() {
      super(560, 420, "POSE", "PATH", "GRID_TILE", "HYPOTHESES", "SIM_TRUTH");
    }

    @Override
    void opened() {
      final tile_request_t request = new tile_request_t();
      request.utime = System.currentTimeMillis() * 1000;
      request.id = request.utime;
      request.floor = "";
      request.tile_column = new int[0];
      request.tile_row = new int[0];
      LCM.getSingleton().publish("TILE_REQUEST", request);
    }

    @Override
    Runnable take(String channel, LCMDataInputStream data) throws IOException {
      switch (channel) {
        case "POSE": {
          final pose_t message = new pose_t(data);
          return () -> {
            pose = message;
            follow(believed, message.x, message.y, message.state == pose_t.STATE_TRACKING);
          };
        }
        case "PATH": {
          final path_t message = new path_t(data);
          return () -> path = message;
        }
        case "HYPOTHESES": {
          final hypotheses_t message = new hypotheses_t(data);
          return () -> hypotheses = message;
        }
        case "SIM_TRUTH": {
          final sim_truth_t message = new sim_truth_t(data);
          return () -> {
            truth = message;
            follow(driven, message.x, message.y, true);
          };
        }
        default: {
          final grid_tile_t message = new grid_tile_t(data);
          return () -> grid = GridImage.with(grid, message);
        }
      }
    }

    private static void follow(List<TrailPoint> trail, double x, double y, boolean tracking) {
      final TrailPoint last = trail.isEmpty() ? null : trail.get(trail.size() - 1);
      if (last == null || last.tracking != tracking || Math.hypot(x - last.x, y - last.y) >= TRAIL_STEP) {
        trail.add(new TrailPoint(x, y, tracking));
      }
      if (trail.size() > LONGEST_TRAIL) {
        trail.subList(0, LONGEST_TRAIL / 2).clear();
      }
    }

    /** World [m] to panel [px]: the whole grid, or 20 m round the pose while there is none. */
    private AffineTransform panelFromWorld() {
      final double left = grid != null ? grid.originX : (pose != null ? pose.x : 0.0) - 10.0;
      final double bottom = grid != null ? grid.originY : (pose != null ? pose.y : 0.0) - 10.0;
      final double width = grid != null ? grid.width() : 20.0;
      final double height = grid != null ? grid.height() : 20.0;
      final double scale = Math.min(getWidth() / width, getHeight() / height);
      final AffineTransform transform = new AffineTransform();
      transform.translate((getWidth() - scale * width) / 2.0, (getHeight() + scale * height) / 2.0);
      transform.scale(scale, -scale);
      transform.translate(-left, -bottom);
      return transform;
    }

    @Override
    void draw(Graphics2D g) {
      final AffineTransform plain = g.getTransform();
      final AffineTransform world = panelFromWorld();
      final float pixel = (float) (1.0 / world.getScaleX());  // [m]
      g.transform(world);
      if (grid != null) {
        grid.draw(g);
      }
      drawTrail(g, driven, TRUTH, TRUTH, 4.0f * pixel);
      drawTrail(g, believed, TRACKING, SEARCHING, 1.5f * pixel);
      if (hypotheses != null && pose != null && pose.state != pose_t.STATE_TRACKING) {
        drawHypotheses(g, pixel);
      }
      if (path != null) {
        drawPath(g, pixel);
      }
      if (truth != null) {
        drawRobot(g, truth.x, truth.y, truth.theta, TRUTH);
      }
      if (pose != null) {
        final boolean tracking = pose.state == pose_t.STATE_TRACKING;
        drawRobot(g, pose.x, pose.y, pose.theta, tracking ? TRACKING : SEARCHING);
        g.setTransform(plain);
        final String state = tracking ? "TRACKING" : pose.state == pose_t.STATE_AMBIGUOUS ? "AMBIGUOUS" : "LOST";
        label(g, String.format("%s  %.2f m  %.2f m  %.0f deg  %s", state, pose.x, pose.y, Math.toDegrees(pose.theta),
            pose.reason));
      }
    }

    private static void drawTrail(Graphics2D g, List<TrailPoint> trail, Color tracking, Color other, float width) {
      g.setStroke(new BasicStroke(width));
      for (int i = 1; i < trail.size(); i++) {
        final TrailPoint a = trail.get(i - 1);
        final TrailPoint b = trail.get(i);
        if (Math.hypot(b.x - a.x, b.y - a.y) < LONGEST_LINE) {
          g.setColor(b.tracking ? tracking : other);
          g.draw(new Line2D.Double(a.x, a.y, b.x, b.y));
        }
      }
    }

    private void drawHypotheses(Graphics2D g, float pixel) {
      g.setColor(SEARCHING);
      for (int i = 0; i < hypotheses.particle_count; i++) {
        g.fill(disc(hypotheses.particle_x[i], hypotheses.particle_y[i], pixel));
      }
      g.setStroke(new BasicStroke(pixel));
      for (int i = 0; i < hypotheses.count; i++) {
        g.draw(disc(hypotheses.x[i], hypotheses.y[i], Math.max(0.1, hypotheses.sigma[i])));
      }
    }

    private void drawPath(Graphics2D g, float pixel) {
      g.setColor(WAY);
      g.setStroke(new BasicStroke(2.0f * pixel));
      final Path2D line = new Path2D.Double();
      for (int i = 0; i < path.count; i++) {
        if (i == 0) {
          line.moveTo(path.x[i], path.y[i]);
        } else {
          line.lineTo(path.x[i], path.y[i]);
        }
      }
      g.draw(line);
      if (path.count > 0) {
        g.draw(disc(path.x[path.count - 1], path.y[path.count - 1], Math.max(0.05, path.tolerance)));
      }
    }

    private static Shape disc(double x, double y, double radius) {
      return new Ellipse2D.Double(x - radius, y - radius, 2.0 * radius, 2.0 * radius);
    }

    /** An arrow head, larger than the robot so that it is seen on the whole map. */
    private static void drawRobot(Graphics2D g, double x, double y, double theta, Color colour) {
      final Path2D arrow = new Path2D.Double();
      arrow.moveTo(0.5, 0.0);
      arrow.lineTo(-0.35, 0.32);
      arrow.lineTo(-0.15, 0.0);
      arrow.lineTo(-0.35, -0.32);
      arrow.closePath();
      final AffineTransform worldFromRobot = AffineTransform.getTranslateInstance(x, y);
      worldFromRobot.rotate(theta);
      g.setColor(colour);
      g.fill(worldFromRobot.createTransformedShape(arrow));
    }
  }
}
