// The connection to the server: PROTOCOL.md, seen from the browser. It comes back by itself.

const kProtocol = "lookout.page.v1";
const kHeadBytes = 16;
const kLiveSource = 255;

export interface GuardZone { name: string; range_m: number; from_deg: number; to_deg: number }
/** Where a lidar sits, and how it is turned: config/schema/boat.proto. */
export interface Mounting { x_m: number; y_m: number; z_m: number; roll_deg: number; pitch_deg: number; yaw_deg: number }
/** Facts of a boat out of its config; frames: vessel (x forward, y port, z up). */
export interface BoatFacts {
  name: string;
  hull_length_m: number | null;
  hull_beam_m: number | null;
  reference_point_above_water_m: number;
  lidar: Mounting;
  /** null: the boat has one lidar. */
  lidar_2?: Mounting | null;
  own_vessel: { min_x_m: number; max_x_m: number; min_y_m: number; max_y_m: number };
  guard_zones: GuardZone[];
  cpa_limit_m: number | null;
}
/** A recording that the server holds. */
export interface Source {
  id: number;
  name: string;
  begin_utime_us: number;
  end_utime_us: number;
  num_scans: number;
  is_growing: boolean;
  is_indexed: boolean;
  /** Where a page opens it: the first scan with POSE and TRACKS. */
  opens_utime_us?: number;
  has_pose?: boolean;
  has_tracks?: boolean;
  boat: BoatFacts | null;
}
export interface Hello {
  mode: "live" | "log";
  version: string;
  host: string;
  server_utime_us: number;
  channels: string[];
  /** Names in HEALTH of the processes of a boat. */
  processes: string[];
  sources: Source[];
  may_acknowledge: boolean;
}
/** What an `answer` says of the moment whose frames came before it. */
export interface AnswerHead {
  id: number;
  source: number;
  utime_us: number;
  scan_utime_us: number;
  scan_index: number;
  num_scans: number;
  num_frames: number;
}
export interface StripEvent { utime_us: number; kind: "alert" | "health" | "loss" | "start" | "end" | "gap"; level: number; text: string }
export interface Strip {
  source: number;
  begin_utime_us: number;
  bucket_us: number;
  num_tracks: number[];
  alert_level: number[];
  num_lost: number[];
  health: number[];
  events: StripEvent[];
}
/** A message as it came: of a channel, with the time of its reception by the server, or of its event in the log. */
export interface Frame { channel: string; utime_us: number; bytes: Uint8Array }
export interface Answer { head: AnswerHead; frames: Frame[] }

export interface LinkEvents {
  /** Called on each opening of the connection; the first thing that is known. */
  onHello(hello: Hello): void;
  onSources(sources: Source[]): void;
  onIndexing(source: number, share: number): void;
  onLive(frame: Frame): void;
  /** The connection has ended; it is tried again. */
  onLost(): void;
}

/** Why a request was not answered. */
export class RequestRefused extends Error {}
/** Reason of what was not sent, or not answered any more. */
export const kNoConnection = "no connection";

interface Pending { settle(value: Answer | Strip): void; fail(error: RequestRefused): void; frames: Frame[] }

export class Link {
  private socket: WebSocket | null = null;
  private channels: string[] = [];
  private watched: string[] = [];
  private nextId = 1;
  private numFrames = 0;
  private numConfirmed = 0;
  private wait_ms = 250;
  private readonly pending = new Map<number, Pending>();

  constructor(private readonly events: LinkEvents, private readonly url = `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/socket`) {}

  open(): void {
    const socket = new WebSocket(this.url, kProtocol);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => {
      if (typeof event.data === "string") this.takeText(event.data);
      else this.takeFrame(event.data);
    };
    socket.onclose = () => {
      this.socket = null;
      for (const request of this.pending.values()) request.fail(new RequestRefused(kNoConnection));
      this.pending.clear();
      this.events.onLost();
      setTimeout(() => { this.open(); }, this.wait_ms);
      this.wait_ms = Math.min(2 * this.wait_ms, 3000);
    };
  }

  /** Live messages of these channels from now on, in place of those before; kept over a lost connection. */
  watch(channels: string[]): void {
    this.watched = channels;
    this.send({ op: "watch", channels: channels.filter((name) => this.channels.includes(name)) });
  }

  at(source: number, time: { utime_us: number } | { scan_utime_us: number }, channels: string[]): Promise<Answer> {
    return this.ask({ op: "at", source, ...time, channels }) as Promise<Answer>;
  }
  step(source: number, utime_us: number, scans: number, channels: string[]): Promise<Answer> {
    return this.ask({ op: "step", source, utime_us, scans, channels }) as Promise<Answer>;
  }
  range(source: number, channel: string, from_utime_us: number, to_utime_us: number, max_messages: number): Promise<Answer> {
    return this.ask({ op: "range", source, channel, from_utime_us, to_utime_us, max_messages }) as Promise<Answer>;
  }
  strip(source: number, from_utime_us: number, to_utime_us: number, buckets: number): Promise<Strip> {
    return this.ask({ op: "strip", source, from_utime_us, to_utime_us, buckets }) as Promise<Strip>;
  }

  /** Frames that were handled are confirmed together: the server sends on when it has room. To be called once a picture. */
  confirm(): void {
    if (this.numConfirmed === this.numFrames) return;
    this.send({ op: "got", frames: this.numFrames });  // of this connection by now, in all
    this.numConfirmed = this.numFrames;
  }

  private ask(request: Record<string, unknown>): Promise<Answer | Strip> {
    return new Promise((settle, fail) => {
      if (this.socket?.readyState !== WebSocket.OPEN) { fail(new RequestRefused(kNoConnection)); return; }
      const id = this.nextId++;
      this.pending.set(id, { settle, fail, frames: [] });
      this.send({ ...request, id });
    });
  }

  private send(request: Record<string, unknown>): void {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(request));
  }

  private takeFrame(data: ArrayBuffer): void {
    ++this.numFrames;
    if (data.byteLength < kHeadBytes) return;
    const head = new DataView(data);
    const channel = this.channels[head.getUint16(2, true)];
    if (head.getUint8(0) !== 1 || channel === undefined) return;
    const frame = { channel, utime_us: head.getInt32(12, true) * 4294967296 + head.getUint32(8, true), bytes: new Uint8Array(data, kHeadBytes) };
    if (head.getUint8(1) === kLiveSource) this.events.onLive(frame);
    else {
      this.pending.get(head.getUint32(4, true))?.frames.push(frame);
      if (this.numFrames - this.numConfirmed >= 8) this.confirm();
    }
  }

  private takeText(text: string): void {
    const message = JSON.parse(text) as { type: string; id?: number };
    switch (message.type) {
      case "hello": {
        const hello = message as unknown as Hello;
        this.channels = hello.channels;
        this.numFrames = this.numConfirmed = 0;
        this.wait_ms = 250;
        this.events.onHello(hello);
        this.watch(this.watched);
        break;
      }
      case "sources": this.events.onSources((message as unknown as { sources: Source[] }).sources); break;
      case "indexing": {
        const { source, share } = message as unknown as { source: number; share: number };
        this.events.onIndexing(source, share);
        break;
      }
      case "answer": {
        const request = this.take(message.id);
        request?.settle({ head: message as unknown as AnswerHead, frames: request.frames });
        this.confirm();
        break;
      }
      case "strip": this.take(message.id)?.settle(message as unknown as Strip); break;
      case "refused": this.take(message.id)?.fail(new RequestRefused((message as unknown as { reason: string }).reason)); break;
      default: break;
    }
  }

  private take(id: number | undefined): Pending | undefined {
    const request = this.pending.get(id ?? -1);
    this.pending.delete(id ?? -1);
    return request;
  }
}
