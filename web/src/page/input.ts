// Turns the camera by mouse, touch and keys.

import type { Camera } from './camera.js';

const STEP = 0.08;

export function steer(canvas: HTMLCanvasElement, camera: Camera, redraw: () => void): void {
  const pointers = new Map<number, { x: number; y: number }>();
  const spread = (): number => {
    const [a, b] = [...pointers.values()];
    return a && b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
  };
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  canvas.addEventListener('pointermove', (event) => {
    const last = pointers.get(event.pointerId);
    if (!last) return;
    const before = spread();
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (pointers.size === 1) {
      const radians = Math.PI / Math.max(canvas.clientHeight, 1);
      camera.turn(-(event.clientX - last.x) * radians, (event.clientY - last.y) * radians);
    } else if (before > 0) {
      camera.zoom(before / Math.max(spread(), 1));
    }
    redraw();
  });
  for (const end of ['pointerup', 'pointercancel'] as const) {
    canvas.addEventListener(end, (event) => pointers.delete(event.pointerId));
  }
  canvas.addEventListener(
    'wheel',
    (event) => {
      event.preventDefault();
      camera.zoom(Math.exp(Math.max(-1, Math.min(1, event.deltaY * 0.0015))));
      redraw();
    },
    { passive: false },
  );
  canvas.addEventListener('keydown', (event) => {
    const keys: Record<string, () => void> = {
      ArrowLeft: () => camera.turn(-STEP, 0),
      ArrowRight: () => camera.turn(STEP, 0),
      ArrowUp: () => camera.turn(0, STEP),
      ArrowDown: () => camera.turn(0, -STEP),
      '+': () => camera.zoom(0.9),
      '=': () => camera.zoom(0.9),
      '-': () => camera.zoom(1 / 0.9),
    };
    const key = keys[event.key];
    if (!key || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    key();
    redraw();
  });
}
