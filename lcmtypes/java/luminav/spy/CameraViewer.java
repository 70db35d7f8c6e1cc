package luminav.spy;

import java.awt.BasicStroke;
import java.awt.Color;
import java.awt.Graphics2D;
import java.awt.geom.Path2D;
import java.awt.image.BufferedImage;
import java.io.ByteArrayInputStream;
import java.io.IOException;
import javax.imageio.ImageIO;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import lcm.lcm.LCMDataInputStream;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;
import luminav.camera_image_t;
import luminav.fixture_detection_t;
import luminav.fixture_detections_t;

/** The camera's picture with the detections made in it: lit orange, half lit yellow, unlit blue, else white. */
public class CameraViewer implements SpyPlugin {
  @Override
  public boolean canHandle(long fingerprint) {
    return fingerprint == camera_image_t.LCM_FINGERPRINT || fingerprint == fixture_detections_t.LCM_FINGERPRINT;
  }

  @Override
  public Action getAction(JDesktopPane pane, ChannelData channel) {
    return Viewer.action("Camera picture with detections", pane, Panel::new);
  }

  private static class Panel extends Viewer {
    private static final int LARGEST = 4096;  // [px] along a side

    private BufferedImage picture;
    private camera_image_t image;
    private fixture_detections_t detections;

    Panel() {
      super(480, 360, "CAMERA_IMAGE", "FIXTURE_DETECTIONS");
    }

    @Override
    Runnable take(String channel, LCMDataInputStream data) throws IOException {
      if (channel.equals("FIXTURE_DETECTIONS")) {
        final fixture_detections_t message = new fixture_detections_t(data);
        return () -> detections = message;
      }
      final camera_image_t message = new camera_image_t(data);
      final BufferedImage decoded =
          message.format == camera_image_t.FORMAT_JPEG ? ImageIO.read(new ByteArrayInputStream(message.data)) : grey(message);
      return () -> {
        image = message;
        picture = decoded;
      };
    }

    private static BufferedImage grey(camera_image_t message) {
      if (message.width <= 0 || message.height <= 0 || message.width > LARGEST || message.height > LARGEST
          || message.data.length < message.width * message.height) {
        return null;
      }
      final BufferedImage decoded = new BufferedImage(message.width, message.height, BufferedImage.TYPE_BYTE_GRAY);
      decoded.getRaster().setDataElements(0, 0, message.width, message.height, message.data);
      return decoded;
    }

    @Override
    void draw(Graphics2D g) {
      if (picture == null) {
        label(g, image == null ? "no CAMERA_IMAGE yet" : "the picture does not decode");
        return;
      }
      final double scale =
          Math.min((double) getWidth() / picture.getWidth(), (double) getHeight() / picture.getHeight());
      final Graphics2D scaled = (Graphics2D) g.create();
      scaled.scale(scale, scale);
      scaled.drawImage(picture, 0, 0, null);
      if (detections != null) {
        scaled.setStroke(new BasicStroke((float) (2.0 / scale)));
        for (fixture_detection_t detection : detections.detections) {
          scaled.setColor(colour(detection));
          scaled.draw(outline(detection.corners_px));
        }
      }
      scaled.dispose();
      label(g, String.format("picture %d  %.1f ms  gain %.2f  %s", image.sequence, image.exposure_us / 1000.0, image.gain,
          image.health));
    }

    private static Color colour(fixture_detection_t detection) {
      switch (detection.state) {
        case fixture_detection_t.STATE_LIT:
          return new Color(255, 120, 0);
        case fixture_detection_t.STATE_HALF:
          return new Color(240, 220, 0);
        case fixture_detection_t.STATE_UNLIT:
          return new Color(0, 120, 255);
        default:
          return Color.WHITE;
      }
    }

    private static Path2D outline(float[] corners) {
      final Path2D line = new Path2D.Double();
      line.moveTo(corners[0], corners[1]);
      for (int i = 2; i + 1 < corners.length; i += 2) {
        line.lineTo(corners[i], corners[i + 1]);
      }
      line.closePath();
      return line;
    }
  }
}
