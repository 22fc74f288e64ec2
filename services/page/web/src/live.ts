// The live loop: messages become a picture, at most once a frame of the screen.
import type { Frame, Hello } from "./link.js";
import { Assembler, kPictureChannels } from "./picture.js";
import type { State } from "./state.js";

export class Live {
  private assembler = new Assembler();
  private isNew = false;
  private last_ms = -Infinity;  // performance.now() when a scan came last, or where none ever came TRACKS or OBSTACLES
  private hasScan = false;
  private latency_s = 0;        // of the newest scan, from its end to its reception by the server

  constructor(private readonly state: State) {
    const draw = () => {
      this.turn();
      requestAnimationFrame(draw);
    };
    requestAnimationFrame(draw);
    setInterval(() => { this.tellAge(); }, 250);
  }

  begin(hello: Hello): void {
    // What was before the connection was lost is not mixed with what comes after it.
    this.assembler = new Assembler();
    this.hasScan = false;
    this.assembler.boat = hello.sources[0]?.boat ?? null;
    if (this.state.showing.kind === "live" && hello.mode === "live") this.state.link?.watch(kPictureChannels);
  }
  setBoat(): void { this.assembler.boat = this.state.sources[0]?.boat ?? null; }

  take(frame: Frame): void {
    const { channel } = frame;
    const isDrawn = this.assembler.take(frame);
    // HEALTH is shown also while no scan comes: then one wants to know why. Else it waits for the next scan.
    if (isDrawn || (channel === "HEALTH" && performance.now() - this.last_ms > 1000)) this.isNew = true;
    // ALERTS come by the host's clock when the lidar is silent: they make no picture young.
    if (isDrawn && channel === "LIDAR_SCAN") this.hasScan = true;
    if (isDrawn && (this.hasScan ? channel === "LIDAR_SCAN" : channel === "TRACKS" || channel === "OBSTACLES")) this.last_ms = performance.now();
  }

  private turn(): void {
    if (this.isNew && this.state.showing.kind === "live") {
      this.isNew = false;
      this.state.picture = this.assembler.picture();
      const { picture } = this.state;
      const received_us = picture.times_us.get("TRACKS") ?? picture.times_us.get("LIDAR_SCAN");
      // A clock of the sensor's own may be off by more: then the age is since reception.
      const late_s = received_us === undefined ? 0 : (received_us - picture.end_utime_us) / 1e6;
      this.latency_s = late_s > 0 && late_s < 10 ? late_s : 0;
      this.state.age_s = this.latency_s + (performance.now() - this.last_ms) / 1000;
      this.state.tell("picture");
    }
    this.state.link?.confirm();
  }

  private tellAge(): void {
    if (this.state.showing.kind !== "live") return;
    const age_s = this.state.picture === null ? 0 : this.latency_s + (performance.now() - this.last_ms) / 1000;
    this.state.age_s = age_s;
    this.state.tell("age");
  }
}
