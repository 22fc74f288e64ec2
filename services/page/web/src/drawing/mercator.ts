// The earth as raster tiles have it (web mercator): x from 0 at 180 degrees west to 1, y from 0 in the north to 1. Nothing here knows the DOM.

const kMost_deg = 85.05;
const kCircumference_m = 40_075_016.686;

export function mercatorX(longitude_deg: number): number { return (longitude_deg + 180) / 360; }
export function mercatorY(latitude_deg: number): number {
  const latitude = Math.min(kMost_deg, Math.max(-kMost_deg, latitude_deg)) * Math.PI / 180;
  return 0.5 - Math.log(Math.tan(Math.PI / 4 + latitude / 2)) / (2 * Math.PI);
}
export function longitudeOf(x: number): number { return x * 360 - 180; }
export function latitudeOf(y: number): number { return (2 * Math.atan(Math.exp((0.5 - y) * 2 * Math.PI)) - Math.PI / 2) * 180 / Math.PI; }
/** How many metres the whole width is worth at a latitude. */
export function widthAt(latitude_deg: number): number { return kCircumference_m * Math.cos(latitude_deg * Math.PI / 180); }

/** Zoom level whose tiles of 256 pixels are not blurred when the whole earth has `world_px` pixels. */
export function zoomFor(world_px: number, least: number, most: number): number {
  return Math.min(most, Math.max(least, Math.round(Math.log2(world_px / 256))));
}

// Along a parallel of WGS84.
function metresPerDegreeEast(latitude_rad: number): number { return 111_412.9 * Math.cos(latitude_rad) - 93.5 * Math.cos(3 * latitude_rad); }

/** East and north of one place from another on WGS84, m: good to a thousandth within 100 km. Degrees. */
export function offset(from_latitude: number, from_longitude: number, to_latitude: number, to_longitude: number): [number, number] {
  const middle_rad = (from_latitude + to_latitude) / 2 * Math.PI / 180;
  const dlon = ((to_longitude - from_longitude + 540) % 360 + 360) % 360 - 180;
  return [dlon * metresPerDegreeEast(middle_rad), (to_latitude - from_latitude) * (111_132.9 - 559.8 * Math.cos(2 * middle_rad))];
}

/** Degrees and minutes as charts have them: 54° 19.123' N. */
export function position(degrees: number, isLatitude: boolean, decimals = 3): string {
  if (!Number.isFinite(degrees)) return "–";
  const factor = 10 ** decimals, minutes = Math.round(Math.abs(degrees) * 60 * factor) / factor;
  const whole = Math.floor(minutes / 60), rest = (minutes - 60 * whole).toFixed(decimals).padStart(decimals > 0 ? 3 + decimals : 2, "0");
  return `${String(whole).padStart(isLatitude ? 2 : 3, "0")}° ${rest}' ${isLatitude ? (degrees < 0 ? "S" : "N") : degrees < 0 ? "W" : "E"}`;
}

/** Step of a grid in minutes of arc, not less than `least`: 1, 2, 5, 10, 20, 30 of a minute or a degree, or a decimal part of a minute. */
export function gridStep(least_minutes: number): number {
  for (const step of [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600]) if (step >= least_minutes) return step;
  return 1800;
}
