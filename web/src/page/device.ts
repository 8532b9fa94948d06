// A device of WebGPU's default limits and without optional features, or what to do where there is none.

/** Why there is nothing to draw with, and the way out. */
export class NoDevice extends Error {
  override name = 'NoDevice';
  constructor(
    readonly title: string,
    message: string,
  ) {
    super(message);
  }
}

export interface Opened {
  device: GPUDevice;
  name: string;
}

export async function open(): Promise<Opened> {
  // The types promise it; browsers do not.
  const gpu = navigator.gpu as GPU | undefined;
  if (!gpu) {
    throw isSecureContext
      ? new NoDevice(
          'This browser has no WebGPU',
          'Chrome and Edge have it from version 113 on (Android: 121), Safari from version 26, Firefox from version 141 on Windows.\nOn Linux, Chrome may need chrome://flags/#enable-unsafe-webgpu.',
        )
      : new NoDevice('WebGPU needs a secure page', 'Open this page by https:// or from localhost: browsers hide WebGPU from others.');
  }
  const adapter = await gpu.requestAdapter();
  if (!adapter) {
    throw new NoDevice(
      'The browser has WebGPU, but no GPU for it',
      'Turn on “Use graphics acceleration” in the browser’s settings, update the graphics driver, or start Chrome with --enable-unsafe-webgpu --use-webgpu-adapter=swiftshader, which draws in software. chrome://gpu says why a GPU is not used.',
    );
  }
  const device = await adapter.requestDevice();
  const { vendor, architecture, description } = adapter.info;
  return { device, name: description || [vendor, architecture].filter(Boolean).join(' ') || 'unnamed' };
}
