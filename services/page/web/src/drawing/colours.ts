// Colours of the palette for what is drawn, and the colour of each return. The palettes themselves are in the style sheet.
import { alertColour } from "./alerts.js";
import { Segments, Track } from "../messages/generated.js";
import type { Alert } from "../messages/generated.js";
import type { Picture } from "../picture.js";
import type { SettingValues } from "../settings.js";
import type { State } from "../state.js";

// What a palette that lacks one has in its place.
const kDefaults = {
  bg: "#eef3f6", panel: "#ffffff", text: "#10212b", muted: "#5d7280", line: "#c3d0d8", accent: "#0a66c2", water: "#dfeaf1", land: "#a08a5f", own: "#10212b",
  track: "#1f6f8b", moving: "#0a66c2", tentative: "#93a4ae", caution: "#b26a00", warning: "#c8102e", ok: "#1b7f4b", returns: "#4a6572",
};
export type ColourBy = SettingValues["colour_by"];
export type ColourName = keyof typeof kDefaults;
export type Rgb = readonly [number, number, number];
/** Colours of one palette: as text for a canvas, and as numbers from 0 to 255. */
export interface Theme {
  palette: string;
  isNight: boolean;
  isDark: boolean;
  css: Record<ColourName, string>;
  rgb: Record<ColourName, Rgb>;
}

/** `#rrggbb` and `rgb(r g b)` in any of their spellings as numbers; null when it is something else. */
export function parseColour(text: string): Rgb | null {
  const hex = /^#([0-9a-f]{3}|[0-9a-f]{6})$/i.exec(text.trim())?.[1];
  if (hex !== undefined) {
    const full = hex.length === 3 ? [...hex].map((digit) => digit + digit).join("") : hex;
    return [0, 2, 4].map((at) => Number.parseInt(full.slice(at, at + 2), 16)) as unknown as Rgb;
  }
  const numbers = /^rgba?\(([^)]*)\)$/i.exec(text.trim())?.[1]?.split(/[\s,/]+/).filter(Boolean).slice(0, 3).map(Number);
  return numbers?.length === 3 && numbers.every(Number.isFinite) ? (numbers as unknown as Rgb) : null;
}

let theme: Theme | null = null;
/** The palette that is shown now. Cheap: read anew only when it has changed. */
export function currentTheme(): Theme {
  const palette = document.documentElement.dataset["palette"] ?? "day";
  if (theme?.palette === palette) return theme;
  const style = getComputedStyle(document.documentElement);
  const css = { ...kDefaults };
  const rgb = {} as Record<ColourName, Rgb>;
  for (const name of Object.keys(kDefaults) as ColourName[]) {
    const given = style.getPropertyValue(`--${name}`).trim();
    const parsed = parseColour(given);
    if (parsed !== null) css[name] = given;
    rgb[name] = parsed ?? parseColour(kDefaults[name])!;
  }
  // Land is drawn as lines and single cells here, not as a ground: it must stand out from the water.
  rgb.land = standingOut(rgb.land, rgb.water, rgb.text);
  css.land = `rgb(${rgb.land.join(" ")})`;
  theme = { palette, isNight: palette === "night", isDark: luminance(rgb.water) < 0.2, css, rgb };
  return theme;
}
/** Relative luminance, 0 black to 1 white. */
export function luminance(rgb: Rgb): number {
  const [r, g, b] = rgb.map((value) => (value <= 10 ? value / 255 / 12.92 : ((value / 255 + 0.055) / 1.055) ** 2.4)) as unknown as Rgb;
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

/** A colour mixed with that of the text until its contrast with the ground is 3. */
export function standingOut(colour: Rgb, ground: Rgb, text: Rgb): Rgb {
  for (let share = 0; share < 1; share += 0.1) {
    const mixed = [0, 1, 2].map((k) => Math.round(colour[k]! * (1 - share) + text[k]! * share)) as unknown as Rgb;
    const a = luminance(mixed), b = luminance(ground);
    if ((Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05) >= 3) return mixed;
  }
  return text;
}

/** Colour of a track by what it means to the helmsman; the same in every view. */
export function trackColour(track: Track, alert: Alert | undefined): ColourName {
  if (alert !== undefined) return alertColour(alert);
  if (track.status === Track.STATUS_TENTATIVE) return "tentative";
  return track.speed_mps > 0.3 && Number.isFinite(track.course_rad) ? "moving" : "track";
}

/** hue 0 to 360, saturation and lightness 0 to 1. */
export function fromHsl(hue: number, saturation: number, lightness: number): Rgb {
  const a = saturation * Math.min(lightness, 1 - lightness);
  const part = (n: number) => { const k = (n + hue / 30) % 12; return Math.round(255 * (lightness - a * Math.max(-1, Math.min(k - 3, 9 - k, 1)))); };
  return [part(0), part(8), part(4)];
}
/** A colour of its own for a number; at night all are red, of many brightnesses. */
export function distinctColour(id: number, isNight: boolean, isDark: boolean): Rgb {
  const share = (id * 0.6180339887) % 1;
  if (isNight) return fromHsl(12 * share, 1, 0.28 + 0.34 * ((id * 0.7548776662) % 1));
  return fromHsl(360 * share, 0.75, (isDark ? 0.6 : 0.38) + 0.06 * ((id % 3) - 1));
}
const kRampDay: Rgb[] = [[38, 70, 150], [10, 120, 140], [60, 135, 50], [190, 115, 0], [190, 25, 40]];
const kRampDark: Rgb[] = [[90, 110, 220], [40, 170, 190], [110, 200, 110], [240, 190, 60], [255, 110, 90]];
const kRampNight: Rgb[] = [[70, 0, 0], [115, 0, 0], [160, 5, 0], [210, 20, 0], [255, 60, 10]];
/** A share from 0 to 1 as a colour, from low to high. */
export function rampColour(share: number, isNight: boolean, isDark: boolean): Rgb {
  const stops = isNight ? kRampNight : isDark ? kRampDark : kRampDay;
  const at = Math.min(1, Math.max(0, share)) * (stops.length - 1), index = Math.min(stops.length - 2, Math.floor(at)), rest = at - index;
  return [0, 1, 2].map((k) => Math.round(stops[index]![k]! * (1 - rest) + stops[index + 1]![k]! * rest)) as unknown as Rgb;
}
/** What colours of a ramp stand for: where its ends are, and which values are named on its legend. */
export interface Ramp { share(value: number): number; ticks: readonly number[] }
const linear = (low: number, high: number, ticks: readonly number[]): Ramp => ({ share: (value) => (value - low) / (high - low), ticks });
const kNearest_m = 1, kFarthest_m = 100;
/** Of the height above the water, m; of the reflectivity, device units; of the range, m: what is near has the colour that warns, and each doubling is as wide. */
export const kRamps = {
  height: linear(-0.5, 5, [0, 1, 2, 3, 4, 5]),
  reflectivity: linear(0, 150, [0, 50, 100, 150]),
  range: { share: (range_m: number) => 1 - Math.log(range_m / kNearest_m) / Math.log(kFarthest_m / kNearest_m), ticks: [1, 2, 5, 10, 20, 50, 100] },
} as const satisfies Record<string, Ramp>;
/** The ramp by which returns are coloured; undefined: they are coloured by what they belong to. */
export function rampOf(colour_by: ColourBy): Ramp | undefined { return Object.hasOwn(kRamps, colour_by) ? kRamps[colour_by as keyof typeof kRamps] : undefined; }

interface Key { picture: Picture; theme: Theme; colour_by: ColourBy; track: number | null; segment: number | null; chosen: number | null }
let cached: { key: Key; colours: ReturnColours } | null = null;

/** `version` is another object whenever the bytes are others. */
export interface ReturnColours { bytes: Uint8Array; version: object }

/** Red, green, blue, opacity of each return of the picture, by what the user has chosen; made once for all views that show the same. */
export function returnColours(state: State, picture: Picture, colour_by: ColourBy = state.settings.get("colour_by")): ReturnColours {
  const key: Key = { picture, theme: currentTheme(), colour_by, track: state.marked.track, segment: state.marked.segment, chosen: state.chosen };
  if (cached !== null && (Object.keys(key) as (keyof Key)[]).every((name) => cached!.key[name] === key[name])) return cached.colours;
  // A picture's array is used again for the next of about its size: 10 of them a second otherwise.
  const room = 4 * (picture.returns?.count ?? 0), last = cached?.colours.bytes;
  const bytes = last !== undefined && last.length >= room && last.length < 4 * room + 4096 ? last : new Uint8Array(room + (room >> 2));
  fillColours(picture, key, bytes);
  cached = { key, colours: { bytes, version: key } };
  return cached.colours;
}

/** The same, into `out`: pure. */
export function fillColours(picture: Picture, { theme, colour_by, track, segment, chosen }: Omit<Key, "picture">, out: Uint8Array): void {
  const { returns } = picture;
  if (returns === null) return;
  const perLabel = new Map<number, Rgb>();
  const ofLabel = (label: number): Rgb => {
    const owner = label > 0 ? picture.track_of_segment.get(label) : undefined;
    if (label > 0 && (label === segment || (owner !== undefined && (owner.id === track || owner.id === chosen)))) return theme.rgb.text;
    if (colour_by === "segment") return label > 0 ? distinctColour(label, theme.isNight, theme.isDark) : theme.rgb.muted;
    if (owner !== undefined) return theme.rgb[trackColour(owner, picture.alert_of_track.get(owner.id))];
    return label > 0 && picture.land_segments.has(label) ? theme.rgb.land : theme.rgb.returns;
  };
  const scale = rampOf(colour_by), ramp: Rgb[] = [];
  if (scale !== undefined) for (let i = 0; i < 256; ++i) ramp.push(rampColour(i / 255, theme.isNight, theme.isDark));
  for (let i = 0; i < returns.count; ++i) {
    const label = returns.label[i]!;
    let colour = perLabel.get(label);
    if (colour === undefined) perLabel.set(label, colour = ofLabel(label));
    if (scale !== undefined && colour !== theme.rgb.text) {
      const share = scale.share(colour_by === "height" ? returns.level_m[3 * i + 2]! : colour_by === "range" ? returns.range_m[i]! : returns.reflectivity[i]!);
      colour = ramp[share <= 0 ? 0 : share >= 1 ? 255 : Math.round(255 * share)]!;
    }
    out[4 * i] = colour[0];
    out[4 * i + 1] = colour[1];
    out[4 * i + 2] = colour[2];
    // What belongs to nothing stands back; the own boat's returns are not part of the picture around it.
    out[4 * i + 3] = label > 0 || label === 0 ? 255 : label === -Segments.REASON_OWN_VESSEL ? 0 : 110;
  }
}
