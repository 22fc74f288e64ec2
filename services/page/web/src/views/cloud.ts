// Returns in three dimensions, with the water, the own hull and the tracks as boxes. Frame: x forward, y port, z up from the water.
import { currentTheme, returnColours, trackColour, type Rgb, type Theme } from "../drawing/colours.js";
import { drawLabels, type Label } from "../drawing/labels.js";
import { lookAt, perspective, product, project } from "../drawing/matrix.js";
import { Points } from "../drawing/points.js";
import { ringStep } from "../drawing/own_boat.js";
import { ownPlace, type OwnPlace } from "../drawing/scene.js";
import { Stage } from "../drawing/stage.js";
import { danger } from "../drawing/tracks.js";
import { whyNothing } from "../film.js";
import type { Track } from "../messages/generated.js";
import type { Picture } from "../picture.js";
import type { State, View } from "../state.js";
import { texts } from "../texts/index.js";
import { length } from "../units.js";
import { shortNameOf } from "./track_words.js";

const kFirst = { around_rad: 0, above_rad: 0.5, distance_m: 70, x_m: 12, y_m: 0 };
const kHeightOfView_rad = 0.9;
const kNear_m = 3, kFar_m = 600;

/** Lines that grow as they are needed, and are used again. */
class Lines {
  places = new Float32Array(3 * 4096);
  colours = new Uint8Array(4 * 4096);
  count = 0;
  begin(): void { this.count = 0; }
  add(x1: number, y1: number, z1: number, x2: number, y2: number, z2: number, colour: Rgb, opacity: number): void {
    if (3 * (this.count + 2) > this.places.length) {
      const places = new Float32Array(2 * this.places.length), colours = new Uint8Array(2 * this.colours.length);
      places.set(this.places);
      colours.set(this.colours);
      this.places = places;
      this.colours = colours;
    }
    this.places.set([x1, y1, z1, x2, y2, z2], 3 * this.count);
    this.colours.set([...colour, opacity, ...colour, opacity], 4 * this.count);
    this.count += 2;
  }
}

export class CloudView implements View {
  private readonly points = new Points(true);
  private readonly stage: Stage;
  private readonly lines = new Lines();
  private eye = { ...kFirst };

  constructor(private readonly state: State) {
    this.points.onRestored = () => { this.stage.ask(); };
    this.stage = new Stage(state, "cloud", [this.points.canvas], () => { this.paint(); }, {
      onDrag: (dx, dy, fingers, isSecond) => {
        if (fingers > 1 || isSecond) this.shift(dx, dy); else this.orbit(-0.006 * dx, 0.006 * dy);
        this.stage.ask();
      },
      onZoom: (factor) => { this.zoom(factor); this.stage.ask(); },
      onClick: (x, y) => { this.choose(x, y); },
      onHover: () => undefined,
    });
    this.stage.button(texts.drawing.zoom_in, "nearer", () => { this.zoom(1.4); });
    this.stage.button(texts.drawing.zoom_out, "further", () => { this.zoom(1 / 1.4); });
    this.stage.button(texts.drawing.reset, "centre", () => { this.eye = { ...kFirst }; });
    const turn = (around: number, above: number) => () => { this.orbit(around, above); };
    this.stage.keys({
      "+": () => { this.zoom(1.2); }, "-": () => { this.zoom(1 / 1.2); }, Home: () => { this.eye = { ...kFirst }; },
      ArrowLeft: turn(0.1, 0), ArrowRight: turn(-0.1, 0), ArrowUp: turn(0, 0.08), ArrowDown: turn(0, -0.08),
    });
    this.stage.describe(texts.drawing.cloud);
  }
  get element(): HTMLElement { return this.stage.element; }
  setVisible(isVisible: boolean): void { this.stage.setVisible(isVisible); }

  private orbit(around_rad: number, above_rad: number): void {
    this.eye.around_rad += around_rad;
    this.eye.above_rad = Math.min(1.5, Math.max(0.03, this.eye.above_rad + above_rad));
  }
  private zoom(factor: number): void { this.eye.distance_m = Math.min(400, Math.max(kNear_m, this.eye.distance_m / factor)); }
  private shift(dx: number, dy: number): void {
    const scale = 1.1 * this.eye.distance_m / this.stage.height_px, sin = Math.sin(this.eye.around_rad), cos = Math.cos(this.eye.around_rad);
    this.eye.x_m += scale * (cos * dy - sin * dx);
    this.eye.y_m += scale * (sin * dy + cos * dx);
  }
  private matrix(): Float32Array {
    const { around_rad, above_rad, distance_m, x_m, y_m } = this.eye, flat = distance_m * Math.cos(above_rad);
    const eye = [x_m - flat * Math.cos(around_rad), y_m - flat * Math.sin(around_rad), distance_m * Math.sin(above_rad)] as const;
    return product(perspective(kHeightOfView_rad, this.stage.width_px / this.stage.height_px, Math.max(0.3, distance_m / 100), kFar_m + distance_m), lookAt(eye, [x_m, y_m, 0], [0, 0, 1]));
  }

  private paint(): void {
    const { context, width_px, height_px } = this.stage, { picture } = this.state, theme = currentTheme();
    context.clearRect(0, 0, width_px, height_px);
    const lost = this.points.works ? "" : texts.drawing.restoring;
    this.stage.setNote(picture === null ? whyNothing(this.state) : lost !== "" ? lost : picture.returns === null ? texts.drawing.no_scan : "");
    if (picture === null) return;
    const matrix = this.matrix(), own = ownPlace(picture), labels: Label[] = [];
    this.lines.begin();
    this.addWater(theme, labels, matrix);
    this.addHull(picture, theme);
    if (own.isOnMap) this.addTracks(picture, own, theme, labels, matrix);
    this.points.setLines(this.lines.places, this.lines.colours, this.lines.count);
    if (picture.returns === null) this.points.clearPoints();
    else {
      const colours = returnColours(this.state, picture);
      this.points.setPoints(picture.returns.level_m, colours.bytes, picture.returns.count, colours.version);
    }
    this.points.draw(matrix, (this.eye.distance_m < 40 ? 2.6 : 2) * this.stage.scale);
    drawLabels(context, labels, theme, this.stage, width_px < 500 ? 8 : 20, []);
  }
  private toScreen(matrix: Float32Array, x: number, y: number, z: number): [number, number] | null {
    const place = project(matrix, x, y, z);
    if (place === null || Math.abs(place[0]) > 1 || Math.abs(place[1]) > 1) return null;
    return [(place[0] + 1) / 2 * this.stage.width_px, (1 - place[1]) / 2 * this.stage.height_px];
  }
  // Rings on the water, as in the picture from above, and a line ahead.
  private addWater(theme: Theme, labels: Label[], matrix: Float32Array): void {
    const step = ringStep(this.stage.height_px / (1.6 * this.eye.distance_m), false);
    for (let k = 1; k <= 8; ++k) {
      const r = k * step;
      for (let i = 0; i < 96; ++i) {
        const a = i / 96 * 2 * Math.PI, b = (i + 1) / 96 * 2 * Math.PI;
        this.lines.add(r * Math.cos(a), r * Math.sin(a), 0, r * Math.cos(b), r * Math.sin(b), 0, theme.rgb.line, 255);
      }
      const place = this.toScreen(matrix, r, 0, 0);
      if (place !== null) labels.push({ x_px: place[0], y_px: place[1], radius_px: -4, lines: [length(this.state.settings, r).replace(".0 ", " ")], colour: theme.css.muted, isBoxed: false });
    }
    for (let k = 0; k < 12; ++k) {
      const a = k / 12 * 2 * Math.PI;
      this.lines.add(step * Math.cos(a), step * Math.sin(a), 0, 8 * step * Math.cos(a), 8 * step * Math.sin(a), 0, theme.rgb[k === 0 ? "own" : "line"], k === 0 ? 200 : 130);
    }
  }
  private addHull(picture: Picture, theme: Theme): void {
    const box = picture.boat?.own_vessel ?? { min_x_m: -1.5, max_x_m: 1.5, min_y_m: -0.7, max_y_m: 0.7 }, middle = (box.min_y_m + box.max_y_m) / 2, bow = box.min_x_m + 0.6 * (box.max_x_m - box.min_x_m);
    const x = [box.max_x_m, bow, box.min_x_m, box.min_x_m, bow], y = [middle, box.max_y_m, box.max_y_m, box.min_y_m, box.min_y_m];
    this.addBox(x, y, 0, 0.7, theme.rgb.own, 255);
  }
  private addBox(x: ArrayLike<number>, y: ArrayLike<number>, low: number, high: number, colour: Rgb, opacity: number): void {
    for (let i = 0, j = x.length - 1; i < x.length; j = i++) {
      this.lines.add(x[j]!, y[j]!, low, x[i]!, y[i]!, low, colour, opacity);
      this.lines.add(x[j]!, y[j]!, high, x[i]!, y[i]!, high, colour, opacity);
      this.lines.add(x[i]!, y[i]!, low, x[i]!, y[i]!, high, colour, opacity);
    }
  }
  private addTracks(picture: Picture, own: OwnPlace, theme: Theme, labels: Label[], matrix: Float32Array): void {
    const sin = Math.sin(own.heading_rad), cos = Math.cos(own.heading_rad);
    const forward = (east: number, north: number) => (east - own.east_m) * sin + (north - own.north_m) * cos;
    const port = (east: number, north: number) => -(east - own.east_m) * cos + (north - own.north_m) * sin;
    const shown = picture.tracks.filter((track) => this.isShown(picture, track))
      .sort((a, b) => danger(a, picture.alert_of_track.get(a.id)) - danger(b, picture.alert_of_track.get(b.id)));
    const tops: Label[] = [];
    for (const track of shown) {
      const alert = picture.alert_of_track.get(track.id), isOn = this.state.marked.track === track.id || this.state.chosen === track.id;
      const name = trackColour(track, alert), top = Math.max(0.3, Number.isFinite(track.top_above_water_m) ? track.top_above_water_m : 1);
      const outline = track.num_outline > 2 ? track : null;
      const x: number[] = [], y: number[] = [];
      for (let i = 0; i < (outline?.num_outline ?? 4); ++i) {
        const east = outline?.outline_east_m[i] ?? track.position_map_m[0]! + (i === 1 || i === 2 ? 0.3 : -0.3);
        const north = outline?.outline_north_m[i] ?? track.position_map_m[1]! + (i > 1 ? 0.3 : -0.3);
        x.push(forward(east, north));
        y.push(port(east, north));
      }
      this.addBox(x, y, 0, top, theme.rgb[isOn ? "text" : name], track.status === 1 ? 110 : 255);
      const cx = forward(track.position_map_m[0]!, track.position_map_m[1]!), cy = port(track.position_map_m[0]!, track.position_map_m[1]!);
      const place = this.toScreen(matrix, cx, cy, top);
      const isRaised = name === "warning" || name === "caution";
      if (place === null) continue;
      tops.push({
        x_px: place[0], y_px: place[1], radius_px: 4, lines: [this.labelOf(track, picture, isRaised || isOn || name === "moving")],
        colour: theme.css[isRaised || isOn ? name : name === "moving" ? "text" : "muted"], isBoxed: isRaised || isOn,
      });
    }
    labels.unshift(...tops);
  }
  private labelOf(track: Track, names: Picture, isNamed: boolean): string {
    const range = length(this.state.settings, track.range_m);
    return isNamed || names.name_of_track.has(track.id) || names.ship_of_track.has(track.id) ? `${shortNameOf(track, names)}  ${range}` : texts.drawing.plain(track.kind, track.id, range);
  }
  private isShown(picture: Picture, track: Track): boolean {
    return track.status !== 4 && (track.status !== 1 || this.state.settings.get("shows_tentative") || picture.alert_of_track.has(track.id));
  }
  // The track whose middle is nearest to a tap, on the screen.
  private choose(x: number, y: number): void {
    const { picture } = this.state;
    if (picture === null) return;
    const own = ownPlace(picture), matrix = this.matrix(), sin = Math.sin(own.heading_rad), cos = Math.cos(own.heading_rad);
    let best: Track | null = null, least = 40;
    for (const track of own.isOnMap ? picture.tracks : []) {
      if (!this.isShown(picture, track)) continue;
      const east = track.position_map_m[0]! - own.east_m, north = track.position_map_m[1]! - own.north_m;
      const place = this.toScreen(matrix, east * sin + north * cos, -east * cos + north * sin, (track.top_above_water_m || 1) / 2);
      const distance = place === null ? Infinity : Math.hypot(place[0] - x, place[1] - y);
      if (distance < least) { least = distance; best = track; }
    }
    this.state.choose(best === null || best.id === this.state.chosen ? null : best.id);
  }
}
