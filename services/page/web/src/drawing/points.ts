// Returns and lines drawn by WebGL2: one call for all returns, one for all lines. What was lost with the context is made again.

const kVertex = `#version 300 es
uniform mat4 matrix;
uniform float size;
in vec3 place;
in vec4 colour;
out vec4 shade;
void main() {
  gl_Position = matrix * vec4(place, 1.0);
  gl_PointSize = size;
  shade = vec4(colour.rgb * colour.a, colour.a);
}`;
const kFragment = `#version 300 es
precision mediump float;
in vec4 shade;
out vec4 pixel;
void main() {
  if (shade.a == 0.0) discard;
  pixel = shade;
}`;

class Buffers {
  readonly array: WebGLVertexArrayObject;
  private readonly places: WebGLBuffer;
  private readonly colours: WebGLBuffer;
  count = 0;

  constructor(private readonly gl: WebGL2RenderingContext, program: WebGLProgram) {
    this.array = gl.createVertexArray();
    this.places = gl.createBuffer();
    this.colours = gl.createBuffer();
    gl.bindVertexArray(this.array);
    const attribute = (name: string, buffer: WebGLBuffer, size: number, type: number, normalised: boolean) => {
      const location = gl.getAttribLocation(program, name);
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.enableVertexAttribArray(location);
      gl.vertexAttribPointer(location, size, type, normalised, 0, 0);
    };
    attribute("place", this.places, 3, gl.FLOAT, false);
    attribute("colour", this.colours, 4, gl.UNSIGNED_BYTE, true);
    gl.bindVertexArray(null);
  }
  setPlaces(places: Float32Array, count: number): void {
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, this.places);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, places, this.gl.STREAM_DRAW, 0, 3 * count);
    this.count = count;
  }
  setColours(colours: Uint8Array, count: number): void {
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, this.colours);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, colours, this.gl.STREAM_DRAW, 0, 4 * count);
  }
}

/** A canvas of points and lines. Where the browser has no WebGL2, `works` is false and it draws nothing. */
export class Points {
  readonly canvas = document.createElement("canvas");
  /** To draw all again: the context came back. */
  onRestored: () => void = () => undefined;
  private readonly gl: WebGL2RenderingContext | null;
  private parts: { program: WebGLProgram; matrix: WebGLUniformLocation | null; size: WebGLUniformLocation | null; points: Buffers; lines: Buffers } | null = null;
  private shown: { places: Float32Array | null; colours: unknown } = { places: null, colours: null };

  constructor(private readonly hasDepth: boolean) {
    this.canvas.setAttribute("aria-hidden", "true");
    this.gl = this.canvas.getContext("webgl2", { antialias: false, depth: hasDepth, alpha: true, powerPreference: "low-power" });
    this.prepare();
    this.canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      this.parts = null;
    });
    this.canvas.addEventListener("webglcontextrestored", () => {
      this.prepare();
      this.onRestored();
    });
  }
  /** False where there is no WebGL2, or its context is lost. */
  get works(): boolean { return this.parts !== null; }

  private prepare(): void {
    const gl = this.gl;
    this.shown = { places: null, colours: null };
    this.parts = null;
    if (gl === null || gl.isContextLost()) return;
    const program = gl.createProgram();
    for (const [type, source] of [[gl.VERTEX_SHADER, kVertex], [gl.FRAGMENT_SHADER, kFragment]] as const) {
      const shader = gl.createShader(type);
      if (shader === null) return;
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) return;
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    if (this.hasDepth) gl.enable(gl.DEPTH_TEST);
    this.parts = {
      program, matrix: gl.getUniformLocation(program, "matrix"), size: gl.getUniformLocation(program, "size"), points: new Buffers(gl, program), lines: new Buffers(gl, program),
    };
  }

  /** Points of the next `draw`: x, y, z of each, and four bytes of colour. An array that is the same as before is not sent again; `version` says whether colours are. */
  setPoints(places: Float32Array, colours: Uint8Array, count: number, version: unknown): void {
    const buffers = this.parts?.points;
    if (buffers === undefined || this.gl === null) return;
    if (this.shown.places !== places) buffers.setPlaces(places, count);
    if (this.shown.places !== places || this.shown.colours !== version) buffers.setColours(colours, count);
    this.shown = { places, colours: version };
    buffers.count = count;
  }
  clearPoints(): void {
    if (this.parts !== null) this.parts.points.count = 0;
    this.shown = { places: null, colours: null };
  }
  /** Lines from each even point to the next. */
  setLines(places: Float32Array, colours: Uint8Array, count: number): void {
    this.parts?.lines.setPlaces(places, count);
    this.parts?.lines.setColours(colours, count);
  }
  draw(matrix: Float32Array, size_px: number): void {
    const gl = this.gl;
    if (this.parts === null || gl === null) return;
    const { program, points, lines } = this.parts;
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | (this.hasDepth ? gl.DEPTH_BUFFER_BIT : 0));
    gl.useProgram(program);
    gl.uniformMatrix4fv(this.parts.matrix, false, matrix);
    gl.uniform1f(this.parts.size, size_px);
    for (const [buffers, mode] of [[lines, gl.LINES], [points, gl.POINTS]] as const) {
      if (buffers.count === 0) continue;
      gl.bindVertexArray(buffers.array);
      gl.drawArrays(mode, 0, buffers.count);
    }
    gl.bindVertexArray(null);
  }
}
