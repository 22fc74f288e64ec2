// All that is known of the chosen track.
import type * as wire from "../messages/generated.js";
import type { State } from "../state.js";
import { texts } from "../texts/index.js";
import { duration, length } from "../units.js";
import { button, Facts, make, setAttribute, setText } from "./dom.js";
import { gravityOf } from "./gravity.js";
import { NameForm } from "./name_form.js";
import { nameOf, shipName, situation, textsOf } from "./track_words.js";

const words = texts.panels.tracks;

export class TrackDetail {
  readonly element = make("section", "card detail");
  private readonly name = make("span", "state");
  private readonly situation = make("span");
  private readonly alert = make("p", "reason");
  private readonly facts = new Facts();
  private readonly naming: NameForm;

  constructor(private readonly state: State) {
    const head = make("header");
    head.append(this.name, this.situation, button(words.close, () => { state.choose(null); }, "plain end"));
    this.naming = new NameForm(state);
    this.element.append(head, this.alert, this.facts.element, this.naming.element);
    this.element.hidden = true;
  }

  draw(): void {
    const { picture, chosen } = this.state;
    this.element.hidden = chosen === null;
    if (chosen === null || picture === null) return;
    const track = picture.track_by_id.get(chosen);
    this.facts.element.hidden = track === undefined;
    if (track === undefined) this.naming.element.hidden = true;
    const alert = picture.alert_of_track.get(chosen);
    setAttribute(this.element, "data-gravity", alert === undefined ? null : gravityOf(alert));
    this.alert.hidden = alert === undefined;
    setText(this.alert, alert?.text ?? "");
    if (track === undefined) {
      setText(this.situation, words.gone);
      return;
    }
    setText(this.name, nameOf(track, picture));
    this.naming.draw(track.id);
    setText(this.situation, situation(track));
    this.drawFacts(track);
  }

  private drawFacts(track: wire.Track): void {
    const { settings } = this.state, picture = this.state.picture!;
    const { facts } = this, names = words.facts, columns = words.columns;
    const values = textsOf(track, picture, settings);
    facts.set(columns.bearing, `${values.bearing}, ${values.relative}`);
    facts.set(columns.range, values.range);
    facts.set(columns.course, values.course);
    facts.set(columns.speed, values.speed);
    facts.set(columns.cpa, values.cpa);
    facts.set(columns.tcpa, values.tcpa);
    facts.set(names.close, words.percent(track.cpa_probability || 0));
    facts.set(names.distance, length(settings, track.distance_m));
    facts.set(columns.rests, values.rests, true);
    facts.set(names.exists, words.percent(track.existence_probability));
    facts.set(names.moves, words.percent(track.moving_probability));
    facts.set(names.size, `${track.length_m.toFixed(1)} × ${track.width_m.toFixed(1)} m`);
    facts.set(names.top, Number.isFinite(track.top_above_water_m) ? `${track.top_above_water_m.toFixed(1)} m` : null);
    facts.set(names.seenShare, words.percent(track.seen_share));
    facts.set(names.deviation, length(settings, Math.sqrt(Math.max(track.covariance[0]?.[0] ?? NaN, track.covariance[1]?.[1] ?? NaN))));
    facts.set(names.drift, Number.isFinite(track.bearing_drift_radps) ? words.perSecond((track.bearing_drift_radps * 180 / Math.PI).toFixed(1)) : null);
    facts.set(names.first, texts.panels.health.ago(duration(Math.max(0, (picture.end_utime_us - track.first_utime_us) / 1e6))));
    facts.set(names.seen, texts.panels.health.ago(duration(Math.max(0, (picture.end_utime_us - track.seen_utime_us) / 1e6))));
    const ship = picture.ship_of_track.get(track.id);
    facts.set(texts.drawing.ais, ship === undefined ? null : `${shipName(ship)}, ${texts.drawing.mmsi(ship.mmsi)}${ship.call_sign === "" ? "" : `, ${ship.call_sign}`}`, true);
    facts.set(names.place, place(track.latitude_deg, track.longitude_deg), true);
  }
}

/** Degrees and decimal minutes, as they stand on a chart. */
export function place(latitude_deg: number, longitude_deg: number): string {
  if (!Number.isFinite(latitude_deg) || !Number.isFinite(longitude_deg)) return "–";
  const one = (value: number, width: number, letters: [string, string]) => {
    const thousandths = Math.round(Math.abs(value) * 60000);
    const degrees = Math.floor(thousandths / 60000);
    return `${String(degrees).padStart(width, "0")}°${((thousandths - degrees * 60000) / 1000).toFixed(3).padStart(6, "0")}′${value < 0 ? letters[1] : letters[0]}`;
  };
  return `${one(latitude_deg, 2, ["N", "S"])} ${one(longitude_deg, 3, ["E", "W"])}`;
}
