// A camera on a sphere around a place, and what the stage and the draws need of it.

import type { View } from '../stage/layout.js';
import type { Scene } from '../scenes/scenes.js';

type Vec3 = readonly [number, number, number];

/** Of the picture's shorter side, radians. */
const FIELD = Math.PI / 4;
const STEEPEST = 1.5;

const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a: Vec3, b: Vec3): Vec3 => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

export class Camera {
  yaw = 0;
  pitch = 0;
  distance = 1;
  private scene!: Scene['camera'];

  constructor(scene: Scene) {
    this.show(scene);
  }

  show(scene: Scene): void {
    this.scene = scene.camera;
    ({ yaw: this.yaw, pitch: this.pitch, distance: this.distance } = scene.camera);
  }

  /** Turns by so many radians. */
  turn(yaw: number, pitch: number): void {
    this.yaw = (this.yaw + yaw) % (2 * Math.PI);
    this.pitch = Math.min(Math.max(this.pitch + pitch, -STEEPEST), STEEPEST);
  }

  /** Comes closer by a factor below 1, or goes away. */
  zoom(factor: number): void {
    const { nearest, farthest } = this.scene;
    this.distance = Math.min(Math.max(this.distance * factor, nearest), farthest);
  }

  /** From the stage's space to clip space, column by column; and the view as control functions see it. */
  look(width: number, height: number, pixelsPerEdge: number): { clip: Float32Array; view: View } {
    const { centre } = this.scene;
    const [cosine, sine] = [Math.cos(this.pitch), Math.sin(this.pitch)];
    const back: Vec3 = [Math.sin(this.yaw) * cosine, sine, Math.cos(this.yaw) * cosine];
    const right: Vec3 = [Math.cos(this.yaw), 0, -Math.sin(this.yaw)];
    const up = cross(back, right);
    const eye: Vec3 = [0, 1, 2].map((k) => centre[k]! + back[k]! * this.distance) as unknown as Vec3;
    const focal = Math.min(1, width / height) / Math.tan(FIELD / 2);
    const near = this.distance * 0.01;
    // Rows of the product of projection (infinite, depth reversed) and view.
    const row = (axis: Vec3, scale: number): number[] => [...axis.map((x) => x * scale), -dot(axis, eye) * scale];
    const rows = [row(right, (focal * height) / width), row(up, focal), [0, 0, 0, near], row(back, -1)];
    const clip = new Float32Array(16);
    rows.forEach((numbers, r) => numbers.forEach((number, c) => (clip[4 * c + r] = number)));
    const plane = (sign: number, r: number): number[] => {
      const sum = rows[3]!.map((number, k) => number + sign * rows[r]![k]!);
      const length = Math.hypot(sum[0]!, sum[1]!, sum[2]!);
      return sum.map((number) => number / length);
    };
    const planes = [plane(1, 0), plane(-1, 0), plane(1, 1), plane(-1, 1), plane(-1, 2), [0, 0, 0, 1]];
    const view: View = { planes, eye, anchor: [0, 0, 0], pixelsPerRadian: (focal * height) / 2, pixelsPerEdge };
    return { clip, view };
  }
}
