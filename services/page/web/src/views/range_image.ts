// The scan as the lidar has it: directions beside each other with the bow in the middle, lasers above each other; a strip for each return of a laser shot.
import { currentTheme, rampOf, returnColours, type Theme } from "../drawing/colours.js";
import { kFont } from "../drawing/labels.js";
import { kLegendHeight_px, kLegendName_px, paintLegend } from "../drawing/legend.js";
import { isOld, Stage } from "../drawing/stage.js";
import { describeReturn } from "../drawing/words.js";
import { whyNothing } from "../film.js";
import type { Picture } from "../picture.js";
import type { State, View } from "../state.js";
import { texts } from "../texts/index.js";
import { bearing } from "../units.js";
import { colourButton } from "./colour_button.js";

const kAxis_px = 26, kGap_px = 26, kMostRing_px = 24, kLegend_px = 320, kElevation_px = 34;
const kMostZoom = 24;

interface Strip { top_px: number; height_px: number; kind: number }

/** Direction of each column from the bow, -0.5 (astern over port) to 0.5 of a whole turn, by the mounting of the lidar; NaN where there is none. */
export function columnTurns(picture: Picture, out: Float32Array): void {
  const yaw = (picture.boat?.lidar.yaw_deg ?? 0) / 360;
  out.fill(NaN);
  for (const part of picture.scan) {
    for (let column = 0; column < part.num_columns; ++column) {
      const turn = part.azimuth_rad[column]! / (2 * Math.PI) - yaw;
      out[part.first_column + column] = turn - Math.round(turn);
    }
  }
}

export class RangeImageView implements View {
  private readonly stage: Stage;
  private readonly image = document.createElement("canvas");
  // What part of the turn is shown, and which return lies in which pixel of the image (-1 none).
  private middle = 0;
  private span = 1;
  private pixels: ImageData | null = null;
  private owner = new Int32Array();
  private turns = new Float32Array(4096);
  private strips: Strip[] = [];
  private numRings = 0;
  private hover: { x: number; y: number } | null = null;

  constructor(private readonly state: State) {
    this.stage = new Stage(state, "range-image", [], () => { this.paint(); }, {
      onDrag: (dx) => { this.pan(-dx / this.stage.width_px * this.span); this.stage.ask(); },
      onZoom: (factor, x) => { this.zoom(factor, x); this.stage.ask(); },
      onClick: (x, y) => { this.choose(x, y); },
      onHover: (x, y) => {
        this.hover = Number.isFinite(x) ? { x, y } : null;
        this.point();
      },
    });
    this.stage.button(texts.drawing.zoom_in, "nearer", () => { this.zoom(1.6, this.stage.width_px / 2); });
    this.stage.button(texts.drawing.zoom_out, "further", () => { this.zoom(1 / 1.6, this.stage.width_px / 2); });
    this.stage.button(texts.drawing.reset, "centre", () => { this.reset(); });
    colourButton(this.stage, state, "image_colour_by");
    this.stage.keys({
      "+": () => { this.zoom(1.25, this.stage.width_px / 2); }, "-": () => { this.zoom(0.8, this.stage.width_px / 2); }, Home: () => { this.reset(); },
      ArrowLeft: () => { this.pan(-0.1 * this.span); }, ArrowRight: () => { this.pan(0.1 * this.span); },
    });
    this.stage.describe(texts.drawing.range_image);
  }
  get element(): HTMLElement { return this.stage.element; }
  setVisible(isVisible: boolean): void { this.stage.setVisible(isVisible); }

  private reset(): void { this.middle = 0; this.span = 1; }
  private pan(turn: number): void {
    this.middle += turn;
    this.middle = this.span >= 1 ? 0 : this.middle - Math.round(this.middle);
  }
  private zoom(factor: number, x: number): void {
    const share = x / this.stage.width_px - 0.5, under = this.middle + share * this.span;
    this.span = Math.min(1, Math.max(1 / kMostZoom, this.span / factor));
    this.middle = this.span >= 1 ? 0 : under - share * this.span;
  }

  private paint(): void {
    const { context, width_px, height_px } = this.stage, { picture } = this.state, theme = currentTheme();
    context.clearRect(0, 0, width_px, height_px);
    const first = picture?.scan[0];
    this.strips = [];
    this.stage.setNote(picture === null ? whyNothing(this.state) : first === undefined ? texts.drawing.no_scan : "");
    if (picture === null || picture.returns === null || first === undefined) return;
    this.numRings = first.num_rings;
    const colour_by = this.state.settings.get("image_colour_by"), legend_px = rampOf(colour_by) === undefined ? 0 : kLegendHeight_px;
    const numStrips = first.num_returns, room = (height_px - kAxis_px - legend_px) / numStrips - kGap_px;
    const strip_px = Math.max(this.numRings, Math.min(kMostRing_px * this.numRings, room));
    for (let k = 0; k < numStrips; ++k) this.strips.push({ top_px: kGap_px + k * (strip_px + kGap_px), height_px: strip_px, kind: first.return_kind[k] ?? 1 });
    this.fill(picture, theme, numStrips);
    context.imageSmoothingEnabled = false;
    context.font = kFont;
    for (const [k, strip] of this.strips.entries()) {
      context.drawImage(this.image, 0, k * this.numRings, this.image.width, this.numRings, 0, strip.top_px, width_px, strip.height_px);
      context.fillStyle = theme.css.muted;
      context.textAlign = "left";
      context.textBaseline = "bottom";
      context.fillText(texts.drawing.return_kinds[strip.kind] ?? "", 8, strip.top_px - 4);
    }
    this.paintAxis(context, theme);
    for (const strip of this.strips) this.paintElevations(context, theme, strip, first.elevation_rad);
    const last = this.strips.at(-1)!;
    paintLegend(context, theme, colour_by, { x_px: 14, y_px: last.top_px + last.height_px + kAxis_px + kLegendName_px, width_px: Math.min(kLegend_px, width_px - 96), ground: theme.css.water });
    if (this.hover !== null) this.point();
  }

  // A pixel shows the nearest return of all that lie in it: small things stay visible on a small screen.
  private fill(picture: Picture, theme: Theme, numStrips: number): void {
    const width = Math.round(this.stage.width_px * this.stage.scale), height = this.numRings * numStrips, returns = picture.returns!;
    if (this.pixels?.width !== width || this.pixels.height !== height) {
      this.image.width = width;
      this.image.height = height;
      this.pixels = new ImageData(width, height);
      this.owner = new Int32Array(width * height);
    }
    let numColumns = 0;
    for (const part of picture.scan) numColumns = Math.max(numColumns, part.first_column + part.num_columns);
    if (this.turns.length < numColumns) this.turns = new Float32Array(numColumns);
    columnTurns(picture, this.turns);
    const { owner } = this, words = new Uint32Array(this.pixels.data.buffer);
    owner.fill(-1);
    const [r, g, b] = theme.rgb.panel;
    words.fill(0xff000000 | (b << 16) | (g << 8) | r);
    const { bytes } = returnColours(this.state, picture, this.state.settings.get("image_colour_by"));
    // When columns are wider than a pixel, each fills all of its pixels.
    const wide = Math.max(1, Math.ceil(width / this.span / Math.max(1, numColumns)));
    for (let i = 0; i < returns.first_count; ++i) {
      let turn = this.turns[returns.column[i]!]! - this.middle;
      turn -= Math.round(turn);
      const from = Math.floor((turn / this.span + 0.5) * width), row = returns.return_index[i]! * this.numRings + this.numRings - 1 - returns.ring[i]!;
      if (!(from > -wide && from < width) || row >= height) continue;
      const dim = bytes[4 * i + 3]! < 255 ? 0.45 : 1;
      const colour = 0xff000000 | (mix(bytes[4 * i + 2]!, b, dim) << 16) | (mix(bytes[4 * i + 1]!, g, dim) << 8) | mix(bytes[4 * i]!, r, dim);
      for (let x = Math.max(0, from); x < Math.min(width, from + wide); ++x) {
        const at = row * width + x, before = owner[at]!;
        if (before >= 0 && returns.range_m[before]! <= returns.range_m[i]!) continue;
        owner[at] = i;
        words[at] = colour;
      }
    }
    this.image.getContext("2d")!.putImageData(this.pixels, 0, 0);
  }
  private paintAxis(context: CanvasRenderingContext2D, theme: Theme): void {
    const { width_px } = this.stage, last = this.strips.at(-1)!, y = last.top_px + last.height_px;
    const degrees = this.span * 360, step = [1, 2, 5, 10, 15, 30, 45, 90].find((candidate) => width_px / (degrees / candidate) >= 58) ?? 90;
    const begin = (this.middle - this.span / 2) * 360;
    context.strokeStyle = theme.css.line;
    context.fillStyle = theme.css.text;
    context.lineWidth = 1;
    context.textBaseline = "top";
    context.textAlign = "center";
    context.beginPath();
    for (let k = Math.ceil(begin / step); k * step <= begin + degrees; ++k) {
      const x = (k * step - begin) / degrees * width_px, angle = ((k * step) % 360 + 360) % 360;
      context.moveTo(x, this.strips[0]!.top_px);
      context.lineTo(x, y + 5);
      const name = angle === 0 ? texts.drawing.bow : angle === 90 ? texts.drawing.starboard : angle === 270 ? texts.drawing.port : angle === 180 ? texts.drawing.stern : bearing(angle * Math.PI / 180);
      context.textAlign = x < 30 ? "left" : x > width_px - 30 ? "right" : "center";
      context.fillText(name, Math.min(width_px - 4, Math.max(4, x)), y + 8);
    }
    context.globalAlpha = 0.6;
    context.stroke();
    context.globalAlpha = 1;
  }

  // How far up the lasers look, the lowest first in the message: as many as there is room for, with the horizon.
  private paintElevations(context: CanvasRenderingContext2D, theme: Theme, strip: Strip, elevation_rad: ArrayLike<number>): void {
    const ring_px = strip.height_px / this.numRings, every = Math.max(1, Math.ceil(kElevation_px / ring_px));
    context.textAlign = "left";
    context.textBaseline = "middle";
    context.lineJoin = "round";
    context.strokeStyle = theme.css.panel;
    context.lineWidth = 4;
    context.fillStyle = theme.css.muted;
    for (let ring = 0; ring < this.numRings; ring += every) {
      const y = strip.top_px + (this.numRings - ring - 0.5) * ring_px, text = texts.drawing.elevation((elevation_rad[ring]! * 180 / Math.PI).toFixed(0).replace("-", "−"));
      context.strokeText(text, 6, y);
      context.fillText(text, 6, y);
    }
  }

  // The return under a pixel of the screen, or the nearest within some pixels beside it; -1: none.
  private at(x: number, y: number): number {
    const strip = this.strips.findIndex(({ top_px, height_px }) => y >= top_px && y < top_px + height_px);
    if (strip < 0 || this.image.width === 0) return -1;
    const row = strip * this.numRings + Math.floor((y - this.strips[strip]!.top_px) / this.strips[strip]!.height_px * this.numRings);
    const column = Math.floor(x / this.stage.width_px * this.image.width);
    for (let off = 0; off <= 6; ++off) {
      for (const candidate of [column - off, column + off]) {
        const index = candidate >= 0 && candidate < this.image.width ? this.owner[row * this.image.width + candidate]! : -1;
        if (index >= 0) return index;
      }
    }
    return -1;
  }
  private point(): void {
    const { picture } = this.state;
    if (picture === null || picture.returns === null || this.hover === null || isOld(this.state)) { this.stage.setTip(""); this.state.mark({}); return; }
    const index = this.at(this.hover.x, this.hover.y);
    if (index < 0 || index >= picture.returns.first_count) { this.stage.setTip(""); this.state.mark({}); return; }
    const label = picture.returns.label[index]!;
    this.state.mark({ track: picture.track_of_segment.get(label)?.id ?? null, segment: label > 0 ? label : null });
    this.stage.setTip(describeReturn(this.state, picture, index), this.hover.x, this.hover.y);
  }
  private choose(x: number, y: number): void {
    const { picture } = this.state, index = this.at(x, y);
    if (picture === null || picture.returns === null) return;
    const track = index < 0 ? undefined : picture.track_of_segment.get(picture.returns.label[index] ?? 0);
    this.state.choose(track === undefined || track.id === this.state.chosen ? null : track.id);
    // A finger has no hover: its tap tells as much.
    if (index >= 0) this.stage.setTip(describeReturn(this.state, picture, index), x, y);
  }
}
function mix(colour: number, ground: number, share: number): number { return Math.round(colour * share + ground * (1 - share)); }
