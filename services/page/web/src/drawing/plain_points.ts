// Points and lines plotted by the processor: where there is no graphics processor, a software WebGL takes many times as long.

/** What WebGL would be given: x, y, z of each, four bytes of colour. Lines: from each even point to the next. */
export interface Drawn { places: Float32Array; colours: Uint8Array; count: number }

export class PlainPoints {
  private readonly context: CanvasRenderingContext2D;
  private image: ImageData | null = null;
  private words = new Uint32Array();
  private depth = new Float32Array();

  constructor(private readonly canvas: HTMLCanvasElement, private readonly hasDepth: boolean) {
    this.context = canvas.getContext("2d", { willReadFrequently: true })!;
  }

  draw(m: Float32Array, points: Drawn, lines: Drawn, size_px: number): void {
    const { width, height } = this.canvas;
    if (width < 1 || height < 1) return;
    if (this.image?.width !== width || this.image.height !== height) {
      this.image = new ImageData(width, height);
      this.words = new Uint32Array(this.image.data.buffer);
      this.depth = new Float32Array(this.hasDepth ? width * height : 0);
    }
    this.words.fill(0);
    this.depth.fill(Infinity);
    plot(m, points, Math.max(1, Math.round(size_px)), this.words, this.depth, width, height);
    this.context.putImageData(this.image, 0, 0);
    if (lines.count > 0) this.strokeLines(m, lines, width, height);
  }

  private strokeLines(m: Float32Array, { places, colours, count }: Drawn, width: number, height: number): void {
    const { context } = this;
    context.lineWidth = 1;
    let before = -1;
    context.beginPath();
    for (let i = 0; i + 1 < count; i += 2) {
      const a = clip(m, places, i), b = clip(m, places, i + 1);
      if (a[3] < kNear && b[3] < kNear) continue;
      // What is behind the eye is cut off.
      if (a[3] < kNear) cut(a, b); else if (b[3] < kNear) cut(b, a);
      const colour = (colours[4 * i]! << 16) | (colours[4 * i + 1]! << 8) | colours[4 * i + 2]!;
      if (colour !== before) {
        context.stroke();
        context.beginPath();
        context.strokeStyle = `#${colour.toString(16).padStart(6, "0")}`;
        context.globalAlpha = colours[4 * i + 3]! / 255;
        before = colour;
      }
      context.moveTo((a[0] / a[3] + 1) / 2 * width, (1 - a[1] / a[3]) / 2 * height);
      context.lineTo((b[0] / b[3] + 1) / 2 * width, (1 - b[1] / b[3]) / 2 * height);
    }
    context.stroke();
    context.globalAlpha = 1;
  }
}

const kNear = 0.1;
type Clipped = [number, number, number, number];
function clip(m: Float32Array, places: Float32Array, i: number): Clipped {
  const x = places[3 * i]!, y = places[3 * i + 1]!, z = places[3 * i + 2]!;
  return [m[0]! * x + m[4]! * y + m[8]! * z + m[12]!, m[1]! * x + m[5]! * y + m[9]! * z + m[13]!, 0, m[3]! * x + m[7]! * y + m[11]! * z + m[15]!];
}
function cut(behind: Clipped, before: Clipped): void {
  const share = (kNear - behind[3]) / (before[3] - behind[3]);
  for (let k = 0; k < 4; ++k) behind[k]! += share * (before[k]! - behind[k]!);
}

/** Squares of `size` pixels around each point, the nearest to the eye in front where `depth` has room; pixels in order of rows, 0xAABBGGRR. */
export function plot(m: Float32Array, { places, colours, count }: Drawn, size: number, words: Uint32Array, depth: Float32Array, width: number, height: number): void {
  const hasDepth = depth.length > 0, half = (size - 1) / 2;
  for (let i = 0; i < count; ++i) {
    const alpha = colours[4 * i + 3]!;
    if (alpha === 0) continue;
    const x = places[3 * i]!, y = places[3 * i + 1]!, z = places[3 * i + 2]!;
    const w = m[3]! * x + m[7]! * y + m[11]! * z + m[15]!;
    if (!(w > 1e-6)) continue;
    const left = Math.floor(((m[0]! * x + m[4]! * y + m[8]! * z + m[12]!) / w + 1) / 2 * width - half);
    const top = Math.floor((1 - (m[1]! * x + m[5]! * y + m[9]! * z + m[13]!) / w) / 2 * height - half);
    if (!(left > -size && top > -size && left < width && top < height)) continue;
    const word = (alpha << 24) | (colours[4 * i + 2]! << 16) | (colours[4 * i + 1]! << 8) | colours[4 * i]!;
    for (let row = Math.max(0, top); row < Math.min(height, top + size); ++row) {
      for (let at = row * width + Math.max(0, left), end = row * width + Math.min(width, left + size); at < end; ++at) {
        if (hasDepth) {
          if (depth[at]! <= w) continue;
          depth[at] = w;
        }
        words[at] = word;
      }
    }
  }
}
