package luminav.spy;

import java.awt.Graphics2D;
import java.awt.geom.AffineTransform;
import java.awt.image.BufferedImage;
import java.util.zip.DataFormatException;
import java.util.zip.Inflater;
import luminav.grid_tile_t;

/** The occupancy grid as a picture, put together from tiles; a tile not received is grey. */
final class GridImage {
  private static final int SIDE = grid_tile_t.TILE_SIDE;
  private static final int CELLS = SIDE * SIDE;
  private static final int LARGEST = 4096;  // cells along a side, as for all receivers
  private static final int OCCUPIED_EVIDENCE = 17;  // log-odds x 20: more likely occupied than 70 %
  private static final int UNKNOWN = 0xd8d8d8;

  final double originX;  // [m] world, lower left corner
  final double originY;
  private final double resolution;  // [m]
  private final long session;
  private final BufferedImage image;

  private GridImage(grid_tile_t tile) {
    originX = tile.origin_x;
    originY = tile.origin_y;
    resolution = tile.resolution;
    session = tile.map_session;
    image = new BufferedImage(tile.columns, tile.rows, BufferedImage.TYPE_INT_RGB);
    for (int row = 0; row < tile.rows; row++) {
      for (int column = 0; column < tile.columns; column++) {
        image.setRGB(column, row, UNKNOWN);
      }
    }
  }

  /** The grid with a tile in it: `grid` itself, a new one when the map has changed, `grid` unchanged for nonsense. */
  static GridImage with(GridImage grid, grid_tile_t tile) {
    final boolean possible = tile.columns > 0 && tile.rows > 0 && tile.columns <= LARGEST && tile.rows <= LARGEST
        && tile.resolution >= 0.01 && tile.resolution <= 1.0 && tile.tile_column >= 0 && tile.tile_row >= 0
        && (long) SIDE * tile.tile_column < tile.columns && (long) SIDE * tile.tile_row < tile.rows
        && Double.isFinite(tile.origin_x) && Double.isFinite(tile.origin_y);
    final byte[] cells = possible ? inflated(tile) : null;
    if (cells == null) {
      return grid;
    }
    final boolean same = grid != null && grid.session == tile.map_session && grid.image.getWidth() == tile.columns
        && grid.image.getHeight() == tile.rows && grid.resolution == tile.resolution && grid.originX == tile.origin_x
        && grid.originY == tile.origin_y;
    final GridImage target = same ? grid : new GridImage(tile);
    target.put(tile, cells);
    return target;
  }

  private static byte[] inflated(grid_tile_t tile) {
    final Inflater inflater = new Inflater();
    try {
      final byte[] cells = new byte[2 * CELLS];
      inflater.setInput(tile.data);
      int size = 0;
      while (size < cells.length) {
        final int more = inflater.inflate(cells, size, cells.length - size);
        if (more == 0) {
          return null;
        }
        size += more;
      }
      return cells;
    } catch (DataFormatException damaged) {
      return null;
    } finally {
      inflater.end();
    }
  }

  private void put(grid_tile_t tile, byte[] cells) {
    for (int i = 0; i < CELLS; i++) {
      final int column = SIDE * tile.tile_column + i % SIDE;
      final int row = SIDE * tile.tile_row + i / SIDE;
      if (column < image.getWidth() && row < image.getHeight()) {
        image.setRGB(column, image.getHeight() - 1 - row, colour(cells[i], cells[CELLS + i]));
      }
    }
  }

  private static int colour(int prior, int evidence) {
    if (prior == grid_tile_t.PRIOR_OCCUPIED) {
      return 0x303030;
    }
    if (evidence >= OCCUPIED_EVIDENCE) {
      return 0x8060b0;
    }
    if (prior == grid_tile_t.PRIOR_DISPUTED) {
      return 0xf0a040;
    }
    return prior == grid_tile_t.PRIOR_FREE ? 0xffffff : UNKNOWN;
  }

  double width() {
    return image.getWidth() * resolution;
  }

  double height() {
    return image.getHeight() * resolution;
  }

  /** In world coordinates [m]. */
  void draw(Graphics2D g) {
    final AffineTransform worldFromImage = AffineTransform.getTranslateInstance(originX, originY + height());
    worldFromImage.scale(resolution, -resolution);
    g.drawImage(image, worldFromImage, null);
  }
}
