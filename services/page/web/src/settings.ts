// What the user has chosen, kept by the browser.

export interface SettingValues {
  palette: "day" | "dusk" | "night" | "sun";
  length_unit: "m" | "NM";
  speed_unit: "kn" | "mps" | "kmh";
  orientation: "north" | "head";
  colour_by: "segment" | "track" | "height" | "reflectivity" | "range";
  /** Of the range image, which has a look of its own. */
  image_colour_by: SettingValues["colour_by"];
  /** Two logs: share of the returns that are told differently, and how far apart a track is, from which on a scan differs; 0: never. */
  differs_share: number;
  differs_moved_m: number;
  sound: boolean;
  shows_tentative: boolean;
  shows_returns: boolean;
  shows_trails: boolean;
  shows_ellipses: boolean;
  /** Of a wide window: lists or plots beside the picture. */
  shows_side: boolean;
}
export const kDefaults: SettingValues = {
  palette: "day", length_unit: "m", speed_unit: "kn", orientation: "head", colour_by: "track", image_colour_by: "range", differs_share: 0.05, differs_moved_m: 2, sound: false,
  shows_tentative: false, shows_returns: true, shows_trails: true, shows_ellipses: false, shows_side: true,
};
const kColours = ["segment", "track", "height", "reflectivity", "range"] as const;
const kChoices: { [Name in keyof SettingValues]: readonly SettingValues[Name][] } = {
  palette: ["day", "dusk", "night", "sun"], length_unit: ["m", "NM"], speed_unit: ["kn", "mps", "kmh"], orientation: ["north", "head"],
  colour_by: kColours, image_colour_by: kColours, differs_share: [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 0], differs_moved_m: [0.5, 1, 2, 5, 10, 0], sound: [false, true], shows_tentative: [false, true], shows_returns: [false, true],
  shows_trails: [false, true], shows_ellipses: [false, true], shows_side: [false, true],
};
const kKey = "lookout.settings";

export class Settings {
  private values: SettingValues;
  constructor(private readonly onChange: () => void) { this.values = load(); }

  get<Name extends keyof SettingValues>(name: Name): SettingValues[Name] { return this.values[name]; }
  choices<Name extends keyof SettingValues>(name: Name): readonly SettingValues[Name][] { return kChoices[name]; }
  set<Name extends keyof SettingValues>(name: Name, value: SettingValues[Name]): void {
    if (this.values[name] === value) return;
    this.values = { ...this.values, [name]: value };
    try { localStorage.setItem(kKey, JSON.stringify(this.values)); } catch { /* a browser that keeps nothing */ }
    this.onChange();
  }
}

// What is not among the choices of today is left out.
function load(): SettingValues {
  const values: Record<string, unknown> = { ...kDefaults };
  try {
    const kept = JSON.parse(localStorage.getItem(kKey) ?? "{}") as Record<string, unknown>;
    for (const [name, choices] of Object.entries(kChoices)) if ((choices as readonly unknown[]).includes(kept[name])) values[name] = kept[name];
  } catch { /* as above */ }
  return values as unknown as SettingValues;
}
