// Each process in words: what state it is in and why, what it costs, and whether it still talks.
import type * as wire from "../messages/generated.js";
import type { State, View } from "../state.js";
import { texts } from "../texts/index.js";
import { bytes, duration } from "../units.js";
import { Facts, make, Pace, placeChildren, setAttribute, setText } from "./dom.js";
import type { ProcessWatch } from "./process_watch.js";
import { Shape } from "./shapes.js";
import { gravityOfProcess, kSilent_s } from "./traffic.js";

const words = texts.panels.health;
const kEvery_ms = 500;

class Card {
  readonly element = make("article", "card");
  private readonly shape = new Shape();
  private readonly name = make("strong");
  private readonly state = make("span", "state");
  private readonly age = make("span", "end");
  private readonly reason = make("p", "reason");
  private readonly facts = new Facts();
  private readonly more = make("details");
  private readonly counters = make("ul", "counters");
  private readonly values = new Map<string, { row: HTMLElement; value: HTMLElement }>();

  constructor() {
    const head = make("header");
    head.append(this.shape.element, this.name, this.state, this.age);
    this.more.append(make("summary", "", words.counters), this.counters);
    this.element.append(head, this.reason, this.facts.element, this.more);
  }

  update(health: wire.Health, age_s: number): void {
    const gravity = gravityOfProcess(health.state, age_s);
    setAttribute(this.element, "data-gravity", gravity);
    this.shape.set(gravity);
    setText(this.name, health.process);
    setText(this.state, age_s > kSilent_s ? words.silent(duration(Math.floor(age_s)).replace(".0", "")) : words.states[health.state] ?? "");
    setText(this.age, age_s > kSilent_s ? "" : words.ago(duration(age_s)));
    this.reason.hidden = health.reason === "";
    setText(this.reason, health.reason);
    const latency_us = Math.max(-1, ...health.channels.filter((channel) => !channel.is_input).map((channel) => channel.latency_p99_us));
    const sum = (pick: (channel: wire.HealthChannel) => number) => health.channels.reduce((total, channel) => total + pick(channel), 0);
    this.facts.set(words.cpu, words.percent(health.cpu_fraction));
    this.facts.set(words.memory, bytes(health.resident_bytes));
    this.facts.set(words.latency, latency_us < 0 ? null : words.milliseconds((latency_us / 1000).toFixed(latency_us < 10_000 ? 1 : 0)));
    this.facts.set(words.lost, String(sum((channel) => (channel.is_input ? channel.num_lost : 0))));
    this.facts.set(words.refused, String(sum((channel) => channel.num_undecodable)));
    this.facts.set(words.uptime, duration(health.uptime_s));
    this.facts.set(words.host, health.host);
    this.more.hidden = health.counters.length === 0;
    if (this.more.open) this.drawCounters(health);
    else this.more.ontoggle = () => { this.drawCounters(health); };
  }

  private drawCounters(health: wire.Health): void {
    placeChildren(this.counters, health.counters.map(({ name, count }) => {
      let found = this.values.get(name);
      if (found === undefined) {
        found = { row: make("li"), value: make("b") };
        found.row.append(make("span", "", name.replaceAll("_", " ")), found.value);
        this.values.set(name, found);
      }
      setText(found.value, String(count));
      return found.row;
    }));
  }
}

export class Processes implements View {
  readonly element = make("div", "processes page");
  private readonly cards = new Map<string, Card>();
  private readonly list = make("div");
  private readonly empty = make("p", "empty", words.none);
  private isVisible = false;
  private readonly pace = new Pace(() => { this.draw(); }, () => kEvery_ms);

  constructor(state: State, private readonly watch: ProcessWatch) {
    this.element.append(this.empty, this.list);
    state.on(["picture", "age"], () => {
      if (this.isVisible) this.pace.ask();
    });
    state.on(["showing"], () => { this.draw(); });
  }

  setVisible(isVisible: boolean): void {
    this.isVisible = isVisible;
    this.draw();
  }

  private draw(): void {
    if (!this.isVisible) return;
    const listed = this.watch.list();
    this.empty.hidden = listed.length > 0;
    const shown = listed.map(({ health, age_s }) => {
      const key = `${health.process}@${health.host}`;
      let card = this.cards.get(key);
      if (card === undefined) {
        card = new Card();
        this.cards.set(key, card);
      }
      card.update(health, age_s);
      return { key, element: card.element };
    });
    const keys = new Set(shown.map(({ key }) => key));
    for (const key of this.cards.keys()) if (!keys.has(key)) this.cards.delete(key);
    placeChildren(this.list, shown.map(({ element }) => element));
  }
}
