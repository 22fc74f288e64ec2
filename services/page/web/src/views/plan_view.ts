// What `around` and `map` share: returns below, the scene above, pointing, measuring.
import { paintAlertPlaces } from "../drawing/alerts.js";
import { currentTheme, returnColours, type Theme } from "../drawing/colours.js";
import { drawLabels } from "../drawing/labels.js";
import { paintLand, paintObstacles } from "../drawing/land.js";
import { paintLegend } from "../drawing/legend.js";
import { isOnOwn, Measure } from "../drawing/measure.js";
import { paintGuardZones, paintOwnBoat, paintRings, paintScale } from "../drawing/own_boat.js";
import { pickReturn, pickTrack } from "../drawing/pick.js";
import { Plane } from "../drawing/plane.js";
import { Points } from "../drawing/points.js";
import { ownPlace, type Scene } from "../drawing/scene.js";
import { paintShips } from "../drawing/ships.js";
import { Stage } from "../drawing/stage.js";
import { isShown, paintTracks, paintTrails } from "../drawing/tracks.js";
import { Trails } from "../drawing/trails.js";
import { describeReturn } from "../drawing/words.js";
import { whyNothing } from "../film.js";
import type { Picture } from "../picture.js";
import type { State, View } from "../state.js";
import { texts } from "../texts/index.js";
import { colourButton } from "./colour_button.js";

const kMouse_px = 14, kFinger_px = 28, kReturn_px = 8;
const kDescribe_ms = 3000;
const kLegend_px = 180;

export abstract class PlanView implements View {
  protected readonly plane = new Plane();
  protected readonly stage: Stage;
  protected readonly trails: Trails;
  protected readonly points = new Points(false);
  protected scene: Scene | null = null;
  protected hasRings = true;
  private readonly measure = new Measure();
  private readonly measureButton: HTMLButtonElement;
  private isVisible = false;
  private described_ms = -Infinity;
  private hover: { x: number; y: number } | null = null;
  private isHoverAsked = false;

  constructor(protected readonly state: State, name: string) {
    this.trails = new Trails(state);
    this.trails.onCame = () => { this.stage.ask(); };
    this.points.onRestored = () => { this.stage.ask(); };
    this.stage = new Stage(state, name, [this.points.canvas], () => { this.paint(); }, {
      onDrag: (dx, dy) => { this.stage.setTip(""); this.pan(dx, dy); this.stage.ask(); },
      onZoom: (factor, x, y) => { this.zoom(factor, x, y); this.stage.ask(); },
      onClick: (x, y, isTouch) => { this.click(x, y, isTouch ? kFinger_px : kMouse_px); },
      onHover: (x, y) => { this.point(x, y); },
    });
    const middle = () => [this.stage.width_px * this.plane.anchor_x, this.stage.height_px * this.plane.anchor_y] as const;
    const nearer = (factor: number) => () => { this.zoom(factor, ...middle()); };
    this.stage.button(texts.drawing.zoom_in, "nearer", nearer(1.5));
    this.stage.button(texts.drawing.zoom_out, "further", nearer(1 / 1.5));
    this.stage.button(texts.drawing.centre, "centre", () => { this.centre(); });
    this.measureButton = this.stage.button(texts.drawing.measure, "measure", () => { this.toggleMeasure(); });
    this.measureButton.setAttribute("aria-pressed", "false");
    colourButton(this.stage, state, "colour_by");
    const step = (dx: number, dy: number) => () => { this.pan(dx, dy); };
    this.stage.keys({
      "+": nearer(1.25), "=": nearer(1.25), "-": nearer(0.8), Home: () => { this.centre(); }, "0": () => { this.centre(); }, m: () => { this.toggleMeasure(); },
      ArrowLeft: step(60, 0), ArrowRight: step(-60, 0), ArrowUp: step(0, 60), ArrowDown: step(0, -60),
      Escape: () => { if (this.measure.isOn) this.toggleMeasure(); else this.state.choose(null); }, ...this.moreKeys(),
    });
    // Trails grow while the view is not seen, so that they are there when it is.
    state.on(["picture"], () => { if (state.picture !== null) this.trails.take(state.picture); });
  }

  get element(): HTMLElement { return this.stage.element; }
  setVisible(isVisible: boolean): void {
    this.isVisible = isVisible;
    this.stage.setVisible(isVisible);
    if (isVisible) this.onShown();
  }

  /** Puts the plane where it is to be for this picture; false: it has no place there. */
  protected abstract place(picture: Picture, scene: Scene): boolean;
  protected abstract pan(dx_px: number, dy_px: number): void;
  protected abstract zoom(factor: number, x_px: number, y_px: number): void;
  protected abstract centre(): void;
  /** Below returns and tracks, on the canvas of the plan; `scene` is null where nothing came yet or the own place is not known. */
  protected paintGround?(context: CanvasRenderingContext2D, theme: Theme, scene: Scene | null): void;
  protected moreKeys(): Record<string, () => void> { return {}; }
  protected onShown(): void { /* nothing to fetch */ }
  protected between(from: readonly [number, number], to: readonly [number, number]): [number, number] { return [to[0] - from[0], to[1] - from[1]]; }
  protected abstract describe(scene: Scene): string;
  protected abstract noteFor(scene: Scene | null): string;

  private paint(): void {
    const { context, width_px, height_px } = this.stage, { picture } = this.state, theme = currentTheme();
    this.plane.width_px = width_px;
    this.plane.height_px = height_px;
    context.clearRect(0, 0, width_px, height_px);
    let scene: Scene | null = null;
    if (picture !== null) {
      scene = { context, plane: this.plane, picture, own: ownPlace(picture), theme, state: this.state, trails: this.trails, labels: [], taken: [] };
      if (!this.place(picture, scene)) scene = null;
    }
    this.scene = scene;
    this.paintGround?.(context, theme, scene);
    this.paintReturns(scene);
    if (scene !== null) this.paintScene(scene);
    const lost = this.points.works || !this.state.settings.get("shows_returns") ? "" : texts.drawing.restoring;
    this.stage.setNote([picture === null ? whyNothing(this.state) : this.noteFor(scene), lost, this.measure.hint].filter((part) => part !== "").join(" · "));
    if (scene !== null && performance.now() - this.described_ms > kDescribe_ms) {
      this.described_ms = performance.now();
      this.stage.describe(this.describe(scene));
    }
  }
  private paintReturns(scene: Scene | null): void {
    const returns = scene?.picture.returns ?? null;
    if (scene === null || returns === null || !this.state.settings.get("shows_returns")) {
      this.points.clearPoints();
      this.points.draw(new Float32Array(16), 1);
      return;
    }
    const colours = returnColours(this.state, scene.picture);
    this.points.setPoints(returns.level_m, colours.bytes, returns.count, colours.version);
    const size = Math.min(6, Math.max(1.6, 0.09 * this.plane.px_per_m)) * this.stage.scale;
    this.points.draw(this.plane.fromLevel(scene.own.east_m, scene.own.north_m, scene.own.heading_rad), size);
  }
  private paintScene(scene: Scene): void {
    const { context } = scene, { width_px, height_px } = this.stage;
    const { taken } = scene;
    taken.push({ x: 0, y: height_px - 44, width: 150, height: 44 });
    if (this.hasRings) taken.push(...paintRings(scene));
    paintGuardZones(scene);
    paintLand(scene);
    paintObstacles(scene);
    if (scene.own.isOnMap) {
      paintTrails(scene);
      paintOwnBoat(scene);
      paintTracks(scene);
      paintShips(scene);
    } else paintOwnBoat(scene);
    paintAlertPlaces(scene);
    this.measure.paint(scene, (from, to) => this.between(from, to));
    const x = scene.plane.x(scene.own.east_m, scene.own.north_m), y = scene.plane.y(scene.own.east_m, scene.own.north_m);
    taken.push({ x: x - 10, y: y - 14, width: 20, height: 28 });
    drawLabels(context, scene.labels, scene.theme, this.stage, width_px < 500 ? 8 : 24, taken);
    paintScale(scene, 14, height_px - 14);
    this.paintLegend(scene);
  }
  private paintLegend({ context, theme }: Scene): void {
    paintLegend(context, theme, this.state.settings.get("colour_by"), { x_px: 14, y_px: this.stage.height_px - 80, width_px: kLegend_px, ground: theme.css.water });
  }

  private toggleMeasure(): void {
    this.measure.toggle();
    this.measureButton.setAttribute("aria-pressed", String(this.measure.isOn));
    this.stage.setTip("");
  }
  private click(x: number, y: number, reach: number): void {
    const { scene } = this;
    if (scene === null) return;
    const track = scene.own.isOnMap ? pickTrack(this.plane, scene.picture.tracks.filter((candidate) => isShown(scene, candidate)), x, y, reach) : null;
    if (this.measure.isOn) {
      const [east_m, north_m] = this.plane.place(x, y);
      this.measure.add(isOnOwn(scene, x, y, reach) ? { kind: "own" } : track !== null ? { kind: "track", id: track.id } : { kind: "place", east_m, north_m });
      this.stage.ask();
    } else this.state.choose(track === null || track.id === this.state.chosen ? null : track.id);
  }
  private point(x: number, y: number): void {
    this.hover = Number.isFinite(x) ? { x, y } : null;
    if (this.isHoverAsked) return;
    this.isHoverAsked = true;
    requestAnimationFrame(() => {
      this.isHoverAsked = false;
      if (this.isVisible) this.markUnder();
    });
  }
  private markUnder(): void {
    const { scene, hover } = this;
    if (scene === null || hover === null) { this.stage.setTip(""); this.state.mark({}); return; }
    const { x, y } = hover, { own, picture } = scene;
    const track = own.isOnMap ? pickTrack(this.plane, picture.tracks.filter((candidate) => isShown(scene, candidate)), x, y, kMouse_px) : null;
    const index = this.state.settings.get("shows_returns") ? pickReturn(this.plane, picture, own.east_m, own.north_m, own.heading_rad, x, y, kReturn_px) : -1;
    const label = index < 0 ? 0 : picture.returns!.label[index]!;
    this.state.mark({ track: track?.id ?? picture.track_of_segment.get(label)?.id ?? null, segment: label > 0 ? label : null });
    // While it is measured, the words about a return would lie over the distance.
    this.stage.setTip(index < 0 || this.measure.isOn ? "" : describeReturn(this.state, picture, index), x, y);
  }
}
