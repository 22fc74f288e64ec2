// Mouse, finger and pen over a canvas: what they mean, the same in every view.

export interface Gestures {
  /** The plane is moved by so many pixels; `fingers` is 1 or 2, `isSecond` with the right button or Shift. */
  onDrag(dx_px: number, dy_px: number, fingers: number, isSecond: boolean): void;
  /** Larger (above 1) or smaller around a place of the canvas. */
  onZoom(factor: number, x_px: number, y_px: number): void;
  /** A click or a tap that moved nothing. */
  onClick(x_px: number, y_px: number, isTouch: boolean): void;
  /** A mouse or a pen over the canvas; NaN: it has left. */
  onHover(x_px: number, y_px: number): void;
}

const kStill_px = 7;

/** Listens on `canvas` for as long as it lives. */
export function listen(canvas: HTMLElement, gestures: Gestures): void {
  const down = new Map<number, { x: number; y: number }>();
  let travelled = 0;
  let apart = 0;
  const place = (event: MouseEvent) => {
    const box = canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };
  canvas.style.touchAction = "none";
  canvas.addEventListener("pointerdown", (event) => {
    if (down.size === 0) travelled = 0;
    down.set(event.pointerId, place(event));
    if (down.size > 1) travelled = kStill_px + 1;
    apart = 0;
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    const now = place(event), before = down.get(event.pointerId);
    if (before === undefined) {
      if (event.pointerType !== "touch") gestures.onHover(now.x, now.y);
      return;
    }
    down.set(event.pointerId, now);
    const dx = now.x - before.x, dy = now.y - before.y;
    travelled += Math.hypot(dx, dy);
    if (travelled <= kStill_px) return;
    const isSecond = event.shiftKey || (event.buttons & 2) !== 0;
    gestures.onDrag(dx / down.size, dy / down.size, down.size, isSecond);
    if (down.size !== 2) return;
    const [a, b] = [...down.values()] as [{ x: number; y: number }, { x: number; y: number }];
    const distance = Math.max(10, Math.hypot(a.x - b.x, a.y - b.y));
    if (apart > 0) gestures.onZoom(distance / apart, (a.x + b.x) / 2, (a.y + b.y) / 2);
    apart = distance;
  });
  const up = (event: PointerEvent) => {
    const was = down.delete(event.pointerId);
    apart = 0;
    if (was && event.type === "pointerup" && down.size === 0 && travelled <= kStill_px) {
      const { x, y } = place(event);
      gestures.onClick(x, y, event.pointerType === "touch");
    }
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener("pointerleave", () => { gestures.onHover(NaN, NaN); });
  canvas.addEventListener("contextmenu", (event) => { event.preventDefault(); });
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const { x, y } = place(event);
    // A line of a wheel is about 16 pixels of a touch pad.
    const lines = event.deltaMode === 1 ? event.deltaY : event.deltaY / 16;
    gestures.onZoom(Math.exp(-0.04 * Math.max(-10, Math.min(10, lines))), x, y);
  }, { passive: false });
}
