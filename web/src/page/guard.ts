// Loops of a person's functions end, whatever they ask for: each round is counted, and the loops of a thread have so
// many rounds together. Without it a loop without an end holds the GPU until the browser takes the device away, and a
// software adapter for ever.

/** Rounds that the loops of one thread have together. */
export const MOST_ROUNDS = 1 << 14;

const TOKEN = /\/\/[^\n]*|\/\*[\s\S]*?\*\/|\b(?:for|while|loop)\b|\{|\n|[^/{\n\w]+|\w+|\//g;

/** Whether a text has a loop. */
export function loops(text: string): boolean {
  return text.match(TOKEN)?.some((token) => /^(?:for|while|loop)$/.test(token)) ?? false;
}

/** Where the line of a loop that was ended is written: of the passes at group 1; draws have no such place. */
const STOPPED = '@group(1) @binding(1) var<storage, read_write> web_stopped: atomic<u32>;';

/**
 * The text with every loop ended after its rounds. Lines stay the lines that they are. Where `told` is a number, the
 * passes write down the line of the loop that was ended, more by `told`.
 */
export function guarded(text: string, told?: number): string {
  if (!loops(text)) return text;
  let line = 1;
  let header = 0;
  // Of the loop that used the rounds up, not of those around it, which end with it.
  const first = `if (web_rounds == ${MOST_ROUNDS + 1}u) { atomicMax(&web_stopped, line); } `;
  const body = (text.match(TOKEN) ?? []).map((token) => {
    if (/^(?:for|while|loop)$/.test(token)) header = line;
    line += token.split('\n').length - 1;
    if (token !== '{' || header === 0) return token;
    const guard = `{ if (web_is_over(${header + (told ?? 0)}u)) { break; }`;
    header = 0;
    return guard;
  });
  return `${body.join('')}
${told === undefined ? '' : STOPPED}
var<private> web_rounds: u32;
fn web_is_over(line: u32) -> bool {
  web_rounds += 1u;
  if (web_rounds <= ${MOST_ROUNDS}u) { return false; }
  ${told === undefined ? '' : first}return true;
}
`;
}
