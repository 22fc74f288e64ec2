// Sounds of alerts, and a screen that stays on. Both only where the browser and the user allow it.
import type { State } from "../state.js";
import type { Pattern } from "./gravity.js";

// Tones: frequency in Hz, begin and length in s. Warning: three pairs, high. Caution: two, low. They repeat while the look-out says that they sound.
const kTones: Record<Pattern, { repeat_s: number; tones: readonly (readonly [number, number, number])[] }> = {
  warning: { repeat_s: 2, tones: [0, 0.3, 0.6].flatMap((begin) => [[988, begin, 0.11], [1319, begin + 0.12, 0.14]] as const) },
  caution: { repeat_s: 6, tones: [[587, 0, 0.22], [494, 0.28, 0.3]] },
};

export class Sounder {
  private context: AudioContext | null = null;
  private next_ms = 0;
  private pattern: Pattern | null = null;
  private of = 0;

  constructor(private readonly state: State) {
    // A browser plays nothing before its user has touched the page.
    const allow = () => { if (state.settings.get("sound")) this.open(); };
    for (const kind of ["pointerdown", "keydown"]) addEventListener(kind, allow, { passive: true });
    state.on(["settings"], allow);
    setInterval(() => { this.turn(); }, 250);
  }

  /** Whether there would be a sound now. */
  get isAllowed(): boolean { return this.state.settings.get("sound") && this.context?.state === "running"; }

  /** @param of the alert that sounds: another begins anew */
  want(pattern: Pattern | null, of: number): void {
    if (pattern === this.pattern && of === this.of) return;
    this.pattern = pattern;
    this.of = of;
    this.next_ms = 0;
  }

  /** Both patterns once, whatever is set. To be called by a touch. */
  test(): void {
    this.open();
    this.play("caution", 0);
    this.play("warning", 1.2);
  }

  /** One pattern once, as for a connection that was lost. */
  once(pattern: Pattern): void { if (this.isAllowed) this.play(pattern, 0); }

  private open(): void {
    this.context ??= new AudioContext();
    if (this.context.state === "suspended") void this.context.resume();
  }

  private turn(): void {
    if (this.pattern === null || !this.isAllowed || performance.now() < this.next_ms) return;
    this.next_ms = performance.now() + 1000 * kTones[this.pattern].repeat_s;
    this.play(this.pattern, 0);
  }

  private play(pattern: Pattern, after_s: number): void {
    const { context } = this;
    if (context === null) return;
    for (const [frequency, begin_s, length_s] of kTones[pattern].tones) {
      const tone = context.createOscillator(), volume = context.createGain();
      const start = context.currentTime + after_s + begin_s + 0.02;
      tone.type = "triangle";
      tone.frequency.value = frequency;
      volume.gain.setValueAtTime(0, start);
      volume.gain.linearRampToValueAtTime(0.6, start + 0.015);
      volume.gain.setValueAtTime(0.6, start + length_s - 0.03);
      volume.gain.linearRampToValueAtTime(0, start + length_s);
      tone.connect(volume).connect(context.destination);
      tone.start(start);
      tone.stop(start + length_s + 0.05);
      tone.onended = () => { volume.disconnect(); };
    }
  }
}

/** Keeps the screen on while what is seen is live. */
export class WakeLock {
  private lock: WakeLockSentinel | null = null;
  private isAsking = false;
  /** Absent where the page did not come from the boat's computer itself or by https. */
  static readonly isThere = "wakeLock" in navigator;

  constructor(private readonly state: State) {
    state.on(["showing", "connection"], () => { void this.update(); });
    document.addEventListener("visibilitychange", () => { void this.update(); });
  }

  private async update(): Promise<void> {
    if (!WakeLock.isThere || this.isAsking) return;
    const isWanted = this.state.showing.kind === "live" && this.state.hello?.mode === "live" && document.visibilityState === "visible";
    this.isAsking = true;
    try {
      if (isWanted && (this.lock === null || this.lock.released)) this.lock = await navigator.wakeLock.request("screen");
      else if (!isWanted && this.lock !== null) {
        await this.lock.release();
        this.lock = null;
      }
    } catch { /* a battery that is low, a browser that will not: the screen goes off as it does elsewhere */ }
    this.isAsking = false;
  }
}
