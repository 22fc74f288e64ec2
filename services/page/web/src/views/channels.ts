// Each channel: how fast, how late, what is lost on it, refused, waiting.
import type { State, View } from "../state.js";
import { texts } from "../texts/index.js";
import { make, Pace, placeChildren, setAttribute, setText } from "./dom.js";
import { type ChannelRow, channelsOf } from "./traffic.js";

const words = texts.panels.channels;
const kColumns = ["rate", "lost", "refused", "p50", "p99", "queue"] as const;
const kLess: readonly string[] = ["refused", "p50", "queue"];  // what a narrow pane has no columns for
const kEvery_ms = 500;
const kLosing_ms = 5000;  // how long a loss is marked

const latency = (latency_us: number) => (latency_us < 0 ? "–" : texts.panels.health.milliseconds((latency_us / 1000).toFixed(latency_us < 10_000 ? 1 : 0)));

// Beside its name a channel says what is not as it should be, and its latency.
function isTold(column: (typeof kColumns)[number], row: ChannelRow): boolean {
  return column === "refused" ? row.num_refused > 0 : column === "queue" ? row.queue_depth > 0 : row.latency_p50_us >= 0;
}

class Row {
  readonly element = make("tr");
  private readonly name = make("span");
  private readonly from = make("small");
  private readonly lesser = make("small", "lesser");  // what a narrow pane has no columns for
  private readonly cells = kColumns.map((column) => make("td", kLess.includes(column) ? "less" : ""));
  private num_lost = -1;
  private lost_ms = -Infinity;

  constructor() {
    const cell = make("td");
    cell.append(this.name, this.from, this.lesser);
    this.element.append(cell, ...this.cells);
  }

  update(row: ChannelRow, now_ms: number): void {
    if (this.num_lost >= 0 && row.num_lost > this.num_lost) this.lost_ms = now_ms;
    this.num_lost = row.num_lost;
    const isLosing = now_ms - this.lost_ms < kLosing_ms;
    setText(this.name, row.channel);
    setText(this.from, row.publishers.join(", "));
    setAttribute(this.name, "title", row.readers.length === 0 ? null : words.readers(row.readers.join(", ")));
    const values = [
      words.hertz(row.rate_hz.toFixed(row.rate_hz < 99.95 ? 1 : 0)), isLosing ? words.losing(String(row.num_lost)) : String(row.num_lost),
      String(row.num_refused), latency(row.latency_p50_us), latency(row.latency_p99_us),
      row.queue_depth < 0 ? "–" : words.queue(row.queue_depth, row.queue_limit),
    ];
    setText(this.lesser, kColumns.flatMap((column, index) => (kLess.includes(column) && isTold(column, row) ? [`${words.columns[column]} ${values[index]!}`] : [])).join(" · "));
    values.forEach((value, index) => { setText(this.cells[index]!, value); });
    this.cells[1]!.classList.toggle("losing", isLosing);
    this.cells[2]!.classList.toggle("losing", row.num_refused > 0);
  }
}

export class Channels implements View {
  readonly element = make("div", "channels page");
  private readonly body = make("tbody");
  private readonly empty = make("p", "empty", texts.panels.health.none);
  private readonly rows = new Map<string, Row>();
  private isVisible = false;
  private readonly pace = new Pace(() => { this.draw(); }, () => kEvery_ms);

  constructor(private readonly state: State) {
    const table = make("table", "plain-table"), head = make("thead"), names = make("tr");
    for (const column of ["channel", ...kColumns] as const) {
      const cell = make("th", kLess.includes(column) ? "less" : "", words.columns[column]);
      cell.scope = "col";
      names.append(cell);
    }
    head.append(names);
    table.append(head, this.body);
    table.setAttribute("aria-label", texts.panels.lists.channels);
    this.element.append(table, this.empty);
    state.on(["picture"], () => { if (this.isVisible) this.pace.ask(); });
  }

  setVisible(isVisible: boolean): void {
    this.isVisible = isVisible;
    this.draw();
  }

  private draw(): void {
    if (!this.isVisible) return;
    const now_ms = performance.now();
    const channels = channelsOf(this.state.picture?.health ?? []);
    this.empty.hidden = channels.length > 0;
    placeChildren(this.body, channels.map((channel) => {
      let row = this.rows.get(channel.channel);
      if (row === undefined) {
        row = new Row();
        this.rows.set(channel.channel, row);
      }
      row.update(channel, now_ms);
      return row.element;
    }));
  }
}
