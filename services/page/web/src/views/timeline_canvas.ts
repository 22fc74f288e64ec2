// Draws the time line: a row of alerts, one of HEALTH and losses, the number of tracks as hills, times below, and where the shown moment lies.
import type { Source, Strip } from "../link.js";
import { texts } from "../texts/index.js";
import { sinceBegin, timeOfDay } from "../units.js";
import { gapsOf, type Span } from "./strip.js";

export interface Drawn {
  span: Span;
  strips: readonly Strip[];
  sources: readonly Source[];
  shown_utime_us: number;
  /** Where seconds are counted from; NaN: nowhere. */
  begin_utime_us: number;
  isLive: boolean;
  pointed_px: number | null;
}

const kAlertRow_px = 10, kHealthRow_px = 5, kTimes_px = 16, kTop_px = 8;
const kSteps_s = [0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 14400, 43200, 86400];
const kLabel_px = 132, kShortLabel_px = 76;

/** Draws anew; reads the colours of the palette from the canvas' style. */
export function drawStrip(canvas: HTMLCanvasElement, { span, strips, sources, shown_utime_us, begin_utime_us, isLive, pointed_px }: Drawn): void {
  const width = canvas.clientWidth, height = canvas.clientHeight, ratio = devicePixelRatio || 1;
  if (width === 0 || height === 0) return;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const context = canvas.getContext("2d")!;
  const style = getComputedStyle(canvas);
  const colour = (name: string) => style.getPropertyValue(name).trim();
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  const toX = (utime_us: number) => (utime_us - span.from_utime_us) / (span.to_utime_us - span.from_utime_us) * width;
  const bottom = height - kTimes_px, hills = bottom - kTop_px - kAlertRow_px - kHealthRow_px - 4;

  // Where there is a recording.
  context.fillStyle = colour("--bg");
  for (const source of sources) {
    const from = Math.max(0, toX(source.begin_utime_us)), to = Math.min(width, toX(source.end_utime_us));
    if (to > from) context.fillRect(from, kTop_px, to - from, bottom - kTop_px);
  }
  const most = Math.max(4, ...strips.map((strip) => Math.max(0, ...strip.num_tracks)));
  for (const strip of strips) {
    const bars = (values: readonly number[], draw: (x: number, width: number, value: number) => void) => {
      for (let i = 0; i < values.length; ++i) {
        const from = toX(strip.begin_utime_us + i * strip.bucket_us), to = toX(strip.begin_utime_us + (i + 1) * strip.bucket_us);
        if (to < 0 || from > width || values[i]! < 0) continue;
        draw(from, Math.max(1, to - from + 0.5), values[i]!);
      }
    };
    context.fillStyle = colour("--panel");
    for (const gap of gapsOf(strip)) context.fillRect(toX(gap.from_utime_us), kTop_px, toX(gap.to_utime_us) - toX(gap.from_utime_us), bottom - kTop_px);
    context.fillStyle = colour("--track");
    context.globalAlpha = 0.45;
    bars(strip.num_tracks, (x, w, value) => { const tall = value / most * hills; context.fillRect(x, bottom - tall, w, tall); });
    context.globalAlpha = 1;
    bars(strip.alert_level, (x, w, value) => {
      if (value === 0) return;
      context.fillStyle = colour(value >= 2 ? "--warning" : "--caution");
      // A warning is taller as well: at night all colours are red.
      const tall = value >= 2 ? kAlertRow_px : kAlertRow_px / 2;
      context.fillRect(x, kTop_px + kAlertRow_px - tall, Math.max(2, w), tall);
    });
    const row = kTop_px + kAlertRow_px + 2;
    bars(strip.health, (x, w, value) => {
      if (value === 0) return;
      context.fillStyle = colour(value >= 2 ? "--warning" : "--caution");
      context.fillRect(x, row, w, kHealthRow_px);
    });
    context.fillStyle = colour("--text");
    bars(strip.num_lost, (x, w, value) => { if (value > 0) context.fillRect(x, row + 1, Math.max(1.5, w), kHealthRow_px - 2); });
    // Where runs begin and end, and where nothing was recorded.
    context.strokeStyle = colour("--muted");
    context.setLineDash([3, 3]);
    context.lineWidth = 1;
    context.beginPath();
    for (const event of strip.events) {
      if (event.kind !== "start" && event.kind !== "end" && event.kind !== "gap") continue;
      const x = Math.round(toX(event.utime_us)) + 0.5;
      context.moveTo(x, kTop_px);
      context.lineTo(x, bottom);
    }
    context.stroke();
    context.setLineDash([]);
  }
  drawTimes(context, span, begin_utime_us, width, height, toX, colour);
  if (pointed_px !== null) {
    context.fillStyle = colour("--muted");
    context.fillRect(Math.round(pointed_px), kTop_px, 1, bottom - kTop_px);
  }
  const x = Math.min(width - 2, Math.max(1, toX(shown_utime_us)));
  if (!isLive || shown_utime_us <= span.to_utime_us) {
    context.fillStyle = colour(isLive ? "--ok" : "--accent");
    context.fillRect(x - 1, 0, 3, bottom);
    context.beginPath();
    context.moveTo(x - 7, 0);
    context.lineTo(x + 8, 0);
    context.lineTo(x + 0.5, 9);
    context.fill();
  }
}

function drawTimes(context: CanvasRenderingContext2D, span: Span, begin_utime_us: number, width: number, height: number, toX: (utime_us: number) => number, colour: (name: string) => string): void {
  const length_s = (span.to_utime_us - span.from_utime_us) / 1e6;
  const step_s = kSteps_s.find((candidate) => candidate / length_s * width >= (Number.isFinite(begin_utime_us) ? kLabel_px : kShortLabel_px)) ?? 86400;
  const step_us = step_s * 1e6;
  context.font = "12px system-ui, sans-serif";
  context.textBaseline = "alphabetic";
  context.fillStyle = colour("--muted");
  for (let utime_us = Math.ceil(span.from_utime_us / step_us) * step_us; utime_us <= span.to_utime_us; utime_us += step_us) {
    const x = toX(utime_us), decimals = step_s < 1 ? 1 : 0, text = `${timeOfDay(utime_us, decimals)} ${sinceBegin(utime_us, begin_utime_us, decimals)}`.trim(), textWidth = context.measureText(text).width;
    context.fillRect(Math.round(x), height - kTimes_px, 1, 4);
    if (x - textWidth / 2 >= 0 && x + textWidth / 2 <= width) context.fillText(text, x - textWidth / 2, height - 2);
  }
}

/** What the strips say of a time, in words. */
export function describe(strips: readonly Strip[], utime_us: number): string[] {
  const strip = strips.findLast((candidate) => utime_us >= candidate.begin_utime_us && utime_us <= candidate.begin_utime_us + candidate.bucket_us * candidate.num_tracks.length);
  if (strip === undefined || gapsOf(strip).some((gap) => utime_us >= gap.from_utime_us && utime_us < gap.to_utime_us)) return [texts.film.nothingRecorded];
  const bucket = Math.min(strip.num_tracks.length - 1, Math.floor((utime_us - strip.begin_utime_us) / strip.bucket_us));
  const said: string[] = [];
  const tracks = strip.num_tracks[bucket]!, level = strip.alert_level[bucket]!, health = strip.health[bucket]!, lost = strip.num_lost[bucket]!;
  if (tracks >= 0) said.push(texts.film.tracks(tracks));
  if (level > 0) said.push(level >= 2 ? texts.film.warning : texts.film.caution);
  if (health > 0) said.push(health >= 2 ? texts.film.failed : texts.film.degraded);
  if (lost > 0) said.push(texts.film.lost(lost));
  return said;
}
