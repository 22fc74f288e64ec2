// Raster tiles of the boat's own computer, kept while they may be needed again. Where one is missing, a larger one stands in its place.
import { zoomFor } from "./mercator.js";

interface TileFile { name: string; min_zoom: number; max_zoom: number; bounds: [number, number, number, number]; format: string }
interface Tile { image: HTMLImageElement; state: "coming" | "here" | "missing"; used: number }

const kMostTiles = 160;
const kMostComing = 8;
const kParents = 6;

export class Tiles {
  /** Null: there are none, as far as is known. */
  file: TileFile | null = null;
  /** Whether it is known that there are none. */
  isAbsent = false;
  /** To draw again: a tile came. */
  onCame: () => void = () => undefined;
  private readonly tiles = new Map<string, Tile>();
  private numComing = 0;
  private count = 0;
  private isAsked = false;

  /** Asks once whether there are any. */
  async open(): Promise<void> {
    if (this.isAsked) return;
    this.isAsked = true;
    try {
      const answer = await fetch("/tiles.json");
      this.isAbsent = answer.status === 204;
      this.onCame();
      if (answer.status !== 200) return;
      const file = await answer.json() as TileFile;
      if (Number.isInteger(file.min_zoom) && Number.isInteger(file.max_zoom) && file.max_zoom < 30) this.file = file;
      this.onCame();
    } catch {
      this.isAsked = false;  // no connection: asked again when the map is shown again
    }
  }

  /** Paints what there is for the plane whose middle is at mercator (x, y), the whole earth being `world_px` wide; without smoothing of edges, so that no seams show. */
  paint(context: CanvasRenderingContext2D, x: number, y: number, world_px: number, width_px: number, height_px: number): void {
    if (this.file === null) return;
    ++this.count;
    const zoom = zoomFor(world_px, this.file.min_zoom, this.file.max_zoom), n = 2 ** zoom, size = world_px / n;
    if (size < 48) return;  // far below the least zoom there would be thousands
    const left = Math.floor((x - width_px / 2 / world_px) * n), right = Math.floor((x + width_px / 2 / world_px) * n);
    const top = Math.max(0, Math.floor((y - height_px / 2 / world_px) * n)), bottom = Math.min(n - 1, Math.floor((y + height_px / 2 / world_px) * n));
    const toX = (column: number) => Math.round((column / n - x) * world_px + width_px / 2), toY = (row: number) => Math.round((row / n - y) * world_px + height_px / 2);
    for (let row = top; row <= bottom; ++row) {
      for (let column = left; column <= right; ++column) {
        this.paintTile(context, zoom, ((column % n) + n) % n, row, toX(column), toY(row), toX(column + 1) - toX(column), toY(row + 1) - toY(row));
      }
    }
    if (this.tiles.size > kMostTiles) this.forget();
  }

  private paintTile(context: CanvasRenderingContext2D, zoom: number, column: number, row: number, x: number, y: number, width: number, height: number): void {
    for (let up = 0; up <= kParents && zoom - up >= this.file!.min_zoom; ++up) {
      const tile = this.get(zoom - up, column >> up, row >> up, up === 0);
      if (tile?.state !== "here") continue;
      const part = 1 / 2 ** up, { naturalWidth, naturalHeight } = tile.image;
      const sx = (column % 2 ** up) * part * naturalWidth, sy = (row % 2 ** up) * part * naturalHeight;
      context.drawImage(tile.image, sx, sy, part * naturalWidth, part * naturalHeight, x, y, width, height);
      return;
    }
  }
  // A larger one is asked for only when the one of the right size is known to be missing.
  private get(zoom: number, column: number, row: number, isAsked: boolean): Tile | undefined {
    const key = `${zoom}/${column}/${row}`;
    let tile = this.tiles.get(key);
    if (tile === undefined) {
      if (!isAsked || this.numComing >= kMostComing) return undefined;
      const image = new Image();
      tile = { image, state: "coming", used: this.count };
      this.tiles.set(key, tile);
      ++this.numComing;
      const made = tile;
      const settle = (state: "here" | "missing") => { made.state = state; --this.numComing; this.onCame(); };
      image.onload = () => { settle("here"); };
      image.onerror = () => { settle("missing"); };
      image.src = `/tiles/${key}`;
    }
    tile.used = this.count;
    return tile;
  }
  private forget(): void {
    const oldest = [...this.tiles].filter(([, tile]) => tile.state !== "coming").sort((a, b) => a[1].used - b[1].used);
    for (const [key, tile] of oldest.slice(0, this.tiles.size - kMostTiles)) if (tile.used !== this.count) this.tiles.delete(key);
  }
}
