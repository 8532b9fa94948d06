// Light and colours of the picture, by day and by night.

import type { Scene } from '../scenes/scenes.js';
import type { Look } from './engine.js';

const DARK = [0.05, 0.045, 0.042, 0.5];
const DAY: Look = { sky: [0.62, 0.74, 0.92], ground: [0.34, 0.29, 0.24], lines: DARK, wire: [0.06, 0.055, 0.05], sun: 1.55 };
const NIGHT: Look = { sky: [0.2, 0.25, 0.36], ground: [0.1, 0.09, 0.085], lines: DARK, wire: [0.95, 0.62, 0.42], sun: 1.45 };

/** Whether a scene is seen by night: those that shine by themselves are, and all where the page is dark. */
export function isNight(scene: Scene): boolean {
  return scene.night === true || matchMedia('(prefers-color-scheme: dark)').matches;
}

export function lookOf(scene: Scene): Look {
  return isNight(scene) ? NIGHT : DAY;
}
