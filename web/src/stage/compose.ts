// From files with `#import` lines and `#ifdef`s to one module: what naga_oil does for Rust, as far as Dolomite's
// own files need it. Names of imported modules get their module's name in front, so that a user's functions may be
// called what they like.

/** WGSL files by their path below shaders/src. */
export type Files = ReadonlyMap<string, string>;

/** Text that does not become a module. */
export class ComposeError extends Error {
  override name = 'ComposeError';
  constructor(
    readonly file: string,
    /** From 1. */
    readonly line: number,
    message: string,
  ) {
    super(message);
  }
}

/** A module, and which line of which file each of its lines is. */
export interface Composed {
  code: string;
  /** File and line of each line of the code. */
  lines: readonly { file: string; line: number }[];
}

interface Module {
  file: string;
  path: string | undefined;
  /** Line by line; what is not WGSL or not asked for is empty. */
  lines: string[];
  /** Names as the imported module declares them, and as this one calls them. */
  imports: { path: string; names: (readonly [string, string])[]; line: number }[];
  /** Names that it declares. */
  declared: Set<string>;
}

const TOKEN = /\/\/.*|\/\*[\s\S]*?\*\/|[A-Za-z_][A-Za-z0-9_]*|0[xX][0-9a-fA-F]+[iu]?|[0-9][0-9a-zA-Z.]*|\s+|[\s\S]/g;
const NAME = /^[A-Za-z_][A-Za-z0-9_]*$/;

function preprocess(file: string, source: string, defs: ReadonlySet<string>): Module {
  const module: Module = { file, path: undefined, lines: [], imports: [], declared: new Set() };
  // Whether the lines of each open condition are taken.
  const taken: boolean[] = [];
  source.split('\n').forEach((text, number) => {
    const line = number + 1;
    const word = /^\s*#(\w+)\s*(.*?)\s*;?\s*$/.exec(text);
    if (!word) {
      module.lines.push(taken.every(Boolean) ? text : '');
      return;
    }
    module.lines.push('');
    const [, directive, rest] = word as unknown as [string, string, string];
    switch (directive) {
      case 'ifdef':
        taken.push(defs.has(rest));
        return;
      case 'ifndef':
        taken.push(!defs.has(rest));
        return;
      case 'else': {
        const last = taken.pop();
        if (last === undefined) throw new ComposeError(file, line, '#else without #ifdef');
        taken.push(!last);
        return;
      }
      case 'endif':
        if (taken.pop() === undefined) throw new ComposeError(file, line, '#endif without #ifdef');
        return;
      case 'define_import_path':
        module.path = rest;
        return;
      case 'import': {
        if (!taken.every(Boolean)) return;
        const list = /^([\w:]+)::\{([^}]*)\}$/.exec(rest) ?? /^([\w:]+)::(\w+)$/.exec(rest);
        if (!list) throw new ComposeError(file, line, `this import is not understood: ${rest}`);
        const names = list[2]!
          .split(',')
          .map((name) => name.trim().split(/\s+as\s+/))
          .filter(([name]) => name !== '')
          .map(([name, alias]) => [name!, alias ?? name!] as const);
        module.imports.push({ path: list[1]!, names, line });
        return;
      }
      default:
        throw new ComposeError(file, line, `#${directive} is not known here`);
    }
  });
  if (taken.length > 0) throw new ComposeError(file, module.lines.length, '#ifdef without #endif');
  for (const declaration of module.lines.join('\n').matchAll(/^(?:@[^\n]*\)\s*)?(?:const|var(?:<[^>]*>)?|fn|struct|alias|override)\s+([A-Za-z_]\w*)/gm)) {
    module.declared.add(declaration[1]!);
  }
  return module;
}

/** The text with names in the place of others: not those of members. */
function renamed(text: string, names: ReadonlyMap<string, string>): string {
  let before = '';
  let inStruct = false;
  let depth = 0;
  const tokens = text.match(TOKEN) ?? [];
  return tokens
    .map((token, place) => {
      const last = before;
      if (!/^\s|^\/[/*]/.test(token)) before = token;
      if (token === 'struct') inStruct = true;
      if (token === '{') depth += 1;
      if (token === '}') {
        depth -= 1;
        if (depth === 0) inStruct = false;
      }
      if (!NAME.test(token) || last === '.' || last === '@') return token;
      // A member of a struct, not its type.
      if (inStruct && depth > 0 && /^\s*:/.test(tokens.slice(place + 1, place + 3).join(''))) return token;
      return names.get(token) ?? token;
    })
    .join('');
}

/**
 * The module of the file `root` with all that it imports. `replaced` maps import paths to files that stand in the
 * place of those that have them, as a user's functions in that of dolomite::stage::user.
 */
export function compose(
  files: Files,
  root: string,
  defs: Iterable<string>,
  replaced: ReadonlyMap<string, string> = new Map(),
): Composed {
  const set = new Set(defs);
  const byPath = new Map<string, Module>();
  const all = new Map<string, Module>();
  for (const [file, source] of files) {
    if (file !== root && !source.startsWith('#define_import_path')) continue;
    const module = preprocess(file, source, set);
    all.set(file, module);
    if (module.path && ![...replaced.values()].includes(file)) byPath.set(module.path, module);
  }
  for (const [path, file] of replaced) {
    const source = files.get(file);
    if (source === undefined) throw new ComposeError(file, 1, 'there is no such file');
    const module = all.get(file) ?? preprocess(file, source, set);
    byPath.set(path, { ...module, path });
  }
  const start = all.get(root);
  if (!start) throw new ComposeError(root, 1, 'there is no such file');

  const order: Module[] = [];
  const seen = new Set<Module>();
  const visit = (module: Module): void => {
    if (seen.has(module)) return;
    seen.add(module);
    for (const { path, line } of module.imports) {
      const imported = byPath.get(path);
      if (!imported) throw new ComposeError(module.file, line, `there is no module ${path}`);
      visit(imported);
    }
    order.push(module);
  };
  visit(start);

  // How each module's names are called in the whole: the root's stay as they are.
  const prefix = (module: Module): string =>
    module === start ? '' : `${(module.path ?? module.file).replace(/^dolomite::/, '').replace(/\W+/g, '_')}_`;
  const lines: { file: string; line: number }[] = [];
  const code = order.map((module) => {
    const names = new Map<string, string>();
    for (const { path, names: own, line } of module.imports) {
      const imported = byPath.get(path)!;
      for (const [name, alias] of own) {
        if (!imported.declared.has(name)) throw new ComposeError(module.file, line, `${path} has no ${name}`);
        names.set(alias, prefix(imported) + name);
      }
    }
    if (module !== start) for (const name of module.declared) names.set(name, prefix(module) + name);
    module.lines.forEach((_, number) => lines.push({ file: module.file, line: number + 1 }));
    return renamed(module.lines.join('\n'), names);
  });
  return { code: code.join('\n'), lines };
}
