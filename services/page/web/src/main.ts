// Entry: connection, state, views, layout.
import { Film } from "./film.js";
import { Layout, type ViewName } from "./layout.js";
import { Link } from "./link.js";
import { Live } from "./live.js";
import { State, type View } from "./state.js";
import { AlertBar } from "./views/alerts.js";
import { AroundView } from "./views/around.js";
import { Banner } from "./views/banner.js";
import { CloudView } from "./views/cloud.js";
import { CompareView } from "./views/compare.js";
import { Lists } from "./views/lists.js";
import { MapView } from "./views/map.js";
import { Plots } from "./views/plots.js";
import { ProcessLine } from "./views/process_line.js";
import { ProcessWatch } from "./views/process_watch.js";
import { RangeImageView } from "./views/range_image.js";
import { Sounder, WakeLock } from "./views/sound.js";
import { Timeline } from "./views/timeline.js";
import { listenToKeys, SettingsSheet } from "./views/settings.js";

// A link with #token=... gives this browser the right to acknowledge; it does not stay in the address.
function takeToken(): string {
  const kKey = "lookout.token";
  const given = /^#token=([\w-]+)$/.exec(location.hash)?.[1];
  try {
    if (given !== undefined) {
      localStorage.setItem(kKey, given);
      history.replaceState(null, "", location.pathname);
    }
    return localStorage.getItem(kKey) ?? "";
  } catch {
    return given ?? "";
  }
}

const state = new State();
state.token = takeToken();
const live = new Live(state);
const film = new Film(state, live);
state.link = new Link({
  onHello: (hello) => {
    state.hello = hello;
    state.sources = hello.sources;
    state.indexing.clear();
    state.connection = { state: "open", since_ms: performance.now() };
    live.begin(hello);
    state.tell("connection");
    film.begin();
    state.tell("sources");
  },
  onSources: (sources) => { state.sources = sources; live.setBoat(); state.tell("sources"); },
  onIndexing: (source, share) => {
    if (share >= 1) state.indexing.delete(source); else state.indexing.set(source, share);
    state.tell("sources");
  },
  onLive: (frame) => {
    if (state.showing.kind === "live") live.take(frame);
    film.take(frame);
  },
  onLost: () => {
    if (state.connection.state !== "lost") state.connection = { state: "lost", since_ms: performance.now() };
    state.tell("connection");
  },
});

const sounder = new Sounder(state);
new WakeLock(state);
const settings = new SettingsSheet(state, sounder);
const alerts = new AlertBar(state, sounder, film);
const processes = new ProcessWatch(state);
const lists = new Lists(state, processes);
const views = new Map<ViewName, View>();
views.set("around", new AroundView(state));
views.set("map", new MapView(state));
views.set("range_image", new RangeImageView(state));
views.set("cloud", new CloudView(state));
views.set("lists", lists);
views.set("plots", new Plots(state));
views.set("compare", new CompareView(state, film));
const unwell = new ProcessLine(state, processes, () => {
  layout.show("lists");
  lists.show("health");
});
const top = [new Banner(state, sounder, settings).element, alerts.element, unwell.element];
const layout = new Layout(state, views, top, [new Timeline(state, film).element, settings.element]);
listenToKeys(state, settings, {
  showView: (index) => {
    const name = [...views.keys()][index];
    if (name !== undefined) layout.show(name);
  },
  focusAlert: () => { alerts.focus(); },
});
state.link.open();
