// How finely the view is drawn. A machine that draws by its processor alone draws more coarsely while something moves,
// so that the picture follows, and finely once it rests.

/** Time in ms after which what has not moved rests. */
export const REST = 250;
/** Longest mean time in ms between the pictures of a movement that the eye takes for smooth. */
const SMOOTH = 21;
/** Pictures that a mean is taken over. */
const COUNTED = 6;
const COARSER = 0.8;
const COARSEST = 0.4;

/** Pixels of the picture for each of the page, along an edge. */
export class Sharpness {
  /** Where nothing moves. */
  readonly still: number;
  /** As the display has it: where all is drawn in time, and in films, whose pictures are all of one size. */
  readonly usual: number;
  #moving: number;
  #last = -Infinity;
  #sum = 0;
  #count = 0;

  /** `bySoftware`: edges are not smoothed while something moves, and smoothed by more pixels when it rests. */
  constructor(display: number, bySoftware: boolean) {
    this.usual = Math.min(display, 2);
    this.still = bySoftware ? 2 : this.usual;
    this.#moving = this.usual;
  }

  /** Of the picture that is drawn at a time in ms, when the last ones took too long a coarser one. */
  moving(at: number): number {
    const since = at - this.#last;
    this.#last = at;
    if (since > REST) {
      // What made the last movement slow may be over.
      this.#moving = Math.min(this.#moving / COARSER, this.usual);
      [this.#sum, this.#count] = [0, 0];
      return this.#moving;
    }
    this.#sum += since;
    if (++this.#count === COUNTED) {
      if (this.#sum > SMOOTH * COUNTED) this.#moving = Math.max(this.#moving * COARSER, COARSEST * this.usual);
      [this.#sum, this.#count] = [0, 0];
    }
    return this.#moving;
  }
}

/** Whether a browser draws without a graphics card. */
export function drawsBySoftware(): boolean {
  const context = document.createElement("canvas").getContext("webgl2");
  const card = context?.getExtension("WEBGL_debug_renderer_info");
  const name = card ? String(context?.getParameter(card.UNMASKED_RENDERER_WEBGL)) : "";
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}
