// A message over the picture: what is wrong, and the way out.

export class Message {
  constructor(
    private readonly root: HTMLElement,
    again: () => void,
  ) {
    root.querySelector('button')!.addEventListener('click', again);
  }

  show(title: string, text: string, again: boolean): void {
    this.root.querySelector('h2')!.textContent = title;
    this.root.querySelector('p')!.textContent = text;
    this.root.querySelector('button')!.hidden = !again;
    this.root.hidden = false;
  }

  hide(): void {
    this.root.hidden = true;
  }
}
