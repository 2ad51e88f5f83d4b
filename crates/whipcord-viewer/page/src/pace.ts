// One picture at a time where a processor draws them: a picture that is begun before the last one is there waits in a queue of the
// browser, and each in that queue makes what is seen older.

/** Time in ms between two looks whether a picture is there. */
const LOOK = 2;

export class Pace {
  readonly #context: WebGL2RenderingContext | undefined;
  readonly #took: (time: number) => void;
  #fence: WebGLSync | undefined;
  #begun = 0;
  #waiting: (() => void)[] = [];

  /** `took` hears how long each picture took, in ms. Without a context all is drawn as it comes. */
  constructor(context: WebGL2RenderingContext | undefined, took: (time: number) => void) {
    [this.#context, this.#took] = [context, took];
  }

  /** A picture has been handed over to be drawn. */
  begun(): void {
    const context = this.#context;
    if (!context) return;
    const waited = this.#fence !== undefined;
    if (this.#fence) context.deleteSync(this.#fence);
    this.#fence = context.fenceSync(context.SYNC_GPU_COMMANDS_COMPLETE, 0) ?? undefined;
    context.flush();
    this.#begun = performance.now();
    if (!waited) window.setTimeout(() => this.#look(), LOOK);
  }

  /** Does this when the last picture is there. */
  whenFree(act: () => void): void {
    if (this.#fence) this.#waiting.push(act);
    else act();
  }

  #look(): void {
    const context = this.#context;
    if (!context || !this.#fence) return;
    const isThere = context.getSyncParameter(this.#fence, context.SYNC_STATUS) === context.SIGNALED || context.isContextLost();
    if (!isThere) {
      window.setTimeout(() => this.#look(), LOOK);
      return;
    }
    context.deleteSync(this.#fence);
    this.#fence = undefined;
    this.#took(performance.now() - this.#begun);
    for (const act of this.#waiting.splice(0)) act();
  }
}
