// The list of tracks, the most dangerous first: a table where there is room, cards on a phone; below it the chosen one in full.
import { whyNothing } from "../film.js";
import * as wire from "../messages/generated.js";
import { lacking } from "../picture.js";
import type { State, View } from "../state.js";
import { texts } from "../texts/index.js";
import { button, make, Pace, placeChildren, setAttribute, setText } from "./dom.js";
import { byDanger, gravityOf, keepOrder } from "./gravity.js";
import { Shape } from "./shapes.js";
import { TrackDetail } from "./track_detail.js";
import { nameOf, situation, textsOf } from "./track_words.js";

const words = texts.panels.tracks;
const kColumns = ["bearing", "range", "course", "speed", "cpa", "tcpa", "rests"] as const;
const kCapped = 40;             // rows that are shown before somebody asks for all
const kEvery_ms = 400;          // numbers that change faster are not read
const kEveryOfAll_ms = 1000;    // where all of many are shown
const kStatuses = ["", "tentative", "confirmed", "coasting", "lost"];

class Row {
  readonly element = make("tr");
  private readonly shape = new Shape();
  private readonly name = make("span", "name");
  private readonly situation = make("small");
  private readonly relative = make("small");
  private readonly cells = new Map<string, HTMLElement>();

  constructor(state: State, readonly id: number) {
    const who = make("td", "who");
    who.append(this.shape.element, this.name, this.situation);
    this.element.append(who);
    for (const column of kColumns) {
      const cell = make("td", column);
      cell.dataset["label"] = words.columns[column];
      const value = make("span");
      cell.append(value);
      if (column === "bearing") cell.append(this.relative);
      this.cells.set(column, value);
      this.element.append(cell);
    }
    this.element.tabIndex = -1;
    this.element.onclick = () => { state.choose(state.chosen === id ? null : id); };
    this.element.onpointerenter = () => { state.mark({ track: id }); };
    this.element.onfocus = () => { state.mark({ track: id }); };
  }

  update(track: wire.Track, state: State): void {
    const { picture } = state;
    if (picture === null) return;
    const alert = picture.alert_of_track.get(track.id);
    const gravity = alert === undefined || alert.state === wire.Alert.STATE_CLEARED ? null : gravityOf(alert);
    setAttribute(this.element, "data-gravity", gravity);
    setAttribute(this.element, "data-status", kStatuses[track.status] ?? "");
    this.shape.element.style.display = gravity === null ? "none" : "";
    if (gravity !== null) this.shape.set(gravity);
    setText(this.name, nameOf(track, picture));
    setText(this.situation, situation(track));
    const values = textsOf(track, picture, state.settings);
    for (const [column, cell] of this.cells) setText(cell, values[column as keyof typeof values]);
    setText(this.relative, values.relative);
  }
}

export class Tracks implements View {
  readonly element = make("div", "tracks page");
  private readonly body = make("tbody");
  private readonly rows = new Map<number, Row>();
  private readonly empty = make("p", "empty");
  private readonly all: HTMLButtonElement;
  private readonly detail: TrackDetail;
  private order: number[] = [];
  private isVisible = false;
  private isPointedAt = false;
  private showsAll = false;
  private readonly pace = new Pace(() => { this.draw(); }, () => (this.rows.size > kCapped ? kEveryOfAll_ms : kEvery_ms));

  constructor(private readonly state: State) {
    const table = make("table", "plain-table track-table"), head = make("thead"), names = make("tr");
    for (const column of ["who", ...kColumns] as const) {
      const cell = make("th", column, words.columns[column]);
      cell.scope = "col";
      names.append(cell);
    }
    head.append(names);
    table.append(head, this.body);
    table.setAttribute("aria-label", texts.panels.lists.tracks);
    this.all = button("", () => { this.showsAll = true; this.draw(); }, "show-all");
    this.detail = new TrackDetail(state);
    const list = make("div", "track-list");
    list.append(table, this.empty, this.all);
    this.element.append(list, this.detail.element);
    table.onpointerenter = () => { this.isPointedAt = true; };
    table.onpointerleave = () => { this.isPointedAt = false; state.mark({}); };
    table.onkeydown = (event) => { this.onKey(event); };
    state.on(["picture"], () => { if (this.isVisible) this.pace.ask(); });
    state.on(["settings", "showing", "connection", "sources"], () => { this.draw(); });
    state.on(["marked"], () => { this.drawMarks(); });
  }

  setVisible(isVisible: boolean): void {
    this.isVisible = isVisible;
    this.isPointedAt = false;
    this.draw();
  }

  private draw(): void {
    if (!this.isVisible) return;
    const { picture, settings } = this.state;
    let tracks = byDanger(picture?.tracks ?? [], picture?.alert_of_track ?? new Map<number, wire.Alert>(), settings.get("shows_tentative"));
    // Rows keep their places while somebody points at them: nobody chooses a wrong one.
    if (this.isPointedAt || this.body.contains(document.activeElement)) tracks = keepOrder(this.order, tracks);
    this.order = tracks.map((track) => track.id);
    const shown = this.showsAll ? tracks : tracks.slice(0, kCapped);
    const ids = new Set(shown.map((track) => track.id));
    for (const id of this.rows.keys()) if (!ids.has(id)) this.rows.delete(id);
    placeChildren(this.body, shown.map((track) => {
      let row = this.rows.get(track.id);
      if (row === undefined) {
        row = new Row(this.state, track.id);
        this.rows.set(track.id, row);
      }
      row.update(track, this.state);
      return row.element;
    }));
    this.all.hidden = shown.length === tracks.length;
    setText(this.all, words.showAll(tracks.length));
    this.empty.hidden = tracks.length > 0;
    setText(this.empty, this.whyNone());
    this.drawMarks();
  }

  // Without a position there are no tracks, and of a log nobody asks whether the tracker runs.
  private whyNone(): string {
    const { picture, showing, hello, sources } = this.state;
    const isRecorded = showing.kind === "recorded" || hello?.mode === "log";
    const hasTracks = picture?.times_us.has("TRACKS") === true, lacks = lacking(picture?.pose ?? null);
    if (hasTracks) return lacks === null ? words.none : words.lacks[lacks];
    if (picture === null && (isRecorded || hello === null)) return whyNothing(this.state);
    if (!isRecorded) return words.notYet;
    const source = sources.find((candidate) => showing.kind === "recorded" && candidate.id === showing.source);
    if (source?.has_tracks === false) return source.has_pose === false ? words.logWithoutPosition : words.logWithoutTracks;
    return lacks === null ? words.noneAtThisTime : words.lacks[lacks];
  }

  private drawMarks(): void {
    if (!this.isVisible) return;
    const { chosen, marked } = this.state;
    let first = true;
    const hasChosen = chosen !== null && this.rows.has(chosen);
    for (const id of this.order) {
      const row = this.rows.get(id);
      if (row === undefined) continue;
      setAttribute(row.element, "aria-selected", String(id === chosen));
      setAttribute(row.element, "data-marked", id === marked.track ? "" : null);
      // One row is reached by the tab key, the others by arrows.
      row.element.tabIndex = (hasChosen ? id === chosen : first) ? 0 : -1;
      first = false;
    }
    this.detail.draw();
  }

  private onKey(event: KeyboardEvent): void {
    const row = (event.target as HTMLElement).closest("tr");
    if (row === null) return;
    const rows = [...this.body.children] as HTMLElement[];
    const at = rows.indexOf(row);
    switch (event.key) {
      case "ArrowDown": rows[Math.min(rows.length - 1, at + 1)]?.focus(); break;
      case "ArrowUp": rows[Math.max(0, at - 1)]?.focus(); break;
      case "Home": rows[0]?.focus(); break;
      case "End": rows.at(-1)?.focus(); break;
      case "Enter": case " ": row.click(); break;
      default: return;
    }
    event.preventDefault();
  }
}
