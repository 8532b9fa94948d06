// The panel beside the picture.

import type { Scene } from '../scenes/scenes.js';
import type { Counted, Settings } from './engine.js';

export function one<T extends HTMLElement = HTMLElement>(selector: string): T {
  const found = document.querySelector<T>(selector);
  if (!found) throw new Error(`the page has no ${selector}`);
  return found;
}

const whole = new Intl.NumberFormat('en', { maximumFractionDigits: 0 });

function bytes(count: number): string {
  return count < 1e6 ? `${(count / 1e3).toFixed(0)} kB` : `${(count / 1e6).toFixed(1)} MB`;
}

/** Settings for which shaders are compiled. */
const COMPILED = ['spacing', 'mode'];

export class Controls {
  private readonly form = one<HTMLFormElement>('form');

  get settings(): Settings {
    const data = new FormData(this.form);
    return {
      spacing: data.get('spacing') as Settings['spacing'],
      mode: data.get('mode') as Settings['mode'],
      level: Number(data.get('level')),
      // A disabled input is not among the form's data.
      edge: this.input('edge').valueAsNumber,
      fill: data.has('fill'),
      lines: data.has('lines'),
    };
  }

  /** `then` is told whether what changed has to be compiled. */
  changed(then: (compile: boolean) => void): void {
    this.form.addEventListener('submit', (event) => event.preventDefault());
    this.form.addEventListener('input', (event) => {
      const { name } = event.target as HTMLInputElement;
      // With neither, there would be nothing to see.
      const { fill, lines } = this.settings;
      if (!fill && !lines) this.input(name === 'fill' ? 'lines' : 'fill').checked = true;
      this.say();
      then(COMPILED.includes(name));
    });
  }

  private input(name: string): HTMLInputElement {
    return this.form.elements.namedItem(name) as HTMLInputElement;
  }

  private output(name: string): HTMLOutputElement {
    return this.form.elements.namedItem(name) as HTMLOutputElement;
  }

  private say(): void {
    const { level, edge } = this.settings;
    this.output('level-shown').value = level > 0 ? String(level) : 'as the view asks';
    this.output('edge-shown').value = `${edge} pixels`;
    this.input('edge').disabled = level > 0;
  }

  scenes(scenes: readonly Scene[], choose: (scene: Scene) => void): void {
    one('.scenes').replaceChildren(
      ...scenes.map((scene, k) => {
        const label = document.createElement('label');
        const input = Object.assign(document.createElement('input'), { type: 'radio', name: 'scene', value: scene.name, checked: k === 0 });
        const text = Object.assign(document.createElement('span'), { textContent: scene.title });
        input.addEventListener('input', () => choose(scene));
        label.append(input, text);
        return label;
      }),
    );
  }

  describe(scene: Scene): void {
    one('.text').textContent = scene.text;
    this.input('edge').value = String(scene.edge);
    this.input('level').value = '0';
    this.say();
  }

  private show(name: string, text: string): void {
    one(`[data-count="${name}"]`).textContent = text;
  }

  count({ patches, head, triangles, bytes: size }: Counted): void {
    this.show('patches', whole.format(patches));
    this.show('discarded', whole.format(head.discarded));
    this.show('vertices', whole.format(head.vertices));
    this.show('triangles', whole.format(triangles));
    this.show('bytes', bytes(size));
    const lowered = one('.lowered');
    lowered.hidden = head.lowered === 0;
    lowered.textContent = `${whole.format(head.wantedPrimitives)} were asked for, more than the buffers hold: all levels are lowered evenly until they fit.`;
  }

  time(times: readonly { pass: string; milliseconds: number }[]): void {
    const sum = times.reduce((all, { milliseconds }) => all + milliseconds, 0);
    this.show('time', `${sum.toFixed(1)} ms`);
    const most = Math.max(...times.map(({ milliseconds }) => milliseconds), 0.1);
    one('.passes ol').replaceChildren(
      ...times.map(({ pass, milliseconds }) => {
        const line = document.createElement('li');
        const meter = Object.assign(document.createElement('meter'), { max: most, value: milliseconds });
        meter.ariaLabel = pass;
        const name = Object.assign(document.createElement('span'), { textContent: pass });
        line.append(name, meter, Object.assign(document.createElement('span'), { textContent: `${milliseconds.toFixed(2)} ms` }));
        return line;
      }),
    );
  }
}
