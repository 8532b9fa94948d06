// Bad input of every kind: a message that says what to do, and nothing hangs.

import type { Browser, Page } from 'playwright-core';
import { closed, opened, type Say, state } from './opened.js';

/** Browsers in which the page has nothing to draw with: what is missing, a script that takes it away, the message's words. */
const MISSING = [
  ['no WebGPU', "Object.defineProperty(Navigator.prototype, 'gpu', { get: () => undefined });", ['no WebGPU', 'Chrome']],
  ['no adapter', 'GPU.prototype.requestAdapter = async () => null;', ['no GPU', 'Chrome']],
  [
    'a page that is not secure',
    "Object.defineProperty(Navigator.prototype, 'gpu', { get: () => undefined }); Object.defineProperty(window, 'isSecureContext', { value: false });",
    ['secure', 'https'],
  ],
  ['an adapter that refuses', "GPUAdapter.prototype.requestDevice = async () => { throw new Error('out of memory'); };", ['cannot start', 'out of memory']],
] as const;

export async function cannotStart(browser: Browser, address: string, say: Say): Promise<void> {
  for (const [what, script, words] of MISSING) {
    const it = await opened(browser, address, script);
    await state(it.page, 'failed');
    const text = await it.page.locator('.message').innerText();
    say(words.every((word) => text.includes(word)), `${what}: ${text.replace(/\s+/g, ' ').slice(0, 100)}`);
    await closed(it, say, what);
  }
}

/** The line in which a text has some words, from 1. */
const lineOf = (text: string, words: string): number => text.split('\n').findIndex((line) => line.includes(words)) + 1;

/** Functions that do not compile or do not end, no room, a device that goes: on a page that draws the sphere. */
export async function breaks(page: Page, say: Say): Promise<void> {
  const editor = page.locator('textarea');
  const text = await editor.inputValue();
  const marked = async (): Promise<string> => (await page.locator('.gutter b').allInnerTexts()).join();
  const fault = async (): Promise<string> => (await page.locator('.faults button').first().innerText()).slice(0, 110);

  const wrong = lineOf(text, 'let height = relief');
  await editor.fill(text.split('\n').map((line, k) => (k + 1 === wrong ? line.replace('given.z', 'given.nothing') : line)).join('\n'));
  await state(page, 'faulty');
  say((await marked()) === String(wrong), `a fault in line ${wrong} is marked in ${await marked()}: ${await fault()}`);

  const loop = lineOf(text, 'k < 8u; k++');
  for (const [what, bound] of [['no end', 'true; k++'], ['an end that never comes', 'k < 8u; k += 0u']] as const) {
    await editor.fill(text.split('\n').map((line, k) => (k + 1 === loop ? line.replace('k < 8u; k++', bound) : line)).join('\n'));
    await state(page, 'endless');
    say((await marked()) === String(loop), `a loop with ${what} in line ${loop} is marked in ${await marked()}: ${await fault()}`);
    await editor.fill(text);
    await state(page, 'drawn');
  }

  for (const [what, source, words] of [
    ['nothing at all', '', 'control'],
    ['a function that is missing', text.replaceAll('fn evaluate', 'fn elevate'), 'evaluate'],
    ['a function that calls itself', text.replace('fn control(', 'fn again(x: u32) -> u32 { return again(x); }\nfn control('), 'again'],
    ['no WGSL', 'Lorem ipsum dolor sit amet', ''],
    ['a directive that is not closed', `${text}\n#ifdef NEVER\n`, '#endif'],
  ] as const) {
    await editor.fill(source);
    await state(page, 'faulty');
    const said = await fault();
    say(said.includes(words) && said.startsWith('line '), `${what}: ${said}`);
  }

  const changed = text.replace('* (1.0 + 1.5', '* (1.1 + 1.5').replace('1.0 + given.y * height.w', '1.0 + 0.2 * given.y * height.w');
  await editor.fill(changed);
  await state(page, 'drawn');
  say((await marked()) === '' && changed !== text, 'functions that compile are drawn');

  await page.addStyleTag({ content: '.no-room { height: 0 !important; min-height: 0 !important; border: 0 !important }' });
  const stage = page.locator('.stage');
  await stage.evaluate((element) => element.classList.add('no-room'));
  await state(page, 'no-room');
  say((await page.locator('.message h2').innerText()).includes('no room'), 'a canvas of 0 × 0: a message');
  await stage.evaluate((element) => element.classList.remove('no-room'));
  await state(page, 'drawn');
  say(await page.locator('.message').isHidden(), 'with room again it is drawn');

  await page.evaluate('window.lastDevice.destroy()');
  await state(page, 'lost');
  const message = await page.locator('.message').innerText();
  say(message.includes('gone') && message.includes('Start again'), `a lost device: ${message.replace(/\s+/g, ' ').slice(0, 100)}`);
  await page.locator('.message button').click();
  await state(page, 'drawn');
  say(await page.locator('.message').isHidden(), 'a new device at a press');
}
