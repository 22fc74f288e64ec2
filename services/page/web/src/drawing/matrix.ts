// 4 by 4 matrices as WebGL takes them, column by column; frames are right-handed.

export function product(a: Float32Array, b: Float32Array): Float32Array {
  const c = new Float32Array(16);
  for (let column = 0; column < 4; ++column) {
    for (let row = 0; row < 4; ++row) {
      let sum = 0;
      for (let k = 0; k < 4; ++k) sum += a[4 * k + row]! * b[4 * column + k]!;
      c[4 * column + row] = sum;
    }
  }
  return c;
}
export function perspective(height_rad: number, aspect: number, near: number, far: number): Float32Array {
  const f = 1 / Math.tan(height_rad / 2);
  return Float32Array.of(f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0);
}
type Vector = readonly [number, number, number];
const cross = (a: Vector, b: Vector): Vector => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a: Vector): Vector => { const n = Math.hypot(...a); return [a[0] / n, a[1] / n, a[2] / n]; };
const dot = (a: Vector, b: Vector) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** From the frame of eye and target into that of the eye: x right, y up, z back. `up` is not along the line of sight. */
export function lookAt(eye: Vector, target: Vector, up: Vector): Float32Array {
  const back = unit([eye[0] - target[0], eye[1] - target[1], eye[2] - target[2]]);
  const right = unit(cross(up, back)), top = cross(back, right);
  return Float32Array.of(right[0], top[0], back[0], 0, right[1], top[1], back[1], 0, right[2], top[2], back[2], 0, -dot(right, eye), -dot(top, eye), -dot(back, eye), 1);
}
/** A point in clip coordinates divided out: x and y from -1 to 1; null behind the eye. */
export function project(m: Float32Array, x: number, y: number, z: number): [number, number] | null {
  const w = m[3]! * x + m[7]! * y + m[11]! * z + m[15]!;
  if (w <= 1e-6) return null;
  return [(m[0]! * x + m[4]! * y + m[8]! * z + m[12]!) / w, (m[1]! * x + m[5]! * y + m[9]! * z + m[13]!) / w];
}
