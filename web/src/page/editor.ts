// A text area with line numbers, colours, and marks at lines that do not compile.

import type { Fault } from '../stage/host.js';

const WORDS =
  /(\/\/.*)|(#\w+)|\b(fn|let|var|const|return|if|else|for|while|loop|switch|case|default|struct|select|break|continue|true|false)\b|\b([iu]32|f32|bool|vec[234](?:<[^>]*>)?|mat\dx\d|array|Patch(?:Levels)?|StageView|Vertex|StoredVertex|Surface|Shaded)\b|\b(\d[\w.]*)\b/g;

function escaped(text: string): string {
  return text.replace(/&/g, '&amp;').replace(/</g, '&lt;');
}

function coloured(text: string): string {
  let html = '';
  let last = 0;
  for (const match of text.matchAll(WORDS)) {
    html += escaped(text.slice(last, match.index));
    const kind = match[1] ? 'comment' : match[2] ? 'directive' : match[3] ? 'word' : match[4] ? 'type' : 'number';
    html += `<i class="${kind}">${escaped(match[0])}</i>`;
    last = match.index + match[0].length;
  }
  return html + escaped(text.slice(last));
}

export class Editor {
  private readonly area: HTMLTextAreaElement;
  private readonly paint: HTMLElement;
  private readonly gutter: HTMLElement;
  private readonly faults: HTMLElement;
  private wrong: readonly Fault[] = [];

  constructor(root: HTMLElement, changed: () => void) {
    const one = <T extends HTMLElement>(name: string): T => root.querySelector<T>(`[data-part="${name}"]`)!;
    this.area = one('area');
    this.paint = one('paint');
    this.gutter = one('gutter');
    this.faults = one('faults');
    this.area.addEventListener('input', () => {
      this.draw();
      changed();
    });
    this.area.addEventListener('scroll', () => this.follow());
    this.area.addEventListener('keydown', (event) => {
      // Escape leaves, so that the key that indents is no trap.
      if (event.key === 'Escape') this.area.blur();
      if (event.key !== 'Tab' || event.shiftKey) return;
      event.preventDefault();
      this.area.setRangeText('    ', this.area.selectionStart, this.area.selectionEnd, 'end');
      this.area.dispatchEvent(new Event('input'));
    });
  }

  get text(): string {
    return this.area.value;
  }

  set text(text: string) {
    this.area.value = text;
    this.area.scrollTop = 0;
    this.wrong = [];
    this.draw();
    this.faults.hidden = true;
  }

  /** Shows what does not compile. */
  mark(faults: readonly Fault[]): void {
    if (faults.length === 0 && this.wrong.length === 0) return;
    this.wrong = faults;
    this.draw();
    this.faults.replaceChildren(
      ...faults.slice(0, 4).map((fault) => {
        const line = document.createElement('button');
        line.type = 'button';
        line.textContent = `line ${fault.line}: ${fault.message}`;
        line.addEventListener('click', () => this.go(fault.line));
        return line;
      }),
    );
    this.faults.hidden = faults.length === 0;
  }

  private go(line: number): void {
    const lines = this.text.split('\n');
    const at = lines.slice(0, line - 1).join('\n').length + (line > 1 ? 1 : 0);
    this.area.focus();
    this.area.setSelectionRange(at, at + (lines[line - 1]?.length ?? 0));
    this.area.scrollTop = Math.max(0, (line - 4) * parseFloat(getComputedStyle(this.area).lineHeight));
  }

  private draw(): void {
    const lines = this.text.split('\n').length;
    const wrong = new Set(this.wrong.map((fault) => fault.line));
    this.paint.innerHTML = `${coloured(this.text)}\n`;
    this.gutter.innerHTML = Array.from({ length: lines }, (_, k) =>
      wrong.has(k + 1) ? `<b>${k + 1}</b>` : String(k + 1),
    ).join('\n');
    this.follow();
  }

  private follow(): void {
    this.paint.style.transform = `translate(${-this.area.scrollLeft}px, ${-this.area.scrollTop}px)`;
    this.gutter.style.transform = `translateY(${-this.area.scrollTop}px)`;
  }
}
