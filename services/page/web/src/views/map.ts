// The same on the earth: north up, tiles of the boat's computer below where there are any, a grid of degrees in any case.
import type { Theme } from "../drawing/colours.js";
import { kFont } from "../drawing/labels.js";
import { gridStep, latitudeOf, longitudeOf, mercatorX, mercatorY, offset, position, widthAt } from "../drawing/mercator.js";
import type { Scene } from "../drawing/scene.js";
import { Tiles } from "../drawing/tiles.js";
import { isRelative, lacking, type Picture } from "../picture.js";
import type { State } from "../state.js";
import { texts } from "../texts/index.js";
import { PlanView } from "./plan_view.js";

const kFirstReach_m = 60;
const kMost_px_per_m = 80;
const kGrid_px = 130;
const kNoTiles_px = 24;

export class MapView extends PlanView {
  private readonly tiles = new Tiles();
  // Middle of the screen, and pixels of the whole earth.
  private x = 0.5;
  private y = 0.35;
  private world_px = 2048;
  private follows = true;
  private isFitted = false;

  constructor(state: State) {
    super(state, "map");
    this.hasRings = false;
    this.tiles.onCame = () => { this.stage.ask(); };
  }

  protected override onShown(): void { void this.tiles.open(); }

  protected place(picture: Picture, { own }: Scene): boolean {
    const { pose } = picture, plane = this.plane;
    if (!own.isOnMap || pose === null || isRelative(pose) || !Number.isFinite(pose.latitude_deg)) return false;
    // Turned by what north at the boat and at the datum differ is left out: a quarter of a degree at 20 km.
    const x = mercatorX(pose.longitude_deg), y = mercatorY(pose.latitude_deg), width_m = widthAt(pose.latitude_deg);
    if (!this.isFitted) {
      this.isFitted = true;
      this.world_px = Math.min(plane.width_px, plane.height_px) / 2 / kFirstReach_m * width_m;
    }
    this.world_px = Math.min(this.world_px, kMost_px_per_m * width_m);
    if (this.follows) { this.x = x; this.y = y; }
    plane.px_per_m = this.world_px / width_m;
    plane.east_m = own.east_m;
    plane.north_m = own.north_m;
    plane.up = 0;
    plane.anchor_x = 0.5 + (x - this.x) * this.world_px / plane.width_px;
    plane.anchor_y = 0.5 + (y - this.y) * this.world_px / plane.height_px;
    return true;
  }
  protected pan(dx_px: number, dy_px: number): void {
    this.follows = false;
    this.x = (this.x - dx_px / this.world_px + 1) % 1;
    this.y = Math.min(1, Math.max(0, this.y - dy_px / this.world_px));
  }
  protected zoom(factor: number, x_px: number, y_px: number): void {
    const before = this.world_px;
    this.world_px = Math.min(kMost_px_per_m * widthAt(latitudeOf(this.y)), Math.max(512, before * factor));
    if (this.follows) return;
    const grown = 1 / before - 1 / this.world_px;
    this.x += grown * (x_px - this.plane.width_px / 2);
    this.y = Math.min(1, Math.max(0, this.y + grown * (y_px - this.plane.height_px / 2)));
  }
  protected centre(): void { this.follows = true; }

  protected override paintGround(context: CanvasRenderingContext2D, theme: Theme, scene: Scene | null): void {
    const { width_px, height_px } = this.stage;
    this.tiles.paint(context, this.x, this.y, this.world_px, width_px, height_px);
    if (this.tiles.file !== null && theme.isDark) {
      // A chart is made for the day: what is shown in the dark keeps the eye adapted.
      context.globalCompositeOperation = "multiply";
      context.fillStyle = theme.isNight ? "#5a0000" : "#6b7480";
      context.fillRect(0, 0, width_px, height_px);
      context.globalCompositeOperation = "source-over";
    }
    this.paintGrid(context, theme);
    if (scene !== null) this.paintOwnWay(context, theme);
  }
  private paintGrid(context: CanvasRenderingContext2D, theme: Theme): void {
    const { width_px, height_px } = this.stage;
    const step = gridStep(kGrid_px / this.world_px * 360 * 60) / 60, decimals = step * 60 >= 1 ? 0 : Math.ceil(-Math.log10(step * 60));
    const screenX = (longitude: number) => (mercatorX(longitude) - this.x) * this.world_px + width_px / 2;
    const screenY = (latitude: number) => (mercatorY(latitude) - this.y) * this.world_px + height_px / 2;
    const west = longitudeOf(this.x - width_px / 2 / this.world_px), east = longitudeOf(this.x + width_px / 2 / this.world_px);
    const north = latitudeOf(Math.max(0, this.y - height_px / 2 / this.world_px)), south = latitudeOf(Math.min(1, this.y + height_px / 2 / this.world_px));
    context.strokeStyle = theme.css.line;
    context.fillStyle = theme.css.muted;
    context.lineWidth = 1;
    context.font = kFont;
    context.beginPath();
    for (let k = Math.ceil(west / step); k * step <= east; ++k) {
      context.moveTo(screenX(k * step), 0);
      context.lineTo(screenX(k * step), height_px);
    }
    for (let k = Math.ceil(south / step); k * step <= north; ++k) {
      context.moveTo(0, screenY(k * step));
      context.lineTo(width_px, screenY(k * step));
    }
    context.stroke();
    context.textBaseline = "top";
    context.textAlign = "left";
    for (let k = Math.ceil(west / step); k * step <= east; ++k) context.fillText(position(k * step, false, decimals), screenX(k * step) + 4, 4);
    // Below the longitudes: at the foot are the scale and the legend of colours.
    if (this.tiles.isAbsent) context.fillText(texts.drawing.no_tiles, 4, kNoTiles_px);
    context.textBaseline = "bottom";
    for (let k = Math.ceil(south / step); k * step <= north; ++k) if (screenY(k * step) < height_px - 124 && screenY(k * step) > kNoTiles_px + 34) context.fillText(position(k * step, true, decimals), 4, screenY(k * step) - 3);
  }
  private paintOwnWay(context: CanvasRenderingContext2D, theme: Theme): void {
    const { own_deg } = this.trails;
    if (!this.state.settings.get("shows_trails") || own_deg.length < 4) return;
    context.strokeStyle = theme.css.own;
    context.globalAlpha = 0.45;
    context.lineWidth = 2;
    context.lineJoin = "round";
    context.beginPath();
    for (let i = 0; i + 1 < own_deg.length; i += 2) {
      context.lineTo((mercatorX(own_deg[i + 1]!) - this.x) * this.world_px + this.stage.width_px / 2, (mercatorY(own_deg[i]!) - this.y) * this.world_px + this.stage.height_px / 2);
    }
    context.stroke();
    context.globalAlpha = 1;
  }

  // The scale of mercator changes with the latitude: what is measured is measured on the earth.
  protected override between(from: readonly [number, number], to: readonly [number, number]): [number, number] {
    const place = ([east, north]: readonly [number, number]) => {
      const x = this.x + (this.plane.x(east, north) - this.plane.width_px / 2) / this.world_px, y = this.y + (this.plane.y(east, north) - this.plane.height_px / 2) / this.world_px;
      return [latitudeOf(y), longitudeOf(x)] as const;
    };
    return offset(...place(from), ...place(to));
  }
  protected describe({ picture }: Scene): string {
    return texts.drawing.map(`${position(picture.pose?.latitude_deg ?? NaN, true)}, ${position(picture.pose?.longitude_deg ?? NaN, false)}`);
  }
  protected noteFor(scene: Scene | null): string { return scene === null ? texts.drawing.no_place[lacking(this.state.picture?.pose ?? null) ?? "position"] : ""; }
}
